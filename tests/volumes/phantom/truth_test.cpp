// Closed forms against slow twins that know only what "inside" means.
#include "volumes/phantom/truth.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/volumes/phantom/phantom_support.h"

namespace burrhole {
namespace {

using namespace phantom_test;

/// Is p bone? Written from each shape's definition alone, without any distance: the independent half of every check here.
bool inside(const PhantomSpec& s, const Vec3& p) {
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  switch (s.kind) {
    case PhantomKind::head:  // no dense phantom: head_test.cpp
    case PhantomKind::skull_patch: {
      const double r = glm::length(p - Vec3(0.0, 0.0, -s.curvature));
      const bool in_rim = s.rim_radius <= 0.0 || (rho <= s.rim_radius && p.z >= -s.curvature);
      return r <= s.curvature && r >= s.curvature - s.thickness && in_rim;
    }
    case PhantomKind::block:
      return std::abs(p.x) <= 0.5 * s.block_size.x && std::abs(p.y) <= 0.5 * s.block_size.y && p.z <= 0.0 && p.z >= -s.block_size.z;
    case PhantomKind::plate: {
      const double height = glm::dot(p, s.plate_normal) / glm::length(s.plate_normal);
      return height <= 0.0 && height >= -s.thickness;
    }
    case PhantomKind::sphere:
      return glm::length(p + Vec3(0.0, 0.0, s.sphere_radius)) <= s.sphere_radius;
    case PhantomKind::wedge:
      return std::abs(p.x) <= -p.z * std::tan(0.5 * s.wedge_angle);
    case PhantomKind::pit:
      return p.z <= 0.0 && p.z >= -s.thickness && !(rho < s.hole_radius && p.z > -s.hole_depth);
    case PhantomKind::capsule: {  // a cylinder and a ball at each of its ends
      const double straight = 0.5 * s.capsule_length - s.sphere_radius, beyond = std::max(0.0, std::abs(p.x) - straight);
      const double height = p.z + s.sphere_radius;
      return beyond * beyond + p.y * p.y + height * height <= s.sphere_radius * s.sphere_radius;
    }
  }
  return false;
}

/// Points of the true surface within the box grown by `margin`, found by bisecting `inside` along a lattice of lines on the three axes.
std::vector<Vec3> surface_samples(const PhantomSpec& spec, const Vec3& lo, const Vec3& hi, double spacing) {
  std::vector<Vec3> found;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (double a = lo[u]; a <= hi[u]; a += spacing)
      for (double b = lo[v]; b <= hi[v]; b += spacing) {
        Vec3 p(0.0);
        p[u] = a, p[v] = b;
        const auto at = [&](double t) { return p[axis] = t, inside(spec, p); };
        for (double t = lo[axis]; t < hi[axis]; t += spacing) {
          if (at(t) == at(t + spacing)) continue;
          double x = t, y = t + spacing;
          const bool start = at(x);
          for (int n = 0; n < 40; ++n) (at(0.5 * (x + y)) == start ? x : y) = 0.5 * (x + y);
          at(x);
          found.push_back(p);
        }
      }
  }
  return found;
}

/// A box small enough that its points' nearest surface lies in the doubled box for every shape tested.
struct Probe {
  Vec3 lo{-0.007, -0.007, -0.007};
  Vec3 hi{0.007, 0.007, 0.003};
};

/// The largest disagreement of `distance` with the nearest of the samples, over random points.
template <class Distance>
double worst_distance_error(const PhantomSpec& spec, Distance&& distance) {
  const Probe probe;
  const std::vector<Vec3> surface = surface_samples(spec, probe.lo - 0.008, probe.hi + 0.008, 0.00024);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 120; ++n) {
    const Vec3 p = random_point(11, n, probe.lo, probe.hi);
    double best = 1.0;
    for (const Vec3& s : surface) best = std::min(best, glm::dot(s - p, s - p));
    best = std::sqrt(best);
    worst = std::max(worst, std::abs(distance(p) - (inside(spec, p) ? -best : best)));
  }
  return worst;
}

// Seen along the axis nearest to its normal (at most 54.7 degrees off) a face is sampled on a square lattice of 0.24 mm: in that projection
// the nearest sample is within 0.24 / sqrt(2) mm of any foot, on the face within sqrt(3) times that, and no nearer than the foot itself.
constexpr double kSampleTolerance = 0.24e-3 * 0.7072 * 1.7321;

TEST_CASE("truth: signed distance agrees with the nearest of brute-force surface samples for every shape") {
  for (const Case& c : every_shape()) {
    CAPTURE(c.name);
    const Truth truth(c.spec);
    CHECK(worst_distance_error(c.spec, [&](const Vec3& p) { return truth.signed_distance(p); }) < kSampleTolerance);
  }
}

TEST_CASE("truth: sabotage twin, a pit whose rim is taken as two endless planes fails the brute-force distance") {
  const Case pit = every_shape().back();
  const Truth truth(pit.spec);
  const auto broken = [&](const Vec3& p) {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    const double slab = std::max(p.z, -pit.spec.thickness - p.z);
    return std::max(slab, -std::max(rho - pit.spec.hole_radius, -pit.spec.hole_depth - p.z));  // a bound, not the distance
  };
  CHECK(worst_distance_error(pit.spec, broken) > 2.0 * kSampleTolerance);
}

TEST_CASE("truth: the gradient of the distance has length 1 and is the normal, away from edges and middle surfaces") {
  const double step = 1e-7;  // [m] central differences: error step^2/(6 r^2) < 1e-8 at curvature radii above 1 mm, rounding 1e-18/1e-7
  for (const Case& c : every_shape()) {
    CAPTURE(c.name);
    const Truth truth(c.spec);
    int judged = 0;
    for (std::uint64_t n = 0; n < 4000; ++n) {
      const Vec3 p = random_point(23, n, truth.box_lo(), truth.box_hi());
      const Vec3 normal = truth.normal(p);
      CHECK(std::abs(glm::length(normal) - 1.0) < 1e-12);
      Vec3 gradient(0.0);
      bool smooth = true;
      for (std::size_t a = 0; a < 3; ++a) {
        Vec3 d(0.0);
        d[a] = step;
        gradient[a] = (truth.signed_distance(p + d) - truth.signed_distance(p - d)) / (2.0 * step);
        // Where the nearest feature changes within the stencil there is no gradient: leave the point out.
        smooth = smooth && glm::length(truth.normal(p + d) - normal) < 1e-2 && glm::length(truth.normal(p - d) - normal) < 1e-2;
      }
      if (!smooth) continue;
      ++judged;
      CHECK(std::abs(glm::length(gradient) - 1.0) < 1e-5);
      CHECK(glm::length(gradient - normal) < 1e-5);
    }
    CHECK(judged > 3900);  // edges and middle surfaces have no volume
  }
}

/// Bone along a ray by midpoint marching of `inside` in the grid's box; the slow twin of thickness_along and entry_distance.
struct Marched {
  double thickness = 0.0;
  double entry = -1.0;
};
Marched march(const Truth& truth, const PhantomSpec& spec, const Vec3& origin, const Vec3& unit, double step, double length) {
  Marched m;
  for (double t = 0.5 * step; t < length; t += step) {
    const Vec3 p = origin + t * unit;
    const bool in_box = glm::all(glm::greaterThanEqual(p, truth.box_lo())) && glm::all(glm::lessThanEqual(p, truth.box_hi()));
    if (!in_box || !inside(spec, p)) continue;
    if (m.entry < 0.0) m.entry = t;
    m.thickness += step;
  }
  return m;
}

TEST_CASE("truth: thickness and entry along random rays agree with fine marching, from inside and outside the box") {
  const double step = 5e-6;
  for (const Case& c : every_shape()) {
    CAPTURE(c.name);
    const Truth truth(c.spec);
    int hits = 0;
    for (std::uint64_t n = 0; n < 150; ++n) {
      CAPTURE(n);
      const Vec3 origin = random_point(31, n, truth.box_lo() - 0.004, truth.box_hi() + 0.004);
      const Vec3 target = random_point(37, n, truth.box_lo(), truth.box_hi());
      const Vec3 unit = glm::normalize(target - origin);
      const Marched m = march(truth, c.spec, origin, unit, step, 0.05);
      // Each of at most two stretches is counted in whole steps: an error of one step an interval.
      CHECK(std::abs(truth.thickness_along(origin, 3.0 * unit) - m.thickness) <= 2.0 * step + 1e-12);
      const std::optional<double> entry = truth.entry_distance(origin, unit);
      if (m.entry < 0.0) {
        CHECK(truth.thickness_along(origin, unit) <= 2.0 * step);
        continue;
      }
      ++hits;
      REQUIRE(entry.has_value());
      // A stretch shorter than a step may slip through the marching, then its entry is a later one.
      const bool grazed = std::abs(*entry - m.entry) > step && truth.thickness_along(origin, unit) > m.thickness;
      CHECK((grazed || std::abs(*entry - m.entry) <= step));
    }
    CHECK(hits > 50);
  }
}

TEST_CASE("truth: down the axis every shape is as thick as its parameters say") {
  const Vec3 from(0.0, 0.0, 0.0015), down(0.0, 0.0, -1.0);
  // 1e-12 m: a handful of roundings of lengths up to 0.1 m (1e-17 each) and one square root.
  for (const Case& c : every_shape()) {
    CAPTURE(c.name);
    const Truth truth(c.spec);
    double thickness = c.spec.thickness, entry = 0.0015;
    if (c.spec.kind == PhantomKind::block) thickness = c.spec.block_size.z;
    if (c.spec.kind == PhantomKind::sphere || c.spec.kind == PhantomKind::capsule) thickness = 2.0 * c.spec.sphere_radius;
    if (c.spec.kind == PhantomKind::wedge) thickness = c.spec.extent.z - c.spec.above;  // to the bottom of the grid
    if (c.name == "oblique plate") thickness = c.spec.thickness * std::sqrt(14.0) / 3.0;
    if (c.spec.kind == PhantomKind::pit) thickness -= c.spec.hole_depth, entry += c.spec.hole_depth;
    CHECK(agree(truth.thickness_along(from, down), thickness, 1e-12));
    CHECK(agree(truth.entry_distance(from, down).value(), entry, 1e-12));
    CHECK_FALSE(truth.entry_distance(from, -down).has_value());
    CHECK(truth.thickness_along(from, -down) == 0.0);
  }
}

TEST_CASE("truth: a ray across the pit crosses two stretches of bone and enters at the first") {
  const Case pit = every_shape().back();
  const Truth truth(pit.spec);
  const Vec3 from(-0.1, 0.0, -0.001), along(1.0, 0.0, 0.0);
  // The box is 16 mm wide, the hole 6 mm.
  CHECK(agree(truth.thickness_along(from, along), 0.010, 1e-12));
  CHECK(agree(truth.entry_distance(from, along).value(), 0.092, 1e-12));
  CHECK(agree(truth.entry_distance(Vec3(0.0, 0.0, -0.001), along).value(), 0.003, 1e-12));
  CHECK(truth.entry_distance(Vec3(-0.005, 0.0, -0.001), along).value() == 0.0);  // starts in bone
}

TEST_CASE("truth: corner cases on the wedge's edge and the pit's rim") {
  PhantomSpec wedge;
  wedge.kind = PhantomKind::wedge;
  const Truth w(wedge);  // 90 degrees: faces at 45. Here and below 1e-12 is room for a few roundings and the 2 ulp of portable_sin.
  const double half = std::sqrt(0.5);
  CHECK(std::abs(w.signed_distance(Vec3(0.0))) < 1e-15);
  CHECK(agree(w.signed_distance(Vec3(0.0, 0.004, 0.002)), 0.002, 1e-12));  // straight above: the edge
  CHECK(agree(w.normal(Vec3(0.0, 0.004, 0.002)).z, 1.0, 1e-12));
  CHECK(agree(w.signed_distance(Vec3(0.001, 0.0, 0.002)), std::sqrt(5e-6), 1e-12));  // still the edge
  CHECK(agree(w.signed_distance(Vec3(0.002, 0.0, 0.0)), 0.002 * half, 1e-12));       // the right face
  CHECK(agree(w.normal(Vec3(0.002, 0.0, 0.0)).x, half, 1e-12));
  CHECK(agree(w.normal(Vec3(-0.002, 0.0, 0.0)).x, -half, 1e-12));
  CHECK(agree(w.signed_distance(Vec3(0.0, 0.0, -0.002)), -0.002 * half, 1e-12));  // both faces equally near
  CHECK(agree(std::abs(w.normal(Vec3(0.0, 0.0, -0.002)).x), half, 1e-12));        // one of the two

  const Case c = every_shape().back();  // hole 3 mm radius, 4 mm deep, 6 mm plate
  const Truth pit(c.spec);
  CHECK(std::abs(pit.signed_distance(Vec3(0.003, 0.0, 0.0))) < 1e-15);  // on the rim
  CHECK(is_finite(pit.normal(Vec3(0.003, 0.0, 0.0))));
  CHECK(agree(pit.signed_distance(Vec3(0.0, 0.002, 0.001)), std::sqrt(2.0) * 0.001, 1e-12));       // above the hole: the rim
  CHECK(agree(pit.signed_distance(Vec3(0.0, 0.0, 0.0)), 0.003, 1e-12));                            // the axis: the rim all round
  CHECK(std::abs(pit.signed_distance(Vec3(0.0, 0.0, -0.004))) < 1e-15);                            // the floor
  CHECK(agree(pit.signed_distance(Vec3(0.0, 0.0, -0.0035)), 0.0005, 1e-12));                       // just above the floor
  CHECK(agree(pit.signed_distance(Vec3(0.0, 0.0, -0.0045)), -0.0005, 1e-12));                      // under the floor
  CHECK(agree(pit.signed_distance(Vec3(0.0, 0.0035, -0.0045)), -std::sqrt(2.0) * 0.0005, 1e-12));  // the bottom's inner edge, from bone
  CHECK(agree(pit.signed_distance(Vec3(0.004, 0.0, -0.003)), -0.001, 1e-12));                      // beside the wall
  CHECK(agree(pit.normal(Vec3(0.004, 0.0, -0.003)).x, -1.0, 1e-12));                               // outward = into the hole
}

TEST_CASE("truth: a degenerate point (centre of a ball, a box's corner, the axis) still has a finite unit normal") {
  for (const Case& c : every_shape()) {
    CAPTURE(c.name);
    const Truth truth(c.spec);
    for (const Vec3& p : {Vec3(0.0), Vec3(0.0, 0.0, -c.spec.sphere_radius), Vec3(0.0, 0.0, -c.spec.curvature), Vec3(0.005, 0.004, 0.0),
                          Vec3(0.0, 0.0, -c.spec.hole_depth), Vec3(c.spec.hole_radius, 0.0, -c.spec.hole_depth)})
      CHECK(agree(glm::length(truth.normal(p)), 1.0, 1e-12));
  }
}

}  // namespace
}  // namespace burrhole
