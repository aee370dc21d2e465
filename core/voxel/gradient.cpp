#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/gradient.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "core/base/assert.h"
#include "core/voxel/gradient.h"

// The plain twin, a loop over voxels, is in tests/core/voxel/gradient_simd_test.cpp: the same operations in the same order, so the same
// bits.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Components {
  V x, y, z;
};

template <class D>
HWY_INLINE Components<hn::Vec<D>> gradient_at(D d, const GradientRows& a, const float* density, std::size_t n) {
  const auto half = hn::Set(d, 0.5f);
  const float* at = density + n;
  const auto x = hn::Mul(half, hn::Sub(hn::LoadU(d, at + 1), hn::LoadU(d, at - 1)));
  const auto y = hn::Mul(half, hn::Sub(hn::LoadU(d, at + a.density_row), hn::LoadU(d, at - a.density_row)));
  const auto z = hn::Mul(half, hn::Sub(hn::LoadU(d, at + a.density_slab), hn::LoadU(d, at - a.density_slab)));
  const auto length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const auto dead = hn::Lt(length2, hn::Set(d, a.dead2));
  return {hn::IfThenZeroElse(dead, x), hn::IfThenZeroElse(dead, y), hn::IfThenZeroElse(dead, z)};
}

#if HWY_TARGET <= HWY_AVX3
/// x y z side by side, 16 voxels: two-table permutes take six shuffles where StoreInterleaved3 takes some twenty.
HWY_INLINE void store_side_by_side(hn::CappedTag<float, 16> d, const Components<hn::Vec<hn::CappedTag<float, 16>>>& g, float* out) {
  // Lane n of vector v holds component (16 v + n) % 3 of voxel (16 v + n) / 3; 16 + m names lane m of the second table.
  alignas(64) static constexpr std::int32_t kXy[3][16] = {{0, 16, 0, 1, 17, 0, 2, 18, 0, 3, 19, 0, 4, 20, 0, 5},
                                                          {21, 0, 6, 22, 0, 7, 23, 0, 8, 24, 0, 9, 25, 0, 10, 26},
                                                          {0, 11, 27, 0, 12, 28, 0, 13, 29, 0, 14, 30, 0, 15, 31, 0}};
  alignas(64) static constexpr std::int32_t kWithZ[3][16] = {{0, 1, 16, 3, 4, 17, 6, 7, 18, 9, 10, 19, 12, 13, 20, 15},
                                                             {0, 21, 2, 3, 22, 5, 6, 23, 8, 9, 24, 11, 12, 25, 14, 15},
                                                             {26, 1, 2, 27, 4, 5, 28, 7, 8, 29, 10, 11, 30, 13, 14, 31}};
  for (std::size_t v = 0; v < 3; ++v) {
    const __m512 xy = _mm512_permutex2var_ps(g.x.raw, _mm512_load_si512(kXy[v]), g.y.raw);
    const __m512 xyz = _mm512_permutex2var_ps(xy, _mm512_load_si512(kWithZ[v]), g.z.raw);
    hn::StoreU(hn::Vec512<float>{xyz}, d, out + 16 * v);
  }
}
#endif
template <class D>
HWY_INLINE void store_side_by_side(D d, const Components<hn::Vec<D>>& g, float* out) {
  hn::StoreInterleaved3(g.x, g.y, g.z, d, out);
}

/// A row of at least Lanes(d) voxels; the last vector overlaps the one before.
template <class D>
HWY_INLINE void gradient_row(D d, const GradientRows& a, const float* density, float* gradient, std::size_t count) {
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t n = 0;; n += lanes) {
    n = HWY_MIN(n, count - lanes);
    const auto g = gradient_at(d, a, density, n);
    store_side_by_side(d, g, gradient + 3 * n);
    if (n + lanes == count) return;
  }
}

void UpdateGradientRows(const GradientRows& a) {
  const hn::CappedTag<float, 16> wide;
  const hn::CappedTag<float, 4> narrow;
  const hn::CappedTag<float, 1> single;
  for (std::size_t k = 0; k < a.slabs; ++k)
    for (std::size_t j = 0; j < a.rows; ++j) {
      const float* density = a.density + static_cast<std::ptrdiff_t>(k) * a.density_slab + static_cast<std::ptrdiff_t>(j) * a.density_row;
      float* gradient = a.gradient + k * a.gradient_slab + j * a.gradient_row;
      if (a.count >= hn::Lanes(wide)) {
        gradient_row(wide, a, density, gradient, a.count);
      } else if (a.count >= hn::Lanes(narrow)) {
        gradient_row(narrow, a, density, gradient, a.count);
      } else {
        for (std::size_t n = 0; n < a.count; ++n) {
          const auto g = gradient_at(single, a, density, n);
          gradient[3 * n] = hn::GetLane(g.x);
          gradient[3 * n + 1] = hn::GetLane(g.y);
          gradient[3 * n + 2] = hn::GetLane(g.z);
        }
      }
    }
}

void MultiplyRows(const ProductRows& a) {
  const hn::CappedTag<float, 16> wide;
  const hn::CappedTag<float, 4> narrow;
  const std::size_t lanes = hn::Lanes(wide), few = hn::Lanes(narrow);
  for (std::size_t k = 0; k < a.slabs; ++k)
    for (std::size_t j = 0; j < a.rows; ++j) {
      const std::size_t at = k * a.slab + j * a.row;
      std::size_t n = 0;
      const auto multiply = [&](auto d) {
        hn::StoreU(hn::Mul(hn::LoadU(d, a.a + at + n), hn::LoadU(d, a.b + at + n)), d, a.product + at + n);
      };
      for (; n + lanes <= a.count; n += lanes) multiply(wide);
      for (; n + few <= a.count; n += few) multiply(narrow);
      for (; n < a.count; ++n) a.product[at + n] = a.a[at + n] * a.b[at + n];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(UpdateGradientRows);
HWY_EXPORT(MultiplyRows);

void update_density(std::span<const float> occupancy, std::span<const float> remaining, const VoxelBox& box, const VoxelBox& target,
                    std::span<float> density) noexcept {
  if (target.empty()) return;
  BH_ASSERT(box.contains(target));
  const glm::uvec3 size(target.size()), all(box.size());
  const std::size_t start = box.offset_of(target.lo);
  const ProductRows rows{occupancy.data() + start,
                         remaining.data() + start,
                         density.data() + start,
                         all.x,
                         std::size_t{all.x} * all.y,
                         size.x,
                         size.y,
                         size.z};
  HWY_DYNAMIC_DISPATCH(MultiplyRows)(rows);
}

void update_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& gradient_box,
                     std::span<Vec3f> gradient) noexcept {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  if (target.empty()) return;
  BH_ASSERT(block.box.contains(target.grown(1)));
  BH_ASSERT(gradient_box.contains(target));
  const std::ptrdiff_t row = block.box.size().x;
  const Vec3i out = gradient_box.size();
  const glm::uvec3 size(target.size());
  const GradientRows rows{block.density.data() + block.box.offset_of(target.lo),
                          row,
                          row * block.box.size().y,
                          &gradient[gradient_box.offset_of(target.lo)].x,
                          3 * static_cast<std::size_t>(out.x),
                          3 * static_cast<std::size_t>(out.x) * static_cast<std::size_t>(out.y),
                          size.x,
                          size.y,
                          size.z,
                          dead_zone * dead_zone};
  HWY_DYNAMIC_DISPATCH(UpdateGradientRows)(rows);
}

}  // namespace burrhole
#endif  // HWY_ONCE
