/// core/base/geometry.h: vectors, poses and boxes shared by every folder.
///   Frames  world (LPS, patient), index (voxel centres at integers; i is x and fastest), tool (origin at the tip, +z up the shaft).
///   Units   SI unless a name says otherwise.   Errors  none.   Thread  any: values without shared state.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace burrhole {

using Vec3 = glm::dvec3;
using Vec3f = glm::fvec3;
using Vec3i = glm::ivec3;
using Mat3 = glm::dmat3;
using Quat = glm::dquat;

[[nodiscard]] inline bool is_finite(const Vec3& v) noexcept { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Rigid transform. Names state both frames, target first: world_from_tool * p_tool = p_world.
struct Pose {
  Quat rotation{1.0, 0.0, 0.0, 0.0};  ///< [-] unit length
  Vec3 translation{0.0};              ///< [m]

  [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return rotation * p + translation; }
  [[nodiscard]] Pose operator*(const Pose& b) const noexcept { return {rotation * b.rotation, rotation * b.translation + translation}; }
  [[nodiscard]] Vec3 rotate(const Vec3& v) const noexcept { return rotation * v; }
  [[nodiscard]] Pose inverse() const noexcept {
    const Quat r = glm::conjugate(rotation);
    return {r, -(r * translation)};
  }
};

/// @returns the shortest rotation that maps +z to `axis`. @pre `axis` has length 1.
[[nodiscard]] inline Quat rotation_from_z(const Vec3& axis) noexcept {
  // 1 + z loses digits near z = -1; (x^2 + y^2) / (1 - z) is the same value and does not.
  const double across2 = axis.x * axis.x + axis.y * axis.y;
  if (axis.z < 0.0 && across2 == 0.0) return Quat(0.0, 1.0, 0.0, 0.0);
  const Quat q(axis.z < -0.5 ? across2 / (1.0 - axis.z) : 1.0 + axis.z, -axis.y, axis.x, 0.0);
  return glm::normalize(q);
}

/// Affine map. Scans may be oblique or sheared, so voxel-to-world is never reduced to spacing and origin.
struct Affine {
  Mat3 linear{1.0};  ///< [m] per index step for voxel-to-world maps, columns are the images of the axes
  Vec3 offset{0.0};  ///< [m]

  [[nodiscard]] Vec3 operator*(const Vec3& p) const noexcept { return linear * p + offset; }
  [[nodiscard]] Affine operator*(const Affine& b) const noexcept { return {linear * b.linear, linear * b.offset + offset}; }
  [[nodiscard]] Affine inverse() const noexcept {
    const Mat3 inv = glm::inverse(linear);
    return {inv, -(inv * offset)};
  }
  [[nodiscard]] static Affine from_pose(const Pose& pose) noexcept { return {glm::mat3_cast(pose.rotation), pose.translation}; }
  [[nodiscard]] static Affine scaling(double edge, const Vec3& offset) noexcept { return {Mat3(edge), offset}; }
  /// @returns the edge [m] of the cube with the volume of one cell.
  [[nodiscard]] double mean_edge() const noexcept { return std::cbrt(std::abs(glm::determinant(linear))); }
  /// @returns the longest of the three cell edges [m].
  [[nodiscard]] double longest_edge() const noexcept {
    return std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  }
  /// @returns the volume [m^3] of one cell.
  [[nodiscard]] double cell_volume() const noexcept { return std::abs(glm::determinant(linear)); }
};

/// Half-open box of voxels in index coordinates: lo <= v < hi on every axis.
struct VoxelBox {
  Vec3i lo{0};  ///< [voxels]
  Vec3i hi{0};  ///< [voxels]

  [[nodiscard]] Vec3i size() const noexcept { return hi - lo; }
  [[nodiscard]] bool empty() const noexcept { return hi.x <= lo.x || hi.y <= lo.y || hi.z <= lo.z; }
  [[nodiscard]] std::size_t count() const noexcept {
    if (empty()) return 0;
    const Vec3i s = size();
    return static_cast<std::size_t>(s.x) * static_cast<std::size_t>(s.y) * static_cast<std::size_t>(s.z);
  }
  [[nodiscard]] bool contains(const Vec3i& v) const noexcept {
    return v.x >= lo.x && v.y >= lo.y && v.z >= lo.z && v.x < hi.x && v.y < hi.y && v.z < hi.z;
  }
  [[nodiscard]] bool contains(const VoxelBox& b) const noexcept {
    return b.empty() || (glm::all(glm::greaterThanEqual(b.lo, lo)) && glm::all(glm::lessThanEqual(b.hi, hi)));
  }
  [[nodiscard]] VoxelBox grown(int n) const noexcept { return {lo - n, hi + n}; }
  [[nodiscard]] VoxelBox intersect(const VoxelBox& b) const noexcept { return {glm::max(lo, b.lo), glm::min(hi, b.hi)}; }
  [[nodiscard]] VoxelBox unite(const VoxelBox& b) const noexcept {
    if (empty()) return b;
    if (b.empty()) return *this;
    return {glm::min(lo, b.lo), glm::max(hi, b.hi)};
  }
  void include(const Vec3i& v) noexcept {
    if (empty()) {
      lo = v;
      hi = v + 1;
    } else {
      lo = glm::min(lo, v);
      hi = glm::max(hi, v + 1);
    }
  }
  /// @returns the offset of v in a dense array over this box, i fastest. @pre contains(v).
  [[nodiscard]] std::size_t offset_of(const Vec3i& v) const noexcept {
    const Vec3i s = size();
    const Vec3i d = v - lo;
    return (static_cast<std::size_t>(d.z) * static_cast<std::size_t>(s.y) + static_cast<std::size_t>(d.y)) * static_cast<std::size_t>(s.x) +
           static_cast<std::size_t>(d.x);
  }
  friend bool operator==(const VoxelBox&, const VoxelBox&) = default;
};

/// Calls f(Vec3i) for each voxel of the box, i fastest.
template <class F>
void for_each_voxel(const VoxelBox& box, F&& f) {
  for (int k = box.lo.z; k < box.hi.z; ++k)
    for (int j = box.lo.y; j < box.hi.y; ++j)
      for (int i = box.lo.x; i < box.hi.x; ++i) f(Vec3i(i, j, k));
}

/// floor() to int without a library call. @pre |x| < 2^31.
[[nodiscard]] inline int floor_int(double x) noexcept {
  const int i = static_cast<int>(x);
  return i - (x < static_cast<double>(i) ? 1 : 0);
}
[[nodiscard]] inline Vec3i floor_int(const Vec3& p) noexcept { return {floor_int(p.x), floor_int(p.y), floor_int(p.z)}; }

/// @returns the index of the voxel whose cell (centre +- 1/2) contains point p. Index coordinates.
[[nodiscard]] inline Vec3i voxel_of(const Vec3& p) noexcept { return floor_int(p + 0.5); }

/// Force [N] and torque [N*m] about the tool origin, world frame.
struct Wrench {
  Vec3 force{0.0};   ///< [N]
  Vec3 torque{0.0};  ///< [N*m]
};

}  // namespace burrhole
