// Vectors compute the terms of a block of hits; a scalar loop sums them in order. Scalar reference: tests/core/contact/flank_sums_test.cpp.
#include "core/contact/flank_sums.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/flank_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef BURRHOLE_GRIP_SUMS_ONCE
#define BURRHOLE_GRIP_SUMS_ONCE
namespace burrhole {

/// Hits of one block, and their terms: along, middle x y z, spread, uu, uv, vv.
struct GripBlock {
  static constexpr std::size_t kMost = 64;
  alignas(64) std::int64_t first[kMost];  // of the point's three numbers
  alignas(64) double terms[8][kMost];
  std::size_t count = 0;
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Vd = hn::Vec<Doubles>;

struct Vd3 {
  Vd x, y, z;
};
HWY_INLINE Vd3 gather(const std::vector<Vec3>& from, hn::Vec<hn::RebindToSigned<Doubles>> first) {
  const Doubles d;
  const double* const numbers = &from.front().x;
  return {hn::GatherIndex(d, numbers, first), hn::GatherIndex(d, numbers + 1, first), hn::GatherIndex(d, numbers + 2, first)};
}
HWY_INLINE Vd dot(const Vd3& a, const Vd3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE Vd3 same(const Vec3& v) {
  const Doubles d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

void Terms(const PointShell& shell, const FlankAxes& axes, double least, GripBlock& block) {
  const Doubles d;
  const hn::RebindToSigned<Doubles> di;
  const Vd3 push = same(axes.push), u = same(axes.u), v = same(axes.v);
  for (std::size_t n = 0; n < block.count; n += hn::Lanes(d)) {
    const auto first = hn::Load(di, block.first + n);
    const Vd3 normal = gather(shell.inward_normals, first), at = gather(shell.positions, first);
    const Vd facing = dot(normal, push), height = dot(at, push);
    const auto counts = hn::Not(hn::Lt(facing, hn::Set(d, least)));
    const Vd load = hn::Mul(facing, facing), nu = dot(normal, u), nv = dot(normal, v);
    const Vd terms[8] = {load,
                         hn::Mul(load, at.x),
                         hn::Mul(load, at.y),
                         hn::Mul(load, at.z),
                         hn::Mul(load, hn::Sub(dot(at, at), hn::Mul(height, height))),
                         hn::Mul(nu, nu),
                         hn::Mul(nu, nv),
                         hn::Mul(nv, nv)};
    for (std::size_t t = 0; t < 8; ++t) hn::Store(hn::IfThenElseZero(counts, terms[t]), d, block.terms[t] + n);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {

HWY_EXPORT(Terms);
static_assert(sizeof(Vec3) == 3 * sizeof(double));

}  // namespace

FlankSums sum_flanks(const ProbeHits& inside, const PointShell& shell, const FlankAxes& axes, double least) noexcept {
  GripBlock block;
  std::array<double, 8> sums{};
  for (std::size_t n = 0; n < inside.count;) {
    block.count = 0;
    for (; n < inside.count && block.count < GripBlock::kMost; ++n) {
      block.first[block.count] = 3 * static_cast<std::int64_t>(inside.point[n]);
      block.count += inside.distance[n] < 0.0f ? 1 : 0;
    }
    if (block.count == 0) continue;
    // Lanes beyond the end repeat a valid point.
    std::fill(block.first + block.count, block.first + (block.count + 7) / 8 * 8, block.first[0]);
    HWY_DYNAMIC_DISPATCH(Terms)(shell, axes, least, block);
    // Points that do not count add 0, which does not change the sums.
    for (std::size_t each = 0; each < block.count; ++each)
      for (std::size_t t = 0; t < 8; ++t) sums[t] += block.terms[t][each];
  }
  return {.along = sums[0], .middle = {sums[1], sums[2], sums[3]}, .spread = sums[4], .uu = sums[5], .uv = sums[6], .vv = sums[7]};
}

}  // namespace burrhole
#endif
