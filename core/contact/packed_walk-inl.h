// core/contact/packed_walk-inl.h: second stage of packed_plane: from a touching point to the surface voxel and its plane point.
// Included by SIMD kernels only, once per target (hence no #pragma once).
#if defined(BURRHOLE_PACKED_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PACKED_WALK_INL_H
#undef BURRHOLE_PACKED_WALK_INL_H
#else
#define BURRHOLE_PACKED_WALK_INL_H
#endif

#include <hwy/highway.h>

#include "core/contact/packed_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

struct Walk {
  Place at, last;  // last: inside the last solid voxel
  VI word, surface;
  MI lost;
};

/// Walks along the tool vector, by leaps, to the first voxel with a gradient or outside bone.
HWY_INLINE void March(const PackedJob& job, const Place (&step)[kFlight], const MI (&live)[kFlight], Walk (&walk)[kFlight]) {
  VI left[kFlight];
  Repeat<kFlight>([&](auto v) BH_LANES { left[v] = hn::IfThenElseZero(live[v], hn::Set(kI, job.max_march)); });
  for (bool going = true; going;) {
    going = false;
    Repeat<kFlight>([&](auto v) BH_LANES {
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
  Repeat<kFlight>([&](auto v) BH_LANES {
    // The leap ended outside bone: the previous step was the last inside.
    Walk& w = walk[v];
    const MI beyond = hn::AndNot(Solid(job, w.word), live[v]);
    w.last = {hn::Sub(w.at.x, hn::IfThenElseZero(beyond, step[v].x)), hn::Sub(w.at.y, hn::IfThenElseZero(beyond, step[v].y)),
              hn::Sub(w.at.z, hn::IfThenElseZero(beyond, step[v].z))};
    w.surface = hn::AllFalse(kI, beyond) ? w.word : WordOf(job, w.last);
    w.lost = hn::Or(hn::And(Still(w.word), Solid(job, w.word)), hn::Not(live[v]));
  });
}

/// Walks down the gradient to the last solid voxel before an empty one.
HWY_INLINE void Ascend(const PackedJob& job, Walk (&walk)[kFlight]) {
  Place step[kFlight];
  Repeat<kFlight>([&](auto v) BH_LANES { step[v] = {hn::Zero(kI), hn::Zero(kI), hn::Zero(kI)}; });
  bool going = true;
  for (int n = 0; n < job.max_ascent && going; ++n) {
    going = false;
    Repeat<kFlight>([&](auto v) BH_LANES {
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
  Repeat<kFlight>([&](auto v) BH_LANES { walk[v].lost = hn::Or(walk[v].lost, Solid(job, walk[v].word)); });
}

/// From the position p (plus half a voxel) to the plane point, in voxels: facet or centre of the surface voxel.
HWY_INLINE Triple WayToPlane(const PackedJob& job, const Place& p, const Place& last) {
  const Place voxel = VoxelOf(last);
  const VI offset = Offset(job, voxel), one = hn::Set(kI, 1), half = hn::Set(kI, kHalf);
  VI exposed = hn::Zero(kI);
  const auto facet = [&](std::int32_t step) BH_LANES {
    const VI up = hn::IfThenElseZero(hn::Not(Solid(job, WordAt(job, hn::Add(offset, hn::Set(kI, step))))), one);
    const VI down = hn::IfThenElseZero(hn::Not(Solid(job, WordAt(job, hn::Sub(offset, hn::Set(kI, step))))), one);
    exposed = hn::Add(exposed, hn::Add(up, down));
    return hn::ShiftLeft<kFractionBits - 1>(hn::Sub(up, down));
  };
  const Place side{facet(1), facet(job.row), facet(job.slab)};
  const MI alone = hn::Eq(exposed, one);
  const auto part = [&](VI centre, VI shift, VI from) BH_LANES {
    const VI to = hn::Add(hn::Add(hn::ShiftLeft<kFractionBits>(centre), half), hn::IfThenElseZero(alone, shift));
    return hn::Mul(hn::ConvertTo(kF, hn::Sub(to, from)), hn::Set(kF, 1.0f / kVoxel));
  };
  return {part(voxel.x, side.x, p.x), part(voxel.y, side.y, p.y), part(voxel.z, side.z, p.z)};
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
