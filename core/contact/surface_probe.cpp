// The plain twin is tests/core/contact/surface_probe_twin.cpp: thread sanitizers do not see gathers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/surface_probe.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <limits>

#include "core/contact/surface_probe.h"

#ifndef BURRHOLE_SURFACE_PROBE_ONCE
#define BURRHOLE_SURFACE_PROBE_ONCE
namespace burrhole {

/// What every target's kernel is told: coordinates are relative to the window's corner, so that single precision is enough.
struct ProbeJob {
  const std::int8_t* records8;  // channels of records: distance, nx, ny, nz, and so on; one of the two
  const std::int16_t* records16;
  std::int32_t row, slab;  // records
  float lo[3], hi[3];      // points p with lo <= p < hi have eight known records
  float linear[9];         // column by column
  float offset[3];
  float steps_a_edge;  // of the stored distance
  float normal_scale;
  float look_ahead;  // [voxel edges]
  float slack;       // [voxel edges] a voxel's centre is at most this far from any point of its cell
};

/// For each set of eight lanes, by its bits: those in it first, then the others. Its first four columns serve four lanes.
inline constexpr auto kPackOrder = [] {
  std::array<std::array<std::uint8_t, 8>, 256> out{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    std::size_t at = 0;
    for (const unsigned in : {1u, 0u})
      for (unsigned lane = 0; lane < 8; ++lane)
        if (((bits >> lane) & 1u) == in) out[bits][at++] = static_cast<std::uint8_t>(lane);
  }
  return out;
}();

/// Points are taken in blocks, so that what one pass leaves for the next stays in the nearest cache.
inline constexpr std::size_t kProbeBlock = 128;

/// Survivors of one block. Vector stores may touch up to a vector past what they keep.
struct ProbeBlock {
  static constexpr std::size_t kRoom = kProbeBlock + kShellPad;
  alignas(64) float x[kRoom], y[kRoom], z[kRoom];     // [m] tool frame
  alignas(64) float fx[kRoom], fy[kRoom], fz[kRoom];  // window coordinates; then the part of them past the record
  alignas(64) std::int32_t index[kRoom];              // in the part
  alignas(64) std::int32_t record[kRoom];             // least corner of the cell
  alignas(64) float channels[4 * kRoom];              // interpolated: distance, nx, ny, nz of one, then of the next
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
// At most sixteen lanes: the shell is padded to that.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Vf = hn::Vec<Floats>;
using Vi = hn::Vec<Ints>;

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

// Lanes that are kept, moved to the front. Highway's own Compress() is one instruction with 512 bits, but without them it copies its table to
// the stack at each call and makes the order anew for each array: five times slower than the one order made here for all of them.
#if HWY_MAX_BYTES == 16 || HWY_MAX_BYTES == 32
using Packing = decltype(hn::IndicesFromVec(Ints(), hn::Zero(Ints())));

HWY_INLINE Packing packing_of(hn::Mask<Floats> kept) {
  const Ints di;
  const hn::Rebind<std::uint8_t, Ints> bytes;
  std::uint8_t bits[8];
  hn::StoreMaskBits(Floats(), kept, bits);
  return hn::IndicesFromVec(di, hn::PromoteTo(di, hn::LoadU(bytes, kPackOrder[bits[0]].data())));
}
template <class D, class V>
HWY_INLINE void pack_store(V v, Packing packing, D d, hn::TFromD<D>* to) {
  hn::StoreU(hn::BitCast(d, hn::TableLookupLanes(hn::BitCast(Ints(), v), packing)), d, to);
}
#else
using Packing = hn::Mask<Floats>;

HWY_INLINE Packing packing_of(hn::Mask<Floats> kept) { return kept; }
template <class D, class V>
HWY_INLINE void pack_store(V v, Packing packing, D d, hn::TFromD<D>* to) {
  hn::StoreU(hn::Compress(v, hn::RebindMask(d, packing)), d, to);
}
#endif

HWY_INLINE Vf row_times(const float* m, Vf x, Vf y, Vf z, float offset) {
  const Floats df;
  const Vf xy = hn::Add(hn::Mul(hn::Set(df, m[0]), x), hn::Mul(hn::Set(df, m[3]), y));
  return hn::Add(hn::Add(xy, hn::Mul(hn::Set(df, m[6]), z)), hn::Set(df, offset));
}

HWY_INLINE Vi record_of(const ProbeJob& job, Vi i, Vi j, Vi k) {
  const Ints di;
  return hn::Add(hn::Add(hn::Mul(k, hn::Set(di, job.slab)), hn::Mul(j, hn::Set(di, job.row))), i);
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
    const Packing packing = packing_of(near);
    pack_store(x, packing, df, block.fx + kept);
    pack_store(y, packing, df, block.fy + kept);
    pack_store(z, packing, df, block.fz + kept);
    pack_store(px, packing, df, block.x + kept);
    pack_store(py, packing, df, block.y + kept);
    pack_store(pz, packing, df, block.z + kept);
    pack_store(hn::Iota(di, static_cast<std::int32_t>(n)), packing, di, block.index + kept);
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

// The four channels of one cell, mixed along k, then j, then i. Lanes are channels, of as many corners as a vector holds, so that a row is one
// load and nothing is gathered. The order is the same for every width, and so are the bits.
#if HWY_MAX_BYTES >= 16

template <std::size_t kLanes, class Channel>
HWY_INLINE hn::Vec<hn::FixedTag<float, kLanes>> read_channels(const Channel* from) {
  const hn::FixedTag<float, kLanes> df;
  const hn::FixedTag<std::int32_t, kLanes> di;
  const hn::FixedTag<Channel, kLanes> stored;
  return hn::ConvertTo(df, hn::PromoteTo(di, hn::LoadU(stored, from)));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V mix(D d, V a, V b, float t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), hn::Set(d, t)));
}

#endif
#if HWY_MAX_BYTES >= 32  // sixteen lanes gain nothing: two corners along j are then two loads all the same

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz, float* out) {
  const hn::FixedTag<float, 8> d8;
  const hn::FixedTag<float, 4> d4;
  const auto near = mix(d8, read_channels<8>(first), read_channels<8>(first + slab), fz);
  const auto past = mix(d8, read_channels<8>(first + row), read_channels<8>(first + row + slab), fz);
  const auto pair = mix(d8, near, past, fy);
  hn::Store(mix(d4, hn::LowerHalf(d4, pair), hn::UpperHalf(d4, pair), fx), d4, out);
}

#elif HWY_MAX_BYTES >= 16

template <class Channel>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> along_k(const Channel* first, std::ptrdiff_t slab, float fz) {
  return mix(hn::FixedTag<float, 4>(), read_channels<4>(first), read_channels<4>(first + slab), fz);
}

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz, float* out) {
  const hn::FixedTag<float, 4> d4;
  const auto left = mix(d4, along_k(first, slab, fz), along_k(first + row, slab, fz), fy);
  const auto right = mix(d4, along_k(first + 4, slab, fz), along_k(first + row + 4, slab, fz), fy);
  hn::Store(mix(d4, left, right, fx), d4, out);
}

#else  // one lane

HWY_INLINE float mix(float a, float b, float t) { return a + (b - a) * t; }

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz, float* out) {
  const auto along_k = [&](const Channel* at) { return mix(static_cast<float>(at[0]), static_cast<float>(at[slab]), fz); };
  for (std::size_t c = 0; c < 4; ++c, ++first)
    out[c] = mix(mix(along_k(first), along_k(first + row), fy), mix(along_k(first + 4), along_k(first + row + 4), fy), fx);
}

#endif

/// Third pass: survivors interpolated, one after another.
template <class Channel>
HWY_INLINE void interpolate_all(const ProbeJob& job, ProbeBlock& block, std::size_t kept) {
  const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(job.row), slab = 4 * static_cast<std::ptrdiff_t>(job.slab);
  for (std::size_t n = 0; n < kept; ++n) {
    const Channel* first = records_of<Channel>(job) + 4 * static_cast<std::ptrdiff_t>(block.record[n]);
    interpolate(first, row, slab, block.fx[n], block.fy[n], block.fz[n], block.channels + 4 * n);
  }
}

/// Last pass: those within reach are appended.
HWY_INLINE void append_near(const ProbeJob& job, const ContactShellPart& part, const ProbeBlock& block, std::size_t kept, ProbeHits& hits) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df);
  const Vf to_edges = hn::Set(df, 1.0f / job.steps_a_edge), to_one = hn::Set(df, job.normal_scale);
  const auto* names = reinterpret_cast<const std::int32_t*>(part.point.data());
  auto* named = reinterpret_cast<std::int32_t*>(hits.point.data());
  for (std::size_t n = 0; n < kept; n += lanes) {
    const auto real = hn::FirstN(df, kept - n);
    Vf distance, nx, ny, nz;
    hn::LoadInterleaved4(df, block.channels + 4 * n, distance, nx, ny, nz);
    distance = hn::Mul(distance, to_edges);
    const auto near = hn::And(real, hn::Lt(distance, hn::Set(df, job.look_ahead)));
    const Packing packing = packing_of(near);
    const std::size_t out = hits.count;
    pack_store(distance, packing, df, hits.distance.data() + out);
    pack_store(hn::Mul(nx, to_one), packing, df, hits.nx.data() + out);
    pack_store(hn::Mul(ny, to_one), packing, df, hits.ny.data() + out);
    pack_store(hn::Mul(nz, to_one), packing, df, hits.nz.data() + out);
    pack_store(hn::Load(df, block.x + n), packing, df, hits.x.data() + out);
    pack_store(hn::Load(df, block.y + n), packing, df, hits.y.data() + out);
    pack_store(hn::Load(df, block.z + n), packing, df, hits.z.data() + out);
    const Vi index = hn::IfThenElseZero(hn::RebindMask(di, real), hn::Load(di, block.index + n));
    pack_store(hn::GatherIndex(di, names, index), packing, di, named + out);
    hits.count += hn::CountTrue(df, near);
  }
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
    append_near(job, part, block, kept, hits);
  }
  hits.nearest = hn::GetLane(hn::MinOfLanes(df, nearest)) / job.steps_a_edge;
}

void Probe(const ProbeJob& job, const ContactShellPart& part, ProbeHits& hits) {
  if (job.records8 != nullptr)
    probe<std::int8_t>(job, part, hits);
  else
    probe<std::int16_t>(job, part, hits);
}

ProbeWorst Worst(const ProbeHits& hits, std::size_t first, std::size_t last, const float* linear, const float* offset) {
  const Floats df;
  const Ints di;
  const std::size_t lanes = hn::Lanes(df);
  Vf least = hn::Set(df, std::numeric_limits<float>::infinity());
  Vi where = hn::Set(di, static_cast<std::int32_t>(first));  // a motion that is not finite moves none nearer
  for (std::size_t n = first; n < last; n += lanes) {
    const Vf x = hn::LoadU(df, hits.x.data() + n), y = hn::LoadU(df, hits.y.data() + n), z = hn::LoadU(df, hits.z.data() + n);
    const Vf mx = row_times(linear, x, y, z, offset[0]), my = row_times(linear + 1, x, y, z, offset[1]),
             mz = row_times(linear + 2, x, y, z, offset[2]);
    const Vf along = hn::Add(hn::Add(hn::Mul(hn::LoadU(df, hits.nx.data() + n), mx), hn::Mul(hn::LoadU(df, hits.ny.data() + n), my)),
                             hn::Mul(hn::LoadU(df, hits.nz.data() + n), mz));
    const Vf after = hn::Add(hn::LoadU(df, hits.distance.data() + n), along);
    const auto better = hn::And(hn::FirstN(df, last - n), hn::Lt(after, least));
    least = hn::IfThenElse(better, after, least);
    where = hn::IfThenElse(hn::RebindMask(di, better), hn::Iota(di, static_cast<std::int32_t>(n)), where);
  }
  HWY_ALIGN float values[16];
  HWY_ALIGN std::int32_t places[16];
  hn::Store(least, df, values);
  hn::Store(where, di, places);
  std::size_t best = 0;
  for (std::size_t lane = 1; lane < lanes; ++lane)
    if (values[lane] < values[best] || (values[lane] == values[best] && places[lane] < places[best])) best = lane;
  return {static_cast<std::size_t>(places[best]), values[best]};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {

HWY_EXPORT(Probe);
HWY_EXPORT(Worst);

void copy_matrix(const Mat3& m, const Vec3& offset, float* linear, float* moved) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) linear[3 * c + r] = static_cast<float>(m[c][r]);
  for (std::size_t r = 0; r < 3; ++r) moved[r] = static_cast<float>(offset[r]);
}

}  // namespace

void ProbeHits::reserve(std::size_t points) {
  // Vector stores may touch up to a vector past what they keep.
  for (std::vector<float>* array : {&x, &y, &z, &distance, &nx, &ny, &nz}) array->assign(points + kShellPad, 0.0f);
  point.assign(points + kShellPad, 0);
}

void ProbeHits::clear() noexcept {
  count = 0;
  nearest = static_cast<float>(kRecordBand);
  outside = false;
}

void probe_surface(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead,
                   ProbeHits& hits) noexcept {
  if (points.size() == 0) return;
  const Vec3i size = bone.box.size();
  const bool small = bone.records8 != nullptr;
  const Mat3& cell = bone.bone_from_index.linear;
  const double diagonal = std::max({glm::length(cell[0] + cell[1] + cell[2]), glm::length(cell[0] + cell[1] - cell[2]),
                                    glm::length(cell[0] - cell[1] + cell[2]), glm::length(cell[0] - cell[1] - cell[2])});
  ProbeJob job{};
  job.records8 = reinterpret_cast<const std::int8_t*>(bone.records8);
  job.records16 = reinterpret_cast<const std::int16_t*>(bone.records16);
  job.row = size.x;
  job.slab = size.x * size.y;
  const VoxelBox known{bone.valid.lo - bone.box.lo, bone.valid.hi - bone.box.lo};
  for (std::size_t a = 0; a < 3; ++a) {
    job.lo[a] = static_cast<float>(known.lo[a]);
    job.hi[a] = static_cast<float>(known.hi[a] - 1);
  }
  copy_matrix(index_from_tool.linear, index_from_tool.offset - Vec3(bone.box.lo), job.linear, job.offset);
  job.steps_a_edge = static_cast<float>(1.0 / (small ? kRecord8Distance : kRecord16Distance));
  job.normal_scale = static_cast<float>(small ? kRecord8Normal : kRecord16Normal);
  job.look_ahead = static_cast<float>(look_ahead);
  // Distance changes by no more than the way: half a cell's diagonal, and a hundredth for rounding of stored values.
  job.slack = static_cast<float>(0.5 * diagonal / bone.bone_from_index.mean_edge() + 0.02);
  const float nearest_before = hits.nearest;
  hits.nearest = static_cast<float>(kRecordBand);
  HWY_DYNAMIC_DISPATCH(Probe)(job, points, hits);
  hits.nearest = std::min(nearest_before, hits.nearest - job.slack);
}

std::optional<SurfaceSample> sample_records(const RecordView& bone, const Vec3& index) noexcept {
  if (!is_finite(index) || glm::any(glm::lessThan(index, Vec3(bone.valid.lo))) ||
      glm::any(glm::greaterThanEqual(index, Vec3(bone.valid.hi - 1))))
    return std::nullopt;
  const Vec3i base = floor_int(index);
  const Vec3 f = index - Vec3(base);
  SurfaceSample out{0.0, Vec3(0.0)};
  for_each_voxel({base, base + 2}, [&](const Vec3i& v) {
    const Vec3i d = v - base;
    const double weight = (d.x != 0 ? f.x : 1.0 - f.x) * (d.y != 0 ? f.y : 1.0 - f.y) * (d.z != 0 ? f.z : 1.0 - f.z);
    const std::size_t at = bone.box.offset_of(v);
    const SurfaceSample one = bone.records8 != nullptr ? decode(bone.records8[at]) : decode(bone.records16[at]);
    out.distance += weight * one.distance;
    out.normal += weight * one.normal;
  });
  const double length = glm::length(out.normal);
  out.normal = length > 0.0 ? out.normal / length : Vec3(0.0);
  return out;
}

ProbeWorst find_worst(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion) noexcept {
  float linear[9], offset[3];
  copy_matrix(motion.linear, motion.offset, linear, offset);
  return HWY_DYNAMIC_DISPATCH(Worst)(hits, first, last, linear, offset);
}

}  // namespace burrhole
#endif
