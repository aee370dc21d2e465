/// core/zone/distance_field.h: distance to a set of voxels: signed, exact and Euclidean at voxel centres, trilinear between them.
///   Frame   index coordinates; the edges of a voxel may differ but are perpendicular to each other.   Units  m.
///   Values  outside the set  min |p - q| - h / 2 over the centres q of the set, inside  h / 2 - min |p - q| over the centres q of the rest;
///           h the mean edge. Limited to +- reach. For a body of which a voxel belongs to the set if its centre is in the body, the value
///           at a centre is within sqrt(3) h of the distance to the body's surface, and exact for a face halfway between two layers of voxels.
///   Errors  out_of_range from create().   Thread  any; constant after creation.   `at()` neither allocates nor locks.
///   Source  squared distances axis by axis, by lower envelopes of parabolas: Felzenszwalb & Huttenlocher 2012.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// Distance from a point, and the direction in which it grows fastest.
struct NearestZone {
  double distance = 0.0;  ///< [m] negative inside
  Vec3 away{0.0};         ///< [-] unit, axes of the index coordinates in metres; 0 where the distance has no slope, as beyond the reach
};

class DistanceField {
 public:
  /// @returns for a box of voxels, i fastest, whether each belongs to the set: 1 or 0. The box may reach beyond the volume.
  using Members = std::function<void(const VoxelBox& box, std::span<std::uint8_t> inside)>;

  /// @param box in which the distance is known. @param edges [m] of a voxel. @param reach [m]: members up to that distance from the box are
  /// read. out_of_range: an empty box, a length that is not finite and above 0, or more than kMostVoxels.
  [[nodiscard]] static Result<DistanceField> create(const VoxelBox& box, const Vec3& edges, double reach, const Members& members);
  static constexpr std::size_t kMostVoxels = 200'000'000;  ///< of the box and the reach round it

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  [[nodiscard]] double reach() const noexcept { return reach_; }
  /// @returns whether the field is known at a point of index coordinates.
  [[nodiscard]] bool knows(const Vec3& index) const noexcept;
  /// @pre knows(index).
  [[nodiscard]] NearestZone at(const Vec3& index) const noexcept BH_REALTIME;
  [[nodiscard]] float value(const Vec3i& voxel) const noexcept {
    return values_[box_.offset_of(voxel)];
  }  ///< [m] @pre box().contains(voxel)
  /// @returns whether a voxel of the set lies within the reach of the box.
  [[nodiscard]] bool has_members() const noexcept { return has_members_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return values_.size() * sizeof(float); }

 private:
  DistanceField(const VoxelBox& box, const Vec3& edges, double reach) : box_(box), edges_(edges), reach_(reach) {}
  VoxelBox box_;
  Vec3 edges_;
  double reach_;
  bool has_members_ = false;
  std::vector<float> values_;  // [m]
};

/// Squared distances [m^2] to the nearest voxel of a box for which `inside` is `wanted`, at every voxel of the box; infinity if there is none.
[[nodiscard]] std::vector<float> squared_distances(const Vec3i& size, const Vec3& edges, std::span<const std::uint8_t> inside,
                                                   std::uint8_t wanted);

/// Distance from a tube: a segment with a radius, as a venous sinus. @returns negative inside.   @pre radius > 0.
[[nodiscard]] NearestZone distance_to_tube(const Vec3& from, const Vec3& to, double radius, const Vec3& point) noexcept;

}  // namespace burrhole
