// Records from each voxel and its nearest surfel (steps 3 and 4 of surface_records.cpp), as words. Same bits at every level
// (surface_vectors-inl.h says how).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/record_words.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/base/trilinear.h"
#include "core/voxel/surface_tile.h"
#include "core/voxel/surface_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

/// Packed positions of the voxels that have a surfel within the band.
void list_near(const SurfaceMap& map, SurfaceTile& tile) {
  const DI di;
  const hn::RebindToUnsigned<DI> du;
  const int lanes = static_cast<int>(hn::Lanes(di));
  const auto far = hn::Set(du, map.far_key());
  const I lane = hn::Iota(di, 0);  // made once: it goes through memory
  const Vec3i lo = tile.records.lo - tile.padded.lo, hi = tile.records.hi - tile.padded.lo;
  std::size_t near = 0;
  for (int k = lo.z; k < hi.z; ++k)
    for (int j = lo.y; j < hi.y; ++j)
      for (int i = lo.x; i < hi.x; i += lanes) {
        const auto best = hn::LoadU(du, tile.nearest.data() + i + j * tile.row + k * tile.slab);
        const auto in = hn::And(hn::Lt(best, far), hn::FirstN(du, static_cast<std::size_t>(hi.x - i)));
        if (hn::AllFalse(du, in)) continue;
        near +=
            hn::CompressStore(hn::Add(lane, hn::Set(di, pack_position(i, j, k))), hn::RebindMask(di, in), di, tile.voxels.data() + near);
      }
  tile.near = near;
  if (near > 0) std::fill_n(tile.voxels.data() + near, kMaxLanes, tile.voxels[near - 1]);
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

/// A block of records: the foot of each voxel on its surfel's plane, and the smoothed field there.
struct Feet {
  static constexpr std::size_t kMost = 64;
  HWY_ALIGN std::int32_t surfel[kMost];
  HWY_ALIGN std::int32_t at[kMost];              // cell of the field that the foot is in; before, that of the surfel
  HWY_ALIGN float x[kMost], y[kMost], z[kMost];  // within it
  HWY_ALIGN float gradient[4 * kMost];           // there, x y z and nothing side by side
  HWY_ALIGN float normal[3][kMost], foot[3][kMost], rest[3][kMost], height[kMost], along[kMost];
};

HWY_INLINE void store(const F3& v, float (&to)[3][Feet::kMost], std::size_t n) {
  const D d;
  hn::Store(v.x, d, to[0] + n), hn::Store(v.y, d, to[1] + n), hn::Store(v.z, d, to[2] + n);
}
HWY_INLINE F3 load(const float (&from)[3][Feet::kMost], std::size_t n) {
  const D d;
  return {hn::Load(d, from[0] + n), hn::Load(d, from[1] + n), hn::Load(d, from[2] + n)};
}

/// Where to read the smoothed field for a point given from its cell: not further than one cell away.
HWY_INLINE void place_foot(const SurfaceTile& tile, I cell, const F3& p, Feet& feet, std::size_t n) {
  const D d;
  const DI di;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), back = hn::Set(d, -1.0f);
  const F3 base{hn::Clamp(hn::Floor(p.x), back, one), hn::Clamp(hn::Floor(p.y), back, one), hn::Clamp(hn::Floor(p.z), back, one)};
  const F3 within = sub(p, base);
  hn::Store(hn::Clamp(within.x, zero, one), d, feet.x + n);
  hn::Store(hn::Clamp(within.y, zero, one), d, feet.y + n);
  hn::Store(hn::Clamp(within.z, zero, one), d, feet.z + n);
  const I shift = offset(tile, {hn::ConvertTo(di, base.x), hn::ConvertTo(di, base.y), hn::ConvertTo(di, base.z)});
  hn::Store(hn::Add(cell, shift), di, feet.at + n);
}

#if HWY_TARGET == HWY_SCALAR

void read_gradients(const SurfaceTile& tile, std::size_t count, Feet& feet) {
  const float* const samples = &tile.samples.data()->gx;
  const int row = 4 * tile.row, slab = 4 * tile.slab;
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t part = 0; part < 4; ++part) {
      const float* const at = samples + 4 * feet.at[n] + part;
      feet.gradient[4 * n + part] =
          burrhole::trilinear(Vec3f(feet.x[n], feet.y[n], feet.z[n]), [&](unsigned c) { return at[corner_offset(c, row, slab, 4)]; });
    }
}

#else

/// The field at each foot, x y z side by side, of as many feet as a vector has blocks: eight loads each, where gathers would take 24 for
/// one.
void read_gradients(const SurfaceTile& tile, std::size_t count, Feet& feet) {
  const D d;
  const float* const samples = &tile.samples.data()->gx;
  const int row = 4 * tile.row, slab = 4 * tile.slab;
  for (std::size_t n = 0; n < count; n += hn::Lanes(d) / 4) {
    const auto corner = [&](unsigned c) HWY_ATTR { return load_blocks<4, 1>(samples + corner_offset(c, row, slab, 4), feet.at + n); };
    const auto part = [&](const float* of)
                          HWY_ATTR { return by_block([&](std::size_t block) HWY_ATTR { return hn::Set(d, of[n + block]); }); };
    const F x = part(feet.x), y = part(feet.y), z = part(feet.z);
    hn::Store(trilinear(x, y, z, corner), d, feet.gradient + 4 * n);
  }
}

#endif

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

/// Places within their cells, and normals.
struct SurfelPart {
  F3 place, normal;
};
HWY_INLINE SurfelPart read_surfels(const Surfel* surfels, const std::int32_t* which) {
  const F4 place = read_fours<8>(&surfels->x, which), normal = read_fours<8>(&surfels->nx, which);
  return {{place.x, place.y, place.z}, {normal.x, normal.y, normal.z}};
}

/// Surfels of the voxels listed from `start`, and their cells: in the tile, and as seen from the voxel (in `rest`, for now).
HWY_INLINE void find_surfels(const SurfaceMap& map, const SurfaceTile& tile, std::size_t start, std::size_t count, Feet& feet) {
  const D d;
  const DI di;
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const I3 voxel = unpack(hn::LoadU(di, tile.voxels.data() + start + n));
    const I key = hn::BitCast(di, hn::GatherIndex(hn::RebindToUnsigned<DI>(), tile.nearest.data(), offset(tile, voxel)));
    const I3 cell = cell_of(map, voxel, key);
    const I at = offset(tile, cell);
    hn::Store(at, di, feet.at + n);
    hn::Store(hn::GatherIndex(di, tile.surfel_at.data(), at), di, feet.surfel + n);
    store({hn::ConvertTo(d, hn::Sub(voxel.x, cell.x)), hn::ConvertTo(d, hn::Sub(voxel.y, cell.y)),
           hn::ConvertTo(d, hn::Sub(voxel.z, cell.z))},
          feet.rest, n);
  }
}

/// Feet of those voxels.
HWY_INLINE void find_feet(const SurfaceMap& map, const SurfaceTile& tile, std::size_t count, Feet& feet) {
  const D d;
  const F one = hn::Set(d, 1.0f), patch = hn::Set(d, map.patch_radius);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const SurfelPart surfel = read_surfels(tile.surfels.data(), feet.surfel + n);
    const F3 &s = surfel.place, &ns = surfel.normal;
    const F3 r = times(map.metric_from_index, sub(load(feet.rest, n), s));
    const F height = dot(ns, r);
    const F3 t = sub(r, scale(height, ns));
    const F along = hn::Sqrt(dot(t, t));
    const F kept = hn::IfThenElse(hn::Gt(along, patch), hn::Div(patch, along), one);
    const F3 foot = scale(kept, t);
    store(ns, feet.normal, n), store(foot, feet.foot, n), store(sub(t, foot), feet.rest, n);
    hn::Store(height, d, feet.height + n), hn::Store(along, d, feet.along + n);
    place_foot(tile, hn::Load(DI(), feet.at + n), add(s, times(map.index_from_metric, foot)), feet, n);
  }
}

/// Distance in steps, and the unit normal, of the next vector of feet.
struct Found {
  F steps;  // not yet rounded
  F3 normal;
};
// Cosine of 20 degrees, by which a surface turns within a patch where its radius is three voxels. More is an edge, across which smoothing
// mixes two faces: there the distance is that to the surfel's plane. Beyond the patch, nc is the direction round the edge.
constexpr float kSameBend = 0.94f;

HWY_INLINE Found measure(const SurfaceMap& map, const Feet& feet, std::size_t n, hn::Mask<D> bone, F per_edge) {
  const D d;
  const F zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const F3 ns = load(feet.normal, n), foot = load(feet.foot, n), rest = load(feet.rest, n);
  const F height = hn::Load(d, feet.height + n);
  F3 g;
  F unused;
  hn::LoadInterleaved4(d, feet.gradient + 4 * n, g.x, g.y, g.z, unused);
  const F3 smooth = unit(outward(map, g));
  const F turn = dot(smooth, ns);
  const F3 nc = choose(hn::Gt(turn, zero), smooth, ns);
  const auto beyond = hn::Gt(hn::Load(d, feet.along + n), hn::Set(d, map.patch_radius));
  const F3 near = choose(hn::Or(beyond, hn::Gt(turn, hn::Set(d, kSameBend))), nc, ns);
  const F side = hn::IfThenElse(bone, hn::Set(d, -1.0f), hn::Set(d, 1.0f));
  const F3 q = add(foot, scale(height, ns));
  const F across = hn::Max(zero, hn::Mul(side, hn::Mul(half, hn::Add(dot(ns, q), dot(near, q)))));
  const F distance = hn::Min(hn::Set(d, static_cast<float>(kRecordBand)), hn::Sqrt(hn::Add(hn::Mul(across, across), dot(rest, rest))));
  return {hn::Mul(hn::Mul(side, distance), per_edge), choose(beyond, unit(add(scale(across, nc), scale(side, rest))), nc)};
}

void MakeRecords(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) {
  const D d;
  const DI di;
  const hn::RebindToUnsigned<DI> du;
  const bool wide = precision == RecordPrecision::bits16;
  const F per_edge = hn::Set(d, static_cast<float>(1.0 / (wide ? kRecord16Distance : kRecord8Distance)));
  const F per_one = hn::Set(d, wide ? 32767.0f : 127.0f);
  list_near(map, tile);
  Feet feet;
  for (std::size_t start = 0; start < tile.near; start += Feet::kMost) {
    const std::size_t count = std::min(Feet::kMost, tile.near - start);
    find_surfels(map, tile, start, count, feet);
    find_feet(map, tile, count, feet);
    read_gradients(tile, count, feet);
    for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
      const I here = offset(tile, unpack(hn::LoadU(di, tile.voxels.data() + start + n)));
      const auto bone = hn::Ge(hn::GatherIndex(d, tile.density.data(), here), hn::Set(d, 0.5f));
      const Found found = measure(map, feet, n, bone, per_edge);
      const I steps = rounded(found.steps), x = rounded(hn::Mul(found.normal.x, per_one)), y = rounded(hn::Mul(found.normal.y, per_one)),
              z = rounded(hn::Mul(found.normal.z, per_one));
      hn::StoreU(hn::BitCast(du, wide ? pack16(steps, x) : pack8(steps, x, y, z)), du, tile.low.data() + start + n);
      if (wide) hn::StoreU(hn::BitCast(du, pack16(y, z)), du, tile.high.data() + start + n);
    }
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
HWY_EXPORT(MakeRecords);
HWY_EXPORT(FillFar8);
HWY_EXPORT(FillFar16);

void make_records(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) noexcept {
  HWY_DYNAMIC_DISPATCH(MakeRecords)(map, precision, tile);
}
void fill_far(const float* density, std::size_t length, Record8* out) noexcept {
  if (length >= kMaxLanes) return HWY_DYNAMIC_DISPATCH(FillFar8)(density, length, out);
  for (std::size_t i = 0; i < length; ++i) out[i] = {static_cast<std::int8_t>(density[i] >= 0.5f ? -112 : 112), 0, 0, 0};
}
void fill_far(const float* density, std::size_t length, Record16* out) noexcept {
  if (length >= kMaxLanes) return HWY_DYNAMIC_DISPATCH(FillFar16)(density, length, out);
  for (std::size_t i = 0; i < length; ++i) out[i] = {static_cast<std::int16_t>(density[i] >= 0.5f ? -14336 : 14336), 0, 0, 0};
}

}  // namespace burrhole
#endif
