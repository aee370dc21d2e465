// Gathers, which sanitizers do not see through; the plain form of the same question is what Coverage::meet asks of samples that stay
// unsure, and tests/core/drill/coverage_volume_test.cpp holds the outcome against solids.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/coverage_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cstring>

#include "core/drill/coverage_kernels.h"
#include "core/drill/coverage_samples.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using M = hn::Mask<D>;

struct Place {
  F x, y, z;
};

HWY_INLINE M inside_table(const MeetJob& job, const Place& q) {
  const D d;
  const auto within = [&](F v, float end) { return hn::And(hn::Ge(v, hn::Zero(d)), hn::Lt(v, hn::Set(d, end))); };
  return hn::And(within(q.x, job.end[0]), hn::And(within(q.y, job.end[1]), within(q.z, job.end[2])));
}

/// Trilinear between nodes, in the order of FieldSampler; lanes outside the table look at its first cell.
HWY_INLINE F distance_at(const MeetJob& job, const Place& q, M inside) {
  const D d;
  const DI di;
  const F x = hn::IfThenElseZero(inside, q.x), y = hn::IfThenElseZero(inside, q.y), z = hn::IfThenElseZero(inside, q.z);
  const auto i = hn::ConvertTo(di, x), j = hn::ConvertTo(di, y), k = hn::ConvertTo(di, z);
  const F tx = hn::Sub(x, hn::ConvertTo(d, i)), ty = hn::Sub(y, hn::ConvertTo(d, j)), tz = hn::Sub(z, hn::ConvertTo(d, k));
  const auto at = hn::Add(hn::Add(i, hn::Mul(j, hn::Set(di, job.row))), hn::Mul(k, hn::Set(di, job.slab)));
  const auto mix = [](F a, F b, F t) { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); };
  const auto along = [&](std::int32_t from) {
    return mix(hn::GatherIndex(d, job.distance + from, at), hn::GatherIndex(d, job.distance + from + 1, at), tx);
  };
  const F below = mix(along(0), along(job.row), ty), above = mix(along(job.slab), along(job.slab + job.row), ty);
  return mix(below, above, tz);
}

HWY_INLINE M mask_of(std::uint64_t bits) {
  std::uint8_t bytes[8];
  std::memcpy(bytes, &bits, sizeof bytes);  // lanes are the low bits: little-endian, as every target there is
  return hn::LoadMaskBits(D(), bytes);
}

/// Adds the bits of the samples whose lanes are set.
HWY_INLINE void add_bits(M mask, const std::int32_t* samples, std::uint64_t& bits) {
  std::uint8_t bytes[8] = {};
  (void)hn::StoreMaskBits(D(), mask, bytes);
  for (unsigned left = bytes[0] | (static_cast<unsigned>(bytes[1]) << 8); left != 0; left &= left - 1)
    bits |= std::uint64_t{1} << samples[std::countr_zero(left)];
}

/// Samples that may be inside, side by side.
struct Candidates {
  HWY_ALIGN float x[kCoverageSamples + 16], y[kCoverageSamples + 16], z[kCoverageSamples + 16];
  HWY_ALIGN std::int32_t sample[kCoverageSamples + 16];
  std::size_t count = 0;
};

/// Those of `asked` that bounds alone do not keep out.
HWY_INLINE void find_candidates(const MeetJob& job, std::uint64_t asked, Candidates& out) {
  const D d;
  const DI di;
  constexpr std::size_t kStep = hn::MaxLanes(d);
  const auto set = [&](float v) { return hn::Set(d, v); };
  for (std::size_t n = 0; n < kCoverageSamples; n += kStep) {
    const std::uint64_t here = (asked >> n) & ((std::uint64_t{1} << kStep) - 1);
    if (here == 0) continue;
    const F x = hn::LoadU(d, job.x + n), y = hn::LoadU(d, job.y + n), z = hn::LoadU(d, job.z + n), far = hn::LoadU(d, job.far + n);
    const F plane = hn::Add(hn::Add(hn::Add(set(job.spare), hn::Mul(set(job.slope[0]), x)), hn::Mul(set(job.slope[1]), y)),
                            hn::Mul(set(job.slope[2]), z));
    const F least = hn::Sub(plane, hn::Mul(hn::Add(hn::Mul(set(job.bend), far), set(job.sway)), far));
    const M apart = hn::Or(hn::Gt(least, hn::Zero(d)), hn::Gt(hn::Sub(set(job.closest), far), set(job.half_way + job.slack)));
    const M near = hn::AndNot(apart, mask_of(here));
    if (hn::AllFalse(d, near)) continue;
    hn::StoreU(hn::Compress(x, near), d, out.x + out.count);
    hn::StoreU(hn::Compress(y, near), d, out.y + out.count);
    hn::StoreU(hn::Compress(z, near), d, out.z + out.count);
    hn::StoreU(hn::Compress(hn::Iota(di, static_cast<std::int32_t>(n)), hn::RebindMask(di, near)), di, out.sample + out.count);
    out.count += hn::CountTrue(d, near);
  }
}

MeetMasks MeetSamples(const MeetJob& job, std::uint64_t asked) {
  const D d;
  const F zero = hn::Zero(d);
  Candidates all;
  find_candidates(job, asked, all);
  MeetMasks out;
  for (std::size_t n = 0; n < all.count; n += hn::Lanes(d)) {
    const M near = hn::FirstN(d, all.count - n);
    const Place q{hn::Add(hn::Set(d, job.centre[0]), hn::Load(d, all.x + n)), hn::Add(hn::Set(d, job.centre[1]), hn::Load(d, all.y + n)),
                  hn::Add(hn::Set(d, job.centre[2]), hn::Load(d, all.z + n))};
    const M known = hn::And(near, inside_table(job, q));
    const F distance = distance_at(job, q, known);
    M met = hn::And(known, hn::Le(distance, zero)), unsure = hn::AndNot(known, near);
    const M close = hn::And(hn::AndNot(met, known), hn::Le(distance, hn::Set(d, 1.1f * job.half_way)));
    if (job.half_way > 0.0f && !hn::AllFalse(d, close)) {
      const Place end{hn::Add(q.x, hn::Set(d, job.deeper[0])), hn::Add(q.y, hn::Set(d, job.deeper[1])),
                      hn::Add(q.z, hn::Set(d, job.deeper[2]))};
      const M end_known = hn::And(close, inside_table(job, end));
      const M end_met = hn::And(end_known, hn::Le(distance_at(job, end, end_known), zero));
      met = hn::Or(met, end_met);
      unsure = hn::Or(unsure, hn::AndNot(job.straight ? end_known : end_met, close));
    }
    add_bits(met, all.sample + n, out.met);
    add_bits(unsure, all.sample + n, out.unsure);
  }
  return out;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(MeetSamples);

MeetMasks meet_samples(const MeetJob& job, std::uint64_t asked) noexcept { return HWY_DYNAMIC_DISPATCH(MeetSamples)(job, asked); }

}  // namespace burrhole
#endif
