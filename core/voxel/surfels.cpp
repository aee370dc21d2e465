// Surfels, the nearest of each voxel, and records. Every lane is computed for itself in one order of operations without fused
// multiply-add: same bits at every level. Gathers are used throughout; the plain twin, which sanitizers see through, is in
// tests/core/voxel/surface_twin.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/surfels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "core/voxel/surface_records.h"
#include "core/voxel/surface_tile.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using D = hn::CappedTag<float, kMostLanes>;
using DI = hn::RebindToSigned<D>;
using F = hn::Vec<D>;
using I = hn::Vec<DI>;

/// Three vectors as one; plain operators, so that formulas read as formulas.
struct F3 {
  F x, y, z;
};
HWY_INLINE F3 add(const F3& a, const F3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE F3 sub(const F3& a, const F3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE F3 scale(F s, const F3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE F dot(const F3& a, const F3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
template <class M>
HWY_INLINE F3 choose(M mask, const F3& yes, const F3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
/// Length 1, or zero where there is no direction.
HWY_INLINE F3 unit(const F3& a) {
  const D d;
  const F length2 = dot(a, a);
  const F inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2));
  return scale(hn::IfThenElseZero(hn::Gt(length2, hn::Set(d, 1e-12f)), inverse), a);
}

/// Rows of a matrix times a vector, or columns (the transpose).
using Matrix = std::array<std::array<float, 3>, 3>;
HWY_INLINE F sum3(float a, F x, float b, F y, float c, F z) {
  const D d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, a), x), hn::Mul(hn::Set(d, b), y)), hn::Mul(hn::Set(d, c), z));
}
HWY_INLINE F3 times(const Matrix& m, const F3& v) {
  return {sum3(m[0][0], v.x, m[0][1], v.y, m[0][2], v.z), sum3(m[1][0], v.x, m[1][1], v.y, m[1][2], v.z),
          sum3(m[2][0], v.x, m[2][1], v.y, m[2][2], v.z)};
}
HWY_INLINE F3 times_transpose(const Matrix& m, const F3& v) {
  return {sum3(m[0][0], v.x, m[1][0], v.y, m[2][0], v.z), sum3(m[0][1], v.x, m[1][1], v.y, m[2][1], v.z),
          sum3(m[0][2], v.x, m[1][2], v.y, m[2][2], v.z)};
}

HWY_INLINE F lerp(F a, F b, F t) { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); }

/// Values at the corners of a cell, x fastest.
struct Corners {
  F v[8];
};
HWY_INLINE Corners gather(const float* field, I cell, int row, int slab) {
  const D d;
  return {{hn::GatherIndex(d, field, cell), hn::GatherIndex(d, field + 1, cell), hn::GatherIndex(d, field + row, cell),
           hn::GatherIndex(d, field + row + 1, cell), hn::GatherIndex(d, field + slab, cell), hn::GatherIndex(d, field + slab + 1, cell),
           hn::GatherIndex(d, field + slab + row, cell), hn::GatherIndex(d, field + slab + row + 1, cell)}};
}
HWY_INLINE F interpolate(const Corners& c, const F3& p) {
  const F low = lerp(lerp(c.v[0], c.v[1], p.x), lerp(c.v[2], c.v[3], p.x), p.y);
  const F high = lerp(lerp(c.v[4], c.v[5], p.x), lerp(c.v[6], c.v[7], p.x), p.y);
  return lerp(low, high, p.z);
}
/// Gradient of the trilinear field itself.
HWY_INLINE F3 slope(const Corners& c, const F3& p) {
  const F x00 = lerp(c.v[0], c.v[1], p.x), x10 = lerp(c.v[2], c.v[3], p.x), x01 = lerp(c.v[4], c.v[5], p.x),
          x11 = lerp(c.v[6], c.v[7], p.x);
  const F along0 = lerp(hn::Sub(c.v[1], c.v[0]), hn::Sub(c.v[3], c.v[2]), p.y);
  const F along1 = lerp(hn::Sub(c.v[5], c.v[4]), hn::Sub(c.v[7], c.v[6]), p.y);
  return {lerp(along0, along1, p.z), lerp(hn::Sub(x10, x00), hn::Sub(x11, x01), p.z), hn::Sub(lerp(x01, x11, p.y), lerp(x00, x10, p.y))};
}

/// Outward normal, metric axes, from a gradient in index axes: a covector, so by the inverse's transpose.
HWY_INLINE F3 outward(const SurfaceMap& map, const F3& gradient) {
  const D d;
  return scale(hn::Set(d, -1.0f), times_transpose(map.index_from_metric, gradient));
}

/// Mean of the points where the edges of the cell pass 0.5.
HWY_INLINE F3 mean_crossing(const Corners& c) {
  const D d;
  const F level = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f);
  F count = hn::Zero(d);
  F sum[3] = {count, count, count};
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < 8; ++a) {
      if ((a >> axis) & 1) continue;
      const F from = c.v[a], to = c.v[a | (1 << axis)];
      const auto crosses = hn::Xor(hn::Ge(from, level), hn::Ge(to, level));
      const F here = hn::IfThenElseZero(crosses, one);
      count = hn::Add(count, here);
      sum[axis] = hn::Add(sum[axis], hn::IfThenElseZero(crosses, hn::Div(hn::Sub(level, from), hn::Sub(to, from))));
      for (int other = 0; other < 3; ++other)
        if (other != axis && ((a >> other) & 1)) sum[other] = hn::Add(sum[other], here);
    }
  return {hn::Div(sum[0], count), hn::Div(sum[1], count), hn::Div(sum[2], count)};
}

struct Cell {
  Corners density, gx, gy, gz;
};

/// Normal of the smoothed field; where it contradicts the density in the cell (detail finer than the smoothing), that of the density.
HWY_INLINE F3 normal_at(const SurfaceMap& map, const Cell& cell, const F3& p) {
  const D d;
  const F3 smooth = outward(map, {interpolate(cell.gx, p), interpolate(cell.gy, p), interpolate(cell.gz, p)});
  const F3 sharp = outward(map, slope(cell.density, p));
  return unit(choose(hn::Gt(dot(smooth, sharp), hn::Zero(d)), smooth, sharp));
}

/// Moves p along the normal to where the trilinear density is 0.5, at most to the walls of its cell.
HWY_INLINE F3 project(const SurfaceMap& map, const Corners& density, const F3& normal, F3 p) {
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F3 along = times(map.index_from_metric, normal);
  for (int step = 0; step < 3; ++step) {
    const F off = hn::Sub(hn::Set(d, 0.5f), interpolate(density, p));
    const F rate = dot(slope(density, p), along);
    // Where the density hardly changes along the normal a step would only leave the cell: the mean of the crossings stays.
    const F t = hn::IfThenElseZero(hn::Gt(hn::Abs(rate), hn::Set(d, 1e-3f)), hn::Div(off, rate));
    p = add(p, scale(hn::Clamp(t, hn::Set(d, -1.0f), one), along));
    p = {hn::Clamp(p.x, zero, one), hn::Clamp(p.y, zero, one), hn::Clamp(p.z, zero, one)};
  }
  return p;
}

/// How far the normals at the cell's corners turn from that at its surfel (the sine, at most 1), as a rate.
HWY_INLINE F bend_of(const SurfaceMap& map, const Cell& cell, const F3& normal) {
  const D d;
  F least = hn::Set(d, 1.0f);
  for (int n = 0; n < 8; ++n) least = hn::Min(least, dot(normal, unit(outward(map, {cell.gx.v[n], cell.gy.v[n], cell.gz.v[n]}))));
  least = hn::Max(least, hn::Zero(d));
  return hn::Sqrt(hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1.0f), hn::Mul(least, least))));
}

void MakeSurfels(const SurfaceMap& map, SurfaceTile& tile) {
  const D d;
  const DI di;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN float x[kMostLanes], y[kMostLanes], z[kMostLanes], nx[kMostLanes], ny[kMostLanes], nz[kMostLanes], bend[kMostLanes];
  for (const SurfelRow& row : tile.rows)
    for (std::size_t n = row.first; n < row.last; ++n)
      tile.surfels[n].cell = pack_position(tile.cell_offsets[n] - row.j * tile.row - row.k * tile.slab, row.j, row.k);
  for (std::size_t n = 0; n < tile.found; n += lanes) {
    const I at = hn::LoadU(di, tile.cell_offsets.data() + n);
    const auto corners = [&](const std::vector<float>& field) { return gather(field.data(), at, tile.row, tile.slab); };
    const Cell cell{corners(tile.density), corners(tile.gx), corners(tile.gy), corners(tile.gz)};
    F3 p = mean_crossing(cell.density);
    p = project(map, cell.density, normal_at(map, cell, p), p);
    const F3 normal = normal_at(map, cell, p);
    hn::Store(p.x, d, x), hn::Store(p.y, d, y), hn::Store(p.z, d, z);
    hn::Store(normal.x, d, nx), hn::Store(normal.y, d, ny), hn::Store(normal.z, d, nz);
    hn::Store(bend_of(map, cell, normal), d, bend);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      Surfel& s = tile.surfels[n + lane];
      s = {x[lane], y[lane], z[lane], s.cell, nx[lane], ny[lane], nz[lane], bend[lane]};
    }
  }
}

constexpr float kBand2 = static_cast<float>(kRecordBand * kRecordBand);
using Metric = std::array<float, 3>;

float dot(const Metric& a, const Metric& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Bits of the code of a cell's place; the rest of a key is the squared distance, whose bits as a float are in its order.
std::uint32_t code_mask(const SurfaceMap& map) { return (1u << (3 * map.code_bits)) - 1u; }
std::uint32_t far_key(const SurfaceMap& map) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &kBand2, sizeof bits);
  return bits & ~code_mask(map);
}

/// Rows of voxels, up to 64 at once: squared distances from one surfel along each, a + i (b + i c), i counted from its cell.
struct Rows {
  HWY_ALIGN float a[64], b[64];
  HWY_ALIGN std::int32_t code[64], at[64];  // of a row's voxel i = 0: the cell's place as seen from it, and its offset from the cell
  std::uint64_t wanted = 0;                 // bits of those that it may be nearest in
};

/// One surfel, and which rows it is offered to: those along its normal, as wide as surfels are apart, widening as the normals spread.
struct Offer {
  Offer(const SurfaceMap& to, const Surfel& of) : map(to), s(of) {
    const auto& m = map.metric_from_index;
    step = {m[0][0], m[1][0], m[2][0]};
    normal = {s.nx, s.ny, s.nz};
    c = dot(step, step);
    step_up = dot(step, normal);
    const float c_across = c - step_up * step_up;
    const bool steep = c_across > 1e-3f * c;  // else rows run along the normal
    per_c_across = steep ? 1.0f / c_across : 0.0f;
    least_height = steep ? 0.0f : static_cast<float>(kRecordBand);
  }

  /// Rows further than this from the surfel along an axis hold no voxel that is both within the band and near its normal's line.
  [[nodiscard]] float extent(std::size_t axis) const {
    const Metric& across = map.index_from_metric[axis];
    const float band = static_cast<float>(kRecordBand);
    return band * std::abs(dot(across, normal)) + (map.fan + s.bend * band) * std::sqrt(dot(across, across));
  }

  /// The next 64 rows from (j, k), as `width_bits` says 4 or 8 rows a slab, as far as `last`; places from the cell.
  HWY_INLINE void look(const SurfaceTile& tile, int j, int k, int width_bits, const Vec3i& last, Rows& rows) const {
    const D d;
    const DI di;
    rows.wanted = 0;
    for (int n = 0; n < 64 && k + (n >> width_bits) <= last.z; n += static_cast<int>(hn::Lanes(d))) {
      const I number = hn::Iota(di, n);
      const I row = hn::Add(hn::And(number, hn::Set(di, (1 << width_bits) - 1)), hn::Set(di, j));
      const I slab = hn::Add(hn::ShiftRightSame(number, width_bits), hn::Set(di, k));
      const auto known = hn::And(hn::Lt(row, hn::Set(di, last.y + 1)), hn::Lt(slab, hn::Set(di, last.z + 1)));
      const F wanted_y = hn::Sub(hn::ConvertTo(d, row), hn::Set(d, s.y)), wanted_z = hn::Sub(hn::ConvertTo(d, slab), hn::Set(d, s.z));
      F a, b;
      const auto wanted = hn::And(hn::RebindMask(d, known), near(wanted_y, wanted_z, a, b));
      hn::Store(a, d, rows.a + n);
      hn::Store(hn::Add(b, b), d, rows.b + n);
      const I code_y = hn::ShiftLeftSame(hn::Add(row, hn::Set(di, map.spread.y)), map.code_bits);
      const I code_z = hn::ShiftLeftSame(hn::Add(slab, hn::Set(di, map.spread.z)), 2 * map.code_bits);
      hn::Store(hn::Add(hn::Add(code_y, code_z), hn::Set(di, map.spread.x)), di, rows.code + n);
      hn::Store(hn::Add(hn::Mul(row, hn::Set(di, tile.row)), hn::Mul(slab, hn::Set(di, tile.slab))), di, rows.at + n);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, wanted, bits);
      rows.wanted |= static_cast<std::uint64_t>(bits[0] | (bits[1] << 8)) << n;
    }
  }

  const SurfaceMap& map;
  const Surfel& s;
  Metric step, normal;
  float c, step_up, per_c_across, least_height;

 private:
  /// Which rows, given from the surfel in index steps, come near enough to it and to its normal's line.
  HWY_INLINE hn::Mask<D> near(F y, F z, F& a, F& b) const {
    const D d;
    const auto& m = map.metric_from_index;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const auto start = [&](std::size_t r) {
      return hn::Sub(hn::Add(hn::Mul(set(m[r][1]), y), hn::Mul(set(m[r][2]), z)), set(step[r] * s.x));
    };
    const F3 from{start(0), start(1), start(2)};
    const auto along = [&](const Metric& v) { return sum3(v[0], from.x, v[1], from.y, v[2], from.z); };
    a = HWY_NAMESPACE::dot(from, from);
    b = along(step);
    const F up = along(normal);
    const F a_across = hn::Sub(a, hn::Mul(up, up)), b_across = hn::Sub(b, hn::Mul(up, set(step_up)));
    const F back = hn::Mul(b_across, set(per_c_across));  // to where the row is nearest to the normal's line
    const F beside2 = hn::Sub(a_across, hn::Mul(b_across, back));
    const F height = hn::Max(hn::Abs(hn::Sub(up, hn::Mul(set(step_up), back))), set(least_height));
    const F width = hn::Add(set(map.fan), hn::Mul(set(s.bend), hn::Min(height, set(static_cast<float>(kRecordBand)))));
    const auto in_band = hn::Lt(hn::Sub(hn::Mul(a, set(c)), hn::Mul(b, b)), set(kBand2 * c));
    return hn::And(in_band, hn::Le(beside2, hn::Mul(width, width)));
  }
};

/// Offers one surfel to the voxels of those rows.
void offer(const SurfaceMap& map, const Surfel& s, SurfaceTile& tile) {
  const hn::CappedTag<float, 8> d;  // what one surfel reaches of a row, unless voxels are uneven
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec3i cell = unpack_position(s.cell);
  const Offer one(map, s);
  const float wide = one.extent(1), high = one.extent(2);
  const Vec3i near_lo(-map.spread.x, std::max(-map.spread.y, floor_int(s.y - wide) + 1),
                      std::max(-map.spread.z, floor_int(s.z - high) + 1));
  const Vec3i near_hi(map.spread.x + 1, std::min(map.spread.y + 1, floor_int(s.y + wide)),
                      std::min(map.spread.z + 1, floor_int(s.z + high)));
  const Vec3i first = glm::max(near_lo, tile.records.lo - tile.padded.lo - cell);
  const Vec3i last = glm::min(near_hi, tile.records.hi - tile.padded.lo - 1 - cell);
  const auto distance_bits = hn::Set(du, ~code_mask(map));
  std::uint32_t* const at_cell = tile.nearest.data() + cell.x + cell.y * tile.row + cell.z * tile.slab;
  const auto c = hn::Set(d, one.c);
  const int width_bits = last.y - first.y < 4 ? 2 : 3;
  Rows rows;
  for (int k0 = first.z; k0 <= last.z; k0 += 64 >> width_bits)
    for (int j0 = first.y; j0 <= last.y; j0 += 1 << width_bits) {
      one.look(tile, j0, k0, width_bits, last, rows);
      for (int i = first.x; i <= last.x; i += lanes) {
        const auto along = hn::Iota(di, i);
        const auto t = hn::ConvertTo(d, along), tc = hn::Mul(t, c);
        for (std::uint64_t left = rows.wanted; left != 0; left &= left - 1) {
          const int n = std::countr_zero(left);
          const auto a = hn::Set(d, rows.a[n]), b = hn::Set(d, rows.b[n]);
          const auto distance2 = hn::Max(hn::Zero(d), hn::Add(a, hn::Mul(t, hn::Add(b, tc))));
          const auto code = hn::BitCast(du, hn::Add(along, hn::Set(di, rows.code[n])));
          const auto key = hn::Or(hn::And(hn::BitCast(du, distance2), distance_bits), code);
          std::uint32_t* const row = at_cell + rows.at[n] + i;
          hn::StoreU(hn::Min(key, hn::LoadU(du, row)), du, row);
        }
      }
    }
}

void FindNearest(const SurfaceMap& map, SurfaceTile& tile) {
  const auto length = static_cast<std::size_t>(tile.records.size().x);
  for (int k = tile.records.lo.z; k < tile.records.hi.z; ++k)
    for (int j = tile.records.lo.y; j < tile.records.hi.y; ++j)
      std::fill_n(tile.nearest.data() + tile.offset_of({tile.records.lo.x, j, k}), length, far_key(map));
  for (std::size_t n = 0; n < tile.found; ++n) offer(map, tile.surfels[n], tile);
}

/// Packed positions of the voxels that have a surfel within the band.
void list_near(const SurfaceMap& map, SurfaceTile& tile) {
  const DI di;
  const hn::RebindToUnsigned<DI> du;
  const int lanes = static_cast<int>(hn::Lanes(di));
  const auto far = hn::Set(du, far_key(map));
  const Vec3i lo = tile.records.lo - tile.padded.lo, hi = tile.records.hi - tile.padded.lo;
  std::size_t near = 0;
  for (int k = lo.z; k < hi.z; ++k)
    for (int j = lo.y; j < hi.y; ++j)
      for (int i = lo.x; i < hi.x; i += lanes) {
        const auto best = hn::LoadU(du, tile.nearest.data() + i + j * tile.row + k * tile.slab);
        const auto in = hn::And(hn::Lt(best, far), hn::FirstN(du, static_cast<std::size_t>(hi.x - i)));
        if (hn::AllFalse(du, in)) continue;
        near += hn::CompressStore(hn::Iota(di, pack_position(i, j, k)), hn::RebindMask(di, in), di, tile.voxels.data() + near);
      }
  tile.near = near;
  if (near > 0) std::fill_n(tile.voxels.data() + near, kMostLanes, tile.voxels[near - 1]);
}

struct I3 {
  I x, y, z;
};
HWY_INLINE I3 unpack(I packed) {
  const DI di;
  const I ten = hn::Set(di, 1023);
  return {hn::And(packed, ten), hn::And(hn::ShiftRight<10>(packed), ten), hn::ShiftRight<20>(packed)};
}
HWY_INLINE I offset(const SurfaceTile& tile, const I3& v) {
  const DI di;
  return hn::Add(hn::Add(v.x, hn::Mul(v.y, hn::Set(di, tile.row))), hn::Mul(v.z, hn::Set(di, tile.slab)));
}

/// Normal of the smoothed field at a point given from its cell, not further than one cell away.
HWY_INLINE F3 normal_near(const SurfaceMap& map, const SurfaceTile& tile, I cell, const F3& p, const F3& otherwise) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), back = hn::Set(d, -1.0f);
  const F3 base{hn::Clamp(hn::Floor(p.x), back, one), hn::Clamp(hn::Floor(p.y), back, one), hn::Clamp(hn::Floor(p.z), back, one)};
  F3 within = sub(p, base);
  within = {hn::Clamp(within.x, zero, one), hn::Clamp(within.y, zero, one), hn::Clamp(within.z, zero, one)};
  const I at = hn::Add(cell, offset(tile, {hn::ConvertTo(di, base.x), hn::ConvertTo(di, base.y), hn::ConvertTo(di, base.z)}));
  const auto value = [&](const std::vector<float>& field) { return interpolate(gather(field.data(), at, tile.row, tile.slab), within); };
  const F3 normal = unit(outward(map, {value(tile.gx), value(tile.gy), value(tile.gz)}));
  return choose(hn::Gt(dot(normal, otherwise), zero), normal, otherwise);
}

HWY_INLINE I rounded(F v) {
  const D d;
  return hn::ConvertTo(DI(), hn::Floor(hn::Add(v, hn::Set(d, 0.5f))));
}

/// Low bits of four whole numbers side by side in words.
HWY_INLINE I pack16(I low, I high) {
  const DI di;
  return hn::Or(hn::And(low, hn::Set(di, 0xffff)), hn::ShiftLeft<16>(high));
}
HWY_INLINE I pack8(I a, I b, I c, I e) {
  const DI di;
  const I byte = hn::Set(di, 0xff);
  return pack16(hn::Or(hn::And(a, byte), hn::ShiftLeft<8>(hn::And(b, byte))), hn::Or(hn::And(c, byte), hn::ShiftLeft<8>(hn::And(e, byte))));
}

/// The cell that a voxel's key names.
HWY_INLINE I3 cell_of(const SurfaceMap& map, const I3& voxel, I key) {
  const DI di;
  const I part = hn::Set(di, (1 << map.code_bits) - 1);
  const auto back = [&](int axis, int spread) {
    return hn::Sub(hn::And(hn::ShiftRightSame(key, axis * map.code_bits), part), hn::Set(di, spread));
  };
  return {hn::Sub(voxel.x, back(0, map.spread.x)), hn::Sub(voxel.y, back(1, map.spread.y)), hn::Sub(voxel.z, back(2, map.spread.z))};
}

void MakeRecords(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) {
  const D d;
  const DI di;
  const hn::RebindToUnsigned<DI> du;
  const bool wide = precision == RecordPrecision::bits16;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), fan = hn::Set(d, map.fan);
  const F per_edge = hn::Set(d, static_cast<float>(1.0 / (wide ? kRecord16Distance : kRecord8Distance)));
  const F per_one = hn::Set(d, wide ? 32767.0f : 127.0f);
  list_near(map, tile);
  for (std::size_t n = 0; n < tile.near; n += hn::Lanes(d)) {
    const I3 voxel = unpack(hn::LoadU(di, tile.voxels.data() + n));
    const I here = offset(tile, voxel);
    const I key = hn::BitCast(di, hn::GatherIndex(du, tile.nearest.data(), here));
    const I3 cell = cell_of(map, voxel, key);
    const I surfel = hn::ShiftLeft<3>(hn::GatherIndex(di, tile.surfel_at.data(), offset(tile, cell)));
    const float* const all = &tile.surfels.data()->x;
    const auto part = [&](int which) { return hn::GatherIndex(d, all + which, surfel); };
    const F3 s{part(0), part(1), part(2)}, ns{part(4), part(5), part(6)};

    const F3 off{hn::ConvertTo(d, hn::Sub(voxel.x, cell.x)), hn::ConvertTo(d, hn::Sub(voxel.y, cell.y)),
                 hn::ConvertTo(d, hn::Sub(voxel.z, cell.z))};
    const F3 r = times(map.metric_from_index, sub(off, s));
    const F height = dot(ns, r);
    const F3 t = sub(r, scale(height, ns));
    const F along = hn::Sqrt(dot(t, t));
    const auto beyond = hn::Gt(along, fan);
    const F kept = hn::IfThenElse(beyond, hn::Div(fan, along), one);
    const F3 foot = scale(kept, t), rest = sub(t, foot);
    const F3 nc = normal_near(map, tile, offset(tile, cell), add(s, times(map.index_from_metric, foot)), ns);

    const auto bone = hn::Ge(hn::GatherIndex(d, tile.density.data(), here), half);
    const F side = hn::IfThenElse(bone, hn::Set(d, -1.0f), one);
    const F3 q = add(foot, scale(height, ns));
    const F across = hn::Max(zero, hn::Mul(side, hn::Mul(half, hn::Add(dot(ns, q), dot(nc, q)))));
    const F distance = hn::Min(hn::Set(d, static_cast<float>(kRecordBand)), hn::Sqrt(hn::Add(hn::Mul(across, across), dot(rest, rest))));
    const F3 normal = choose(beyond, unit(add(scale(across, nc), scale(side, rest))), nc);

    const I steps = rounded(hn::Mul(hn::Mul(side, distance), per_edge));
    const I x = rounded(hn::Mul(normal.x, per_one)), y = rounded(hn::Mul(normal.y, per_one)), z = rounded(hn::Mul(normal.z, per_one));
    hn::StoreU(hn::BitCast(du, wide ? pack16(steps, x) : pack8(steps, x, y, z)), du, tile.low.data() + n);
    if (wide) hn::StoreU(hn::BitCast(du, pack16(y, z)), du, tile.high.data() + n);
  }
}

/// Words of "at least that far": the distance alone, normals zero.
constexpr std::uint32_t kOutside16 = 14336, kInside16 = 0x10000 - 14336, kOutside8 = 112, kInside8 = 0x100 - 112;
static_assert(kOutside16 * kRecord16Distance == kRecordBand && kOutside8 * kRecord8Distance == kRecordBand);

/// Whole vectors, then the last again from the row's end; rows shorter than a vector one by one.
template <class Store>
HWY_INLINE void for_row(std::size_t length, std::size_t lanes, Store&& store) {
  for (std::size_t i = 0; i + lanes <= length; i += lanes) store(i);
  if (length % lanes != 0) store(length - lanes);
}

void FillFar8(const float* density, std::size_t length, Record8* out) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  auto* const words = reinterpret_cast<std::uint32_t*>(out);
  for_row(length, hn::Lanes(d), [&](std::size_t i) {
    const auto bone = hn::RebindMask(du, hn::Ge(hn::LoadU(d, density + i), hn::Set(d, 0.5f)));
    hn::StoreU(hn::IfThenElse(bone, hn::Set(du, kInside8), hn::Set(du, kOutside8)), du, words + i);
  });
}

void FillFar16(const float* density, std::size_t length, Record16* out) {
  const hn::CappedTag<std::uint64_t, 8> dw;
  const hn::Rebind<float, decltype(dw)> d;
  const hn::Rebind<std::uint32_t, decltype(dw)> du;
  auto* const words = reinterpret_cast<std::uint64_t*>(out);
  for_row(length, hn::Lanes(dw), [&](std::size_t i) {
    const auto bone = hn::RebindMask(du, hn::Ge(hn::LoadU(d, density + i), hn::Set(d, 0.5f)));
    hn::StoreU(hn::PromoteTo(dw, hn::IfThenElse(bone, hn::Set(du, kInside16), hn::Set(du, kOutside16))), dw, words + i);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(MakeSurfels);
HWY_EXPORT(FindNearest);
HWY_EXPORT(MakeRecords);
HWY_EXPORT(FillFar8);
HWY_EXPORT(FillFar16);

void make_surfels(const SurfaceMap& map, SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(MakeSurfels)(map, tile); }
void find_nearest(const SurfaceMap& map, SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(FindNearest)(map, tile); }
void make_records(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) noexcept {
  HWY_DYNAMIC_DISPATCH(MakeRecords)(map, precision, tile);
}
void fill_far(const float* density, std::size_t length, Record8* out) noexcept {
  if (length >= kMostLanes) return HWY_DYNAMIC_DISPATCH(FillFar8)(density, length, out);
  for (std::size_t i = 0; i < length; ++i) out[i] = {static_cast<std::int8_t>(density[i] >= 0.5f ? -112 : 112), 0, 0, 0};
}
void fill_far(const float* density, std::size_t length, Record16* out) noexcept {
  if (length >= kMostLanes) return HWY_DYNAMIC_DISPATCH(FillFar16)(density, length, out);
  for (std::size_t i = 0; i < length; ++i) out[i] = {static_cast<std::int16_t>(density[i] >= 0.5f ? -14336 : 14336), 0, 0, 0};
}

}  // namespace burrhole
#endif
