// The plain twin of these kernels is in tests/core/drill/face_kernels_test.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/face_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "core/base/compact_lanes-inl.h"
#include "core/drill/face_kernels.h"
#include "core/tool/field_lanes-inl.h"

#ifndef BURRHOLE_FACE_KERNELS_ONCE
#define BURRHOLE_FACE_KERNELS_ONCE
namespace burrhole {

inline constexpr float kExactLag = 1e-4f;    // [voxel unit] of a lag
inline constexpr float kSteepEnough = 0.1f;  // [-] least slope with which a lag is extrapolated
inline constexpr int kMostRounds = 8;        // for a lag

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kBlockEdge>;
using Words = hn::RebindToUnsigned<Floats>;
using F = hn::Vec<Floats>;
using M = hn::Mask<Floats>;
template <bool kRevolved>
using Field = FieldLanes<kRevolved, Floats>;

struct F3 {
  F x, y, z;
};
HWY_INLINE F set(float value) { return hn::Set(Floats(), value); }
HWY_INLINE F load(const std::vector<float>& list, std::size_t n) { return hn::LoadU(Floats(), list.data() + n); }
HWY_INLINE void store(F value, std::vector<float>& list, std::size_t n) { hn::StoreU(value, Floats(), list.data() + n); }
/// Lanes beyond the last entry have the place of the field's first node.
HWY_INLINE F3 place_of(const FaceNodes& nodes, std::size_t n) {
  const auto used = hn::FirstN(Floats(), nodes.count - n);
  return {hn::IfThenElseZero(used, load(nodes.x, n)), hn::IfThenElseZero(used, load(nodes.y, n)),
          hn::IfThenElseZero(used, load(nodes.z, n))};
}
HWY_INLINE F3 moved_back(const FaceTool& tool, const F3& p, F by) {
  return {hn::Sub(p.x, hn::Mul(by, set(tool.along[0]))), hn::Sub(p.y, hn::Mul(by, set(tool.along[1]))),
          hn::Sub(p.z, hn::Mul(by, set(tool.along[2])))};
}

/// Where matching lanes of a search are appended.
struct Appended {
  FaceNodes* nodes;
  HWY_INLINE void operator()(M mask, const F3& p, F tool, F cut, const float* base, std::uint32_t at, std::uint32_t inside) const {
    const Floats d;
    const Words dw;
    const CompactLanes<Floats> lanes(d, mask);
    const std::size_t n = nodes->count;
    lanes.store(d, p.x, nodes->x.data() + n);
    lanes.store(d, p.y, nodes->y.data() + n);
    lanes.store(d, p.z, nodes->z.data() + n);
    lanes.store(d, tool, nodes->tool.data() + n);
    lanes.store(d, cut, nodes->cut.data() + n);
    lanes.store(d, hn::LoadU(d, base), nodes->base.data() + n);
    lanes.store(dw, hn::Iota(dw, at), nodes->at.data() + n);
    lanes.store(dw, hn::Iota(dw, inside), nodes->inside.data() + n);
    nodes->count = n + lanes.count();
  }
};

template <bool kRevolved>
void SearchBlock(const FaceTool& tool, const BlockSearch& b, FaceNodes& nodes, BlockFound& found) {
  const Floats d;
  const Words dw;
  const Field<kRevolved> field(tool.field);
  const F zero = hn::Zero(d), edge = set(tool.edge), follow = set(tool.follow);
  const Appended append{&nodes};
  alignas(64) float nearest[4][kBlockEdge], room[4][kBlockEdge];  // per pair of parts along i
  for (std::size_t pair = 0; pair < 4; ++pair)
    for (std::size_t lane = 0; lane < kBlockEdge; ++lane) nearest[pair][lane] = room[pair][lane] = std::numeric_limits<float>::max();
  std::size_t lacking = 0;
  for (int k = b.lo[2]; k < b.hi[2]; ++k)
    for (int j = b.lo[1]; j < b.hi[1]; ++j) {
      const int pair = (j >> 2) + 2 * (k >> 2);
      const std::uint32_t halves = b.parts >> (2 * pair) & 3u;
      if (halves == 0) continue;
      const auto jf = static_cast<float>(j), kf = static_cast<float>(k);
      float start[3];
      for (std::size_t c = 0; c < 3; ++c) start[c] = b.first[c] + jf * b.step_j[c] + kf * b.step_k[c];
      const auto ju = static_cast<std::size_t>(j), ku = static_cast<std::size_t>(k);
      const std::size_t inside = (ku * kBlockEdge + ju) * kBlockEdge, from = ku * b.slab + ju * b.row;
      const std::uint32_t at = b.at + static_cast<std::uint32_t>(k) * b.window_slab + static_cast<std::uint32_t>(j) * b.window_row;
      for (std::size_t i = 0; i < kBlockEdge; i += hn::Lanes(d)) {
        const F lane = hn::Iota(d, static_cast<float>(i));
        const F lowest = set(static_cast<float>(std::max(b.lo[0], (halves & 1u) != 0 ? 0 : kBlockEdge / 2)));
        const F highest = set(static_cast<float>(std::min(b.hi[0], (halves & 2u) != 0 ? kBlockEdge : kBlockEdge / 2)));
        const F cut = hn::LoadU(d, b.cut + inside + i);
        M wanted = hn::And(hn::Ge(lane, lowest), hn::Lt(lane, highest));
        if (const M air = hn::And(wanted, hn::Gt(cut, set(tool.free))); !hn::AllFalse(d, air)) {
          // Few voxels are this far out, so the arrays of bone are seldom read.
          const M bone = hn::And(hn::Gt(hn::LoadU(d, b.occupancy + from + i), zero), hn::Gt(hn::LoadU(d, b.remaining + from + i), zero));
          wanted = hn::AndNot(hn::AndNot(bone, air), wanted);
        }
        if (hn::AllFalse(d, wanted)) continue;
        const auto place = [&](std::size_t c) HWY_ATTR { return hn::Add(set(start[c]), hn::Mul(lane, set(b.step_i[c]))); };
        const F3 p{place(0), place(1), place(2)};
        const F distance = hn::Div(field.distance(p.x, p.y, p.z), edge);
        const auto lower = [&](M where, F value, float* least) HWY_ATTR {
          const F before = hn::Load(d, least);
          hn::Store(hn::IfThenElse(where, hn::Min(before, value), before), d, least);
        };
        lower(wanted, distance, nearest[pair] + i);
        const M near = hn::And(wanted, hn::Le(distance, follow)), known = hn::Gt(cut, set(-tool.known));
        const F left = hn::Add(distance, cut);
        const F spare = hn::IfThenElse(hn::Le(distance, follow), hn::Max(zero, left), hn::Sub(distance, follow));
        lower(hn::And(wanted, hn::Or(known, hn::Gt(distance, follow))), spare, room[pair] + i);
        const M overlaps = hn::And(near, hn::And(known, hn::Lt(left, zero)));
        if (!hn::AllFalse(d, overlaps))
          append(overlaps, p, distance, cut, b.base + inside + i, at + static_cast<std::uint32_t>(i),
                 static_cast<std::uint32_t>(inside + i));
        const M lacks = hn::AndNot(known, near);
        if (hn::AllFalse(d, lacks)) continue;
        const CompactLanes<Floats> lanes(d, lacks);
        lanes.store(d, distance, found.lacking_tool.data() + lacking);
        lanes.store(dw, hn::Iota(dw, static_cast<std::uint32_t>(inside + i)), found.lacking.data() + lacking);
        lacking += lanes.count();
      }
    }
  for (std::size_t part = 0; part < 8; ++part) {
    const std::size_t first = part % 2 * (kBlockEdge / 2);
    found.nearest[part] = *std::min_element(nearest[part / 2] + first, nearest[part / 2] + first + kBlockEdge / 2);
    found.room[part] = *std::min_element(room[part / 2] + first, room[part / 2] + first + kBlockEdge / 2);
  }
  found.lacking_count = lacking;
}

template <bool kRevolved>
void FindWear(const FaceTool& tool, const float* hardness, float least, FaceNodes& nodes) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const Field<kRevolved> field(tool.field);
  for (std::size_t n = 0; n < nodes.count; n += hn::Lanes(d)) {
    const F3 p = place_of(nodes, n);
    const auto at = hn::BitCast(di, hn::LoadU(Words(), nodes.at.data() + n));
    const auto used = hn::RebindMask(di, hn::FirstN(d, nodes.count - n));
    const F bone = hn::Max(hn::GatherIndex(d, hardness, hn::IfThenElseZero(used, at)), set(least));
    store(hn::Div(field.factor(p.x, p.y, p.z), bone), nodes.wear, n);
  }
}

/// 1 - e^-x of x / 64 by the series; then 1 - e^-2y = a (2 - a) with a = 1 - e^-y.
void FindShares(const FaceNodes& nodes, float turns, float* out) {
  const Floats d;
  constexpr float kParts = 64.0f;  // 2^6
  for (std::size_t n = 0; n < nodes.count; n += hn::Lanes(d)) {
    const F x = hn::Min(hn::Mul(set(turns), load(nodes.wear, n)), set(32.0f));
    const F y = hn::Mul(x, set(1.0f / kParts));
    F sum = set(-1.0f / 720.0f);
    for (const float c : {1.0f / 120.0f, -1.0f / 24.0f, 1.0f / 6.0f, -0.5f, 1.0f}) sum = hn::Add(hn::Mul(sum, y), set(c));
    F share = hn::Mul(sum, y);
    for (int doubled = 0; doubled < 6; ++doubled) share = hn::Mul(share, hn::Sub(set(2.0f), share));
    hn::StoreU(share, d, out + n);
  }
}

template <bool kRevolved>
void FindLags(const FaceTool& tool, float usual, float longest, FaceNodes& nodes) {
  const Floats d;
  const Field<kRevolved> field(tool.field);
  const F zero = hn::Zero(d), exact = set(kExactLag), steep = set(kSteepEnough);
  for (std::size_t n = 0; n < nodes.count; n += hn::Lanes(d)) {
    const F3 p = place_of(nodes, n);
    const F cut = load(nodes.cut, n);
    F near = zero, near_missing = hn::Neg(hn::Add(load(nodes.tool, n), cut)), far = set(-1.0f), far_missing = zero;
    F now = hn::Max(set(usual), near_missing), behind = zero, rest = zero;
    M open = hn::FirstN(d, nodes.count - n);
    for (int round = 0; round < kMostRounds && !hn::AllFalse(d, open); ++round) {
      const F3 at = moved_back(tool, p, hn::IfThenElseZero(open, now));
      const F missing = hn::Sub(hn::Neg(cut), hn::Div(field.distance(at.x, at.y, at.z), set(tool.edge)));
      const M settled = hn::And(open, hn::Le(hn::Abs(missing), exact));
      behind = hn::IfThenElse(settled, now, behind);
      rest = hn::IfThenElse(settled, missing, rest);
      open = hn::AndNot(settled, open);
      const M beyond = hn::Lt(missing, zero);
      far = hn::IfThenElse(beyond, now, far);
      far_missing = hn::IfThenElse(beyond, missing, far_missing);
      const F slope = hn::Div(hn::Sub(near_missing, missing), hn::Sub(now, near));
      const F step = hn::IfThenElse(hn::Gt(slope, steep), hn::Max(missing, hn::Div(missing, slope)), missing);
      F next = hn::Add(now, step);
      near = hn::IfThenElse(beyond, near, now);
      near_missing = hn::IfThenElse(beyond, near_missing, missing);
      const M between = hn::And(hn::Ge(far, zero), hn::Or(beyond, hn::Ge(next, far)));
      const F chord = hn::Add(near, hn::Div(hn::Mul(hn::Sub(far, near), near_missing), hn::Sub(near_missing, far_missing)));
      next = hn::IfThenElse(between, chord, next);
      open = hn::And(open, hn::Le(next, set(longest)));
      now = next;
    }
    store(behind, nodes.behind, n);
    store(rest, nodes.rest, n);
  }
}

template <bool kRevolved>
void RecedeNodes(const FaceTool& tool, const FaceNodes& nodes, const float* shares, float* after, float* back) {
  const Floats d;
  const Field<kRevolved> field(tool.field);
  for (std::size_t n = 0; n < nodes.count; n += hn::Lanes(d)) {
    const F share = hn::LoadU(d, shares + n), before = load(nodes.cut, n), most = hn::Neg(load(nodes.tool, n)),
            behind = load(nodes.behind, n);
    const F by = hn::IfThenElseZero(hn::FirstN(d, nodes.count - n), hn::Mul(hn::Sub(set(1.0f), share), behind));
    const F3 p = moved_back(tool, place_of(nodes, n), by);
    const F there = hn::Div(field.distance(p.x, p.y, p.z), set(tool.edge));
    const F along_normal = hn::Min(hn::Max(hn::Add(before, hn::Mul(share, hn::Sub(most, before))), before), most);
    const F followed = hn::Min(hn::Sub(hn::Neg(there), load(nodes.rest, n)), most);
    const M follows = hn::And(hn::Gt(behind, hn::Zero(d)), hn::Gt(followed, along_normal));
    hn::StoreU(hn::IfThenElse(follows, followed, along_normal), d, after + n);
    hn::StoreU(hn::IfThenElseZero(follows, by), d, back + n);
  }
}

void Quantise(const float* from, const float* other, std::size_t count, std::int16_t* steps) {
  const Floats d;
  const hn::Rebind<std::int16_t, Floats> d16;
  const F band = set(static_cast<float>(kRecordBand)), scale = set(static_cast<float>(1.0 / kRecord16Distance));
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const F distance = hn::Min(hn::Max(hn::Max(hn::LoadU(d, from + n), hn::LoadU(d, other + n)), hn::Neg(band)), band);
    hn::StoreU(hn::DemoteTo(d16, hn::NearestInt(hn::Mul(distance, scale))), d16, steps + n);
  }
}

template <bool kRevolved>
void FindNormals(const FaceTool& tool, const PlaceList& places, const std::array<std::int16_t*, 3>& normals) {
  const Floats d;
  const hn::Rebind<std::int16_t, Floats> d16;
  const Field<kRevolved> field(tool.field);
  const F one = set(1.0f), scale = set(static_cast<float>(1.0 / kRecord16Normal));
  for (std::size_t n = 0; n < places.count; n += hn::Lanes(d)) {
    const auto used = hn::FirstN(d, places.count - n);
    const auto read = [&](const float* list) HWY_ATTR { return hn::IfThenElseZero(used, hn::LoadU(d, list + n)); };
    const F3 p{read(places.x), read(places.y), read(places.z)};
    const F slope[3] = {hn::Sub(field.distance(hn::Add(p.x, one), p.y, p.z), field.distance(hn::Sub(p.x, one), p.y, p.z)),
                        hn::Sub(field.distance(p.x, hn::Add(p.y, one), p.z), field.distance(p.x, hn::Sub(p.y, one), p.z)),
                        hn::Sub(field.distance(p.x, p.y, hn::Add(p.z, one)), field.distance(p.x, p.y, hn::Sub(p.z, one)))};
    F out[3];
    F square = hn::Zero(d);
    for (std::size_t r = 0; r < 3; ++r) {
      const auto m = [&](std::size_t c) HWY_ATTR { return set(-tool.normal_from[3 * r + c]); };
      out[r] = hn::Add(hn::Add(hn::Mul(m(0), slope[0]), hn::Mul(m(1), slope[1])), hn::Mul(m(2), slope[2]));
      square = hn::Add(square, hn::Mul(out[r], out[r]));
    }
    const F length = hn::Sqrt(square);
    const F per_length = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d)), hn::Div(scale, length));
    for (std::size_t r = 0; r < 3; ++r) hn::StoreU(hn::DemoteTo(d16, hn::NearestInt(hn::Mul(out[r], per_length))), d16, normals[r] + n);
  }
}

}  // namespace

// Each is a choice between the two kinds of table.
void SearchBlockOf(const FaceTool& tool, const BlockSearch& b, FaceNodes& nodes, BlockFound& found) {
  tool.field.revolved ? SearchBlock<true>(tool, b, nodes, found) : SearchBlock<false>(tool, b, nodes, found);
}
void FindWearOf(const FaceTool& tool, const float* hardness, float least, FaceNodes& nodes) {
  tool.field.revolved ? FindWear<true>(tool, hardness, least, nodes) : FindWear<false>(tool, hardness, least, nodes);
}
void FindSharesOf(const FaceNodes& nodes, float turns, float* out) { FindShares(nodes, turns, out); }
void FindLagsOf(const FaceTool& tool, float usual, float longest, FaceNodes& nodes) {
  tool.field.revolved ? FindLags<true>(tool, usual, longest, nodes) : FindLags<false>(tool, usual, longest, nodes);
}
void RecedeNodesOf(const FaceTool& tool, const FaceNodes& nodes, const float* shares, float* after, float* back) {
  tool.field.revolved ? RecedeNodes<true>(tool, nodes, shares, after, back) : RecedeNodes<false>(tool, nodes, shares, after, back);
}
void QuantiseOf(const float* from, const float* other, std::size_t count, std::int16_t* steps) { Quantise(from, other, count, steps); }
void FindNormalsOf(const FaceTool& tool, const PlaceList& places, const std::array<std::int16_t*, 3>& normals) {
  tool.field.revolved ? FindNormals<true>(tool, places, normals) : FindNormals<false>(tool, places, normals);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(SearchBlockOf);
HWY_EXPORT(FindWearOf);
HWY_EXPORT(FindSharesOf);
HWY_EXPORT(FindLagsOf);
HWY_EXPORT(RecedeNodesOf);
HWY_EXPORT(QuantiseOf);
HWY_EXPORT(FindNormalsOf);

void FaceNodes::make_room(std::size_t more) {
  const std::size_t least = count + more + kFieldPad;
  if (x.size() >= least) return;
  at.resize(2 * least);
  inside.resize(2 * least);
  cut_before.resize(2 * least);
  for (std::vector<float>* list : {&x, &y, &z, &tool, &cut, &base, &wear, &behind, &rest}) list->resize(2 * least);
}

void search_block(const FaceTool& tool, const BlockSearch& block, FaceNodes& nodes, BlockFound& found) noexcept {
  HWY_DYNAMIC_DISPATCH(SearchBlockOf)(tool, block, nodes, found);
}
void find_wear(const FaceTool& tool, const float* hardness, float least, FaceNodes& nodes) noexcept {
  HWY_DYNAMIC_DISPATCH(FindWearOf)(tool, hardness, least, nodes);
}
void find_shares(const FaceNodes& nodes, float turns, float* out) noexcept { HWY_DYNAMIC_DISPATCH(FindSharesOf)(nodes, turns, out); }
void find_lags(const FaceTool& tool, float usual, float longest, FaceNodes& nodes) noexcept {
  HWY_DYNAMIC_DISPATCH(FindLagsOf)(tool, usual, longest, nodes);
}
void recede_nodes(const FaceTool& tool, const FaceNodes& nodes, const float* shares, float* after, float* back) noexcept {
  HWY_DYNAMIC_DISPATCH(RecedeNodesOf)(tool, nodes, shares, after, back);
}
void quantise_distances(const float* from, const float* other, std::size_t count, std::int16_t* steps) noexcept {
  HWY_DYNAMIC_DISPATCH(QuantiseOf)(from, other, count, steps);
}
void find_normals(const FaceTool& tool, const PlaceList& places, std::array<std::int16_t*, 3> normals) noexcept {
  HWY_DYNAMIC_DISPATCH(FindNormalsOf)(tool, places, normals);
}

}  // namespace burrhole
#endif  // HWY_ONCE
