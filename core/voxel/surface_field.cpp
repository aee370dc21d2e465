// Densities of a tile and their smoothed gradients, made only where a record may ask for them: near the surface, a third of a tile or less.
// Same bits at every level: per-element sums in one order, no fused multiply-add.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/surface_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>

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

using D = hn::CappedTag<float, kMaxLanes>;
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

/// Calls f(i) so that the vectors from each i, rising, hold every bit of a row.
template <class Do>
HWY_INLINE void for_vectors(const std::uint64_t* bits, int words, int lanes, Do&& f) {
  int next = 0;
  for (int w = 0; w < words; ++w) {
    const int first = 64 * w;
    std::uint64_t left = bits[w];
    for (;;) {
      if (next >= first + 64) break;
      if (next > first) left &= ~std::uint64_t{0} << (next - first);
      if (left == 0) break;
      const int i = first + std::countr_zero(left);
      f(i);
      next = i + lanes;
    }
  }
}

/// Bits of `wanted` rows two voxels wider along i, in `by_y`, and these two rows wider along j, in `by_z`: what the later passes read.
/// @returns whether there is any.
bool widen(const std::uint64_t* wanted, int height, int words, std::uint64_t* by_y, std::uint64_t* by_z) {
  std::uint64_t any = 0;
  for (int j = 0; j < height; ++j)
    for (int w = 0; w < words; ++w) {
      const std::uint64_t* const row = wanted + j * words;
      const std::uint64_t here = row[w], before = w > 0 ? row[w - 1] : 0, after = w + 1 < words ? row[w + 1] : 0;
      const std::uint64_t up = (here << 1) | (here << 2) | (before >> 63) | (before >> 62);
      const std::uint64_t down = (here >> 1) | (here >> 2) | (after << 63) | (after << 62);
      any |= by_y[j * words + w] = here | up | down;
    }
  if (any == 0) return false;
  for (int j = 0; j < height; ++j)
    for (int w = 0; w < words; ++w) {
      std::uint64_t all = 0;
      for (int near = std::max(0, j - 2); near <= std::min(height - 1, j + 2); ++near) all |= by_y[near * words + w];
      by_z[j * words + w] = all;
    }
  return true;
}

/// What a vector writes beyond its bits lies in the row's next voxels, or in the next row: both are written later if they are wanted.
void SmoothGradient(SurfaceTile& tile) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int row = tile.row, slab = tile.slab, words = tile.words, height = slab / row;
  const auto plane = [&](int n) { return tile.plane.data() + 32 + n * (slab + 64); };
  float *const smooth_z = plane(0), *const slope_z = plane(1), *const smooth_yz = plane(2), *const slope_y = plane(3),
               *const slope_zy = plane(4);
  std::uint64_t *const by_y = tile.widened.data(), *const by_z = by_y + height * words;
  for (int k = 2; k < tile.padded.size().z - 2; ++k) {
    const std::uint64_t* const wanted = tile.wanted.data() + k * height * words;
    if (!widen(wanted, height, words, by_y, by_z)) continue;
    const auto for_each = [&](const std::uint64_t* bits, auto&& pass) {
      for (int j = 0; j < height; ++j) for_vectors(bits + j * words, words, lanes, [&](int i) { pass(j * row + i); });
    };
    for_each(by_z, [&](int n) {
      const Taps z(tile.density.data() + k * slab + n, slab);
      hn::StoreU(z.smooth(), d, smooth_z + n);
      hn::StoreU(z.slope(), d, slope_z + n);
    });
    for_each(by_y, [&](int n) {
      const Taps y(smooth_z + n, row);
      hn::StoreU(y.smooth(), d, smooth_yz + n);
      hn::StoreU(y.slope(), d, slope_y + n);
      hn::StoreU(Taps(slope_z + n, row).smooth(), d, slope_zy + n);
    });
    for_each(wanted, [&](int n) {
      const int at = k * slab + n;
      hn::StoreInterleaved4(Taps(smooth_yz + n, 1).slope(), Taps(slope_y + n, 1).smooth(), Taps(slope_zy + n, 1).smooth(),
                            hn::LoadU(d, tile.density.data() + at), d, &tile.samples[static_cast<std::size_t>(at)].gx);
    });
  }
}

/// Bits past a row's end are those of the next row: no cell of the window reaches there.
void FindSolid(SurfaceTile& tile) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int row = tile.row, rows = tile.slab / row * tile.padded.size().z;
  const auto level = hn::Set(d, 0.5f);
  std::uint64_t* out = tile.solid.data();
  for (int r = 0; r < rows; ++r)
    for (int i = 0; i < row; i += 64) {
      std::uint64_t word = 0;
      for (int n = 0; n < 64 && i + n < row; n += lanes) {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Ge(hn::LoadU(d, tile.density.data() + r * row + i + n), level), bits);
        word |= static_cast<std::uint64_t>(bits[0] | (bits[1] << 8)) << n;
      }
      *out++ = word;
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(SmoothGradient);
HWY_EXPORT(FindSolid);

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
  HWY_DYNAMIC_DISPATCH(FindSolid)(tile);
}

void smooth_gradient(SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(SmoothGradient)(tile); }

}  // namespace burrhole
#endif
