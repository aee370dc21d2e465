#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/engaged_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "core/base/simd_exp-inl.h"
#include "core/drill/engaged_kernels.h"

// The scalar reference is in tests/core/drill/engaged_kernels_test.cpp.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void Decay(const DecayJob& job) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  const auto load = [&](const float* from) { return hn::PromoteTo(d, hn::LoadU(df, from)); };
  for (std::size_t n = 0; n < job.count; n += hn::Lanes(d)) {
    const auto power = hn::Div(hn::Mul(hn::Set(d, -job.turns), load(job.exposure + n)), load(job.hardness + n));
    hn::StoreU(hn::DemoteTo(df, hn::Mul(load(job.available + n), exp_of_negative(d, power))), df, job.left + n);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(Decay);

void decay(const DecayJob& job) noexcept { HWY_DYNAMIC_DISPATCH(Decay)(job); }

}  // namespace burrhole
#endif
