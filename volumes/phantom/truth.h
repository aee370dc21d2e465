/// volumes/phantom/truth.h: the closed form of a generated bone: what every measured surface, normal and thickness is compared with.
///   Frame  bone frame.   Units  SI.
///   The grid ends where it ends: rays see only the bone inside the grid's box (voxel cells included), while distances and normals are
///   those of the shape itself, which for plate, pit, wedge and a patch without a rim runs on past the box.
#pragma once

#include <optional>
#include <variant>

#include "core/voxel/bone_model.h"
#include "volumes/phantom/phantom_spec.h"
#include "volumes/phantom/shapes.h"

namespace burrhole {

class Truth {
 public:
  /// @pre validate(spec) found nothing.
  explicit Truth(const PhantomSpec& spec);

  /// @returns Euclidean distance [m] from the bone's surface, negative inside.
  [[nodiscard]] double signed_distance(const Vec3& p_bone) const noexcept { return nearest(p_bone).signed_distance; }
  /// @returns outward unit normal of the nearest surface point; see shapes.h for edges and ties.
  [[nodiscard]] Vec3 normal(const Vec3& p_bone) const noexcept { return nearest(p_bone).normal; }
  /// Both at once.
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p_bone) const noexcept;

  /// @returns length [m] of bone ahead of the origin along the direction (any length but 0), all stretches added.
  [[nodiscard]] double thickness_along(const Vec3& origin, const Vec3& direction) const noexcept;
  /// @returns distance [m] from the origin to the first bone ahead, 0 from inside; nothing if there is none.
  [[nodiscard]] std::optional<double> entry_distance(const Vec3& origin, const Vec3& direction) const noexcept;

  /// @returns tissue at a point: bone or none; for skull_patch tables, diploe, dura and brain by depth below the outer surface.
  [[nodiscard]] VoxelLabel label(const Vec3& p_bone) const noexcept;

  /// Ends of the grid's box [m], bone frame.
  [[nodiscard]] const Vec3& box_lo() const noexcept { return box_lo_; }
  [[nodiscard]] const Vec3& box_hi() const noexcept { return box_hi_; }

 private:
  [[nodiscard]] RaySpans stretches(const Vec3& origin, const Vec3& direction) const noexcept;

  std::variant<ShellShape, BoxShape, SlabShape, BallShape, WedgeShape, PitShape> shape_;
  Vec3 box_lo_{0.0};
  Vec3 box_hi_{0.0};
  PhantomSpec spec_;
};

}  // namespace burrhole
