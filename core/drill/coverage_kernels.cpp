// Sanitizers do not check gather instructions. Coverage::meet contains the scalar form of the same test, used for undecided samples;
// tests/core/drill/coverage_volume_test.cpp compares the result with solids.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/coverage_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cstring>
#include <limits>

#include "core/base/trilinear-inl.h"
#include "core/base/trilinear.h"
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

/// Trilinear from cell (i, j, k) on.
template <class DF, class VI, class VF>
HWY_INLINE VF between(DF d, const float* values, std::int32_t row, std::int32_t slab, const VI* cell, const VF* t) {
  const hn::RebindToSigned<DF> di;
  const auto at = hn::Add(hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, row))), hn::Mul(cell[2], hn::Set(di, slab)));
  return trilinear(t[0], t[1], t[2], [&](unsigned n) HWY_ATTR { return hn::GatherIndex(d, values + corner_offset(n, row, slab), at); });
}

HWY_INLINE M inside_table(const MeetJob& job, const Place& q) {
  const D d;
  const auto within = [&](F v, float end) { return hn::And(hn::Ge(v, hn::Zero(d)), hn::Lt(v, hn::Set(d, end))); };
  return hn::And(within(q.x, job.end[0]), hn::And(within(q.y, job.end[1]), within(q.z, job.end[2])));
}

/// Lanes outside the table read its first cell.
HWY_INLINE F distance_at(const MeetJob& job, const Place& q, M inside) {
  const D d;
  const DI di;
  const F x = hn::IfThenElseZero(inside, q.x), y = hn::IfThenElseZero(inside, q.y), z = hn::IfThenElseZero(inside, q.z);
  const hn::Vec<DI> cell[3] = {hn::ConvertTo(di, x), hn::ConvertTo(di, y), hn::ConvertTo(di, z)};
  const F t[3] = {hn::Sub(x, hn::ConvertTo(d, cell[0])), hn::Sub(y, hn::ConvertTo(d, cell[1])), hn::Sub(z, hn::ConvertTo(d, cell[2]))};
  return between(d, job.distance, job.row, job.slab, cell, t);
}

HWY_INLINE M mask_of(std::uint64_t bits) {
  std::uint8_t bytes[8];
  std::memcpy(bytes, &bits, sizeof bytes);  // lanes are the low bits: every target is little-endian
  return hn::LoadMaskBits(D(), bytes);
}

/// Adds the bits of the samples whose lanes are set.
HWY_INLINE void add_bits(M mask, const std::int32_t* samples, std::uint64_t& bits) {
  std::uint8_t bytes[8] = {};
  (void)hn::StoreMaskBits(D(), mask, bytes);
  for (unsigned left = bytes[0] | (static_cast<unsigned>(bytes[1]) << 8); left != 0; left &= left - 1)
    bits |= std::uint64_t{1} << samples[std::countr_zero(left)];
}

/// Samples that may be inside, as arrays.
struct Candidates {
  HWY_ALIGN float x[kCoverageSamples + 16], y[kCoverageSamples + 16], z[kCoverageSamples + 16];
  HWY_ALIGN std::int32_t sample[kCoverageSamples + 16];
  std::size_t count = 0;
  float nearest = std::numeric_limits<float>::infinity();  ///< [m] least distance of the samples excluded by bounds
};

/// Those of `asked` that the bounds do not exclude.
HWY_INLINE void find_candidates(const MeetJob& job, std::uint64_t asked, Candidates& out) {
  const D d;
  const DI di;
  constexpr std::size_t kStep = hn::MaxLanes(d);
  const auto lane = hn::Iota(di, 0);  // computed once: it is stored and loaded
  F nearest = hn::Set(d, out.nearest);
  const auto set = [&](float v) { return hn::Set(d, v); };
  for (std::size_t n = 0; n < kCoverageSamples; n += kStep) {
    const std::uint64_t here = (asked >> n) & ((std::uint64_t{1} << kStep) - 1);
    if (here == 0) continue;
    const F x = hn::LoadU(d, job.x + n), y = hn::LoadU(d, job.y + n), z = hn::LoadU(d, job.z + n), far = hn::LoadU(d, job.far + n);
    const F plane = hn::Add(hn::Add(hn::Add(set(job.spare), hn::Mul(set(job.slope[0]), x)), hn::Mul(set(job.slope[1]), y)),
                            hn::Mul(set(job.slope[2]), z));
    const F least = hn::Sub(plane, hn::Mul(hn::Add(hn::Mul(set(job.bend), far), set(job.sway)), far));
    const F within = hn::Sub(set(job.closest), far);
    const M apart = hn::Or(hn::Gt(least, hn::Zero(d)), hn::Gt(within, set(job.half_way + job.slack)));
    const M lanes = mask_of(here), near = hn::AndNot(apart, lanes);
    const F bound = hn::Max(hn::Add(least, set(job.half_way)), hn::Sub(within, set(job.slack)));
    nearest = hn::IfThenElse(hn::And(apart, lanes), hn::Min(nearest, bound), nearest);
    if (hn::AllFalse(d, near)) continue;
    hn::StoreU(hn::Compress(x, near), d, out.x + out.count);
    hn::StoreU(hn::Compress(y, near), d, out.y + out.count);
    hn::StoreU(hn::Compress(z, near), d, out.z + out.count);
    hn::StoreU(hn::Compress(hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(n))), hn::RebindMask(di, near)), di,
               out.sample + out.count);
    out.count += hn::CountTrue(d, near);
  }
  out.nearest = hn::GetLane(hn::MinOfLanes(d, nearest));
}

using DD = hn::CappedTag<double, 8>;
using DH = hn::Rebind<float, DD>;
using H = hn::Vec<DH>;

/// As FieldSampler::distance, also outside the table.
HWY_INLINE H distance_of(const PlaceJob& job, const H* q) {
  const DH d;
  const DD dd;
  const hn::RebindToSigned<DH> di;
  const H zero = hn::Zero(d);
  const auto end = [&](std::size_t axis) { return hn::Set(d, job.end[axis]); };
  auto inside = hn::And(hn::Ge(q[0], zero), hn::Lt(q[0], end(0)));
  for (const std::size_t axis : {1u, 2u}) inside = hn::And(inside, hn::And(hn::Ge(q[axis], zero), hn::Lt(q[axis], end(axis))));
  hn::Vec<decltype(di)> cell[3];
  H t[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const H here = hn::IfThenElseZero(inside, q[axis]);
    cell[axis] = hn::ConvertTo(di, here);
    t[axis] = hn::Sub(here, hn::ConvertTo(d, cell[axis]));
  }
  const H found = between(d, job.distance, job.row, job.slab, cell, t);
  if (hn::AllTrue(d, inside)) return found;
  H square = zero;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const H beyond = hn::Max(zero, hn::Max(hn::Neg(q[axis]), hn::Sub(q[axis], end(axis))));
    square = axis == 0 ? hn::Mul(beyond, beyond) : hn::Add(square, hn::Mul(beyond, beyond));
  }
  const auto away = hn::Add(hn::Set(dd, job.margin), hn::Mul(hn::Set(dd, job.pitch), hn::PromoteTo(dd, hn::Sqrt(square))));
  return hn::IfThenElse(inside, found, hn::DemoteTo(d, away));
}

void MeasurePlaces(const PlaceJob& job, const VoxelList& voxels, const PlaceList& out) {
  const DD dd;
  const DH d;
  const hn::RebindToSigned<DH> di;
  for (std::size_t n = 0; n < voxels.count; n += hn::Lanes(dd)) {
    const auto i = hn::PromoteTo(dd, hn::LoadU(di, voxels.i + n)), j = hn::PromoteTo(dd, hn::LoadU(di, voxels.j + n)),
               k = hn::PromoteTo(dd, hn::LoadU(di, voxels.k + n));
    H q[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto set = [&](std::size_t column) { return hn::Set(dd, job.linear[column][axis]); };
      const auto sum = hn::Add(hn::Add(hn::Mul(set(0), i), hn::Mul(set(1), j)), hn::Mul(set(2), k));
      q[axis] = hn::DemoteTo(d, hn::Add(sum, hn::Set(dd, job.offset[axis])));
    }
    hn::StoreU(q[0], d, out.x + n);
    hn::StoreU(q[1], d, out.y + n);
    hn::StoreU(q[2], d, out.z + n);
    hn::StoreU(distance_of(job, q), d, out.distance + n);
  }
}

void WeighPlaces(const PlaceJob& job, const WeighList& list) {
  const DD dd;
  const DH d;
  const hn::RebindToSigned<DH> di;
  const H zero = hn::Zero(d);
  for (std::size_t n = 0; n < list.count; n += hn::Lanes(dd)) {
    const H q[3] = {hn::LoadU(d, list.at.x + n), hn::LoadU(d, list.at.y + n), hn::LoadU(d, list.at.z + n)};
    hn::Vec<decltype(di)> cell[3];
    H t[3];
    auto square = hn::Zero(dd);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const H end = hn::Set(d, job.end[axis]), p = hn::Min(hn::Max(q[axis], zero), end);
      cell[axis] = hn::Min(hn::ConvertTo(di, p), hn::Sub(hn::ConvertTo(di, end), hn::Set(di, 1)));
      t[axis] = hn::Sub(p, hn::ConvertTo(d, cell[axis]));
      if (axis == 2) continue;
      const auto metres = hn::Add(hn::Set(dd, job.origin[axis]), hn::Mul(hn::Set(dd, job.pitch), hn::PromoteTo(dd, q[axis])));
      square = axis == 0 ? hn::Mul(metres, metres) : hn::Add(square, hn::Mul(metres, metres));
    }
    const H factor = between(d, job.factor, job.row, job.slab, cell, t);
    hn::StoreU(hn::DemoteTo(d, hn::Sqrt(square)), d, list.radius + n);
    const auto distance = hn::PromoteTo(dd, hn::LoadU(d, list.at.distance + n)), half = hn::Set(dd, 0.5);
    const auto ramp =
        hn::Min(hn::Max(hn::Sub(half, hn::Div(hn::Mul(half, distance), hn::Set(dd, job.ramp))), hn::Zero(dd)), hn::Set(dd, 1.0));
    const H share = hn::LoadU(d, list.share + n), grown = hn::LoadU(d, list.grown + n);
    const H now = hn::Min(share, hn::Max(hn::DemoteTo(d, ramp), hn::Mul(hn::Set(d, 0.5f), grown)));
    const H exposure = hn::Div(hn::Mul(factor, now), share);
    hn::StoreU(hn::IfThenElseZero(hn::Gt(now, zero), exposure), d, list.exposure + n);
  }
}

MeetMasks MeetSamples(const MeetJob& job, std::uint64_t asked) {
  const D d;
  const F zero = hn::Zero(d);
  Candidates all;
  find_candidates(job, asked, all);
  MeetMasks out;
  F nearest = hn::Set(d, all.nearest);
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
    nearest = hn::IfThenElse(hn::AndNot(hn::Or(met, unsure), near), hn::Min(nearest, distance), nearest);
  }
  out.nearest = hn::GetLane(hn::MinOfLanes(d, nearest));
  return out;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(MeasurePlaces);
HWY_EXPORT(WeighPlaces);
HWY_EXPORT(MeetSamples);

void measure_places(const PlaceJob& job, const VoxelList& voxels, const PlaceList& out) noexcept {
  HWY_DYNAMIC_DISPATCH(MeasurePlaces)(job, voxels, out);
}

void weigh_places(const PlaceJob& job, const WeighList& list) noexcept { HWY_DYNAMIC_DISPATCH(WeighPlaces)(job, list); }

MeetMasks meet_samples(const MeetJob& job, std::uint64_t asked) noexcept { return HWY_DYNAMIC_DISPATCH(MeetSamples)(job, asked); }

}  // namespace burrhole
#endif
