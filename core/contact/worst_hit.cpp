// The scalar reference is worst_plainly() of tests/core/contact/surface_probe_twin.cpp.
#include "core/contact/worst_hit.h"

#include <algorithm>

#include "core/base/assert.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/worst_hit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact/probe_lanes-inl.h"

#ifndef BURRHOLE_WORST_HIT_ONCE
#define BURRHOLE_WORST_HIT_ONCE
namespace burrhole {

inline constexpr std::size_t kFewBlocks = kScannedHits / kHitBlock;
inline constexpr std::size_t kMaxHitBlocks = kMaxShellPoints / kHitBlock + 2;
// Relative to the sum of magnitudes behind a bound: rounding of the bound and of the distances of its hits together, 12 operations deep
// each, of half a unit in the last place (6e-8); and the loss by underflow.
inline constexpr float kBoundRounding = 4e-6f, kBoundLeast = 1e-30f;

/// The motion in single precision, column by column.
struct WorstJob {
  float linear[9], offset[3];
  float limit;
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

/// The minimum so far, per lane; each lane keeps its first one.
struct Least {
  Vf value;
  Vi place;
};

HWY_INLINE void scan(const ProbeHits& hits, const WorstJob& job, const HitRange& range, Least& least) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df);
  const float* const distance = hits.lowered ? hits.lower.data() : hits.distance.data();
  const Vi lane = hn::Iota(di, 0);  // made once: it is loaded from memory
  for (std::size_t n = range.first; n < range.last; n += lanes) {
    const Vf x = hn::LoadU(df, hits.x.data() + n), y = hn::LoadU(df, hits.y.data() + n), z = hn::LoadU(df, hits.z.data() + n);
    const Vf mx = row_times(job.linear, x, y, z, job.offset[0]), my = row_times(job.linear + 1, x, y, z, job.offset[1]),
             mz = row_times(job.linear + 2, x, y, z, job.offset[2]);
    const Vf along = hn::Add(hn::Add(hn::Mul(hn::LoadU(df, hits.nx.data() + n), mx), hn::Mul(hn::LoadU(df, hits.ny.data() + n), my)),
                             hn::Mul(hn::LoadU(df, hits.nz.data() + n), mz));
    const Vf after = hn::Add(hn::LoadU(df, distance + n), along);
    const auto better = hn::And(hn::FirstN(df, range.last - n), hn::Lt(after, least.value));
    least.value = hn::IfThenElse(better, after, least.value);
    least.place = hn::IfThenElse(hn::RebindMask(di, better), hn::Add(lane, hn::Set(di, static_cast<std::int32_t>(n))), least.place);
  }
}

/// Lower bounds of the distances in blocks, for a vector of blocks.
HWY_INLINE Vf bound(const HitBlocks& blocks, std::size_t n, const WorstJob& job) {
  const Floats df;
  Vf sum = hn::LoadU(df, blocks.distance.data() + n), size = hn::Abs(sum);
  for (std::size_t r = 0; r < 3; ++r) {
    Vf lo = hn::Set(df, job.offset[r]), hi = lo, most = hn::Abs(lo);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vf m = hn::Set(df, job.linear[3 * c + r]);
      const Vf a = hn::Mul(m, hn::LoadU(df, blocks.lo[c].data() + n)), b = hn::Mul(m, hn::LoadU(df, blocks.hi[c].data() + n));
      lo = hn::Add(lo, hn::Min(a, b));
      hi = hn::Add(hi, hn::Max(a, b));
      most = hn::Add(most, hn::Max(hn::Abs(a), hn::Abs(b)));
    }
    const Vf from = hn::LoadU(df, blocks.lo[3 + r].data() + n), to = hn::LoadU(df, blocks.hi[3 + r].data() + n);
    sum = hn::Add(sum, hn::Min(hn::Min(hn::Mul(from, lo), hn::Mul(from, hi)), hn::Min(hn::Mul(to, lo), hn::Mul(to, hi))));
    size = hn::Add(size, hn::Mul(most, hn::Max(hn::Abs(from), hn::Abs(to))));
  }
  return hn::Sub(sum, hn::Add(hn::Mul(size, hn::Set(df, kBoundRounding)), hn::Set(df, kBoundLeast)));
}

HWY_INLINE Least nothing(const HitRange& range, float limit) {
  return {hn::Set(Floats(), limit), hn::Set(Ints(), static_cast<std::int32_t>(range.first))};
}

HWY_INLINE WorstHit first_of(const Least& least) {
  const Floats df;
  HWY_ALIGN float values[16];
  HWY_ALIGN std::int32_t places[16];
  hn::Store(least.value, df, values);
  hn::Store(least.place, Ints(), places);
  std::size_t best = 0;
  for (std::size_t lane = 1; lane < hn::Lanes(df); ++lane)
    if (values[lane] < values[best] || (values[lane] == values[best] && places[lane] < places[best])) best = lane;
  return {static_cast<std::size_t>(places[best]), values[best]};
}

/// Blocks [first, last). Scans the block of the least bound for an upper bound of the answer, then, in order, all blocks with a bound not
/// above it, so that ties resolve as in a plain scan.
HWY_INLINE void scan_blocks(const ProbeHits& hits, const WorstJob& job, const HitRange& which, Least& least) {
  const Floats df;
  const HitBlocks& blocks = hits.blocks;
  alignas(64) float bounds[kMaxHitBlocks + kShellPad];
  const std::size_t count = which.last - which.first;
  for (std::size_t n = 0; n < count; n += hn::Lanes(df)) hn::Store(bound(blocks, which.first + n, job), df, bounds + n);
  float known = job.limit;
  std::size_t seed = count;
  for (std::size_t n = 0; n < count; ++n)
    if (bounds[n] < known) known = bounds[n], seed = n;
  if (seed < count) {
    const HitRange range = blocks.hits_of(which.first + seed);
    Least of_seed = nothing(range, job.limit);
    scan(hits, job, range, of_seed);
    known = first_of(of_seed).distance;
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (bounds[n] > known) continue;  // NaN passes: the scan decides
    HitRange range = blocks.hits_of(which.first + n);
    while (n + 1 < count && !(bounds[n + 1] > known)) range.last = blocks.end[which.first + ++n];
    scan(hits, job, range, least);
  }
}

WorstHit Worst(const ProbeHits& hits, const WorstJob& job, const HitRange& range, const HitRange& whole) {
  Least least = nothing(range, job.limit);
  if (whole.first + kFewBlocks < whole.last) {
    const HitRange held{hits.blocks.hits_of(whole.first).first, hits.blocks.end[whole.last - 1]};
    scan(hits, job, {range.first, held.first}, least);
    scan_blocks(hits, job, whole, least);
    scan(hits, job, {held.last, range.last}, least);
  } else {
    scan(hits, job, range, least);
  }
  return first_of(least);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {

HWY_EXPORT(Worst);

/// The blocks that lie completely in a range of hits.
HitRange whole_blocks(const HitBlocks& blocks, const HitRange& range) noexcept {
  std::size_t first = 0, last = blocks.count;
  while (first < last && blocks.hits_of(first).first < range.first) ++first;
  while (last > first && blocks.end[last - 1] > range.last) --last;
  return {first, last};
}

}  // namespace

std::optional<WorstHit> find_worst(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion,
                                   float limit) noexcept {
  if (first >= last) return std::nullopt;
  BH_ASSERT(last <= hits.count && hits.blocks.count <= kMaxHitBlocks);
  WorstJob job{.linear = {}, .offset = {}, .limit = limit};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) job.linear[3 * c + r] = static_cast<float>(motion.linear[c][r]);
  for (std::size_t r = 0; r < 3; ++r) job.offset[r] = static_cast<float>(motion.offset[r]);
  const WorstHit found = HWY_DYNAMIC_DISPATCH(Worst)(hits, job, {first, last}, whole_blocks(hits.blocks, {first, last}));
  return found.distance < limit ? std::optional(found) : std::nullopt;
}

}  // namespace burrhole
#endif
