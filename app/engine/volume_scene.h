/// app/engine/volume_scene.h: the [volume] table: a phantom, a bone model saved earlier, or a scan or mesh that is imported at load.
///   Units SI; keys in the file carry their unit and are converted here and nowhere else.
#pragma once

#include <optional>
#include <string>

#include "app/engine/import.h"
#include "core/base/toml.h"
#include "volumes/phantom/phantom_spec.h"

namespace burrhole {

/// A file or folder to import. The region's centre is not known here: it hangs on the approach.
struct ScanScene {
  ImportRequest request;
  std::optional<Vec3> region;  ///< [m] size of the box round the approach that is kept; key region_mm
};

/// [volume]
struct VolumeScene {
  std::optional<PhantomSpec> phantom;
  std::optional<ScanScene> scan;     ///< when no phantom; .vdb files too
  std::string place;                 ///< of `source`, for faults found later
  Pose world_from_bone;              ///< keys position_mm, turn_deg (about x, then y, then z)
  double gradient_dead_zone = 0.08;  ///< [density/voxel]
};

/// How far below the entry the region's centre lies, along the axis: a skull is 5 to 9 mm thick.
inline constexpr double kRegionDepth = 5e-3;  // [m]

/// Pushes faults to the table's Issues. @param scene_file paths are relative to its folder; `$NAME` at their start is the environment's.
[[nodiscard]] VolumeScene read_volume(TableReader table, const std::string& scene_file);

/// "mm", "cm", "m", "in" in metres.
[[nodiscard]] const std::vector<std::string>& length_unit_names();
[[nodiscard]] double length_unit(const std::string& name);

}  // namespace burrhole
