/// core/contact/contact_place.h: the place of the tool's surface at which it is nearest to bone, or deepest in it.
///   Frame  tool frame, except where named.   Units  SI.   Errors  none.   Thread  contact; never allocates.
///   Source own derivation.
///   settle()  Near a place q with distance d, outward normal n and radius of curvature R, bone is a ball with the centre x = q - (d + R) n.
///             The place of the tool nearest to x is the contact, the way from x to it the normal, its length less R the gap: exact for
///             balls and planes against any tool. At an edge of bone R is small, and the normal is that of the tool's face; on smooth bone R
///             is large, and the normal is that of bone; where two edges cross it is perpendicular to both.
///   search()  From a shell point: the place of the tool's face whose normal is opposite to that of bone, or where the cell of the point ends.
///             If bone rises again on the way, an edge or a crest is between: there the tangents at both ends cross.
#pragma once

#include <optional>

#include "core/contact/surface_probe.h"
#include "core/tool/tool_surface.h"

namespace burrhole {

struct ContactPlace {
  Vec3 at{0.0};       ///< [m]
  Vec3 normal{0.0};   ///< [-] outward normal of bone there, bone frame
  double gap = 0.0;   ///< [m]
  double bend = 0.0;  ///< [1/m] sum of bone's principal curvatures there
};

class PlaceFinder {
 public:
  PlaceFinder(const ToolSurface* surface, const RecordView& bone, const Pose& bone_from_tool) noexcept;

  /// @returns distance and normal of bone at a place; empty where they are not known.
  [[nodiscard]] std::optional<ContactPlace> sample(const Vec3& at) const noexcept;
  /// @returns the place of the cell round `home` that is deepest. @param radius [m] of the cell.
  [[nodiscard]] std::optional<ContactPlace> search(const Vec3& home, double radius) const noexcept;
  /// @param from what is known at a place near the contact; its normal may be a better one than the records'.
  /// @returns the contact; empty where the tool has none that is consistent.
  [[nodiscard]] std::optional<ContactPlace> settle(const ContactPlace& from) const noexcept;

 private:
  [[nodiscard]] Vec3 in_tool(const Vec3& bone_direction) const noexcept { return bone_direction * axes_; }
  [[nodiscard]] std::optional<ContactPlace> deepest_of_ring(const Vec3& home, double radius) const noexcept;
  [[nodiscard]] ContactPlace between(const ContactPlace& start, const ContactPlace& end) const noexcept;

  const ToolSurface* surface_;
  RecordSampler records_;
  Affine index_from_tool_;
  Mat3 axes_;  // of the tool, bone frame
  double edge_;
};

}  // namespace burrhole
