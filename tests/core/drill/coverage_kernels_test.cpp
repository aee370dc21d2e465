#include "core/drill/coverage_kernels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/portable_math.h"
#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/drill/coverage_samples.h"
#include "core/drill/engaged_kernels.h"
#include "core/drill/field_sampler.h"

using namespace burrhole;

namespace {

constexpr double kRadius = 1.5e-3, kPitch = 0.125e-3;

/// A ball's distances on nodes, wide enough that some samples fall outside.
CuttingField ball_field() {
  CuttingField field;
  field.pitch = kPitch;
  field.margin = 4 * kPitch;
  field.dims = Vec3i(33);
  field.origin = Vec3(-16 * kPitch);
  for_each_voxel({Vec3i(0), field.dims}, [&](const Vec3i& v) {
    field.distance.push_back(static_cast<float>(glm::length(field.origin + kPitch * Vec3(v)) - kRadius));
    field.factor.push_back(1.0f);
  });
  return field;
}

/// A voxel somewhere near the ball's surface, on a way of up to a voxel.
struct Case {
  std::array<float, kCoverageSamples> x{}, y{}, z{}, far{};
  MeetJob job{};
  std::uint64_t asked = 0;

  Case(const CuttingField& field, std::uint64_t n) {
    const auto random = [n](std::uint64_t k) { return static_cast<float>(uniform11(31, 1024 * n + k)); };
    for (std::size_t s = 0; s < kCoverageSamples; ++s) {
      x[s] = 1.9f * random(3 * s), y[s] = 1.9f * random(3 * s + 1), z[s] = 1.9f * random(3 * s + 2);
      far[s] = static_cast<float>(kPitch) * glm::length(Vec3f(x[s], y[s], z[s]));
    }
    const Vec3f way = glm::normalize(Vec3f(random(300), random(301), random(302)));
    const Vec3f centre = Vec3f(16.0f) + way * (12.0f + 3.5f * random(303));
    const Vec3f deeper = -way * (n % 4 == 0 ? 0.0f : 0.5f + 0.5f * random(304));
    const FieldSampler sampler(field);
    const Vec3f slope = sampler.gradient(centre);
    const float half_way = static_cast<float>(kPitch) * glm::length(deeper), slack = static_cast<float>(0.25 * kPitch);
    job = {.distance = field.distance.data(),
           .row = field.dims.x,
           .slab = field.dims.x * field.dims.y,
           .end = {32.0f, 32.0f, 32.0f},
           .x = x.data(),
           .y = y.data(),
           .z = z.data(),
           .far = far.data(),
           .centre = {centre.x, centre.y, centre.z},
           .slope = {slope.x, slope.y, slope.z},
           .deeper = {deeper.x, deeper.y, deeper.z},
           .closest = sampler.distance(centre),
           .spare = sampler.distance(centre) - half_way - slack,
           .bend = 400.0f,
           .sway = 0.05f,
           .half_way = half_way,
           .slack = slack,
           .straight = n % 3 != 0};
    asked = hash_of(n);
  }
  static std::uint64_t hash_of(std::uint64_t n) { return n % 5 == 0 ? ~std::uint64_t{0} : 0x9e3779b97f4a7c15ull * (n + 1); }
};

/// One sample after another by FieldSampler.
MeetMasks meet_plainly(const CuttingField& field, const Case& c) {
  const FieldSampler sampler(field);
  const MeetJob& job = c.job;
  const auto known = [](const Vec3f& q) {
    return glm::all(glm::greaterThanEqual(q, Vec3f(0.0f))) && glm::all(glm::lessThan(q, Vec3f(32.0f)));
  };
  MeetMasks out;
  out.nearest = std::numeric_limits<float>::infinity();
  for (std::size_t n = 0; n < kCoverageSamples; ++n) {
    const std::uint64_t bit = std::uint64_t{1} << n;
    const float least =
        job.spare + job.slope[0] * c.x[n] + job.slope[1] * c.y[n] + job.slope[2] * c.z[n] - (job.bend * c.far[n] + job.sway) * c.far[n];
    if ((c.asked & bit) == 0) continue;
    if (least > 0.0f || job.closest - c.far[n] > job.half_way + job.slack) {
      out.nearest = std::min(out.nearest, std::max(least + job.half_way, job.closest - c.far[n] - job.slack));
      continue;
    }
    const Vec3f q = Vec3f(job.centre[0], job.centre[1], job.centre[2]) + Vec3f(c.x[n], c.y[n], c.z[n]);
    const Vec3f end = q + Vec3f(job.deeper[0], job.deeper[1], job.deeper[2]);
    const float d = sampler.distance(q);
    if (!known(q))
      out.unsure |= bit;
    else if (d <= 0.0f)
      out.met |= bit;
    else if (job.half_way > 0.0f && d <= 1.1f * job.half_way) {
      if (known(end) && sampler.distance(end) <= 0.0f)
        out.met |= bit;
      else if (!job.straight || !known(end))
        out.unsure |= bit;
    }
    if (((out.met | out.unsure) & bit) == 0) out.nearest = std::min(out.nearest, d);
  }
  return out;
}

}  // namespace

TEST_CASE("coverage: samples met by vectors are those met one by one, at every level") {
  const CuttingField field = ball_field();
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const std::string& level : levels) {
    CAPTURE(level);
    REQUIRE(choose_simd(level).ok());
    std::size_t met = 0, unsure = 0, different_when_moved = 0;
    for (std::uint64_t n = 0; n < 2000; ++n) {
      const Case c(field, n);
      const MeetMasks by_vectors = meet_samples(c.job, c.asked), plainly = meet_plainly(field, c);
      REQUIRE(by_vectors.met == plainly.met);
      REQUIRE(by_vectors.unsure == plainly.unsure);
      REQUIRE(by_vectors.nearest == plainly.nearest);
      met += plainly.met != 0 ? 1 : 0;
      unsure += plainly.unsure != 0 ? 1 : 0;
      Case moved = c;  // sabotage: half a node aside
      moved.job.x = moved.x.data(), moved.job.y = moved.y.data(), moved.job.z = moved.z.data(), moved.job.far = moved.far.data();
      moved.job.centre[0] += 0.5f;
      different_when_moved += meet_samples(moved.job, c.asked).met != plainly.met ? 1 : 0;
    }
    // All branches are taken, and a field read half a node aside would be noticed.
    CHECK(met > 500);
    CHECK(unsure > 100);
    CHECK(different_when_moved > 300);
  }
  REQUIRE(choose_simd("auto").ok());
}

TEST_CASE("coverage: places measured and weighed by vectors are those of the plain sampler, inside the table and out, at every level") {
  CuttingField field = ball_field();
  for (std::size_t n = 0; n < field.factor.size(); ++n) field.factor[n] = 0.1f + static_cast<float>(uniform01(7, n));
  const FieldSampler sampler(field);
  constexpr std::size_t kCount = 1003;
  constexpr double kRamp = 0.2e-3;
  const Affine middle{glm::mat3_cast(rotation_from_z(glm::normalize(Vec3(0.3, 0.5, 0.8)))) * 1.9, Vec3(15.2, 16.7, 14.9)};
  std::array<std::int32_t, kCount + kPlacePad> i{}, j{}, k{};
  std::array<float, kCount + kPlacePad> share{}, grown{}, x{}, y{}, z{}, distance{}, exposure{}, radius{};
  const auto draw = [](std::uint64_t n) { return static_cast<std::int32_t>(std::floor(12.0 * uniform11(9, n))); };
  for (std::size_t n = 0; n < kCount; ++n) {
    i[n] = draw(3 * n), j[n] = draw(3 * n + 1), k[n] = draw(3 * n + 2);
    share[n] = static_cast<float>(n % 65) / 64.0f;
    grown[n] = n % 3 == 0 ? share[n] : 0.0f;
  }
  PlaceJob job{.distance = field.distance.data(),
               .factor = field.factor.data(),
               .row = 33,
               .slab = 33 * 33,
               .end = {32.0f, 32.0f, 32.0f},
               .linear = {},
               .offset = {middle.offset.x, middle.offset.y, middle.offset.z},
               .margin = field.margin,
               .pitch = field.pitch,
               .origin = {field.origin.x, field.origin.y, field.origin.z},
               .ramp = kRamp};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t axis = 0; axis < 3; ++axis) job.linear[c][axis] = middle.linear[c][axis];
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const std::string& level : levels) {
    CAPTURE(level);
    REQUIRE(choose_simd(level).ok());
    const PlaceList places{x.data(), y.data(), z.data(), distance.data()};
    measure_places(job, {kCount, i.data(), j.data(), k.data()}, places);
    weigh_places(job, {kCount, places, share.data(), grown.data(), exposure.data(), radius.data()});
    int outside = 0, exposed = 0;
    for (std::size_t n = 0; n < kCount; ++n) {
      CAPTURE(n);
      const Vec3f q(middle * Vec3(i[n], j[n], k[n]));
      REQUIRE(Vec3f(x[n], y[n], z[n]) == q);
      REQUIRE(distance[n] == sampler.distance(q));
      outside += glm::all(glm::lessThan(q, Vec3f(32.0f))) && glm::all(glm::greaterThanEqual(q, Vec3f(0.0f))) ? 0 : 1;
      const auto ramp = static_cast<float>(std::clamp(0.5 - 0.5 * static_cast<double>(distance[n]) / kRamp, 0.0, 1.0));
      const float now = std::min(share[n], std::max(ramp, 0.5f * grown[n]));
      REQUIRE(exposure[n] == (now > 0.0f ? sampler.factor(q) * now / share[n] : 0.0f));
      const Vec3 p = field.origin + field.pitch * Vec3(q);
      REQUIRE(radius[n] == static_cast<float>(std::sqrt(p.x * p.x + p.y * p.y)));
      exposed += exposure[n] > 0.0f ? 1 : 0;
    }
    // Both branches are taken.
    CHECK(outside > 50);
    CHECK(exposed > 200);
    CHECK(exposed < static_cast<int>(kCount) - 200);
  }
  REQUIRE(choose_simd("auto").ok());
}

TEST_CASE("coverage: what is left by vectors is what the portable exponential leaves, to nothing at all") {
  constexpr std::size_t kCount = 501;
  std::array<float, kCount + 8> available{}, exposure{}, hardness{}, left{};
  hardness.fill(1.0f);
  for (std::size_t n = 0; n < kCount; ++n) {
    available[n] = static_cast<float>(uniform01(3, n));
    exposure[n] = static_cast<float>(std::pow(10.0, 6.0 * uniform11(4, n)));
    hardness[n] = 0.1f + static_cast<float>(uniform01(5, n));
  }
  std::vector<std::string> levels{"auto"};
  for (const SimdLevel level : simd_levels()) levels.emplace_back(name_of(level));
  for (const std::string& level : levels) {
    CAPTURE(level);
    REQUIRE(choose_simd(level).ok());
    int none = 0, whole = 0;
    for (const double turns : {0.37, 12.0, std::numeric_limits<double>::infinity()}) {
      decay({kCount, turns, available.data(), exposure.data(), hardness.data(), left.data()});
      for (std::size_t n = 0; n < kCount; ++n) {
        const double power = -turns * static_cast<double>(exposure[n]) / static_cast<double>(hardness[n]);
        REQUIRE(left[n] == static_cast<float>(static_cast<double>(available[n]) * portable_exp(power)));
        none += left[n] == 0.0f ? 1 : 0;
        whole += left[n] > 0.9f * available[n] ? 1 : 0;
      }
    }
    CHECK(none > 100);
    CHECK(whole > 100);
  }
  REQUIRE(choose_simd("auto").ok());
}
