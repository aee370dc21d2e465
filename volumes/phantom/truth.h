/// volumes/phantom/truth.h: closed form of a generated bone, the reference for measured surfaces, normals and thicknesses.
///   Frame  bone frame.   Units  SI.   Errors  none.   Thread  any; immutable.
///   Rays are limited to the box of the grid (voxel cells included). Distances and normals are those of the shape itself, which extends
///   beyond the box for plate, pit, wedge and a patch without a rim.
#pragma once

#include <optional>
#include <variant>

#include "core/voxel/bone_model.h"
#include "volumes/phantom/phantom_spec.h"
#include "volumes/phantom/shapes.h"

namespace burrhole {

class Truth {
 public:
  /// @pre validate(spec) found no error.
  explicit Truth(const PhantomSpec& spec);

  /// @returns Euclidean distance [m] from the bone's surface, negative inside.
  [[nodiscard]] double signed_distance(const Vec3& p_bone) const noexcept { return nearest(p_bone).signed_distance; }
  /// @returns outward unit normal of the nearest surface point; see shapes.h for edges and ties.
  [[nodiscard]] Vec3 normal(const Vec3& p_bone) const noexcept { return nearest(p_bone).normal; }
  /// Distance and normal together.
  [[nodiscard]] SurfaceDistance nearest(const Vec3& p_bone) const noexcept;

  /// @returns the total length [m] of bone ahead of the origin along the direction (any length except 0).
  [[nodiscard]] double thickness_along(const Vec3& origin, const Vec3& direction) const noexcept;
  /// @returns the distance [m] from the origin to the first bone ahead, 0 if the origin is inside; nothing if there is none.
  [[nodiscard]] std::optional<double> entry_distance(const Vec3& origin, const Vec3& direction) const noexcept;

  /// @returns the tissue at a point: bone or none; for skull_patch the tables, diploe, dura and brain by depth below the outer surface.
  [[nodiscard]] VoxelLabel label(const Vec3& p_bone) const noexcept;

  /// Corners of the box of the grid [m], bone frame.
  [[nodiscard]] const Vec3& box_lo() const noexcept { return box_lo_; }
  [[nodiscard]] const Vec3& box_hi() const noexcept { return box_hi_; }

 private:
  [[nodiscard]] RaySpans stretches(const Vec3& origin, const Vec3& direction) const noexcept;

  std::variant<ShellShape, BoxShape, SlabShape, BallShape, CapsuleShape, WedgeShape, PitShape> shape_;
  Vec3 box_lo_{0.0};
  Vec3 box_hi_{0.0};
  PhantomSpec spec_;
};

}  // namespace burrhole
