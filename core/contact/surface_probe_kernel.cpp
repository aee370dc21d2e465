// Blocks of points go through three passes: selection by one record each; cells; interpolation and selection by distance.
// Where most of the last block was near, one pass does all. The choice does not change any bit.
// The scalar reference is tests/core/contact/surface_probe_twin.cpp: thread sanitizers do not track gathers.
#include "core/contact/surface_probe_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/surface_probe_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact/probe_cell-inl.h"
#include "core/contact/probe_hits-inl.h"
#include "core/contact/probe_lanes-inl.h"

#ifndef BURRHOLE_SURFACE_PROBE_ONCE
#define BURRHOLE_SURFACE_PROBE_ONCE
namespace burrhole {

/// Small enough that the data between passes stays in the first-level cache.
inline constexpr std::size_t kProbeBlock = kHitBlock;

/// Survivors of one block. Vector stores may write up to one vector beyond the kept elements.
struct ProbeBlock {
  static constexpr std::size_t kRoom = kProbeBlock + kShellPad;
  alignas(64) float x[kRoom], y[kRoom], z[kRoom];     // [m] tool frame
  alignas(64) float wx[kRoom], wy[kRoom], wz[kRoom];  // window coordinates
  alignas(64) std::int32_t point[kRoom];              // index into the shell
  alignas(64) std::int32_t record[kRoom];             // least corner of the cell
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

template <class Channel>
HWY_INLINE RowStarts<Channel> rows_of(const ProbeJob& job) {
  const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(job.row), slab = 4 * static_cast<std::ptrdiff_t>(job.slab);
  const Channel* const first = records_of<Channel>(job);
  return {first, first + slab, first + row, first + slab + row};
}

/// Records at whole coordinates, not negative and below 2^22. Their sum with 2^23 has them in its lowest bits: Highway's own conversions
/// mind overflow, in four more instructions each. The bits above are taken off once for all three.
HWY_INLINE Vi record_of(const ProbeJob& job, Vf i, Vf j, Vf k) {
  const Ints di;
  constexpr std::uint32_t kAbove = 0x4b000000u;
  const auto bits = [](Vf whole) HWY_ATTR { return hn::BitCast(Ints(), hn::Add(whole, hn::Set(Floats(), 8388608.0f))); };
  const Vi sum = hn::Add(hn::Add(hn::Mul(bits(k), hn::Set(di, job.slab)), hn::Mul(bits(j), hn::Set(di, job.row))), bits(i));
  const std::uint32_t above = kAbove * (static_cast<std::uint32_t>(job.slab) + static_cast<std::uint32_t>(job.row) + 1u);
  return hn::Sub(sum, hn::Set(di, static_cast<std::int32_t>(above)));
}

/// Point numbers, the only array without padding.
HWY_INLINE Vi names(const ContactShellPart& part, std::size_t first) {
  const Ints di;
  const auto* from = reinterpret_cast<const std::int32_t*>(part.point.data()) + first;
  const std::size_t left = part.size() - first;
  if (left >= hn::Lanes(di)) return hn::LoadU(di, from);
  HWY_ALIGN std::int32_t last[16] = {};
  std::copy_n(from, left, last);
  return hn::Load(di, last);
}

/// A vector of points in window coordinates; points without a record are not usable and are moved to the first record.
struct Placed {
  Vf px, py, pz, x, y, z;
  hn::Mask<Floats> usable;
};
HWY_INLINE Placed place(const ProbeJob& job, const ContactShellPart& part, std::size_t n, std::size_t last, bool& outside) {
  const Floats df;
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
  return {px, py, pz, hn::IfThenElseZero(usable, x), hn::IfThenElseZero(usable, y), hn::IfThenElseZero(usable, z), usable};
}

/// The voxels with the nearest centres.
HWY_INLINE Vf nearest_voxel(Vf x) { return hn::Floor(hn::Add(x, hn::Set(Floats(), 0.5f))); }

/// First pass: points [first, last) against the one record of their voxel. @returns the number of survivors, stored contiguously.
template <class Channel>
HWY_INLINE std::size_t keep_near(const ProbeJob& job, const ContactShellPart& part, std::size_t first, std::size_t last, ProbeBlock& block,
                                 Vf& nearest, bool& outside) {
  const Floats df;
  const Ints di;
  const Vf limit = hn::Set(df, (job.look_ahead + job.slack) * job.steps_per_edge);
  std::size_t kept = 0;
  for (std::size_t n = first; n < last; n += hn::Lanes(df)) {
    const Placed at = place(job, part, n, last, outside);
    const Vf distance = read_distance<Channel>(job, record_of(job, nearest_voxel(at.x), nearest_voxel(at.y), nearest_voxel(at.z)));
    nearest = hn::Min(nearest, hn::IfThenElse(at.usable, distance, nearest));
    const auto near = hn::And(at.usable, hn::Lt(distance, limit));
    if (hn::AllFalse(df, near)) continue;
    const Vi name = names(part, n);
    keep_lanes(near, [&](auto keep) HWY_ATTR {
      keep(at.x, df, block.wx + kept);
      keep(at.y, df, block.wy + kept);
      keep(at.z, df, block.wz + kept);
      keep(at.px, df, block.x + kept);
      keep(at.py, df, block.y + kept);
      keep(at.pz, df, block.z + kept);
      keep(name, di, block.point + kept);
    });
    kept += hn::CountTrue(df, near);
  }
  return kept;
}

/// Second pass: the cell of each survivor, to a whole vector; its four rows of records are asked for.
template <class Channel>
HWY_INLINE void find_cells(const ProbeJob& job, ProbeBlock& block, std::size_t kept) {
  const Floats df;
  const Ints di;
  for (std::size_t n = 0; n < kept; n += hn::Lanes(df)) {
    const auto real = hn::FirstN(df, kept - n);  // past them lies what earlier stores touched
    const Vf x = hn::IfThenElseZero(real, hn::Load(df, block.wx + n)), y = hn::IfThenElseZero(real, hn::Load(df, block.wy + n)),
             z = hn::IfThenElseZero(real, hn::Load(df, block.wz + n));
    hn::Store(record_of(job, hn::Floor(x), hn::Floor(y), hn::Floor(z)), di, block.record + n);
  }
  const RowStarts<Channel> rows = rows_of<Channel>(job);
  for (std::size_t n = 0; n < kept; ++n) {
    const std::ptrdiff_t at = 4 * static_cast<std::ptrdiff_t>(block.record[n]);
    hwy::Prefetch(rows.row00 + at);
    hwy::Prefetch(rows.row01 + at);
    hwy::Prefetch(rows.row10 + at);
    hwy::Prefetch(rows.row11 + at);
  }
}

/// A vector of points of a block in window coordinates, and what their cells say.
template <class Channel>
struct InCells {
  HWY_INLINE InCells(const RowStarts<Channel>& starts, const ProbeBlock& block, std::size_t n)
      : x(hn::Load(Floats(), block.wx + n)),
        y(hn::Load(Floats(), block.wy + n)),
        z(hn::Load(Floats(), block.wz + n)),
        i(hn::Floor(x)),
        j(hn::Floor(y)),
        k(hn::Floor(z)),
        rows(read_cells(starts, block.record + n)) {}
  template <bool kStraight>
  [[nodiscard]] HWY_INLINE CellSample sample(const ProbeJob& job) const {
    return interpolate<kStraight>(rows, hn::Sub(x, i), hn::Sub(y, j), hn::Sub(z, k), job.metric, in_cut(job));
  }
  [[nodiscard]] HWY_INLINE hn::Mask<Floats> in_cut(const ProbeJob& job) const {
    if (!job.any_cut) return hn::FirstN(Floats(), 0);
    const auto along = [&](Vf at, std::size_t a) HWY_ATTR {
      return hn::And(hn::Ge(at, hn::Set(Floats(), job.cut_lo[a])), hn::Lt(at, hn::Set(Floats(), job.cut_hi[a])));
    };
    return hn::And(hn::And(along(i, 0), along(j, 1)), along(k, 2));
  }
  /// Of the voxel whose centre is nearest, which is one of the cell's corners; in steps.
  [[nodiscard]] HWY_INLINE Vf nearest_record() const {
    const Vf scaled = distance_at(rows, hn::Ne(nearest_voxel(x), i), hn::Ne(nearest_voxel(y), j), hn::Ne(nearest_voxel(z), k));
    return hn::Mul(scaled, hn::Set(Floats(), 1.0f / kChannelScale<Channel>));
  }
  Vf x, y, z, i, j, k;
  CellRows<Channel> rows;
};

/// Last pass: interpolates the survivors and appends those within reach.
template <bool kStraight, class Channel>
HWY_INLINE void append_near(const ProbeJob& job, const ProbeBlock& block, std::size_t kept, BlockRange& range, ProbeHits& hits) {
  const Floats df;
  const RowStarts<Channel> starts = rows_of<Channel>(job);
  for (std::size_t n = 0; n < kept; n += hn::Lanes(df)) {
    const InCells<Channel> cells(starts, block, n);
    append<Channel>(job, hn::FirstN(df, kept - n), cells.template sample<kStraight>(job), hn::Load(df, block.x + n),
                    hn::Load(df, block.y + n), hn::Load(df, block.z + n), hn::Load(Ints(), block.point + n), range, hits);
  }
}

/// Whether most points of a part's first vector are near: what is expected of its first block.
template <class Channel>
HWY_INLINE bool begins_near(const ProbeJob& job, const ContactShellPart& part) {
  const Floats df;
  bool outside = false;
  const std::size_t last = HWY_MIN(part.size(), hn::Lanes(df));
  const Placed at = place(job, part, 0, last, outside);
  const Vf distance = read_distance<Channel>(job, record_of(job, nearest_voxel(at.x), nearest_voxel(at.y), nearest_voxel(at.z)));
  const Vf limit = hn::Set(df, (job.look_ahead + job.slack) * job.steps_per_edge);
  return 4 * hn::CountTrue(df, hn::And(at.usable, hn::Lt(distance, limit))) >= 3 * last;
}

/// The cells of all points of a block. @returns false, with undefined cells, where a point has none.
HWY_INLINE bool find_all_cells(const ProbeJob& job, const ContactShellPart& part, std::size_t first, std::size_t last, ProbeBlock& block) {
  const Floats df;
  for (std::size_t n = first; n < last; n += hn::Lanes(df)) {
    bool outside = false;
    const Placed at = place(job, part, n, last, outside);
    if (outside) return false;
    hn::Store(at.x, df, block.wx + (n - first));
    hn::Store(at.y, df, block.wy + (n - first));
    hn::Store(at.z, df, block.wz + (n - first));
    hn::Store(record_of(job, hn::Floor(at.x), hn::Floor(at.y), hn::Floor(at.z)), Ints(), block.record + (n - first));
  }
  return true;
}

/// What the passes do, for a block of points that have cells: each is interpolated, and the record of its voxel is one of its cell's.
/// @returns how many that record says are near.
template <bool kStraight, class Channel>
HWY_INLINE std::size_t append_all(const ProbeJob& job, const ContactShellPart& part, std::size_t first, std::size_t last,
                                  const ProbeBlock& block, BlockRange& range, Vf& nearest, ProbeHits& hits) {
  const Floats df;
  const RowStarts<Channel> starts = rows_of<Channel>(job);
  const Vf limit = hn::Set(df, (job.look_ahead + job.slack) * job.steps_per_edge);
  std::size_t kept = 0;
  for (std::size_t n = first; n < last; n += hn::Lanes(df)) {
    const InCells<Channel> cells(starts, block, n - first);
    const auto real = hn::FirstN(df, last - n);
    const Vf distance = cells.nearest_record();
    nearest = hn::Min(nearest, hn::IfThenElse(real, distance, nearest));
    const auto near = hn::And(real, hn::Lt(distance, limit));
    kept += hn::CountTrue(df, near);
    append<Channel>(job, near, cells.template sample<kStraight>(job), hn::LoadU(df, part.x.data() + n), hn::LoadU(df, part.y.data() + n),
                    hn::LoadU(df, part.z.data() + n), names(part, n), range, hits);
  }
  return kept;
}

template <bool kStraight, class Channel>
HWY_INLINE void probe(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) {
  const Floats df;
  Vf nearest = hn::Set(df, hits.nearest * job.steps_per_edge);
  ProbeBlock block;
  bool most_near = begins_near<Channel>(job, part);  // later, of the block before, which lies beside this one
  for (std::size_t first = 0; first < part.size(); first += kProbeBlock) {
    const std::size_t last = HWY_MIN(first + kProbeBlock, part.size()), before = hits.count;
    BlockRange range;
    range.clear();
    std::size_t kept = 0;
    if (most_near && find_all_cells(job, part, first, last, block)) {
      kept = append_all<kStraight, Channel>(job, part, first, last, block, range, nearest, hits);
    } else {
      kept = keep_near<Channel>(job, part, first, last, block, nearest, hits.outside);
      find_cells<Channel>(job, block, kept);
      append_near<kStraight, Channel>(job, block, kept, range, hits);
    }
    if (hits.blocks.wanted && hits.count > before) range.append(hits.count, hits.blocks);
    most_near = 4 * kept >= 3 * (last - first);
  }
  hits.nearest = hn::GetLane(hn::MinOfLanes(df, nearest)) / job.steps_per_edge;
}

void Probe(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) {
  if (job.records8 != nullptr)
    job.diagonal ? probe<true, std::int8_t>(job, part, hits) : probe<false, std::int8_t>(job, part, hits);
  else
    job.diagonal ? probe<true, std::int16_t>(job, part, hits) : probe<false, std::int16_t>(job, part, hits);
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
