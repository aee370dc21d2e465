/// app/window/skull_site.h: a place for a hole on a bone, from what a person points at: the point that is seen, the axis square to the bone
/// there, and the scene file that drills it. It knows no window.
///   Frame  bone frame, which is the patient frame of a scan (LPS: x left, y posterior, z superior).   Units  SI.
///   Errors bad_input with one line for the person.   Thread  any; reads the bone alone.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

/// @returns where a ray first meets the 0.5 level of occupancy; nothing if it meets none. @param direction length 1.
[[nodiscard]] std::optional<Vec3> find_bone(const BoneModel& bone, const Vec3& from, const Vec3& direction);

/// @returns the outward normal of the plane through the surface within `radius` [m] of a point, by least squares, as a bit of that size
/// would stand. Steps to deeper surfaces, such as the edge of a hole, are left out. @param outward length 1, roughly: towards a person who
/// sees the point. It is returned where there is too little surface.
[[nodiscard]] Vec3 disc_normal(const BoneModel& bone, const Vec3& at, const Vec3& outward, double radius);

struct SkullSite {
  Vec3 entry{0.0};            ///< [m] on the outer surface
  Vec3 axis{0.0, 0.0, -1.0};  ///< [-] into bone, square to the surface
  double thickness = 0.0;     ///< [m] of bone along the axis
};

/// @param at a point of the surface. @param outward as disc_normal().
/// @returns the site; bad_input if the bone does not end along the axis, as under the base of a skull.
[[nodiscard]] Result<SkullSite> make_site(const BoneModel& bone, const Vec3& at, const Vec3& outward);

/// A place that a key chooses: where a ray towards the middle of the braincase meets bone.
struct SkullRegion {
  const char* name;
  Vec3 outward;  ///< [-] from the middle of the braincase
};
[[nodiscard]] const std::array<SkullRegion, 6>& skull_regions() noexcept;
/// @returns the point of the outermost bone there; nothing if there is none.
[[nodiscard]] std::optional<Vec3> find_region(const BoneModel& bone, const SkullRegion& region);
/// @returns the middle of the braincase: 75 mm below the highest bone, or the middle of a bone that is smaller than a head.
[[nodiscard]] Vec3 braincase_middle(const BoneModel& bone);

/// What a scene says of the volume.
struct SkullSource {
  std::string path;            ///< absolute, of the scan
  std::string unit{};          ///< of a mesh or of another program's .vdb; empty: the file states its own
  bool is_bone_model = false;  ///< the file holds a bone model, which is used at its own voxels
  std::string series{};        ///< of a DICOM folder, SeriesLine::name; empty: the file is one volume
};

/// @returns a scene file with the defaults of app/scenes/head_phantom.toml: a perforator, its hand, contact, erosion, picture and record.
[[nodiscard]] std::string site_scene(const SkullSite& site, const SkullSource& source);

}  // namespace burrhole
