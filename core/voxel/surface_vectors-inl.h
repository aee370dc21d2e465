// core/voxel/surface_vectors-inl.h: vectors of three, corners of a cell and what is read between them, for the kernels that make records.
// Included by them only, once a target (hence no #pragma once). Every lane is computed for itself in one order of operations without fused
// multiply-add: same bits at every level. Gathers are used throughout; the plain twin, which sanitizers see through, is in
// tests/core/voxel/surface_twin.cpp.
#if defined(BURRHOLE_SURFACE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_SURFACE_VECTORS_INL_H
#undef BURRHOLE_SURFACE_VECTORS_INL_H
#else
#define BURRHOLE_SURFACE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "core/voxel/surface_tile.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMostLanes>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using I = hn::Vec<DI>;

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

HWY_INLINE F lerp(F a, F b, F t) { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); }

/// Values at the corners of a cell, x fastest.
struct Corners {
  F v[8];
};
/// The field at the corners of cells, given by offset.
struct Cell {
  Corners gx, gy, gz, density;
};
HWY_INLINE Cell gather(const FieldSample* samples, I cell, int row, int slab) {
  const D d;
  Cell out;
  for (int n = 0; n < 8; ++n) {
    const float* const base = &samples[(n & 1) + ((n >> 1) & 1) * row + (n >> 2) * slab].gx;
#if HWY_TARGET == HWY_SCALAR
    const I at = hn::ShiftLeft<2>(cell);
    const auto part = [&](int which) { return hn::GatherIndex(d, base + which, at); };
    out.gx.v[n] = part(0), out.gy.v[n] = part(1), out.gz.v[n] = part(2), out.density.v[n] = part(3);
#else
    // Two floats at a time: a gather costs by the element.
    const hn::Repartition<std::int64_t, D> dw;
    const hn::Half<DI> half;
    const auto low = hn::ShiftLeft<1>(hn::PromoteTo(dw, hn::LowerHalf(half, cell)));
    const auto high = hn::ShiftLeft<1>(hn::PromoteTo(dw, hn::UpperHalf(half, cell)));
    const auto* const pairs = reinterpret_cast<const std::int64_t*>(base);
    const F low_xy = hn::BitCast(d, hn::GatherIndex(dw, pairs, low)), high_xy = hn::BitCast(d, hn::GatherIndex(dw, pairs, high));
    const F low_zd = hn::BitCast(d, hn::GatherIndex(dw, pairs + 1, low)), high_zd = hn::BitCast(d, hn::GatherIndex(dw, pairs + 1, high));
    out.gx.v[n] = hn::ConcatEven(d, high_xy, low_xy);
    out.gy.v[n] = hn::ConcatOdd(d, high_xy, low_xy);
    out.gz.v[n] = hn::ConcatEven(d, high_zd, low_zd);
    out.density.v[n] = hn::ConcatOdd(d, high_zd, low_zd);
#endif
  }
  return out;
}
HWY_INLINE F interpolate(const Corners& c, const F3& p) {
  const F low = lerp(lerp(c.v[0], c.v[1], p.x), lerp(c.v[2], c.v[3], p.x), p.y);
  const F high = lerp(lerp(c.v[4], c.v[5], p.x), lerp(c.v[6], c.v[7], p.x), p.y);
  return lerp(low, high, p.z);
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
