/// tests/volumes/phantom/phantom_support.h: what the phantom tests share: one spec of each shape, slow twins, seeded random points.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "tests/support/plain_trilinear.h"
#include "volumes/phantom/phantom.h"

namespace burrhole::phantom_test {

struct Case {
  std::string name;
  PhantomSpec spec;
};

/// A small spec of every shape (oblique plate, acute and obtuse wedge, patch with and without rim): 16 x 16 x 12 mm at 0.25 mm.
inline std::vector<Case> every_shape() {
  PhantomSpec base;
  base.extent = Vec3(0.016, 0.016, 0.012);
  base.thickness = 0.006;
  const auto with = [&](PhantomKind kind, auto change) {
    PhantomSpec spec = base;
    spec.kind = kind;
    change(spec);
    return spec;
  };
  return {
      {"skull_patch", with(PhantomKind::skull_patch, [](PhantomSpec& s) { s.curvature = 0.03; })},
      {"skull_patch with rim", with(PhantomKind::skull_patch, [](PhantomSpec& s) { s.curvature = 0.03, s.rim_radius = 0.006; })},
      {"block", with(PhantomKind::block, [](PhantomSpec& s) { s.block_size = Vec3(0.010, 0.008, 0.005); })},
      {"plate", with(PhantomKind::plate, [](PhantomSpec&) {})},
      {"oblique plate", with(PhantomKind::plate, [](PhantomSpec& s) { s.plate_normal = Vec3(1.0, -2.0, 3.0); })},
      {"sphere", with(PhantomKind::sphere, [](PhantomSpec& s) { s.sphere_radius = 0.0045; })},
      {"capsule", with(PhantomKind::capsule, [](PhantomSpec& s) { s.sphere_radius = 0.0035, s.capsule_length = 0.011; })},
      {"acute wedge", with(PhantomKind::wedge, [](PhantomSpec& s) { s.wedge_angle = 50.0 * kDegree; })},
      {"obtuse wedge", with(PhantomKind::wedge, [](PhantomSpec& s) { s.wedge_angle = 140.0 * kDegree; })},
      {"pit", with(PhantomKind::pit, [](PhantomSpec&) {})},
  };
}

/// Relative agreement. (doctest's Approx adds 1 to the scale, which at lengths of millimetres in m accepts anything.)
inline bool agree(double a, double b, double relative) { return std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)); }

/// Depth [m] of a point inside the diploe's own borders; negative in the tables.
inline double into_diploe(const PhantomSpec& spec, const Vec3& p) {
  const double depth = spec.curvature - glm::length(p + Vec3(0.0, 0.0, spec.curvature));
  return std::min(depth - spec.outer_table, spec.thickness - spec.inner_table - depth);
}

/// Point n of a seeded stream, uniform in the box.
inline Vec3 random_point(std::uint64_t seed, std::uint64_t n, const Vec3& lo, const Vec3& hi) {
  return lo + (hi - lo) * Vec3(uniform01(seed, 3 * n), uniform01(seed, 3 * n + 1), uniform01(seed, 3 * n + 2));
}

/// Direction n of a seeded stream, uniform on the sphere (rejection from the cube).
inline Vec3 random_direction(std::uint64_t seed, std::uint64_t n) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    const Vec3 v = random_point(seed + 7919 * attempt, n, Vec3(-1.0), Vec3(1.0));
    const double length = glm::length(v);
    if (length > 0.1 && length <= 1.0) return v / length;
  }
}

/// Trilinear occupancy at a point of the bone frame; cells beyond the outermost centres take the nearest. Slow plain twin.
inline double trilinear(const DenseBone& bone, const std::vector<float>& field, const Vec3& p_bone) {
  const Vec3 p = glm::clamp(bone.bone_from_index.inverse() * p_bone, Vec3(0.0), Vec3(bone.dims) - 1.0);
  const VoxelBox box{Vec3i(0), bone.dims};
  return test::plain_trilinear(p, [&](const Vec3i& v) { return field[box.offset_of(glm::min(v, bone.dims - 1))]; });
}

/// Largest |true distance| [m] of the field's 0.5 level, found along `rays` random lines through the grid (0.1 voxel marching, bisection).
/// `counts(p)` says which places to judge.
template <class Counts>
double worst_surface_error(const Phantom& phantom, int rays, std::uint64_t seed, Counts&& counts) {
  const double pitch = phantom.spec.pitch;
  const Vec3 lo = phantom.truth.box_lo() + pitch, hi = phantom.truth.box_hi() - pitch;
  const auto above = [&](const Vec3& p) { return trilinear(phantom.bone, phantom.bone.occupancy, p) - 0.5; };
  double worst = 0.0;
  for (int n = 0; n < rays; ++n) {
    const Vec3 from = random_point(seed, 2 * static_cast<std::uint64_t>(n), lo, hi);
    const Vec3 to = random_point(seed, 2 * static_cast<std::uint64_t>(n) + 1, lo, hi);
    const int steps = static_cast<int>(glm::length(to - from) / (0.1 * pitch)) + 1;
    double before = above(from);
    for (int s = 1; s <= steps; ++s) {
      double a = double(s - 1) / steps, b = double(s) / steps;
      const double now = above(from + b * (to - from));
      if ((before > 0.0) != (now > 0.0)) {
        for (int halving = 0; halving < 40; ++halving) {
          const double mid = 0.5 * (a + b);
          ((above(from + mid * (to - from)) > 0.0) == (before > 0.0) ? a : b) = mid;
        }
        const Vec3 p = from + a * (to - from);
        if (counts(p)) worst = std::max(worst, std::abs(phantom.truth.signed_distance(p)));
      }
      before = now;
    }
  }
  return worst;
}

}  // namespace burrhole::phantom_test
