#include "volumes/read/quiet_values.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace burrhole {
namespace {

struct Range {
  float least, most;
  void add(const Range& other) {
    least = std::min(least, other.least);
    most = std::max(most, other.most);
  }
};

/// Range of the values of each block.
std::vector<Range> ranges_of(std::span<const float> values, const Vec3i& dims, const VoxelBox& blocks, int edge) {
  const VoxelBox all{Vec3i(0), dims};
  std::vector<Range> out(blocks.count());
  for_each_number(blocks.hi.z, [&](int k) {
    for_each_voxel({{0, 0, k}, {blocks.hi.x, blocks.hi.y, k + 1}}, [&](const Vec3i& block) {
      const float first = values[all.offset_of(block * edge)];
      Range range{first, first};
      for_each_voxel({block * edge, glm::min((block + 1) * edge, dims)}, [&](const Vec3i& v) {
        const float value = values[all.offset_of(v)];
        range.add({value, value});
      });
      out[blocks.offset_of(block)] = range;
    });
  });
  return out;
}

/// Range of the blocks up to `reach` away on one axis; beyond the last block lies `nothing`.
std::vector<Range> spread(const std::vector<Range>& from, const VoxelBox& blocks, std::size_t axis, int reach, float nothing) {
  std::vector<Range> out = from;
  for_each_number(blocks.hi.z, [&](int k) {
    for_each_voxel({{0, 0, k}, {blocks.hi.x, blocks.hi.y, k + 1}}, [&](const Vec3i& block) {
      Range& range = out[blocks.offset_of(block)];
      for (int d = -reach; d <= reach; ++d) {
        Vec3i other = block;
        other[axis] += d;
        range.add(blocks.contains(other) ? from[blocks.offset_of(other)] : Range{nothing, nothing});
      }
    });
  });
  return out;
}

}  // namespace

std::uint64_t QuietValues::bytes(const Vec3i& dims) noexcept {
  // Ranges before and after an axis, and the flags while they grow.
  return (2 * sizeof(Range) + 3) * VoxelBox{Vec3i(0), (dims + kEdge - 1) / kEdge}.count();
}

QuietValues::QuietValues(std::span<const float> values, const Vec3i& dims, const Vec3i& reach, const QuietRule& rule)
    : blocks_{Vec3i(0), (dims + kEdge - 1) / kEdge} {
  std::vector<Range> ranges = ranges_of(values, dims, blocks_, kEdge);
  for (std::size_t axis = 0; axis < 3; ++axis)
    ranges = spread(ranges, blocks_, axis, (reach[axis] + kEdge - 1) / kEdge, static_cast<float>(rule.nothing));
  for (const Range& range : ranges) {
    const double most = static_cast<double>(range.most), width = most - static_cast<double>(range.least);
    quiet_.push_back(most + 0.1875 * width + std::max(rule.half_band, rule.steps * width) <= rule.middle ? 1 : 0);
  }
}

}  // namespace burrhole
