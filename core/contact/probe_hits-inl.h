// core/contact/probe_hits-inl.h: appends hits of the surface probe and computes the bounds of their blocks.
// Included by SIMD kernels only, once per target (hence no #pragma once).
#if defined(BURRHOLE_PROBE_HITS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PROBE_HITS_INL_H
#undef BURRHOLE_PROBE_HITS_INL_H
#else
#define BURRHOLE_PROBE_HITS_INL_H
#endif

#include <hwy/highway.h>

#include <limits>

#include "core/contact/probe_cell-inl.h"
#include "core/contact/probe_lanes-inl.h"
#include "core/contact/surface_probe_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// Minimum and maximum over the hits of one block.
struct BlockRange {
  Vf distance, lo[6], hi[6];  // position, then normal

  HWY_INLINE void clear() {
    const Floats df;
    distance = hn::Set(df, std::numeric_limits<float>::infinity());
    for (int a = 0; a < 6; ++a) lo[a] = distance, hi[a] = hn::Neg(distance);
  }
  HWY_INLINE void add(hn::Mask<Floats> near, Vf at, const Vf (&values)[6]) {
    if (hn::AllTrue(Floats(), near))
      widen(at, values, [](Vf bound, Vf) HWY_ATTR { return bound; });
    else
      widen(at, values, [near](Vf bound, Vf before) HWY_ATTR { return hn::IfThenElse(near, bound, before); });
  }
  template <class Choose>
  HWY_INLINE void widen(Vf at, const Vf (&values)[6], const Choose& choose) {
    distance = choose(hn::Min(distance, at), distance);
    for (int a = 0; a < 6; ++a) {
      lo[a] = choose(hn::Min(lo[a], values[a]), lo[a]);
      hi[a] = choose(hn::Max(hi[a], values[a]), hi[a]);
    }
  }
  HWY_INLINE void append(std::size_t end, HitBlocks& blocks) const {
    const Floats df;
    const std::size_t n = blocks.count++;
    blocks.end[n] = static_cast<std::uint32_t>(end);
    blocks.distance[n] = hn::GetLane(hn::MinOfLanes(df, distance));
    for (std::size_t a = 0; a < 6; ++a) {
      blocks.lo[a][n] = hn::GetLane(hn::MinOfLanes(df, lo[a]));
      blocks.hi[a][n] = hn::GetLane(hn::MaxOfLanes(df, hi[a]));
    }
  }
};

/// Appends the points of a vector that are within reach.
template <class Channel>
HWY_INLINE void append(const ProbeJob& job, hn::Mask<Floats> real, const CellSample& found, Vf px, Vf py, Vf pz, Vi name, BlockRange& range,
                       ProbeHits& hits) {
  const Floats df;
  const Ints di;
  const Vf distance = hn::Mul(found.distance, hn::Set(df, 1.0f / (job.steps_per_edge * kChannelScale<Channel>)));
  const Vf to_one = hn::Set(df, job.normal_scale / kChannelScale<Channel>);
  const Vf values[6] = {px, py, pz, hn::Mul(found.nx, to_one), hn::Mul(found.ny, to_one), hn::Mul(found.nz, to_one)};
  float* const arrays[6] = {hits.x.data(), hits.y.data(), hits.z.data(), hits.nx.data(), hits.ny.data(), hits.nz.data()};
  const auto near = hn::And(real, hn::Lt(distance, hn::Set(df, job.look_ahead)));
  const std::size_t out = hits.count;
  if (hits.blocks.wanted) range.add(near, distance, values);
  keep_lanes(near, [&](auto keep) HWY_ATTR {
    keep(distance, df, hits.distance.data() + out);
    for (int a = 0; a < 6; ++a) keep(values[a], df, arrays[a] + out);
    keep(name, di, reinterpret_cast<std::int32_t*>(hits.point.data()) + out);
  });
  hits.count += hn::CountTrue(df, near);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
