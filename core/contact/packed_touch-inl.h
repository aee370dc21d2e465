// core/contact/packed_touch-inl.h: first stage of packed_plane: transforms points into the window and queues those that touch.
// Included by SIMD kernels only, once per target (hence no #pragma once).
#if defined(BURRHOLE_PACKED_TOUCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PACKED_TOUCH_INL_H
#undef BURRHOLE_PACKED_TOUCH_INL_H
#else
#define BURRHOLE_PACKED_TOUCH_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "core/base/trilinear-inl.h"
#include "core/contact/packed_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// @returns whether the trilinear density at each position is at or above the 0.5 level. Where the voxel of the position is below it,
/// `word` becomes the word of the densest corner (the first of equals, i fastest) and `corner` 1 + its number.
HWY_INLINE MI Trilinear(const PackedJob& job, const Place& p, VI& word, VI& corner) {
  const VI half = hn::Set(kI, kHalf), fraction = hn::Set(kI, kVoxel - 1);
  const Place low{hn::Sub(p.x, half), hn::Sub(p.y, half), hn::Sub(p.z, half)};
  const VI first = Offset(job, VoxelOf(low));
  const auto share = [&](VI x) BH_LANES { return hn::Mul(hn::ConvertTo(kF, hn::And(x, fraction)), hn::Set(kF, 1.0f / kVoxel)); };
  const VF tx = share(low.x), ty = share(low.y), tz = share(low.z);
  VI words[8];
  Repeat<8>([&](auto n)
                BH_LANES { words[n] = WordAt(job, hn::Add(first, hn::Set(kI, (n & 1) + (n / 2 & 1) * job.row + n / 4 * job.slab))); });
  VI best = words[0], best_density = Density(words[0]), best_corner = hn::Set(kI, 1);
  Repeat<7>([&](auto m) BH_LANES {
    const VI density = Density(words[m + 1]);
    const MI denser = hn::Gt(density, best_density);
    best = hn::IfThenElse(denser, words[m + 1], best);
    best_density = hn::Max(density, best_density);
    best_corner = hn::IfThenElse(denser, hn::Set(kI, m + 2), best_corner);
  });
  const VF density = trilinear(tx, ty, tz, [&](unsigned n) BH_LANES { return hn::ConvertTo(kF, Density(words[n])); });
  const MI own = Solid(job, word);
  word = hn::IfThenElse(own, word, best);
  corner = hn::IfThenElse(own, hn::Zero(kI), best_corner);
  return hn::RebindMask(kI, hn::Ge(density, hn::Set(kF, kWordLevel)));
}

/// Computes the positions of one vector of points, n the first. @returns where they are known.
HWY_INLINE MI PlacePoints(const PackedJob& job, int n, Place& p) {
  const VD scale = hn::Set(kD, static_cast<double>(kVoxel)), shift = hn::Set(kD, kHalf + 0.5);
  const auto half_vector = [&](const double(&m)[4], int first) BH_LANES {
    const VD x = hn::LoadU(kD, job.position[0] + first), y = hn::LoadU(kD, job.position[1] + first),
             z = hn::LoadU(kD, job.position[2] + first);
    const VD sum = hn::Add(hn::Add(hn::Mul(hn::Set(kD, m[0]), x), hn::Mul(hn::Set(kD, m[1]), y)), hn::Mul(hn::Set(kD, m[2]), z));
    const VD index = hn::Add(sum, hn::Set(kD, m[3]));
    // Beyond the range of an index, or NaN: outside.
    const auto sane = hn::And(hn::Gt(index, hn::Set(kD, -1.0)), hn::Lt(index, hn::Set(kD, 2.0 * kMaxWindowEdge)));
    const VD bounded = hn::IfThenElse(sane, index, hn::Set(kD, -1.0));
    return hn::DemoteTo(DIofD(), hn::Add(hn::Mul(bounded, scale), shift));
  };
#if HWY_TARGET == HWY_SCALAR
  const auto along = [&](const double(&m)[4]) { return half_vector(m, n); };
#else
  const auto along = [&](const double(&m)[4]) BH_LANES { return hn::Combine(kI, half_vector(m, n + kLanes / 2), half_vector(m, n)); };
#endif
  const auto known = [&](VI x, int size)
                         BH_LANES { return hn::And(hn::Gt(x, hn::Set(kI, kVoxel - 1)), hn::Lt(x, hn::Set(kI, (size - 1) * kVoxel))); };
  const VI x = along(job.index_from_tool[0]), y = along(job.index_from_tool[1]), z = along(job.index_from_tool[2]);
  const MI inside = hn::And(known(x, job.size[0]), hn::And(known(y, job.size[1]), known(z, job.size[2])));
  const VI somewhere = hn::Set(kI, kVoxel);
  p = {hn::IfThenElse(inside, x, somewhere), hn::IfThenElse(inside, y, somewhere), hn::IfThenElse(inside, z, somewhere)};
  return inside;
}

/// Queues the touching points of one vector; `numbers` is 0, 1, 2 and so on. @returns flags.
HWY_INLINE std::uint32_t QueueTouching(const PackedJob& job, int n, VI numbers, TouchQueue& queue) {
  Place p;
  const MI inside = PlacePoints(job, n, p);
  const MI real = hn::FirstN(kI, static_cast<std::size_t>(std::min(kLanes, job.count - n)));
  const std::uint32_t flags = hn::AllTrue(kI, hn::Or(inside, hn::Not(real))) ? 0u : static_cast<std::uint32_t>(kContactOutsideWindow);
  const MI asked = hn::And(inside, real);
  VI word = WordOf(job, p), corner = hn::Zero(kI);
  MI touching = hn::And(asked, Solid(job, word));
  if (job.trilinear) {
    // A leap of two or more: the whole cell is on one side of the level, and so is the trilinear density.
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
  const VI tag = hn::Or(hn::Add(numbers, hn::Set(kI, n)), hn::ShiftLeft<kPointBits>(corner));
  // Stores whole vectors: elements beyond the end of the queue are overwritten by the next store, or masked.
  const int at = queue.size;
  const auto keep = [&](VI value, std::int32_t* list) BH_LANES { hn::StoreU(hn::Compress(value, touching), kI, list + at); };
  keep(p.x, queue.x);
  keep(p.y, queue.y);
  keep(p.z, queue.z);
  keep(word, queue.word);
  keep(tag, queue.tag);
  Repeat<3>([&](auto axis) BH_LANES {
    const VF inward = hn::LoadU(kF, job.inward[axis] + n);
    hn::StoreU(hn::Compress(inward, hn::RebindMask(kF, touching)), kF, queue.inward[axis] + at);
  });
  queue.size += static_cast<int>(hn::CountTrue(kI, touching));
  return flags;
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
