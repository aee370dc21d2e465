// Two stages. The first places points and asks whether they touch, a vector at a time, and queues those that do. The second takes 64 from
// the queue, four vectors of sixteen in flight so that one gather hides behind another: along the tool vector by leaps, down the gradient,
// the plane, the sums.
// No place outside the window is ever read: a point starts inside its known part; a leap ends at the outermost layer at the latest
// (contact_words.h); that layer is empty, so no walk goes on from there; a step down the gradient starts in a solid voxel.
//
// Vector kernels (TSan does not see their gathers); the plain twin is tests/core/contact/words_twin.cpp.
#include "core/contact/packed_plane.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/contact/gradient_plane.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/packed_plane.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef BURRHOLE_PACKED_PLANE_JOB
#define BURRHOLE_PACKED_PLANE_JOB
namespace burrhole {

inline constexpr int kFractionBits = 14;
inline constexpr std::int32_t kVoxel = 1 << kFractionBits, kHalf = kVoxel / 2;
inline constexpr int kBatch = 64, kSums = 16, kPlanePad = 64;
inline constexpr int kPointBits = 20;  // of a queued tag; above it 0, or 1 + the corner of the cell that the walk starts from

/// Constants of one evaluation. Matrices row by row. Places are relative to the window's first voxel.
struct PackedJob {
  const std::int32_t* words;
  std::int32_t size[3], row, slab;
  std::array<const double*, 3> position{};
  std::array<const float*, 3> inward{};
  int count;
  double index_from_tool[3][4] = {}, world_from_index[3][4] = {}, origin[3] = {};
  float steps_from_tool[3][3] = {}, way_from_index[3][3] = {}, normal_from_gradient[3][3] = {}, world_from_tool[3][3] = {};
  std::int32_t solid;  // least density of a solid voxel
  bool trilinear;      // which rule says what collides
  std::int32_t max_march, max_ascent;
  const std::uint32_t* point;
};

/// Partial sums: force, torque, and xx xy xz yy yz zz of the normals of those under the plane.
struct PackedSums {
  alignas(64) double part[12][kSums] = {};
};

/// Points that touch and wait for their walk. Places as whole numbers, half a voxel added, so that a shift gives the voxel.
struct TouchQueue {
  static constexpr int kRoom = kBatch + 16;
  alignas(64) std::int32_t x[kRoom], y[kRoom], z[kRoom], word[kRoom], tag[kRoom];
  alignas(64) float inward[3][kRoom];
  int size = 0;
};

struct PackedPlanes {
  alignas(64) double position[3][kBatch];
  alignas(64) float way[3][kBatch], normal[3][kBatch], depth[kBatch];
  alignas(64) std::int32_t found[kBatch];
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DI = hn::CappedTag<std::int32_t, 16>;
using DF = hn::CappedTag<float, 16>;
using DD = hn::CappedTag<double, 8>;  // half as many lanes, or one where there is only one
using DIofD = hn::Rebind<std::int32_t, DD>;
using DFofD = hn::Rebind<float, DD>;
using VI = hn::Vec<DI>;
using VF = hn::Vec<DF>;
using VD = hn::Vec<DD>;
using MI = hn::Mask<DI>;
inline constexpr DI kI;
inline constexpr DF kF;
inline constexpr DD kD;
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(DI()));  // fixed on every target there is
inline constexpr int kFlight = 4;                                    // vectors

template <int N, class F>
HWY_INLINE void Repeat(F&& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) HWY_ATTR { (f(std::integral_constant<int, I>{}), ...); }
  (std::make_integer_sequence<int, N>{});
}

struct Place {
  VI x, y, z;
};

HWY_INLINE VI Density(VI word) { return hn::And(word, hn::Set(kI, 0xFF)); }
HWY_INLINE MI Still(VI word) { return hn::Lt(word, hn::Set(kI, static_cast<std::int32_t>(0x81000000))); }
HWY_INLINE MI Solid(const PackedJob& job, VI word) { return hn::Gt(Density(word), hn::Set(kI, job.solid - 1)); }
HWY_INLINE VI Leap(VI word) { return hn::And(hn::ShiftRight<8>(word), hn::Set(kI, 0xFF)); }
HWY_INLINE VI Offset(const PackedJob& job, const Place& voxel) {
  return hn::Add(hn::Add(voxel.x, hn::Mul(voxel.y, hn::Set(kI, job.row))), hn::Mul(voxel.z, hn::Set(kI, job.slab)));
}
HWY_INLINE Place VoxelOf(const Place& p) {
  return {hn::ShiftRight<kFractionBits>(p.x), hn::ShiftRight<kFractionBits>(p.y), hn::ShiftRight<kFractionBits>(p.z)};
}
HWY_INLINE VI WordAt(const PackedJob& job, VI offset) { return hn::GatherIndex(kI, job.words, offset); }
HWY_INLINE VI WordOf(const PackedJob& job, const Place& p) { return WordAt(job, Offset(job, VoxelOf(p))); }

struct Triple {
  VF x, y, z;
};
HWY_INLINE Triple Times(const float (&m)[3][3], const Triple& v) {
  const auto row = [&](const float(&r)[3]) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(hn::Set(kF, r[0]), v.x), hn::Mul(hn::Set(kF, r[1]), v.y)), hn::Mul(hn::Set(kF, r[2]), v.z));
  };
  return {row(m[0]), row(m[1]), row(m[2])};
}
HWY_INLINE VF Dot(const Triple& a, const Triple& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE Triple GradientOf(VI word) {
  return {hn::ConvertTo(kF, hn::ShiftRight<24>(hn::ShiftLeft<16>(word))), hn::ConvertTo(kF, hn::ShiftRight<24>(hn::ShiftLeft<8>(word))),
          hn::ConvertTo(kF, hn::ShiftRight<24>(word))};
}
/// One voxel along `v` (or against it, `length` < 0), whole numbers, at most a voxel on each axis; none where v is zero.
HWY_INLINE Place StepAlong(const Triple& v, float length) {
  const VF square = Dot(v, v);
  const VF scale = hn::IfThenElseZero(hn::Gt(square, hn::Zero(kF)), hn::Div(hn::Set(kF, length), hn::Sqrt(square)));
  const VI most = hn::Set(kI, kVoxel), least = hn::Set(kI, -kVoxel);
  const auto part = [&](VF x) HWY_ATTR { return hn::Min(hn::Max(hn::NearestInt(hn::Mul(x, scale)), least), most); };
  return {part(v.x), part(v.y), part(v.z)};
}

/// Trilinear density of the cell round each place at or above the 0.5 level; where the place's own voxel is below, `word` becomes the word
/// of the densest corner (the first of equals, i fastest) and `corner` 1 + its number.
HWY_INLINE MI Trilinear(const PackedJob& job, const Place& p, VI& word, VI& corner) {
  const VI half = hn::Set(kI, kHalf), fraction = hn::Set(kI, kVoxel - 1);
  const Place low{hn::Sub(p.x, half), hn::Sub(p.y, half), hn::Sub(p.z, half)};
  const VI first = Offset(job, VoxelOf(low));
  const auto share = [&](VI x) HWY_ATTR { return hn::Mul(hn::ConvertTo(kF, hn::And(x, fraction)), hn::Set(kF, 1.0f / kVoxel)); };
  const VF tx = share(low.x), ty = share(low.y), tz = share(low.z);
  VI words[8];
  Repeat<8>([&](auto n)
                HWY_ATTR { words[n] = WordAt(job, hn::Add(first, hn::Set(kI, (n & 1) + (n / 2 & 1) * job.row + n / 4 * job.slab))); });
  VI best = words[0], best_density = Density(words[0]), best_corner = hn::Set(kI, 1);
  Repeat<7>([&](auto m) HWY_ATTR {
    const VI density = Density(words[m + 1]);
    const MI denser = hn::Gt(density, best_density);
    best = hn::IfThenElse(denser, words[m + 1], best);
    best_density = hn::Max(density, best_density);
    best_corner = hn::IfThenElse(denser, hn::Set(kI, m + 2), best_corner);
  });
  const auto mix = [&](VF a, VF b, VF t) HWY_ATTR { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); };
  const auto along = [&](VI a, VI b) HWY_ATTR { return mix(hn::ConvertTo(kF, Density(a)), hn::ConvertTo(kF, Density(b)), tx); };
  const VF below = mix(along(words[0], words[1]), along(words[2], words[3]), ty);
  const VF above = mix(along(words[4], words[5]), along(words[6], words[7]), ty);
  const MI own = Solid(job, word);
  word = hn::IfThenElse(own, word, best);
  corner = hn::IfThenElse(own, hn::Zero(kI), best_corner);
  return hn::RebindMask(kI, hn::Ge(mix(below, above, tz), hn::Set(kF, kWordLevel)));
}

/// Places of one vector of points, n the first. @returns where they are known.
HWY_INLINE MI PlacePoints(const PackedJob& job, int n, Place& p) {
  const VD scale = hn::Set(kD, static_cast<double>(kVoxel)), shift = hn::Set(kD, kHalf + 0.5);
  const auto half_vector = [&](const double(&m)[4], int first) HWY_ATTR {
    const VD x = hn::LoadU(kD, job.position[0] + first), y = hn::LoadU(kD, job.position[1] + first),
             z = hn::LoadU(kD, job.position[2] + first);
    const VD sum = hn::Add(hn::Add(hn::Mul(hn::Set(kD, m[0]), x), hn::Mul(hn::Set(kD, m[1]), y)), hn::Mul(hn::Set(kD, m[2]), z));
    const VD index = hn::Add(sum, hn::Set(kD, m[3]));
    // Beyond what an index may be, or not a number: outside.
    const auto sane = hn::And(hn::Gt(index, hn::Set(kD, -1.0)), hn::Lt(index, hn::Set(kD, 2.0 * kMaxWindowEdge)));
    const VD bounded = hn::IfThenElse(sane, index, hn::Set(kD, -1.0));
    return hn::DemoteTo(DIofD(), hn::Add(hn::Mul(bounded, scale), shift));
  };
#if HWY_TARGET == HWY_SCALAR
  const auto along = [&](const double(&m)[4]) { return half_vector(m, n); };
#else
  const auto along = [&](const double(&m)[4]) HWY_ATTR { return hn::Combine(kI, half_vector(m, n + kLanes / 2), half_vector(m, n)); };
#endif
  const auto known = [&](VI x, int size)
                         HWY_ATTR { return hn::And(hn::Gt(x, hn::Set(kI, kVoxel - 1)), hn::Lt(x, hn::Set(kI, (size - 1) * kVoxel))); };
  const VI x = along(job.index_from_tool[0]), y = along(job.index_from_tool[1]), z = along(job.index_from_tool[2]);
  const MI inside = hn::And(known(x, job.size[0]), hn::And(known(y, job.size[1]), known(z, job.size[2])));
  const VI somewhere = hn::Set(kI, kVoxel);
  p = {hn::IfThenElse(inside, x, somewhere), hn::IfThenElse(inside, y, somewhere), hn::IfThenElse(inside, z, somewhere)};
  return inside;
}

/// Queues those of one vector of points that touch. @returns flags.
HWY_INLINE std::uint32_t QueueTouching(const PackedJob& job, int n, TouchQueue& queue) {
  Place p;
  const MI inside = PlacePoints(job, n, p);
  const MI real = hn::FirstN(kI, static_cast<std::size_t>(std::min(kLanes, job.count - n)));
  const std::uint32_t flags = hn::AllTrue(kI, hn::Or(inside, hn::Not(real))) ? 0u : static_cast<std::uint32_t>(kContactOutsideWindow);
  const MI asked = hn::And(inside, real);
  VI word = WordOf(job, p), corner = hn::Zero(kI);
  MI touching = hn::And(asked, Solid(job, word));
  if (job.trilinear) {
    // A leap of two or more: the whole cell is on one side, and the trilinear density with it.
    const MI near = hn::AndNot(hn::And(Still(word), hn::Gt(Leap(word), hn::Set(kI, 1))), asked);
    if (!hn::AllFalse(kI, near)) {
      VI start = word, from = corner;
      const MI meets = Trilinear(job, p, start, from);
      touching = hn::Or(hn::AndNot(near, touching), hn::And(near, meets));
      word = hn::IfThenElse(near, start, word);
      corner = hn::IfThenElse(near, from, corner);
    }
  }
  if (hn::AllFalse(kI, touching)) return flags;
  const VI tag = hn::Or(hn::Iota(kI, n), hn::ShiftLeft<kPointBits>(corner));
  // Whole vectors: what lies past the end of the queue is overwritten by the next, or masked.
  const int at = queue.size;
  const auto keep = [&](VI value, std::int32_t* list) HWY_ATTR { hn::StoreU(hn::Compress(value, touching), kI, list + at); };
  keep(p.x, queue.x);
  keep(p.y, queue.y);
  keep(p.z, queue.z);
  keep(word, queue.word);
  keep(tag, queue.tag);
  Repeat<3>([&](auto axis) HWY_ATTR {
    const VF inward = hn::LoadU(kF, job.inward[axis] + n);
    hn::StoreU(hn::Compress(inward, hn::RebindMask(kF, touching)), kF, queue.inward[axis] + at);
  });
  queue.size += static_cast<int>(hn::CountTrue(kI, touching));
  return flags;
}

struct Walk {
  Place at, last;  // last: inside the last solid voxel
  VI word, surface;
  MI lost;
};

/// Along the tool vector, by leaps, to the first voxel with a gradient or out of bone.
HWY_INLINE void March(const PackedJob& job, const Place (&step)[kFlight], const MI (&live)[kFlight], Walk (&walk)[kFlight]) {
  VI left[kFlight];
  Repeat<kFlight>([&](auto v) HWY_ATTR { left[v] = hn::IfThenElseZero(live[v], hn::Set(kI, job.max_march)); });
  for (bool going = true; going;) {
    going = false;
    Repeat<kFlight>([&](auto v) HWY_ATTR {
      Walk& w = walk[v];
      const MI on = hn::And(hn::And(Still(w.word), Solid(job, w.word)), hn::Gt(left[v], hn::Zero(kI)));
      if (hn::AllFalse(kI, on)) return;
      going = true;
      const VI leap = hn::IfThenElseZero(on, hn::Min(Leap(w.word), left[v]));
      left[v] = hn::Sub(left[v], leap);
      w.at.x = hn::Add(w.at.x, hn::Mul(leap, step[v].x));
      w.at.y = hn::Add(w.at.y, hn::Mul(leap, step[v].y));
      w.at.z = hn::Add(w.at.z, hn::Mul(leap, step[v].z));
      w.word = WordOf(job, w.at);
    });
  }
  Repeat<kFlight>([&](auto v) HWY_ATTR {
    // Landed beyond bone: the step before was the last in it.
    Walk& w = walk[v];
    const MI beyond = hn::AndNot(Solid(job, w.word), live[v]);
    w.last = {hn::Sub(w.at.x, hn::IfThenElseZero(beyond, step[v].x)), hn::Sub(w.at.y, hn::IfThenElseZero(beyond, step[v].y)),
              hn::Sub(w.at.z, hn::IfThenElseZero(beyond, step[v].z))};
    w.surface = hn::AllFalse(kI, beyond) ? w.word : WordOf(job, w.last);
    w.lost = hn::Or(hn::And(Still(w.word), Solid(job, w.word)), hn::Not(live[v]));
  });
}

/// Down the gradient to the last solid voxel before an empty one.
HWY_INLINE void Ascend(const PackedJob& job, Walk (&walk)[kFlight]) {
  Place step[kFlight];
  Repeat<kFlight>([&](auto v) HWY_ATTR { step[v] = {hn::Zero(kI), hn::Zero(kI), hn::Zero(kI)}; });
  bool going = true;
  for (int n = 0; n < job.max_ascent && going; ++n) {
    going = false;
    Repeat<kFlight>([&](auto v) HWY_ATTR {
      Walk& w = walk[v];
      const MI on = hn::AndNot(w.lost, Solid(job, w.word));
      if (hn::AllFalse(kI, on)) return;
      going = true;
      const MI turn = hn::AndNot(Still(w.word), on);
      const Place down = StepAlong(GradientOf(w.word), -static_cast<float>(kVoxel));
      step[v] = {hn::IfThenElse(turn, down.x, step[v].x), hn::IfThenElse(turn, down.y, step[v].y), hn::IfThenElse(turn, down.z, step[v].z)};
      w.last = {hn::IfThenElse(on, w.at.x, w.last.x), hn::IfThenElse(on, w.at.y, w.last.y), hn::IfThenElse(on, w.at.z, w.last.z)};
      w.surface = hn::IfThenElse(on, w.word, w.surface);
      w.at = {hn::Add(w.at.x, hn::IfThenElseZero(on, step[v].x)), hn::Add(w.at.y, hn::IfThenElseZero(on, step[v].y)),
              hn::Add(w.at.z, hn::IfThenElseZero(on, step[v].z))};
      w.word = WordOf(job, w.at);
    });
  }
  Repeat<kFlight>([&](auto v) HWY_ATTR { walk[v].lost = hn::Or(walk[v].lost, Solid(job, walk[v].word)); });
}

/// From the place p (half a voxel added) to the plane point, in voxels: facet or centre of the surface voxel.
HWY_INLINE Triple WayToPlane(const PackedJob& job, const Place& p, const Place& last) {
  const Place voxel = VoxelOf(last);
  const VI offset = Offset(job, voxel), one = hn::Set(kI, 1), half = hn::Set(kI, kHalf);
  VI exposed = hn::Zero(kI);
  const auto facet = [&](std::int32_t step) HWY_ATTR {
    const VI up = hn::IfThenElseZero(hn::Not(Solid(job, WordAt(job, hn::Add(offset, hn::Set(kI, step))))), one);
    const VI down = hn::IfThenElseZero(hn::Not(Solid(job, WordAt(job, hn::Sub(offset, hn::Set(kI, step))))), one);
    exposed = hn::Add(exposed, hn::Add(up, down));
    return hn::ShiftLeft<kFractionBits - 1>(hn::Sub(up, down));
  };
  const Place side{facet(1), facet(job.row), facet(job.slab)};
  const MI alone = hn::Eq(exposed, one);
  const auto part = [&](VI centre, VI shift, VI from) HWY_ATTR {
    const VI to = hn::Add(hn::Add(hn::ShiftLeft<kFractionBits>(centre), half), hn::IfThenElseZero(alone, shift));
    return hn::Mul(hn::ConvertTo(kF, hn::Sub(to, from)), hn::Set(kF, 1.0f / kVoxel));
  };
  return {part(voxel.x, side.x, p.x), part(voxel.y, side.y, p.y), part(voxel.z, side.z, p.z)};
}

/// Positions, forces, torques and normals of a vector's contacts, in double, into the sums. `at` is the vector's place in the batch.
HWY_INLINE void AddUp(const PackedJob& job, int at, const TouchQueue& queue, PackedPlanes& planes, PackedSums& sums) {
  for (int lane = at; lane < at + kLanes; lane += static_cast<int>(hn::Lanes(kD))) {
    VD index[3], n[3], arm[3], push[3];
    const std::int32_t* const places[3] = {queue.x + lane, queue.y + lane, queue.z + lane};
    const VD back = hn::Set(kD, -static_cast<double>(kHalf)), scale = hn::Set(kD, 1.0 / kVoxel);
    const VD depth = hn::PromoteTo(kD, hn::LoadU(DFofD(), planes.depth + lane));
    Repeat<3>([&](auto a) HWY_ATTR {
      index[a] = hn::Mul(hn::Add(hn::PromoteTo(kD, hn::LoadU(DIofD(), places[a])), back), scale);
      n[a] = hn::PromoteTo(kD, hn::LoadU(DFofD(), planes.normal[a] + lane));
    });
    Repeat<3>([&](auto a) HWY_ATTR {
      const auto& m = job.world_from_index[a];
      const VD turned = hn::Add(hn::Add(hn::Mul(hn::Set(kD, m[0]), index[0]), hn::Mul(hn::Set(kD, m[1]), index[1])),
                                hn::Mul(hn::Set(kD, m[2]), index[2]));
      const VD position = hn::Add(turned, hn::Set(kD, m[3]));
      hn::StoreU(position, kD, planes.position[a] + lane);
      arm[a] = hn::Sub(position, hn::Set(kD, job.origin[a]));
      push[a] = hn::Mul(n[a], depth);
    });
    // Lanes that lost their way, and padding, have depth 0.
    const auto pushed = hn::Gt(depth, hn::Zero(kD));
    int which = 0;
    const auto add = [&](VD value) HWY_ATTR {
      double* sum = sums.part[which++] + lane % kSums;
      hn::StoreU(hn::Add(hn::LoadU(kD, sum), hn::IfThenElseZero(pushed, value)), kD, sum);
    };
    Repeat<3>([&](auto a) HWY_ATTR { add(push[a]); });
    Repeat<3>([&](auto a) HWY_ATTR {
      constexpr int b = (a + 1) % 3, c = (a + 2) % 3;
      add(hn::Sub(hn::Mul(arm[b], push[c]), hn::Mul(arm[c], push[b])));
    });
    Repeat<3>([&](auto a) HWY_ATTR { Repeat<3 - a>([&](auto b) HWY_ATTR { add(hn::Mul(n[a], n[a + b])); }); });
  }
}

/// Walks `count` queued points from `first` on, one flight of vectors. @returns flags.
HWY_INLINE std::uint32_t WalkFlight(const PackedJob& job, int first, int count, const TouchQueue& queue, PackedPlanes& planes,
                                    PackedSums& sums) {
  Place place[kFlight], step[kFlight];
  Triple tool_vector[kFlight];
  MI live[kFlight];
  Walk walk[kFlight];
  Repeat<kFlight>([&](auto v) HWY_ATTR {
    const int at = first + v * kLanes;
    live[v] = hn::FirstN(kI, static_cast<std::size_t>(std::clamp(count - at, 0, kLanes)));
    // Lanes past the end of the queue walk nowhere, but must stand in the window.
    const auto stand = [&](const std::int32_t* list)
                           HWY_ATTR { return hn::IfThenElse(live[v], hn::Load(kI, list + at), hn::Set(kI, kVoxel)); };
    place[v] = {stand(queue.x), stand(queue.y), stand(queue.z)};
    tool_vector[v] = {hn::Load(kF, queue.inward[0] + at), hn::Load(kF, queue.inward[1] + at), hn::Load(kF, queue.inward[2] + at)};
    step[v] = StepAlong(Times(job.steps_from_tool, tool_vector[v]), static_cast<float>(kVoxel));
    walk[v].word = hn::Load(kI, queue.word + at);
    walk[v].at = place[v];
    const VI corner = hn::ShiftRight<kPointBits>(hn::Load(kI, queue.tag + at));
    const MI moved = hn::And(hn::Gt(corner, hn::Zero(kI)), live[v]);
    if (!hn::AllFalse(kI, moved)) {
      const VI bits = hn::Sub(corner, hn::Set(kI, 1)), one = hn::Set(kI, 1), half = hn::Set(kI, kHalf);
      const auto centre = [&](VI x, VI bit) HWY_ATTR {
        const VI voxel = hn::Add(hn::ShiftRight<kFractionBits>(hn::Sub(x, half)), hn::And(bit, one));
        return hn::IfThenElse(moved, hn::Add(hn::ShiftLeft<kFractionBits>(voxel), half), x);
      };
      walk[v].at = {centre(place[v].x, bits), centre(place[v].y, hn::ShiftRight<1>(bits)), centre(place[v].z, hn::ShiftRight<2>(bits))};
    }
  });
  March(job, step, live, walk);
  Ascend(job, walk);
  std::uint32_t flags = 0;
  Repeat<kFlight>([&](auto v) HWY_ATTR {
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
    hn::Store(way.x, kF, planes.way[0] + at);
    hn::Store(way.y, kF, planes.way[1] + at);
    hn::Store(way.z, kF, planes.way[2] + at);
    hn::Store(normal.x, kF, planes.normal[0] + at);
    hn::Store(normal.y, kF, planes.normal[1] + at);
    hn::Store(normal.z, kF, planes.normal[2] + at);
    hn::Store(hn::VecFromMask(kI, found), kI, planes.found + at);
    AddUp(job, at, queue, planes, sums);
  });
  return flags;
}

/// Walks the first `count` of the queue and appends their contacts.
std::uint32_t WalkBatch(const PackedJob& job, int count, const TouchQueue& queue, PackedSums& sums, std::vector<Contact>& contacts) {
  PackedPlanes planes;
  std::uint32_t flags = 0;
  for (int first = 0; first < count; first += kFlight * kLanes) flags |= WalkFlight(job, first, count, queue, planes, sums);
  for (int n = 0; n < count; ++n) {
    if (planes.found[n] == 0) continue;
    const Vec3 position(planes.position[0][n], planes.position[1][n], planes.position[2][n]);
    const Vec3 way(planes.way[0][n], planes.way[1][n], planes.way[2][n]),
        normal(planes.normal[0][n], planes.normal[1][n], planes.normal[2][n]);
    contacts.push_back({job.point[queue.tag[n] & ((1 << kPointBits) - 1)], position, position + way, normal, planes.depth[n]});
  }
  return flags;
}

std::uint32_t EvaluateAll(const PackedJob& job, PackedSums& sums, std::vector<Contact>& contacts) {
  TouchQueue queue;
  for (std::int32_t* list : {queue.x, queue.y, queue.z, queue.word, queue.tag}) std::fill_n(list, TouchQueue::kRoom, 0);
  for (auto& axis : queue.inward) std::fill_n(axis, TouchQueue::kRoom, 0.0f);
  std::uint32_t flags = 0;
  for (int n = 0; n < job.count; n += kLanes) {
    flags |= QueueTouching(job, n, queue);
    if (queue.size < kBatch) continue;
    flags |= WalkBatch(job, kBatch, queue, sums, contacts);
    const int rest = queue.size - kBatch;
    for (std::int32_t* list : {queue.x, queue.y, queue.z, queue.word, queue.tag}) std::copy_n(list + kBatch, rest, list);
    for (auto& axis : queue.inward) std::copy_n(axis + kBatch, rest, axis);
    queue.size = rest;
  }
  if (queue.size > 0) flags |= WalkBatch(job, queue.size, queue, sums, contacts);
  return flags;
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {

HWY_EXPORT(EvaluateAll);

namespace {

std::uint32_t spread_bits(std::uint32_t x) noexcept {
  std::uint32_t out = 0;
  for (std::uint32_t bit = 0; bit < 10; ++bit) out |= ((x >> bit) & 1u) << (3 * bit);
  return out;
}

template <class T>
void set_rows(T (&rows)[3][3], const Mat3& m) noexcept {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rows[r][c] = static_cast<T>(m[c][r]);
}
void set_rows(double (&rows)[3][4], const Affine& map) noexcept {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rows[r][c] = map.linear[c][r];
    rows[r][3] = map.offset[r];
  }
}

/// Adds the upper half to the lower until one is left.
double total(double (&part)[kSums]) noexcept {
  for (int half = kSums / 2; half > 0; half /= 2)
    for (int n = 0; n < half; ++n) part[n] += part[n + half];
  return part[0];
}

}  // namespace

std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& positions) {
  Vec3 lo(0.0), hi(0.0);
  if (!positions.empty()) lo = hi = positions.front();
  for (const Vec3& p : positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const Vec3 size = hi - lo;
  const double longest = std::max({size.x, size.y, size.z}), cells = longest > 0.0 ? 1023.0 / longest : 0.0;
  std::vector<std::uint32_t> code;
  for (const Vec3& p : positions) {
    const Vec3 cell = (p - lo) * cells;
    code.push_back(spread_bits(static_cast<std::uint32_t>(cell.x)) | spread_bits(static_cast<std::uint32_t>(cell.y)) << 1 |
                   spread_bits(static_cast<std::uint32_t>(cell.z)) << 2);
  }
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t n) { return code[n]; });
  return order;
}

PackedPlane::PackedPlane(const PointShell& shell) : count_(shell.size()), point_(morton_order(shell.positions)) {
  const std::size_t padded = (count_ + kPlanePad - 1) / kPlanePad * kPlanePad;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    position_[axis].assign(padded, 0.0);
    inward_[axis].assign(padded, 0.0f);
    for (std::size_t n = 0; n < count_; ++n) {
      position_[axis][n] = shell.positions[point_[n]][axis];
      inward_[axis][n] = static_cast<float>(shell.inward_normals[point_[n]][axis]);
    }
  }
}

void PackedPlane::evaluate(const GradientPlaneConfig& config, const ContactView& bone, const Pose& world_from_tool,
                           ContactResult& out) const noexcept {
  static_assert(kMaxShellPoints < (std::size_t{1} << kPointBits));
  const Affine tool = Affine::from_pose(world_from_tool);
  const Affine from_corner{Mat3(1.0), Vec3(bone.box().lo)};
  const Affine world_from_index = bone.world_from_index() * from_corner;
  Affine index_from_tool = bone.index_from_world() * tool;
  index_from_tool.offset -= Vec3(bone.box().lo);
  const Vec3i size = bone.box().size();
  PackedJob job{.words = reinterpret_cast<const std::int32_t*>(bone.words()),
                .size = {size.x, size.y, size.z},
                .row = size.x,
                .slab = size.x * size.y,
                .count = static_cast<int>(count_),
                .solid = config.paper_mode ? 1 : static_cast<std::int32_t>(kWordSolid),
                .trilinear = !config.paper_mode,
                .max_march = config.max_march,
                .max_ascent = config.max_ascent,
                .point = point_.data()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    job.position[axis] = position_[axis].data();
    job.inward[axis] = inward_[axis].data();
    job.origin[axis] = world_from_tool.translation[axis];
  }
  set_rows(job.index_from_tool, index_from_tool);
  set_rows(job.world_from_index, world_from_index);
  set_rows(job.steps_from_tool, index_from_tool.linear);
  set_rows(job.way_from_index, world_from_index.linear);
  set_rows(job.normal_from_gradient, glm::transpose(bone.index_from_world().linear));
  set_rows(job.world_from_tool, tool.linear);

  PackedSums sums;
  out.flags |= HWY_DYNAMIC_DISPATCH(EvaluateAll)(job, sums, out.contacts);
  if (out.contacts.empty()) return;
  // The average over colliding points, d = 0 included; eq. 2.
  const double share = config.stiffness / static_cast<double>(out.contacts.size());
  double sum[12];
  for (int n = 0; n < 12; ++n) sum[n] = total(sums.part[n]) * share;
  out.wrench.force = {sum[0], sum[1], sum[2]};
  out.wrench.torque = {sum[3], sum[4], sum[5]};
  out.force_gradient = -Mat3(sum[6], sum[7], sum[8], sum[7], sum[9], sum[10], sum[8], sum[10], sum[11]);
}

}  // namespace burrhole
#endif
