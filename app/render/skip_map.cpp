#include "app/render/skip_map.h"

#include <algorithm>

#include "core/base/assert.h"

namespace burrhole {
namespace {

/// Distance from v to the nearest voxel of `box`, Chebyshev metric.
int distance_to_box(const Vec3i& v, const VoxelBox& box) {
  const Vec3i outside = glm::max(glm::max(box.lo - v, v - (box.hi - 1)), Vec3i(0));
  return std::max({outside.x, outside.y, outside.z});
}

}  // namespace

SkipMap::SkipMap(const Vec3i& dims, std::span<const std::uint8_t> solid) : all_{Vec3i(0), dims}, distance_(solid.size()) {
  BH_ASSERT(solid.size() == all_.count());
  for (std::size_t n = 0; n < solid.size(); ++n) distance_[n] = solid[n] != 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(kMaxSkip);
  sweep(+1);
  sweep(-1);
}

/// One of the two passes of the chessboard distance transform: each voxel takes the minimum over the 13 neighbours visited before (exact
/// for this metric). Rows are processed as a whole: minimum over the four earlier rows, then over three columns, then along the row.
void SkipMap::sweep(int direction) {
  const Vec3i dims = all_.hi;
  const int row = dims.x;
  std::vector<std::uint8_t> near(static_cast<std::size_t>(row) + 2, static_cast<std::uint8_t>(kMaxSkip));
  const auto row_at = [&](int j, int k) { return distance_.data() + all_.offset_of({0, j, k}); };
  const auto take = [&](int j, int k) {
    if (j < 0 || k < 0 || j >= dims.y || k >= dims.z) return;
    const std::uint8_t* other = row_at(j, k);
    for (int i = 0; i < row; ++i) near[i + 1] = std::min(near[i + 1], other[i]);
  };
  for (int kk = 0; kk < dims.z; ++kk) {
    for (int jj = 0; jj < dims.y; ++jj) {
      const int k = direction > 0 ? kk : dims.z - 1 - kk;
      const int j = direction > 0 ? jj : dims.y - 1 - jj;
      std::fill(near.begin(), near.end(), static_cast<std::uint8_t>(kMaxSkip));
      for (const int side : {-1, 0, 1}) take(j + side, k - direction);
      take(j - direction, k);
      std::uint8_t* own = row_at(j, k);
      for (int i = 0; i < row; ++i) {
        const int least = std::min({near[i], near[i + 1], near[i + 2]}) + 1;
        own[i] = static_cast<std::uint8_t>(std::min<int>(own[i], least));
      }
      for (int n = 1; n < row; ++n) {
        const int i = direction > 0 ? n : row - 1 - n;
        own[i] = static_cast<std::uint8_t>(std::min<int>(own[i], own[i - direction] + 1));
      }
    }
  }
}

VoxelBox SkipMap::raise(const VoxelBox& box, std::span<const std::uint8_t> solid) {
  BH_ASSERT(all_.contains(box) && solid.size() == box.count());
  VoxelBox risen;
  const int row = box.size().x;
  const std::uint8_t* asked = solid.data();
  for (int k = box.lo.z; k < box.hi.z; ++k)
    for (int j = box.lo.y; j < box.hi.y; ++j, asked += row) {
      // Usually no voxel became solid: a whole row is tested first, in a form that compilers vectorise.
      const std::uint8_t* known = &distance_[all_.offset_of({box.lo.x, j, k})];
      unsigned any = 0;
      for (int i = 0; i < row; ++i) any |= static_cast<unsigned>(asked[i] != 0) & static_cast<unsigned>(known[i] != 0);
      for (int i = 0; any != 0 && i < row; ++i)
        if (asked[i] != 0 && known[i] != 0) risen.include({box.lo.x + i, j, k});
    }
  if (risen.empty()) return {};
  // The bounding box of the new solid voxels counts as solid: the bound stays valid, and one pass over the reach of the map suffices.
  const VoxelBox changed = risen.grown(kMaxSkip - 1).intersect(all_);
  for_each_voxel(changed, [&](const Vec3i& v) {
    std::uint8_t& own = distance_[all_.offset_of(v)];
    own = static_cast<std::uint8_t>(std::min<int>(own, distance_to_box(v, risen)));
  });
  return changed;
}

}  // namespace burrhole
