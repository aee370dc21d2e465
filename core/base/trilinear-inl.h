// core/base/trilinear-inl.h: core/base/trilinear.h for vectors: every lane in that order of operations, without fused multiply-add.
// Included by SIMD kernels only, once a target (hence no #pragma once).
#if defined(BURRHOLE_TRILINEAR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_TRILINEAR_INL_H
#undef BURRHOLE_TRILINEAR_INL_H
#else
#define BURRHOLE_TRILINEAR_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

template <class V>
HWY_INLINE V lerp(V a, V b, V t) {
  return hwy::HWY_NAMESPACE::Add(a, hwy::HWY_NAMESPACE::Mul(hwy::HWY_NAMESPACE::Sub(b, a), t));
}

/// @param corner corner(n) is the vector of corner n: bit 0 of n the upper one along x, bit 1 y, bit 2 z
template <class V, class Corner>
HWY_INLINE V trilinear(V x, V y, V z, const Corner& corner) {
  const V low = lerp(lerp(corner(0), corner(1), x), lerp(corner(2), corner(3), x), y);
  const V high = lerp(lerp(corner(4), corner(5), x), lerp(corner(6), corner(7), x), y);
  return lerp(low, high, z);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
