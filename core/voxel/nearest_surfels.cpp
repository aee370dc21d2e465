// The nearest surfel of each voxel: surfels are offered to the rows of voxels that they may be nearest in. Same bits at every level
// (surface_vectors-inl.h says how).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/nearest_surfels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>

#include "core/voxel/surface_tile.h"
#include "core/voxel/surface_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

using Metric = std::array<float, 3>;
constexpr float kBand = static_cast<float>(kRecordBand);

float dot(const Metric& a, const Metric& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Rows are searched in blocks of 64, four or eight per slab. Offset of each row from the first of its block.
struct RowBlock {
  RowBlock(const SurfaceMap& map, const SurfaceTile& tile, int bits) : width_bits(bits) {
    for (int n = 0; n < 64; ++n) {
      const int j = n & ((1 << bits) - 1), k = n >> bits;
      y[n] = static_cast<float>(j);
      z[n] = static_cast<float>(k);
      code[n] = (j << map.code_bits) + (k << 2 * map.code_bits);
      at[n] = j * tile.row + k * tile.slab;
    }
  }
  /// Bits of the first `rows` rows of the first `slabs` slabs.
  [[nodiscard]] std::uint64_t known(int rows, int slabs) const {
    const int width = 1 << width_bits;
    const std::uint64_t each = width_bits == 2 ? 0x1111111111111111u : 0x0101010101010101u;
    const std::uint64_t all = slabs * width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (slabs * width)) - 1;
    return all & (each * ((1u << std::min(rows, width)) - 1u));
  }

  HWY_ALIGN float y[64], z[64];
  std::int32_t code[64], at[64];  // of the cell's place as seen from the row's voxels; in the tile
  int width_bits;
};

/// What all surfels of a tile have in common.
struct OfferPlan {
  OfferPlan(const SurfaceMap& to, const SurfaceTile& tile)
      : map(to),
        records{tile.records.lo - tile.padded.lo, tile.records.hi - tile.padded.lo},
        narrow(to, tile, 2),
        wide(to, tile, 3),
        step{to.metric_from_index[0][0], to.metric_from_index[1][0], to.metric_from_index[2][0]},
        c(dot(step, step)) {
    for (int n = 0; n < 8; ++n) lane[n] = n;
    for (const std::size_t axis : {0, 1, 2}) across[axis] = std::sqrt(dot(map.index_from_metric[axis], map.index_from_metric[axis]));
  }

  const SurfaceMap& map;
  VoxelBox records;  // from the tile's corner
  RowBlock narrow, wide;
  Metric step;  // along a row
  float c;      // its length squared
  Metric across;
  HWY_ALIGN std::int32_t lane[8];  // 0, 1, 2 and so on: made anew they go through memory
};

/// What a block of surfels is offered to: the rows along each one's normal, as wide as surfels are apart, widening as the normals spread;
/// rows first..last and slabs likewise, from its cell.
struct Offers {
  /// Those of surfels `start` and after it, a vector of them.
  HWY_INLINE Offers(const OfferPlan& plan, const Surfel* start) {
    const D d;
    const DI di;
    const I at = hn::ShiftLeft<3>(hn::Iota(di, 0));
    const auto part = [&](int which) { return hn::GatherIndex(d, &start->x + which, at); };
    const auto set = [&](float v) { return hn::Set(d, v); };
    const F3 normal{part(4), part(5), part(6)};
    const auto along = [&](const Metric& v) { return sum3(v[0], normal.x, v[1], normal.y, v[2], normal.z); };
    const F up = along(plan.step), c_across = hn::Sub(set(plan.c), hn::Mul(up, up));
    const auto steep = hn::Gt(c_across, set(1e-3f * plan.c));  // else rows run along the normal
    hn::Store(up, d, step_up);
    hn::Store(hn::IfThenElseZero(steep, hn::Div(set(1.0f), c_across)), d, per_c_across);
    hn::Store(hn::IfThenZeroElse(steep, set(kBand)), d, least_height);
    // Rows further than this from the surfel along an axis hold no voxel that is both within the band and near its normal's line.
    const F width = hn::Add(set(plan.map.patch_radius), hn::Mul(part(7), set(kBand)));
    const I cell = hn::GatherIndex(di, &start->cell, at), ten = hn::Set(di, 1023);
    const auto bound = [&](std::size_t axis, const F& centre, const I& from, std::int32_t* first, std::int32_t* last) {
      const F reach =
          hn::Add(hn::Mul(set(kBand), hn::Abs(along(plan.map.index_from_metric[axis]))), hn::Mul(width, set(plan.across[axis])));
      const auto whole = [&](const F& v) { return hn::ConvertTo(di, hn::Floor(v)); };
      const I lo = hn::Max(hn::Set(di, -plan.map.spread[axis]), hn::Add(whole(hn::Sub(centre, reach)), hn::Set(di, 1)));
      const I hi = hn::Min(hn::Set(di, plan.map.spread[axis] + 1), whole(hn::Add(centre, reach)));
      hn::Store(hn::Max(lo, hn::Sub(hn::Set(di, plan.records.lo[axis]), from)), di, first);
      hn::Store(hn::Min(hi, hn::Sub(hn::Set(di, plan.records.hi[axis] - 1), from)), di, last);
    };
    bound(1, part(1), hn::And(hn::ShiftRight<10>(cell), ten), first_j, last_j);
    bound(2, part(2), hn::ShiftRight<20>(cell), first_k, last_k);
  }

  HWY_ALIGN float step_up[kMaxLanes], per_c_across[kMaxLanes], least_height[kMaxLanes];
  HWY_ALIGN std::int32_t first_j[kMaxLanes], last_j[kMaxLanes], first_k[kMaxLanes], last_k[kMaxLanes];
};

/// One surfel of them; `kStraight` where the metric's matrix has nothing beside its diagonal, which spares the products with zero. Squared
/// distances along a row are a + i (b + i c), i counted from the surfel's cell.
template <bool kStraight>
struct Offer {
  const OfferPlan& plan;
  const Surfel& s;
  float step_up, per_c_across, least_height;

  /// Which rows of the block at (j, k) from the cell, of those known, it may be nearest in; `a` and 2 `b` of each.
  HWY_INLINE std::uint64_t look(const RowBlock& block, int j, int k, std::uint64_t known, float* a, float* b) const {
    const D d;
    const F from_y = hn::Set(d, static_cast<float>(j)), from_z = hn::Set(d, static_cast<float>(k));
    const F y = hn::Set(d, s.y), z = hn::Set(d, s.z);
    std::uint64_t wanted = 0;
    for (int n = 0; n < 64 && known >> n != 0; n += static_cast<int>(hn::Lanes(d))) {
      F here_a, here_b;
      const auto mask = near(hn::Sub(hn::Add(hn::Load(d, block.y + n), from_y), y), hn::Sub(hn::Add(hn::Load(d, block.z + n), from_z), z),
                             here_a, here_b);
      hn::Store(here_a, d, a + n);
      hn::Store(hn::Add(here_b, here_b), d, b + n);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, mask, bits);
      wanted |= static_cast<std::uint64_t>(bits[0] | (bits[1] << 8)) << n;
    }
    return wanted & known;
  }

  /// Which rows, given from the surfel in index steps, come near enough to it and to its normal's line.
  HWY_INLINE hn::Mask<D> near(F y, F z, F& a, F& b) const {
    const D d;
    const auto& m = plan.map.metric_from_index;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const auto start = [&](std::size_t r) {
      return hn::Sub(hn::Add(hn::Mul(set(m[r][1]), y), hn::Mul(set(m[r][2]), z)), set(plan.step[r] * s.x));
    };
    const F3 from =
        kStraight ? F3{set(-(plan.step[0] * s.x)), hn::Mul(set(m[1][1]), y), hn::Mul(set(m[2][2]), z)} : F3{start(0), start(1), start(2)};
    const auto along = [&](const Metric& v) { return sum3(v[0], from.x, v[1], from.y, v[2], from.z); };
    a = HWY_NAMESPACE::dot(from, from);
    b = kStraight ? hn::Mul(set(plan.step[0]), from.x) : along(plan.step);
    const F up = along({s.nx, s.ny, s.nz});
    const F a_across = hn::Sub(a, hn::Mul(up, up)), b_across = hn::Sub(b, hn::Mul(up, set(step_up)));
    const F back = hn::Mul(b_across, set(per_c_across));  // to where the row is nearest to the normal's line
    const F beside2 = hn::Sub(a_across, hn::Mul(b_across, back));
    const F height = hn::Max(hn::Abs(hn::Sub(up, hn::Mul(set(step_up), back))), set(least_height));
    const F width = hn::Add(set(plan.map.patch_radius), hn::Mul(set(s.bend), hn::Min(height, set(kBand))));
    const auto in_band = hn::Lt(hn::Sub(hn::Mul(a, set(plan.c)), hn::Mul(b, b)), set(kBand2 * plan.c));
    return hn::And(in_band, hn::Le(beside2, hn::Mul(width, width)));
  }
};

/// Offers surfel `n` of a block to the voxels of its rows.
template <bool kStraight>
HWY_INLINE void offer(const OfferPlan& plan, const Surfel& s, const Offers& offers, std::size_t n, SurfaceTile& tile) {
  const hn::CappedTag<float, 8> d;  // what one surfel reaches of a row, unless voxels are uneven
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec3i cell = unpack_position(s.cell), &spread = plan.map.spread;
  const Offer<kStraight> one{plan, s, offers.step_up[n], offers.per_c_across[n], offers.least_height[n]};
  const Vec3i first(std::max(-spread.x, plan.records.lo.x - cell.x), offers.first_j[n], offers.first_k[n]);
  const Vec3i last(std::min(spread.x + 1, plan.records.hi.x - 1 - cell.x), offers.last_j[n], offers.last_k[n]);
  const RowBlock& block = last.y - first.y < 4 ? plan.narrow : plan.wide;
  const int bits = plan.map.code_bits, width = 1 << block.width_bits, depth = 64 >> block.width_bits;
  const auto distance_bits = hn::Set(du, ~plan.map.code_mask());
  const auto c = hn::Set(d, plan.c);
  const auto lane = hn::Load(di, plan.lane);
  HWY_ALIGN float row_a[64], row_b[64];
  for (int k = first.z; k <= last.z; k += depth)
    for (int j = first.y; j <= last.y; j += width) {
      const std::uint64_t wanted = one.look(block, j, k, block.known(last.y - j + 1, last.z - k + 1), row_a, row_b);
      const int code = ((j + spread.y) << bits) + ((k + spread.z) << 2 * bits) + spread.x;
      std::uint32_t* const at = tile.nearest.data() + cell.x + (cell.y + j) * tile.row + (cell.z + k) * tile.slab;
      for (int i = first.x; i <= last.x; i += lanes) {
        const auto along = hn::Add(lane, hn::Set(di, i)), place = hn::Add(along, hn::Set(di, code));
        const auto t = hn::ConvertTo(d, along), tc = hn::Mul(t, c);
        for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
          const int r = std::countr_zero(left);
          const auto a = hn::Set(d, row_a[r]), b = hn::Set(d, row_b[r]);
          const auto distance2 = hn::Max(hn::Zero(d), hn::Add(a, hn::Mul(t, hn::Add(b, tc))));
          const auto key =
              hn::Or(hn::And(hn::BitCast(du, distance2), distance_bits), hn::BitCast(du, hn::Add(place, hn::Set(di, block.code[r]))));
          std::uint32_t* const row = at + block.at[r] + i;
          hn::StoreU(hn::Min(key, hn::LoadU(du, row)), du, row);
        }
      }
    }
}

template <bool kStraight>
void offer_all(const OfferPlan& plan, SurfaceTile& tile) {
  const std::size_t lanes = hn::Lanes(D());
  for (std::size_t n = 0; n < tile.found; n += lanes) {
    const Offers offers(plan, tile.surfels.data() + n);
    for (std::size_t each = 0; each < std::min(lanes, tile.found - n); ++each)
      offer<kStraight>(plan, tile.surfels[n + each], offers, each, tile);
  }
}

void FindNearest(const SurfaceMap& map, SurfaceTile& tile) {
  const auto length = static_cast<std::size_t>(tile.records.size().x);
  for (int k = tile.records.lo.z; k < tile.records.hi.z; ++k)
    for (int j = tile.records.lo.y; j < tile.records.hi.y; ++j)
      std::fill_n(tile.nearest.data() + tile.offset_of({tile.records.lo.x, j, k}), length, map.far_key());
  const OfferPlan plan(map, tile);
  const auto& m = map.metric_from_index;
  const bool straight = m[0][1] == 0.0f && m[0][2] == 0.0f && m[1][0] == 0.0f && m[1][2] == 0.0f && m[2][0] == 0.0f && m[2][1] == 0.0f;
  if (straight)
    offer_all<true>(plan, tile);
  else
    offer_all<false>(plan, tile);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(FindNearest);

void find_nearest(const SurfaceMap& map, SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(FindNearest)(map, tile); }

}  // namespace burrhole
#endif
