/// core/mesh/vertex_map.h: the number of the vertex at a voxel, in blocks of 8^3 voxels that exist where a vertex has been.
///   Frame  index.   Errors  none.   Thread  one writer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

class VertexMap {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  VertexMap() = default;
  explicit VertexMap(const VoxelBox& box) : lo_(box.lo), blocks_((box.size() + 7) / 8) {
    first_.assign(VoxelBox{Vec3i(0), blocks_}.count(), kNone);
  }

  /// @returns the vertex at a voxel; kNone if there is none. @pre voxel in the box.
  [[nodiscard]] std::uint32_t find(const Vec3i& voxel) const noexcept {
    const Vec3i d = voxel - lo_;
    const std::uint32_t first = first_[block_of(d)];
    return first == kNone ? kNone : values_[first + within(d)];
  }
  /// Sets the vertex at a voxel; kNone: none. @pre voxel in the box.
  void set(const Vec3i& voxel, std::uint32_t vertex) {
    const Vec3i d = voxel - lo_;
    std::uint32_t& first = first_[block_of(d)];
    if (first == kNone) {
      first = static_cast<std::uint32_t>(values_.size());
      values_.resize(values_.size() + 512, kNone);
    }
    values_[first + within(d)] = vertex;
  }
  void clear() noexcept {
    std::ranges::fill(first_, kNone);
    values_.clear();
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return (first_.capacity() + values_.capacity()) * sizeof(std::uint32_t); }

 private:
  [[nodiscard]] std::size_t block_of(const Vec3i& d) const noexcept {
    return static_cast<std::size_t>((d.z >> 3) * blocks_.y + (d.y >> 3)) * static_cast<std::size_t>(blocks_.x) +
           static_cast<std::size_t>(d.x >> 3);
  }
  [[nodiscard]] static std::size_t within(const Vec3i& d) noexcept {
    return static_cast<std::size_t>((d.z & 7) << 6 | (d.y & 7) << 3 | (d.x & 7));
  }

  Vec3i lo_{0}, blocks_{0};
  std::vector<std::uint32_t> first_, values_;
};

}  // namespace burrhole
