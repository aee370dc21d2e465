// core/base/simd_exp-inl.h: portable_exp of a vector of doubles, bit for bit, for arguments at or below 0. Included by SIMD kernels only,
// once a target (hence no #pragma once); the plain twin is portable_exp in core/base/portable_math.cpp.
#if defined(BURRHOLE_SIMD_EXP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_SIMD_EXP_INL_H
#undef BURRHOLE_SIMD_EXP_INL_H
#else
#define BURRHOLE_SIMD_EXP_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// e^x, x <= 0: portable_exp's bits for x >= -707, 0 below (where that is under 1e-307). Not for NaN.
/// Mul and Add only, in the order of the plain form: a fused product would round differently.
template <class D, class V>
HWY_INLINE V exp_of_negative(D d, V x) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RebindToSigned<D> di;
  const auto least = hn::Set(d, -707.0);
  const auto k = hn::Round(hn::Mul(hn::Max(x, least), hn::Set(d, 1.44269504088896338700e+00)));
  const auto r = hn::Sub(hn::Sub(hn::Max(x, least), hn::Mul(k, hn::Set(d, 6.93147180369123816490e-01))),
                         hn::Mul(k, hn::Set(d, 1.90821492927058770002e-10)));
  auto sum = hn::Set(d, 1.0 / 6227020800.0);
  for (const double c : {1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
                         1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5})
    sum = hn::Add(hn::Mul(sum, r), hn::Set(d, c));
  const auto fraction = hn::Add(hn::Set(d, 1.0), hn::Add(r, hn::Mul(hn::Mul(r, r), sum)));
  // k >= -1020, so 2^k is a normal double and so is the product: scaling is exact. Adding 1.5 * 2^52 leaves k in the low bits.
  const auto shifted = hn::BitCast(di, hn::Add(k, hn::Set(d, 6755399441055744.0)));
  const auto scale = hn::BitCast(d, hn::ShiftLeft<52>(hn::Add(shifted, hn::Set(di, 1023))));
  return hn::IfThenZeroElse(hn::Lt(x, least), hn::Mul(fraction, scale));
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
