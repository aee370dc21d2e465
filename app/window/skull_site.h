/// app/window/skull_site.h: regions of a skull that a key chooses, and the scene file that drills a site. It knows no window.
///   Frame  bone frame, which is the patient frame of a scan (LPS: x left, y posterior, z superior).   Units  SI.
///   Errors bad_input with one line for the person.   Thread  any; reads the bone alone.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/measure/drill_site.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

/// A place that a key chooses: where a ray towards the middle of the braincase meets bone.
struct SkullRegion {
  const char* name;
  Vec3 outward;  ///< [-] from the middle of the braincase
};
[[nodiscard]] const std::array<SkullRegion, 6>& skull_regions() noexcept;
/// @returns the point of the outermost bone there; nothing if there is none.
[[nodiscard]] std::optional<Vec3> find_region(const BoneModel& bone, const SkullRegion& region);

/// What a scene says of the volume.
struct SkullSource {
  std::string path;            ///< absolute, of the scan
  std::string unit{};          ///< of a mesh or of another program's .vdb; empty: the file states its own
  bool is_bone_model = false;  ///< the file holds a bone model, which is used at its own voxels
  std::string series{};        ///< of a DICOM folder, SeriesLine::name; empty: the file is one volume
  std::string link{};          ///< by which the scene names the scan; empty: its path
};

/// @returns a scene file with the defaults of app/scenes/head_phantom.toml: a perforator, its hand, contact, erosion, picture and record.
[[nodiscard]] std::string site_scene(const DrillSite& site, const SkullSource& source);

}  // namespace burrhole
