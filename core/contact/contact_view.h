/// core/contact/contact_view.h: queries of contact models on bone: density and gradient per voxel, and points of the 0.5 surface.
///   Frame  world for points in arguments and results, index where stated.   Units SI; density 0..1.   Thread contact, one reader per view.
#pragma once

#include <cmath>
#include <optional>

#include "core/base/geometry.h"
#include "core/voxel/contact_window.h"
#include "core/voxel/vdb_contact_grids.h"

namespace burrhole {

/// Level of occupancy x remaining that defines the surface of bone for contact, display, meshes and measurement.
inline constexpr float kSurfaceLevel = 0.5f;

/// @returns whether each coordinate of an index is below 1e9 in magnitude; false for NaN. Such an index, and those that a march reaches
/// from it, can be converted to int. A device may report any position, and the conversion of a number beyond the range of int is undefined.
[[nodiscard]] inline bool holds_index(const Vec3& index) noexcept {
  constexpr double kLargest = 1e9;
  return std::abs(index.x) < kLargest && std::abs(index.y) < kLargest && std::abs(index.z) < kLargest;
}

/// A point of the 0.5 surface [m] with its outward unit normal [-], world frame.
struct SurfacePoint {
  Vec3 position;  ///< [m]
  Vec3 normal;    ///< [-]
};

class ContactView {
 public:
  /// A view of the dense window; `window` must outlive the view and contain the fields that are queried.
  ContactView(const ContactWindow& window, const Affine& bone_from_index, const Pose& world_from_bone);
  /// A view of the storage of the paper; bone is known everywhere, not only in a window.
  ContactView(const VdbContactGrids& grids, const Affine& bone_from_index, const Pose& world_from_bone);

  [[nodiscard]] Vec3 index_of(const Vec3& world) const noexcept { return index_from_world_ * world; }
  [[nodiscard]] Vec3 world_of(const Vec3& index) const noexcept { return world_from_index_ * index; }
  /// The direction in index axes of a world direction (not normalised).
  [[nodiscard]] Vec3 index_direction(const Vec3& world) const noexcept { return index_from_world_.linear * world; }
  /// Outward world normal for a density gradient in index axes. A gradient is a covector: it maps by the transposed inverse.
  [[nodiscard]] Vec3 outward_normal(const Vec3& index_gradient) const noexcept;
  [[nodiscard]] double voxel_edge() const noexcept { return voxel_edge_; }

  /// True where density and gradient are both known.
  [[nodiscard]] bool knows(const Vec3i& v) const noexcept { return grids_ != nullptr || valid_.contains(v); }
  /// Density [-] of a voxel; 0 outside the known part.
  [[nodiscard]] float density(const Vec3i& v) const noexcept {
    if (grids_ != nullptr) return grids_->density(v);
    return valid_.contains(v) ? density_[box_.offset_of(v)] : 0.0f;
  }
  /// Gradient of the density [1/voxel], index axes; zero outside the known part.
  [[nodiscard]] Vec3f gradient(const Vec3i& v) const noexcept {
    if (grids_ != nullptr) return grids_->gradient(v);
    return valid_.contains(v) ? gradient_[box_.offset_of(v)] : Vec3f(0.0f);
  }
  /// Packed words over box(), outermost layer empty; nullptr where the window has none.
  [[nodiscard]] const ContactWord* words() const noexcept { return words_; }
  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  [[nodiscard]] const Affine& world_from_index() const noexcept { return world_from_index_; }
  [[nodiscard]] const Affine& index_from_world() const noexcept { return index_from_world_; }
  /// Triangles of the surface; nullptr where the window has none.
  [[nodiscard]] const TrianglePatch* triangles() const noexcept { return triangles_; }
  [[nodiscard]] const Pose& world_from_bone() const noexcept { return world_from_bone_; }
  /// Trilinear density at a point in index coordinates.
  [[nodiscard]] double sample(const Vec3& index) const noexcept;
  /// Trilinear gradient [1/voxel], index axes.
  [[nodiscard]] Vec3 sample_gradient(const Vec3& index) const noexcept;

  /// Searches the first crossing of the 0.5 level along a ray from a point inside bone, in steps of half a voxel edge, and refines it with
  /// three steps of false position: the error is below 0.002 voxel on smooth fields (tested). The normal is that of the density; where the
  /// density has no gradient, it is `direction`. @param from [m] world. @param direction unit vector, world. @param reach [m] length of the
  /// ray. @returns nothing if the ray stays in bone.
  [[nodiscard]] std::optional<SurfacePoint> leave_bone(const Vec3& from, const Vec3& direction, double reach) const noexcept;

 private:
  void set_frames(const Affine& bone_from_index, const Pose& world_from_bone);

  Affine world_from_index_, index_from_world_;
  Pose world_from_bone_;
  double voxel_edge_ = 0.0;
  VoxelBox box_, valid_;
  const float* density_ = nullptr;
  const Vec3f* gradient_ = nullptr;
  const ContactWord* words_ = nullptr;
  const TrianglePatch* triangles_ = nullptr;
  const VdbContactGrids* grids_ = nullptr;
};

}  // namespace burrhole
