/// app/job/provenance.h: what made the results of a run. Holds no path of a folder and no field of a patient.
///   Units  in the names.   Frame  none.   Errors  none.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/scene/load.h"

namespace burrhole {

struct RunProvenance {
  std::string program;                                          ///< name and version
  std::string date;                                             ///< ISO 8601, UTC, start of the run
  std::string machine;                                          ///< model of the processor, number of its threads
  std::vector<std::string> overrides, tool_overrides;           ///< changes of the scene's and of the tool's file for this run
  std::vector<std::pair<std::string, double>> erosion_factors;  ///< [1/rev] of each cutting region, times tool.erosion_scale
  std::string scene_hash, tool_hash;                            ///< of the texts with the changes, without folders
  std::string scene_place;                                      ///< place_of_scene(); filled by drill()
  std::optional<std::string> volume_hash;                       ///< of occupancy, hardness and remaining; nothing for a bone in a file
  bool drilled_before = false;                                  ///< the bone had holes at the start
};

/// @returns overrides, erosion factors and hashes of scene and tool: what does not depend on the bone.
[[nodiscard]] RunProvenance text_provenance(const LoadedScene& loaded);
/// @param date ISO 8601. @param drilled_before Voxmap::starts_drilled().
[[nodiscard]] RunProvenance provenance_of(const LoadedScene& loaded, const std::string& date, bool drilled_before);

/// @returns a hash by which results know their scene's file: of its path relative to the folder of the results, so that both may move
/// together; of a scene in the folder `shipped`, of its name.
[[nodiscard]] std::string place_of_scene(const std::string& scene_file, const std::string& results, const std::string& shipped);

/// @returns the title of a run: that of its scene, and the bit in use.
[[nodiscard]] std::string run_title(const LoadedScene& loaded);

/// @returns the text with every absolute path replaced by its last component, and the path of a scan by "<path>": the folder of a scan may
/// have a patient's name.
[[nodiscard]] std::string without_folders(std::string_view text);

/// @returns the hash of all voxels of a bone that are not empty, independent of how it is stored; nothing for a paged bone, which would be
/// read from its file as a whole.
[[nodiscard]] std::optional<std::uint64_t> volume_hash(const BoneModel& bone);

}  // namespace burrhole
