// Two stages. The first transforms points, tests them for contact, one vector at a time, and queues those that touch. The second takes 64
//   from the queue, four vectors of sixteen at a time so that gathers overlap: march along the tool vector by leaps, march down the
//   gradient, plane, sums.
// The kernel never reads outside the window: a point starts inside its known part; a leap ends at the outermost layer at the latest
//   (contact_words.h); that layer is empty, so no march continues there; a step down the gradient starts in a solid voxel.
//
// TSan does not track the gathers of vector kernels; the scalar reference is tests/core/contact/words_twin.cpp.
#include "core/contact/packed_plane_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/packed_plane_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/contact/packed_lanes-inl.h"
#include "core/contact/packed_touch-inl.h"
#include "core/contact/packed_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// Adds positions, forces, torques and normals of a vector's contacts, in double, to the sums. `at` is the vector's position in the batch.
HWY_INLINE void AddUp(const PackedJob& job, int at, const TouchQueue& queue, PackedPlanes& planes, PackedSums& sums) {
  for (int lane = at; lane < at + kLanes; lane += static_cast<int>(hn::Lanes(kD))) {
    VD index[3], n[3], arm[3], push[3];
    const std::int32_t* const places[3] = {queue.x + lane, queue.y + lane, queue.z + lane};
    const VD back = hn::Set(kD, -static_cast<double>(kHalf)), scale = hn::Set(kD, 1.0 / kVoxel);
    const VD depth = hn::PromoteTo(kD, hn::LoadU(DFofD(), planes.depth + lane));
    Repeat<3>([&](auto a) BH_LANES {
      index[a] = hn::Mul(hn::Add(hn::PromoteTo(kD, hn::LoadU(DIofD(), places[a])), back), scale);
      n[a] = hn::PromoteTo(kD, hn::LoadU(DFofD(), planes.normal[a] + lane));
    });
    Repeat<3>([&](auto a) BH_LANES {
      const auto& m = job.world_from_index[a];
      const VD turned = hn::Add(hn::Add(hn::Mul(hn::Set(kD, m[0]), index[0]), hn::Mul(hn::Set(kD, m[1]), index[1])),
                                hn::Mul(hn::Set(kD, m[2]), index[2]));
      const VD position = hn::Add(turned, hn::Set(kD, m[3]));
      if (job.listed) hn::StoreU(position, kD, planes.position[a] + lane);
      arm[a] = hn::Sub(position, hn::Set(kD, job.origin[a]));
      push[a] = hn::Mul(n[a], depth);
    });
    // Lanes without a surface, and padding, have depth 0.
    const auto pushed = hn::Gt(depth, hn::Zero(kD));
    int which = 0;
    const auto add = [&](VD value) BH_LANES {
      double* sum = sums.part[which++] + lane % kSums;
      hn::StoreU(hn::Add(hn::LoadU(kD, sum), hn::IfThenElseZero(pushed, value)), kD, sum);
    };
    Repeat<3>([&](auto a) BH_LANES { add(push[a]); });
    Repeat<3>([&](auto a) BH_LANES {
      constexpr int b = (a + 1) % 3, c = (a + 2) % 3;
      add(hn::Sub(hn::Mul(arm[b], push[c]), hn::Mul(arm[c], push[b])));
    });
    Repeat<3>([&](auto a) BH_LANES { Repeat<3 - a>([&](auto b) BH_LANES { add(hn::Mul(n[a], n[a + b])); }); });
  }
}

/// Marches `count` queued points from `first` on, one group of vectors. @returns flags.
HWY_INLINE std::uint32_t WalkFlight(const PackedJob& job, int first, int count, const TouchQueue& queue, PackedPlanes& planes,
                                    PackedSums& sums) {
  Place place[kFlight], step[kFlight];
  Triple tool_vector[kFlight];
  MI live[kFlight];
  Walk walk[kFlight];
  Repeat<kFlight>([&](auto v) BH_LANES {
    const int at = first + v * kLanes;
    live[v] = hn::FirstN(kI, static_cast<std::size_t>(std::clamp(count - at, 0, kLanes)));
    // Lanes beyond the end of the queue do not march, but must be in the window.
    const auto stand = [&](const std::int32_t* list)
                           BH_LANES { return hn::IfThenElse(live[v], hn::Load(kI, list + at), hn::Set(kI, kVoxel)); };
    place[v] = {stand(queue.x), stand(queue.y), stand(queue.z)};
    tool_vector[v] = {hn::Load(kF, queue.inward[0] + at), hn::Load(kF, queue.inward[1] + at), hn::Load(kF, queue.inward[2] + at)};
    step[v] = StepAlong(Times(job.steps_from_tool, tool_vector[v]), static_cast<float>(kVoxel));
    walk[v].word = hn::Load(kI, queue.word + at);
    walk[v].at = place[v];
    const VI corner = hn::ShiftRight<kPointBits>(hn::Load(kI, queue.tag + at));
    const MI moved = hn::And(hn::Gt(corner, hn::Zero(kI)), live[v]);
    if (!hn::AllFalse(kI, moved)) {
      const VI bits = hn::Sub(corner, hn::Set(kI, 1)), one = hn::Set(kI, 1), half = hn::Set(kI, kHalf);
      const auto centre = [&](VI x, VI bit) BH_LANES {
        const VI voxel = hn::Add(hn::ShiftRight<kFractionBits>(hn::Sub(x, half)), hn::And(bit, one));
        return hn::IfThenElse(moved, hn::Add(hn::ShiftLeft<kFractionBits>(voxel), half), x);
      };
      walk[v].at = {centre(place[v].x, bits), centre(place[v].y, hn::ShiftRight<1>(bits)), centre(place[v].z, hn::ShiftRight<2>(bits))};
    }
  });
  March(job, step, live, walk);
  Ascend(job, walk);
  std::uint32_t flags = 0;
  Repeat<kFlight>([&](auto v) BH_LANES {
    const int at = first + v * kLanes;
    const MI found = hn::AndNot(walk[v].lost, live[v]);
    if (!hn::AllFalse(kI, hn::AndNot(found, live[v]))) flags |= kContactNoSurface;
    const Triple way = Times(job.way_from_index, WayToPlane(job, place[v], walk[v].last));
    const Triple slope = Times(job.normal_from_gradient, GradientOf(walk[v].surface));
    const VF scale = hn::Div(hn::Set(kF, -1.0f), hn::Sqrt(Dot(slope, slope)));
    Triple normal{hn::Mul(slope.x, scale), hn::Mul(slope.y, scale), hn::Mul(slope.z, scale)};
    const MI flat = hn::And(Still(walk[v].surface), found);
    if (!hn::AllFalse(kI, flat)) {
      flags |= kContactZeroGradient;
      const Triple world = Times(job.world_from_tool, tool_vector[v]);
      const auto stand_in = hn::RebindMask(kF, flat);
      normal = {hn::IfThenElse(stand_in, world.x, normal.x), hn::IfThenElse(stand_in, world.y, normal.y),
                hn::IfThenElse(stand_in, world.z, normal.z)};
    }
    const VF depth = hn::Max(hn::Zero(kF), Dot(way, normal));
    hn::Store(hn::IfThenElseZero(hn::RebindMask(kF, found), depth), kF, planes.depth + at);
    hn::Store(normal.x, kF, planes.normal[0] + at);
    hn::Store(normal.y, kF, planes.normal[1] + at);
    hn::Store(normal.z, kF, planes.normal[2] + at);
    if (job.listed) {
      hn::Store(way.x, kF, planes.way[0] + at);
      hn::Store(way.y, kF, planes.way[1] + at);
      hn::Store(way.z, kF, planes.way[2] + at);
      hn::Store(hn::VecFromMask(kI, found), kI, planes.found + at);
    }
    sums.touching += hn::CountTrue(kI, found);
    hn::Store(hn::Max(hn::Load(kF, sums.deepest), hn::Load(kF, planes.depth + at)), kF, sums.deepest);
    AddUp(job, at, queue, planes, sums);
  });
  return flags;
}

/// Appends the points of a batch that have a plane. Inlined: a call would build each contact, copy it and wait for its stores.
__attribute__((flatten)) inline void list(const PackedJob& job, int count, const TouchQueue& queue, const PackedPlanes& planes,
                                          std::vector<Contact>& contacts) {
  for (int n = 0; n < count; ++n) {
    if (planes.found[n] == 0) continue;
    const Vec3 position(planes.position[0][n], planes.position[1][n], planes.position[2][n]);
    const Vec3 way(planes.way[0][n], planes.way[1][n], planes.way[2][n]),
        normal(planes.normal[0][n], planes.normal[1][n], planes.normal[2][n]);
    contacts.push_back({job.point[queue.tag[n] & ((1 << kPointBits) - 1)], position, position + way, normal, planes.depth[n]});
  }
}

/// Marches the first `count` points of the queue and lists their contacts if requested.
HWY_INLINE void WalkBatch(const PackedJob& job, int count, const TouchQueue& queue, PackedSums& sums, ContactResult& out) {
  PackedPlanes planes;
  for (int first = 0; first < count; first += kFlight * kLanes) out.flags |= WalkFlight(job, first, count, queue, planes, sums);
  if (job.listed) list(job, count, queue, planes, out.contacts);
}

void EvaluateAll(const PackedJob& job, PackedSums& sums, ContactResult& out) {
  TouchQueue queue;
  for (std::int32_t* list : {queue.x, queue.y, queue.z, queue.word, queue.tag}) std::fill_n(list, TouchQueue::kRoom, 0);
  for (auto& axis : queue.inward) std::fill_n(axis, TouchQueue::kRoom, 0.0f);
  const VI numbers = hn::Iota(kI, 0);  // made once: it is loaded from memory
  for (int n = 0; n < job.count; n += kLanes) {
    out.flags |= QueueTouching(job, n, numbers, queue);
    if (queue.size < kBatch) continue;
    WalkBatch(job, kBatch, queue, sums, out);
    const int rest = queue.size - kBatch;
    for (std::int32_t* list : {queue.x, queue.y, queue.z, queue.word, queue.tag}) std::copy_n(list + kBatch, rest, list);
    for (auto& axis : queue.inward) std::copy_n(axis + kBatch, rest, axis);
    queue.size = rest;
  }
  if (queue.size > 0) WalkBatch(job, queue.size, queue, sums, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {
HWY_EXPORT(EvaluateAll);
}  // namespace

void evaluate_packed(const PackedJob& job, PackedSums& sums, ContactResult& out) noexcept {
  HWY_DYNAMIC_DISPATCH(EvaluateAll)(job, sums, out);
}

}  // namespace burrhole
#endif
