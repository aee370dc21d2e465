// Vectors compute, once, the values that do not depend on the mean; a scalar loop sums them in order. The bits are those of the scalar loop
//   in tests/core/contact/conforming_normal_test.cpp.
#include "core/contact/conforming_normal.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/conforming_normal.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/base/compact_lanes-inl.h"

#ifndef BURRHOLE_HOLLOW_DIRECTION_ONCE
#define BURRHOLE_HOLLOW_DIRECTION_ONCE
namespace burrhole {

// [voxel edges] a point counts if its gap exceeds that of the contact point by less than this: the search distance of the probe. With half
// of it the error of the direction in a dent is twice as large.
inline constexpr double kNearly = 0.6;
inline constexpr double kReach = 8.0;  // [voxel edges] from the contact point: a larger patch may include another place
inline constexpr double kAlike = 0.3;  // [-] cosine of 73 degrees off the mean: a wall beside a floor is another face
// [1/voxel edge] convex curvature at which a point has half weight: a radius of 33 voxels; the noise of normals is a quarter of it. Across
// an edge the patch would be centred on the edge and not on the contact.
inline constexpr double kBulge = 0.03;
// [-] fraction of the patch, by weight, that is not convex: from the first on the mean has weight, from the second on all weight.
inline constexpr double kLeastShare = 0.8, kWholeShare = 0.95;
inline constexpr int kPasses = 3;                   // the window of directions is centred on the mean, which is not known at first
inline constexpr std::size_t kAsked = 2000;         // largest number of hits is twice this: bounds the time
inline constexpr std::size_t kConformingLanes = 8;  // at most

/// The hits to use.
struct ConformingJob {
  const ProbeHits* hits;
  HitRange near;
  std::size_t every;
  const TouchPoint* touch;
  const Mat3* bone_from_tool;
  double edge;
};

/// The hits that count, in order. 160 kB on the stack, written only as far as there are points.
struct ConformingPatch {
  static constexpr std::size_t kRoom = 2 * kAsked + 2 * kConformingLanes;
  alignas(64) double normal[3][kRoom], nearness[kRoom], level[kRoom];  // weights 0..1: proximity to contact, and flatness
  std::size_t count = 0;
};

struct PatchSum {
  Vec3 normal{0.0};
  double all = 0.0, level = 0.0;  // sums of weights: of all points, and of those that are not convex
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, kConformingLanes>;
using Floats = hn::Rebind<float, Doubles>;
using Vd = hn::Vec<Doubles>;

struct Vd3 {
  Vd x, y, z;
};
HWY_INLINE Vd3 same(const Vec3& v) {
  const Doubles d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE Vd3 sub(const Vd3& a, const Vd3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE Vd dot(const Vd3& a, const Vd3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE Vd promoted(const float* from) { return hn::PromoteTo(Doubles(), hn::LoadU(Floats(), from)); }

/// Distance, position and normal of a vector of hits from the n-th on.
struct AskedHits {
  HWY_INLINE AskedHits(const ConformingJob& job, std::size_t n, std::size_t asked) {
    const ProbeHits& hits = *job.hits;
    const float* const arrays[7] = {hits.distance.data(), hits.x.data(),  hits.y.data(), hits.z.data(),
                                    hits.nx.data(),       hits.ny.data(), hits.nz.data()};
    const std::size_t first = job.near.first + n * job.every;
    if (job.every == 1 && n + hn::Lanes(Doubles()) <= asked) {
      for (std::size_t a = 0; a < 7; ++a) value[a] = promoted(arrays[a] + first);
      return;
    }
    for (std::size_t a = 0; a < 7; ++a) {
      HWY_ALIGN float taken[kConformingLanes];
      for (std::size_t lane = 0; lane < hn::Lanes(Doubles()); ++lane)
        taken[lane] = arrays[a][first + job.every * std::min(lane, asked - 1 - n)];  // lanes beyond the last repeat it
      value[a] = promoted(taken);
    }
  }
  Vd value[7];
};

void FindPatch(const ConformingJob& job, ConformingPatch& patch) {
  const Doubles d;
  const Vd edge = hn::Set(d, job.edge), one = hn::Set(d, 1.0), zero = hn::Zero(d);
  const Vd3 touched = same(job.touch->place), touch_normal = same(job.touch->normal);
  const Mat3& m = *job.bone_from_tool;
  const std::size_t asked = (job.near.last - job.near.first + job.every - 1) / job.every;
  std::size_t count = 0;
  for (std::size_t n = 0; n < asked; n += hn::Lanes(d)) {
    const AskedHits at(job, n, asked);
    const Vd beyond = hn::Abs(hn::Sub(at.value[0], hn::Set(d, job.touch->gap)));
    const Vd3 off = sub({at.value[1], at.value[2], at.value[3]}, touched), normal{at.value[4], at.value[5], at.value[6]};
    const auto turned = [&](std::size_t r) HWY_ATTR { return hn::Div(dot(same({m[0][r], m[1][r], m[2][r]}), off), edge); };
    const Vd3 way{turned(0), turned(1), turned(2)};
    const Vd way2 = dot(way, way);
    auto counts = hn::And(hn::Lt(beyond, hn::Set(d, kNearly)), hn::Lt(way2, hn::Set(d, kReach * kReach)));
    counts = hn::And(counts, hn::FirstN(d, asked - n));
    if (hn::AllFalse(d, counts)) continue;
    // Rate at which normals converge; below half a voxel of distance it would be noise.
    const Vd bend = hn::Div(hn::Neg(dot(sub(normal, touch_normal), way)), hn::Add(way2, hn::Set(d, 0.25)));
    const Vd level = hn::Clamp(hn::Add(hn::Set(d, 1.5), hn::Div(bend, hn::Set(d, kBulge))), zero, one);
    const Vd nearness = hn::Sub(one, hn::Div(beyond, hn::Set(d, kNearly)));
    const CompactLanes<Doubles> lanes(d, counts);
    const auto keep = [&](Vd v, double* list) HWY_ATTR { lanes.store(d, v, list + count); };
    keep(nearness, patch.nearness);
    keep(level, patch.level);
    keep(normal.x, patch.normal[0]);
    keep(normal.y, patch.normal[1]);
    keep(normal.z, patch.normal[2]);
    count += lanes.count();
  }
  patch.count = count;
  // Values that a vector reads beyond the last.
  for (double* list : {patch.nearness, patch.level, patch.normal[0], patch.normal[1], patch.normal[2]})
    std::fill_n(list + count, kConformingLanes, 0.0);
}

void SumPatch(const ConformingPatch& patch, const Vec3& about, PatchSum& sum) {
  const Doubles d;
  const Vd3 mean = same(about);
  constexpr std::size_t kBlock = 64;
  alignas(64) double terms[5][kBlock];  // weight, level, normal
  for (std::size_t first = 0; first < patch.count; first += kBlock) {
    const std::size_t count = std::min(kBlock, patch.count - first);
    for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
      const std::size_t from = first + n;
      const Vd3 normal{hn::LoadU(d, patch.normal[0] + from), hn::LoadU(d, patch.normal[1] + from), hn::LoadU(d, patch.normal[2] + from)};
      const Vd alike = hn::Div(hn::Sub(dot(normal, mean), hn::Set(d, kAlike)), hn::Set(d, 1.0 - kAlike));
      const Vd weight = hn::IfThenElseZero(hn::Gt(alike, hn::Zero(d)), hn::Mul(hn::LoadU(d, patch.nearness + from), alike));
      const Vd level = hn::Mul(weight, hn::LoadU(d, patch.level + from));
      hn::Store(weight, d, terms[0] + n);
      hn::Store(level, d, terms[1] + n);
      hn::Store(hn::Mul(normal.x, level), d, terms[2] + n);
      hn::Store(hn::Mul(normal.y, level), d, terms[3] + n);
      hn::Store(hn::Mul(normal.z, level), d, terms[4] + n);
    }
    // Hits of other faces add 0, which does not change the sums.
    for (std::size_t n = 0; n < count; ++n) {
      sum.all += terms[0][n];
      sum.level += terms[1][n];
      sum.normal += Vec3(terms[2][n], terms[3][n], terms[4][n]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
namespace {

HWY_EXPORT(FindPatch);
HWY_EXPORT(SumPatch);

}  // namespace

Vec3 conforming_normal(const ProbeHits& hits, const HitRange& near, const TouchPoint& touch, const Mat3& bone_from_tool,
                       double edge) noexcept {
  if (near.first >= near.last) return touch.steadied;
  ConformingPatch patch;
  const std::size_t every = std::max<std::size_t>(1, (near.last - near.first) / kAsked);
  HWY_DYNAMIC_DISPATCH(FindPatch)({&hits, near, every, &touch, &bone_from_tool, edge}, patch);
  Vec3 mean = touch.normal;
  double share = 0.0;
  for (int pass = 0; pass < kPasses; ++pass) {
    PatchSum sum;
    HWY_DYNAMIC_DISPATCH(SumPatch)(patch, mean, sum);
    const double length = glm::length(sum.normal);
    if (!(length > 0.0)) return touch.steadied;
    mean = sum.normal / length;
    share = std::clamp((sum.level / sum.all - kLeastShare) / (kWholeShare - kLeastShare), 0.0, 1.0);
  }
  return glm::normalize(touch.steadied * (1.0 - share) + mean * share);
}

}  // namespace burrhole
#endif
