// Smoothed gradients and the cells that the surface passes. Vector loops run over whole slabs and past row ends: what they write there is
// never read. Same bits at every level: per-element sums in one order, no fused multiply-add.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/surface_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/voxel/surface_tile.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

// Five taps that smooth and five that differentiate, matched so that a plane's direction comes out of three separable passes: of the
// family, those with the least errors over random planes, ramps of one voxel and of the phantoms (medians 0.05 degrees, 98 in 100 below
// 0.75; [1 2 1] with central differences has 2 and 4). What is left is aliasing of the ramp's edges in the densities themselves.
constexpr float kSmooth[3] = {0.41f, 0.26f, 0.035f};       // at 0, +-1, +-2
constexpr float kSlope[3] = {0.0f, 0.265957f, 0.117021f};  // sign of the offset

using D = hn::CappedTag<float, kMostLanes>;
using F = hn::Vec<D>;

HWY_INLINE F scaled(F v, float by) { return hn::Mul(v, hn::Set(D(), by)); }
/// Values at n - 2 step .. n + 2 step.
struct Taps {
  F back2, back1, here, ahead1, ahead2;
  HWY_INLINE Taps(const float* at, int step)
      : back2(hn::LoadU(D(), at - 2 * step)),
        back1(hn::LoadU(D(), at - step)),
        here(hn::LoadU(D(), at)),
        ahead1(hn::LoadU(D(), at + step)),
        ahead2(hn::LoadU(D(), at + 2 * step)) {}
  [[nodiscard]] HWY_INLINE F smooth() const {
    const F near = scaled(hn::Add(back1, ahead1), kSmooth[1]), far = scaled(hn::Add(back2, ahead2), kSmooth[2]);
    return hn::Add(scaled(here, kSmooth[0]), hn::Add(near, far));
  }
  [[nodiscard]] HWY_INLINE F slope() const {
    return hn::Add(scaled(hn::Sub(ahead1, back1), kSlope[1]), scaled(hn::Sub(ahead2, back2), kSlope[2]));
  }
};

void SmoothGradient(SurfaceTile& tile) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int row = tile.row, slab = tile.slab;
  float* scratch[5];
  for (int n = 0; n < 5; ++n) scratch[n] = tile.plane.data() + 32 + n * (slab + 64);
  auto& [smooth_z, slope_z, smooth_yz, slope_y, slope_zy] = scratch;
  for (int k = 2; k < tile.padded.size().z - 2; ++k) {
    for (int n = 0; n < slab; n += lanes) {
      const Taps z(tile.density.data() + k * slab + n, slab);
      hn::StoreU(z.smooth(), d, smooth_z + n);
      hn::StoreU(z.slope(), d, slope_z + n);
    }
    for (int n = 2 * row; n < slab - 2 * row; n += lanes) {
      const Taps y(smooth_z + n, row);
      hn::StoreU(y.smooth(), d, smooth_yz + n);
      hn::StoreU(y.slope(), d, slope_y + n);
      hn::StoreU(Taps(slope_z + n, row).smooth(), d, slope_zy + n);
    }
    for (int n = 2 * row; n < slab - 2 * row; n += lanes) {
      hn::StoreU(Taps(smooth_yz + n, 1).slope(), d, tile.gx.data() + k * slab + n);
      hn::StoreU(Taps(slope_y + n, 1).smooth(), d, tile.gy.data() + k * slab + n);
      hn::StoreU(Taps(slope_zy + n, 1).smooth(), d, tile.gz.data() + k * slab + n);
    }
  }
}

void FindCells(SurfaceTile& tile) {
  const D d;
  const hn::RebindToSigned<D> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto level = hn::Set(d, 0.5f);
  const VoxelBox& cells = tile.cells;
  const int length = cells.size().x;
  std::size_t found = 0;
  tile.rows.clear();
  for (int k = cells.lo.z; k < cells.hi.z; ++k)
    for (int j = cells.lo.y; j < cells.hi.y; ++j) {
      const std::size_t first = found;
      const int start = tile.offset_of({cells.lo.x, j, k});
      const float* const p = tile.density.data() + start;
      for (int i = 0; i < length; i += lanes) {
        const auto at = [&](int offset) { return hn::LoadU(d, p + i + offset); };
        auto least = at(0), most = least;
        for (const int offset : {1, tile.row, tile.row + 1, tile.slab, tile.slab + 1, tile.slab + tile.row, tile.slab + tile.row + 1}) {
          const auto v = at(offset);
          least = hn::Min(least, v);
          most = hn::Max(most, v);
        }
        auto passed = hn::And(hn::Ge(most, level), hn::Lt(least, level));
        passed = hn::And(passed, hn::FirstN(d, static_cast<std::size_t>(length - i)));
        if (hn::AllFalse(d, passed)) continue;
        const auto offsets = hn::Iota(di, start + i);
        found += hn::CompressStore(offsets, hn::RebindMask(di, passed), di, tile.cell_offsets.data() + found);
      }
      for (std::size_t n = first; n < found; ++n)
        tile.surfel_at[static_cast<std::size_t>(tile.cell_offsets[n])] = static_cast<std::int32_t>(n);
      if (found > first) tile.rows.push_back({j - tile.padded.lo.y, k - tile.padded.lo.z, first, found});
    }
  tile.found = found;
  if (found > 0) std::fill_n(tile.cell_offsets.data() + found, kMostLanes, tile.cell_offsets[found - 1]);
  if (tile.surfels.size() < found + kMostLanes) tile.surfels.resize(found + kMostLanes);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(SmoothGradient);
HWY_EXPORT(FindCells);

void copy_density(const MasterWindow& window, SurfaceTile& tile) noexcept {
  const VoxelBox& from = window.box;
  const VoxelBox& to = tile.padded;
  const int before = std::max(0, from.lo.x - to.lo.x), after = std::max(0, to.hi.x - from.hi.x);
  const int known = to.size().x - before - after;
  float* out = tile.density.data();
  for (int k = to.lo.z; k < to.hi.z; ++k)
    for (int j = to.lo.y; j < to.hi.y; ++j) {
      const Vec3i start(to.lo.x + before, std::clamp(j, from.lo.y, from.hi.y - 1), std::clamp(k, from.lo.z, from.hi.z - 1));
      const float* const in = window.density.data() + from.offset_of(start);
      out = std::fill_n(out, before, in[0]);
      out = std::copy_n(in, known, out);
      out = std::fill_n(out, after, in[known - 1]);
    }
}

void smooth_gradient(SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(SmoothGradient)(tile); }
void find_cells(SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(FindCells)(tile); }

}  // namespace burrhole
#endif
