// core/voxel/surface_vectors-inl.h: vectors of three, corners of a cell and what is read between them, for the kernels that make records.
// Included by them only, once a target (hence no #pragma once). Every lane is computed for itself in one order of operations without fused
// multiply-add: same bits at every level. Gathers are used; the plain twin, which sanitizers see through, is in
// tests/core/voxel/surface_twin.cpp.
#if defined(BURRHOLE_SURFACE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_SURFACE_VECTORS_INL_H
#undef BURRHOLE_SURFACE_VECTORS_INL_H
#else
#define BURRHOLE_SURFACE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "core/base/trilinear-inl.h"
#include "core/base/trilinear.h"
#include "core/voxel/surface_tile.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMaxLanes>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using I = hn::Vec<DI>;

#if HWY_TARGET != HWY_SCALAR
/// Block n of what comes out is that of make(n): blends, where each is repeated over its vector by the load that makes it.
template <class Make>
HWY_INLINE F by_block(const Make& make) {
  const D d;
  if constexpr (hn::MaxLanes(D()) == 4)
    return make(0);
  else if constexpr (hn::MaxLanes(D()) == 8)
    return hn::ConcatUpperLower(d, make(1), make(0));
  else
    return hn::ConcatUpperLower(d, hn::OddEvenBlocks(make(3), make(2)), hn::OddEvenBlocks(make(1), make(0)));
}

/// Block n is the four floats at kStride times places[kStep n]. Put together from plain loads: on loads that repeat a block over a vector
/// GCC 12 ends in an internal error under the thread sanitizer.
template <int kStride, int kStep>
HWY_INLINE F load_blocks(const float* first, const std::int32_t* places) {
  const hn::CappedTag<float, 4> quarter;
  const auto block = [&](int n) HWY_ATTR { return hn::LoadU(quarter, first + kStride * places[kStep * n]); };
  if constexpr (hn::MaxLanes(D()) == 4) {
    return block(0);
  } else if constexpr (hn::MaxLanes(D()) == 8) {
    return hn::Combine(D(), block(1), block(0));
  } else {
    const hn::Half<D> half;
    return hn::Combine(D(), hn::Combine(half, block(3), block(2)), hn::Combine(half, block(1), block(0)));
  }
}
#endif

/// Three vectors as one; plain operators, so that formulas read as formulas.
struct F3 {
  F x, y, z;
};
HWY_INLINE F3 add(const F3& a, const F3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE F3 sub(const F3& a, const F3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE F3 scale(F s, const F3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE F dot(const F3& a, const F3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
template <class M>
HWY_INLINE F3 choose(M mask, const F3& yes, const F3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
/// Length 1, or zero where there is no direction.
HWY_INLINE F3 unit(const F3& a) {
  const D d;
  const F length2 = dot(a, a);
  const F inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2));
  return scale(hn::IfThenElseZero(hn::Gt(length2, hn::Set(d, 1e-12f)), inverse), a);
}

struct F4 {
  F x, y, z, w;
};
/// Four floats of each lane, at kStride times its place: loaded whole and transposed, where gathers cost by the element.
template <int kStride>
HWY_INLINE F4 read_fours(const float* first, const std::int32_t* places) {
  const D d;
#if HWY_TARGET == HWY_SCALAR
  const float* const at = first + kStride * places[0];
  return {hn::Set(d, at[0]), hn::Set(d, at[1]), hn::Set(d, at[2]), hn::Set(d, at[3])};
#else
  const auto quarter = [&](std::size_t r) HWY_ATTR { return load_blocks<kStride, 4>(first, places + r); };
  const F r0 = quarter(0), r1 = quarter(1), r2 = quarter(2), r3 = quarter(3);
  const hn::Repartition<double, D> pairs;
  const auto low01 = hn::BitCast(pairs, hn::InterleaveLower(d, r0, r1)), low23 = hn::BitCast(pairs, hn::InterleaveLower(d, r2, r3));
  const auto high01 = hn::BitCast(pairs, hn::InterleaveUpper(d, r0, r1)), high23 = hn::BitCast(pairs, hn::InterleaveUpper(d, r2, r3));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23)), hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23)), hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23))};
#endif
}

/// Rows of a matrix times a vector, or columns (the transpose).
using Matrix = std::array<std::array<float, 3>, 3>;
HWY_INLINE F sum3(float a, F x, float b, F y, float c, F z) {
  const D d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, a), x), hn::Mul(hn::Set(d, b), y)), hn::Mul(hn::Set(d, c), z));
}
HWY_INLINE F3 times(const Matrix& m, const F3& v) {
  return {sum3(m[0][0], v.x, m[0][1], v.y, m[0][2], v.z), sum3(m[1][0], v.x, m[1][1], v.y, m[1][2], v.z),
          sum3(m[2][0], v.x, m[2][1], v.y, m[2][2], v.z)};
}
HWY_INLINE F3 times_transpose(const Matrix& m, const F3& v) {
  return {sum3(m[0][0], v.x, m[1][0], v.y, m[2][0], v.z), sum3(m[0][1], v.x, m[1][1], v.y, m[2][1], v.z),
          sum3(m[0][2], v.x, m[1][2], v.y, m[2][2], v.z)};
}

/// Values at the corners of a cell, x fastest.
struct Corners {
  F v[8];
};
/// The field at the corners of cells, given by offset.
struct Cell {
  Corners gx, gy, gz, density;
};
/// Of as many cells as lanes, each where `offsets` say.
HWY_INLINE Cell read_cells(const FieldSample* samples, const std::int32_t* offsets, int row, int slab) {
  Cell out;
  for (unsigned n = 0; n < 8; ++n) {
    const F4 at = read_fours<4>(&samples[corner_offset(n, row, slab)].gx, offsets);
    out.gx.v[n] = at.x, out.gy.v[n] = at.y, out.gz.v[n] = at.z, out.density.v[n] = at.w;
  }
  return out;
}
HWY_INLINE F interpolate(const Corners& c, const F3& p) {
  return trilinear(p.x, p.y, p.z, [&](unsigned n) HWY_ATTR { return c.v[n]; });
}
/// Gradient of the trilinear field itself.
HWY_INLINE F3 slope(const Corners& c, const F3& p) {
  const F x00 = lerp(c.v[0], c.v[1], p.x), x10 = lerp(c.v[2], c.v[3], p.x), x01 = lerp(c.v[4], c.v[5], p.x),
          x11 = lerp(c.v[6], c.v[7], p.x);
  const F along0 = lerp(hn::Sub(c.v[1], c.v[0]), hn::Sub(c.v[3], c.v[2]), p.y);
  const F along1 = lerp(hn::Sub(c.v[5], c.v[4]), hn::Sub(c.v[7], c.v[6]), p.y);
  return {lerp(along0, along1, p.z), lerp(hn::Sub(x10, x00), hn::Sub(x11, x01), p.z), hn::Sub(lerp(x01, x11, p.y), lerp(x00, x10, p.y))};
}

/// Outward normal, metric axes, from a gradient in index axes: a covector, so by the inverse's transpose.
HWY_INLINE F3 outward(const SurfaceMap& map, const F3& gradient) {
  const D d;
  return scale(hn::Set(d, -1.0f), times_transpose(map.index_from_metric, gradient));
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
