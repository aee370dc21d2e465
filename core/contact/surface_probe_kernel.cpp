// Points are taken in blocks through four passes: those that one record says are near, their cells, interpolated, those that are near.
// The plain twin is tests/core/contact/surface_probe_twin.cpp: thread sanitizers do not see gathers.
#include "core/contact/surface_probe_kernel.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/surface_probe_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact/probe_cell-inl.h"
#include "core/contact/probe_lanes-inl.h"

#ifndef BURRHOLE_SURFACE_PROBE_ONCE
#define BURRHOLE_SURFACE_PROBE_ONCE
namespace burrhole {

/// So few that what one pass leaves for the next stays in the nearest cache.
inline constexpr std::size_t kProbeBlock = kHitBlock;

/// Survivors of one block. Vector stores may touch up to a vector past what they keep.
struct ProbeBlock {
  static constexpr std::size_t kRoom = kProbeBlock + kShellPad;
  alignas(64) float x[kRoom], y[kRoom], z[kRoom];     // [m] tool frame
  alignas(64) float fx[kRoom], fy[kRoom], fz[kRoom];  // window coordinates; then the part of them past the record
  alignas(64) std::int32_t point[kRoom];              // index into the shell
  alignas(64) std::int32_t record[kRoom];             // least corner of the cell
  alignas(64) float channels[4 * kRoom];              // interpolated: distance, nx, ny, nz of one, then of the next
  alignas(64) float bends[4 * kRoom];                 // the sum of each four belongs to the distance
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

template <class Channel>
HWY_INLINE const Channel* records_of(const ProbeJob& job) {
  if constexpr (sizeof(Channel) == 1)
    return job.records8;
  else
    return job.records16;
}

/// Only the distance, in stored steps: the lowest channel of a record's first word.
template <class Channel>
HWY_INLINE Vf read_distance(const ProbeJob& job, Vi at) {
  const Floats df;
  const Ints di;
  constexpr int kShift = 32 - 8 * static_cast<int>(sizeof(Channel));
  const auto* words = reinterpret_cast<const std::int32_t*>(records_of<Channel>(job));
  const Vi w = hn::GatherIndex(di, words, sizeof(Channel) == 1 ? at : hn::ShiftLeft<1>(at));
  return hn::ConvertTo(df, hn::ShiftRight<kShift>(hn::ShiftLeft<kShift>(w)));
}

HWY_INLINE Vi record_of(const ProbeJob& job, Vi i, Vi j, Vi k) {
  const Ints di;
  return hn::Add(hn::Add(hn::Mul(k, hn::Set(di, job.slab)), hn::Mul(j, hn::Set(di, job.row))), i);
}

/// Point numbers, which alone are not padded.
HWY_INLINE Vi names(const ContactShellPart& part, std::size_t first) {
  const Ints di;
  const auto* from = reinterpret_cast<const std::int32_t*>(part.point.data()) + first;
  const std::size_t left = part.size() - first;
  if (left >= hn::Lanes(di)) return hn::LoadU(di, from);
  HWY_ALIGN std::int32_t last[16] = {};
  std::copy_n(from, left, last);
  return hn::Load(di, last);
}

/// First pass: points [first, last) against the one record of their voxel. @returns how many survive, written one after another.
template <class Channel>
HWY_INLINE std::size_t keep_near(const ProbeJob& job, const ContactShellPart& part, std::size_t first, std::size_t last, ProbeBlock& block,
                                 Vf& nearest, bool& outside) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df);
  const Vf half = hn::Set(df, 0.5f), zero = hn::Zero(df), limit = hn::Set(df, (job.look_ahead + job.slack) * job.steps_a_edge);
  std::size_t kept = 0;
  for (std::size_t n = first; n < last; n += lanes) {
    const Vf px = hn::LoadU(df, part.x.data() + n), py = hn::LoadU(df, part.y.data() + n), pz = hn::LoadU(df, part.z.data() + n);
    const Vf x = row_times(job.linear, px, py, pz, job.offset[0]);
    const Vf y = row_times(job.linear + 1, px, py, pz, job.offset[1]);
    const Vf z = row_times(job.linear + 2, px, py, pz, job.offset[2]);
    auto known = hn::And(hn::And(hn::Ge(x, hn::Set(df, job.lo[0])), hn::Lt(x, hn::Set(df, job.hi[0]))),
                         hn::And(hn::Ge(y, hn::Set(df, job.lo[1])), hn::Lt(y, hn::Set(df, job.hi[1]))));
    known = hn::And(known, hn::And(hn::Ge(z, hn::Set(df, job.lo[2])), hn::Lt(z, hn::Set(df, job.hi[2]))));
    const auto real = hn::FirstN(df, last - n);
    if (!hn::AllFalse(df, hn::AndNot(known, real))) outside = true;
    const auto usable = hn::And(known, real);
    // Lanes without a record look at the first one, and are dropped.
    const Vi i = hn::ConvertTo(di, hn::Add(hn::IfThenElse(usable, x, zero), half));
    const Vi j = hn::ConvertTo(di, hn::Add(hn::IfThenElse(usable, y, zero), half));
    const Vi k = hn::ConvertTo(di, hn::Add(hn::IfThenElse(usable, z, zero), half));
    const Vf distance = read_distance<Channel>(job, record_of(job, i, j, k));
    nearest = hn::Min(nearest, hn::IfThenElse(usable, distance, nearest));
    const auto near = hn::And(usable, hn::Lt(distance, limit));
    if (hn::AllFalse(df, near)) continue;
    const Vi name = names(part, n);
    keep_lanes(near, [&](auto keep) HWY_ATTR {
      keep(x, df, block.fx + kept);
      keep(y, df, block.fy + kept);
      keep(z, df, block.fz + kept);
      keep(px, df, block.x + kept);
      keep(py, df, block.y + kept);
      keep(pz, df, block.z + kept);
      keep(name, di, block.point + kept);
    });
    kept += hn::CountTrue(df, near);
  }
  return kept;
}

/// Second pass: the cell of each survivor; its four rows of records are asked for.
template <class Channel>
HWY_INLINE void find_cells(const ProbeJob& job, ProbeBlock& block, std::size_t kept) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df);
  for (std::size_t n = 0; n < kept; n += lanes) {
    const auto real = hn::FirstN(df, kept - n);  // past them lies what earlier stores touched
    const Vf x = hn::IfThenElseZero(real, hn::Load(df, block.fx + n)), y = hn::IfThenElseZero(real, hn::Load(df, block.fy + n)),
             z = hn::IfThenElseZero(real, hn::Load(df, block.fz + n));
    const Vi i = hn::ConvertTo(di, x), j = hn::ConvertTo(di, y), k = hn::ConvertTo(di, z);  // coordinates are not negative
    hn::Store(record_of(job, i, j, k), di, block.record + n);
    hn::Store(hn::Sub(x, hn::ConvertTo(df, i)), df, block.fx + n);
    hn::Store(hn::Sub(y, hn::ConvertTo(df, j)), df, block.fy + n);
    hn::Store(hn::Sub(z, hn::ConvertTo(df, k)), df, block.fz + n);
  }
  for (std::size_t n = 0; n < kept; ++n) {
    const Channel* first = records_of<Channel>(job) + 4 * static_cast<std::ptrdiff_t>(block.record[n]);
    const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(job.row), slab = 4 * static_cast<std::ptrdiff_t>(job.slab);
    hwy::Prefetch(first);
    hwy::Prefetch(first + row);
    hwy::Prefetch(first + slab);
    hwy::Prefetch(first + slab + row);
  }
}

/// Third pass: survivors interpolated, one after another.
template <class Channel>
HWY_INLINE void interpolate_all(const ProbeJob& job, ProbeBlock& block, std::size_t kept) {
  const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(job.row), slab = 4 * static_cast<std::ptrdiff_t>(job.slab);
  const Channel* records = records_of<Channel>(job);
  const auto cell = [&](std::size_t n) { return records + 4 * static_cast<std::ptrdiff_t>(block.record[n]); };
  for (std::size_t n = 0; n < kept; ++n)
    interpolate(cell(n), row, slab, block.fx[n], block.fy[n], block.fz[n], job.metric, block.channels + 4 * n, block.bends + 4 * n);
}

/// Least and greatest of what one block of hits holds.
struct BlockRange {
  Vf distance, lo[6], hi[6];  // place, then normal

  HWY_INLINE void clear() {
    const Floats df;
    distance = hn::Set(df, std::numeric_limits<float>::infinity());
    for (int a = 0; a < 6; ++a) lo[a] = distance, hi[a] = hn::Neg(distance);
  }
  HWY_INLINE void add(hn::Mask<Floats> near, Vf at, const Vf (&values)[6]) {
    distance = hn::IfThenElse(near, hn::Min(distance, at), distance);
    for (int a = 0; a < 6; ++a) {
      lo[a] = hn::IfThenElse(near, hn::Min(lo[a], values[a]), lo[a]);
      hi[a] = hn::IfThenElse(near, hn::Max(hi[a], values[a]), hi[a]);
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

/// Last pass: those within reach are appended, as one block.
HWY_INLINE void append_near(const ProbeJob& job, const ProbeBlock& block, std::size_t kept, ProbeHits& hits) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df), before = hits.count;
  const Vf to_edges = hn::Set(df, 1.0f / job.steps_a_edge), to_one = hn::Set(df, job.normal_scale);
  auto* named = reinterpret_cast<std::int32_t*>(hits.point.data());
  float* const arrays[6] = {hits.x.data(), hits.y.data(), hits.z.data(), hits.nx.data(), hits.ny.data(), hits.nz.data()};
  BlockRange range;
  range.clear();
  for (std::size_t n = 0; n < kept; n += lanes) {
    const auto real = hn::FirstN(df, kept - n);
    Vf distance, nx, ny, nz;
    hn::LoadInterleaved4(df, block.channels + 4 * n, distance, nx, ny, nz);
    Vf none, bx, by, bz;
    hn::LoadInterleaved4(df, block.bends + 4 * n, none, bx, by, bz);
    distance = hn::Mul(hn::Add(distance, hn::Add(hn::Add(bx, by), bz)), to_edges);
    const auto near = hn::And(real, hn::Lt(distance, hn::Set(df, job.look_ahead)));
    const std::size_t out = hits.count;
    const Vf values[6] = {hn::Load(df, block.x + n), hn::Load(df, block.y + n), hn::Load(df, block.z + n),
                          hn::Mul(nx, to_one),       hn::Mul(ny, to_one),       hn::Mul(nz, to_one)};
    range.add(near, distance, values);
    keep_lanes(near, [&](auto keep) HWY_ATTR {
      keep(distance, df, hits.distance.data() + out);
      for (int a = 0; a < 6; ++a) keep(values[a], df, arrays[a] + out);
      keep(hn::Load(di, block.point + n), di, named + out);
    });
    hits.count += hn::CountTrue(df, near);
  }
  if (hits.count > before) range.append(hits.count, hits.blocks);
}

template <class Channel>
HWY_INLINE void probe(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) {
  const Floats df;
  Vf nearest = hn::Set(df, hits.nearest * job.steps_a_edge);
  ProbeBlock block;
  for (std::size_t first = 0; first < part.size(); first += kProbeBlock) {
    const std::size_t last = HWY_MIN(first + kProbeBlock, part.size());
    const std::size_t kept = keep_near<Channel>(job, part, first, last, block, nearest, hits.outside);
    find_cells<Channel>(job, block, kept);
    interpolate_all<Channel>(job, block, kept);
    append_near(job, block, kept, hits);
  }
  hits.nearest = hn::GetLane(hn::MinOfLanes(df, nearest)) / job.steps_a_edge;
}

void Probe(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) {
  if (job.records8 != nullptr)
    probe<std::int8_t>(job, part, hits);
  else
    probe<std::int16_t>(job, part, hits);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {
HWY_EXPORT(Probe);
}  // namespace

void probe_points(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) noexcept {
  HWY_DYNAMIC_DISPATCH(Probe)(job, part, hits);
}

}  // namespace burrhole
#endif
