#include <doctest/doctest.h>

#include <cstdio>

#include "core/base/random.h"
#include "tests/core/voxel/surface_cases.h"
#include "tests/core/voxel/surface_twin.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const VoxelBox kBox{{-3, 5, -20}, {35, 43, 18}};  // 38 voxels, corner anywhere
const Vec3 kMiddle = 0.5 * Vec3(kBox.lo + kBox.hi);

Vec3 direction(std::uint64_t seed) {
  return glm::normalize(Vec3(uniform11(seed, 0), uniform11(seed, 1), uniform11(seed, 2)) + Vec3(0.0, 0.0, 1e-3));
}

/// Edges from 0.8 to 1.4, not at right angles, scaled to a mean edge of 1.
Mat3 oblique(std::uint64_t seed) {
  Mat3 m(1.0);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) m[c][r] = 0.2 * uniform11(seed, 3 * c + r) + (c == r ? 0.8 + 0.3 * static_cast<double>(c) : 0.0);
  return m / std::cbrt(std::abs(glm::determinant(m)));
}

/// Largest errors allowed: distance to the trilinear 0.5 surface [voxel edges], normal to the shape's [degrees], and its median.
struct Bounds {
  double distance, degrees, median_degrees;
};
struct Case {
  std::string name;
  Mat3 metric;
  Shape shape;
  std::function<bool(const Vec3&)> keep;
  Bounds wide, coverage;
};

// Distances: on a plane in the phantoms' ramp records are exact but for their steps (1/64 of an edge with 8 bits) and normals off by
// aliasing. A curved surface adds interpolation between voxels, (1/8 of the sum over the axes of the second derivative: 1 / (4 R) on a
// ball, at R = 12 0.02) and what cells cut off it. A ramp of one voxel wobbles by itself, by up to 0.09 along a voxel or two; records,
// some voxels away, average that: allowed is the wobble, longer where edges are.
// Normals: what planes of all tilts show of aliasing (surface_field.cpp), more where edges are longer.
std::vector<Case> cases(std::uint64_t seed) {
  const auto all = [](const Vec3&) { return true; };
  const Mat3 even(1.0), m = oblique(seed);
  const Vec3 c = kMiddle + Vec3(uniform01(seed, 90), uniform01(seed, 91), uniform01(seed, 92)), n = direction(seed);
  const Vec3 other = glm::normalize(glm::cross(n, direction(seed + 9)));
  // Measured along either face; the stencil of two voxels, across the corner of a voxel, reaches 2 sqrt(3).
  const auto off_edge = [=](double least) {
    return [=](const Vec3& p) {
      const double a = glm::dot(p - c, n), b = glm::dot(p - c, other);
      return std::max(-a, -b) > least && std::abs(a - b) > 1.5;
    };
  };
  const Shape edge = wedge(plane(c, n), plane(c, other));
  return {{"plate, level", even, plane(c, {0, 0, 1}), all, {0.016, 0.01, 0.01}, {0.016, 0.01, 0.01}},
          {"plate, tilted", even, plane(c, n), all, {0.03, 0.7, 0.2}, {0.1, 0.7, 0.2}},
          {"plate, tilted, sheared voxels", m, plane(m * c, n), all, {0.03, 1.2, 0.2}, {0.12, 1.2, 0.3}},
          {"ball of 16", even, ball(c - n * 16.0, 16.0, false), all, {0.04, 1.0, 0.2}, {0.1, 1.0, 0.2}},
          {"ball of 16, sheared voxels", m, ball(m * c - n * 16.0, 16.0, false), all, {0.05, 1.5, 0.3}, {0.15, 1.5, 0.35}},
          {"cavity of 12", even, ball(c - n * 10.0, 12.0, true), all, {0.05, 1.0, 0.25}, {0.12, 1.0, 0.25}},
          {"hole of 10", even, hole(c, n, 10.0), all, {0.05, 1.0, 0.25}, {0.12, 1.0, 0.25}},
          {"wedge, 3.5 from its edge", even, edge, off_edge(3.5), {0.03, 0.7, 0.2}, {0.1, 0.7, 0.2}},
          {"wedge, 2 from its edge", even, edge, off_edge(2.0), {0.03, 5.0, 0.5}, {0.1, 5.0, 0.5}}};
}

/// Index positions within a voxel of the surface where the case wants to look.
std::vector<Vec3> places(const Case& one, const VoxelBox& inside, std::uint64_t seed, std::size_t wanted) {
  std::vector<Vec3> out;
  for (std::uint64_t n = 0; n < 200000 && out.size() < wanted; ++n) {
    const Vec3 u(uniform01(seed + 77, 3 * n), uniform01(seed + 77, 3 * n + 1), uniform01(seed + 77, 3 * n + 2));
    const Vec3 at = Vec3(inside.lo) + u * Vec3(inside.size() - 1);
    if (std::abs(one.shape(one.metric * at).distance) <= 1.0 && one.keep(one.metric * at)) out.push_back(at);
  }
  return out;
}

struct Seen {
  Errors bits8, bits16, sabotaged[3];  // without smoothing, second order, plane
  std::vector<double> wobble;          // of the 0.5 surface off the shape
};

void look(const Case& one, Ramp ramp, std::uint64_t seed, Seen& seen) {
  const MasterWindow window = window_of(kBox, one.metric, one.shape, ramp);
  SurfaceRecords records8({one.metric * 0.25e-3, Vec3(0.0)}, RecordPrecision::bits8);
  SurfaceRecords records16({one.metric * 0.25e-3, Vec3(0.0)}, RecordPrecision::bits16);
  records8.rebuild(window);
  records16.rebuild(window);
  const PlainSurface iso(window, one.metric);
  const SurfaceTwin unsmoothed(window, one.metric, {.smoothing = true}), flat(window, one.metric, {.second_order = true}),
      raw(window, one.metric, {.plane = true});
  std::size_t n = 0;
  for (const Vec3& at : places(one, records16.valid_box(), seed, 150)) {
    const Truth truth = one.shape(one.metric * at);
    const double distance = iso.distance(at);
    seen.wobble.push_back(std::abs(distance - truth.distance));
    const auto add = [&](Errors& errors, const SurfaceSample& s) {
      errors.add(s.distance - distance, degrees_between(s.normal, truth.normal));
    };
    add(seen.bits8, read_records(records8, at));
    add(seen.bits16, read_records(records16, at));
    if (++n % 4 != 0) continue;  // the twins are slow
    add(seen.sabotaged[0], unsmoothed.read(at));
    add(seen.sabotaged[1], flat.read(at));
    add(seen.sabotaged[2], raw.read(at));
  }
}

void print(const std::string& name, const char* how, const Errors& e) {
  std::printf("%-30s %-22s %6.4f %6.4f   %6.3f %6.3f\n", name.c_str(), how, median(e.distance), largest(e.distance), median(e.degrees),
              largest(e.degrees));
}

}  // namespace

TEST_CASE("surface records: distance and normal on plates, balls, holes and wedges, and what each step of the method is for") {
  std::printf("bone, ramp and bits: error of distance [voxel] median and largest, of normal [degree] median and largest\n");
  for (const Ramp ramp : {Ramp::wide, Ramp::coverage})
    for (std::size_t n = 0; n < cases(1).size(); ++n) {
      Seen seen;
      for (std::uint64_t seed = 1; seed <= 2; ++seed) look(cases(seed)[n], ramp, seed, seen);
      const Case one = cases(1)[n];
      CAPTURE(one.name);
      const std::string how = ramp == Ramp::wide ? "wide ramp" : "coverage";
      print(one.name, (how + ", 16").c_str(), seen.bits16);
      print(one.name, (how + ", 8").c_str(), seen.bits8);
      const Bounds& bounds = ramp == Ramp::wide ? one.wide : one.coverage;
      CHECK(seen.bits16.distance.size() == 300);
      CHECK(largest(seen.bits16.distance) < bounds.distance);
      CHECK(largest(seen.bits16.degrees) < bounds.degrees);
      CHECK(median(seen.bits16.degrees) < bounds.median_degrees);
      // Half a step of 1/32, and of 1/127 at each component: 0.39 degrees, 0.06 in the mean of eight.
      CHECK(largest(seen.bits8.distance) < bounds.distance + 0.5 * kRecord8Distance);
      CHECK(largest(seen.bits8.degrees) < bounds.degrees + 0.39);
      CHECK(median(seen.bits8.degrees) < bounds.median_degrees + 0.12);
      const char* const left_out[3] = {"no smoothing", "no second order", "nearest surfel"};
      for (std::size_t s = 0; s < 3; ++s) print("    sabotaged:", left_out[s], seen.sabotaged[s]);
      if (one.name == "plate, level") continue;
      CHECK(largest(seen.sabotaged[2].distance) > 1.5 * bounds.distance);  // the way to the nearest surfel instead of its plane
      if (ramp == Ramp::coverage) CHECK(median(seen.sabotaged[0].degrees) > 2.0 * bounds.median_degrees);
      if (one.name == "ball of 16" || one.name == "cavity of 12") CHECK(median(seen.sabotaged[1].degrees) > bounds.median_degrees);
    }
}

TEST_CASE("surface records: a plain twin in double precision finds the same") {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Mat3 metric = seed == 1 ? Mat3(1.0) : oblique(seed);
    const VoxelBox box{kBox.lo + 5, kBox.hi - 5};
    const Vec3 c = metric * (kMiddle + Vec3(0.213, 0.347, 0.119));
    const std::vector<Shape> shapes{ball(c, 8.0, false), ball(c, 9.0, true), hole(c, direction(seed + 3), 6.0),
                                    wedge(plane(c, direction(seed + 4)), plane(c, direction(seed + 5)))};
    for (std::size_t n = 0; n < shapes.size(); ++n) {
      CAPTURE(seed);
      CAPTURE(n);
      const MasterWindow window = window_of(box, metric, shapes[n], Ramp::wide);
      SurfaceRecords records({metric * 0.25e-3, Vec3(0.0)}, RecordPrecision::bits16);
      records.rebuild(window);
      const SurfaceTwin twin(window, metric);
      std::size_t compared = 0, apart = 0, lost = 0;
      double worst = 0.0;
      for_each_voxel(box.grown(-1), [&](const Vec3i& v) {
        const SurfaceSample ours = decode(std::get<std::vector<Record16>>(records.records())[box.offset_of(v)]), theirs = twin.record(v);
        if (std::abs(theirs.distance) > 3.0) return;
        ++compared;
        lost += ours.normal == Vec3(0.0) ? 1 : 0;  // no surfel was offered
        const double off = std::abs(ours.distance - theirs.distance);
        worst = std::max(worst, off);
        apart += off > 2.0 * kRecord16Distance || glm::length(ours.normal - theirs.normal) > 1e-3 ? 1 : 0;
      });
      CHECK(compared > 1000);
      CHECK(lost == 0);
      // Of two surfels as near as each other either may be taken; keys keep squared distances to 14 bits.
      CHECK(apart * 100 < compared);
      CHECK(worst < 0.05);  // such two on a bend
    }
  }
}
