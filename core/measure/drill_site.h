/// core/measure/drill_site.h: a place for a hole on a bone as loaded: the surface that a ray meets, and the axis square to the bone there.
///   Frame  bone frame, which is the patient frame of a scan (LPS: x left, y posterior, z superior).   Units  SI.
///   Errors bad_input with one line for the person.   Thread  any; reads the bone alone.   Source  own definition.
#pragma once

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

struct DrillSite {
  Vec3 entry{0.0};            ///< [m] on the outer surface
  Vec3 axis{0.0, 0.0, -1.0};  ///< [-] into bone, square to the surface
  double thickness = 0.0;     ///< [m] of bone along the axis
};

/// @param at a point of the surface. @param outward as disc_normal().
/// @returns the site; bad_input if the bone does not end along the axis, as under the base of a skull.
[[nodiscard]] Result<DrillSite> make_site(const BoneModel& bone, const Vec3& at, const Vec3& outward);

/// @returns the middle of the braincase: 75 mm below the highest bone of the largest part, or the middle of a bone that is smaller than a head.
[[nodiscard]] Vec3 braincase_middle(const BoneModel& bone);

/// Proposes a site near a point that a person gives, in bone or beside it: the place nearest to it on the outer surface of the largest part of
/// the bone, seen from outside, whose axis leads into the skull, through 20 mm of bone at most. @param near [m]. @returns bad_input with the
/// box of the bone if there is none within 30 mm.
[[nodiscard]] Result<DrillSite> suggest_site(const BoneModel& bone, const Vec3& near);
/// @returns the distance [m] from the axis of a site, from its entry to its end in bone, to the nearest end of the volume, in which bone is
/// known; at least 0.
[[nodiscard]] double distance_to_edge(const BoneModel& bone, const DrillSite& site);
/// @returns the table [approach] of a scene with this site.
[[nodiscard]] std::string approach_text(const DrillSite& site);

}  // namespace burrhole
