#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include "core/drill/coverage_samples.h"
#include "tests/core/drill/coverage_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

std::string name_of(bool ball) { return ball ? "ball" : "cylinder"; }

struct Excess {
  double sum = 0.0, worst = 0.0;
  int count = 0;
  void add(double e) {
    sum += e;
    ++count;
    worst = std::max(worst, std::abs(e));
  }
  [[nodiscard]] std::string text() const {
    return std::to_string(100.0 * sum / count) + " % on average, at worst " + std::to_string(100.0 * worst) + " %";
  }
};

/// Volume [voxels^3] of a tool at rest as its voxels' samples tell it by its exact distance.
double count_of_samples(const SweptSolid& solid, const SolidCase& one, std::size_t words) {
  const CoverageSamples samples = make_coverage_samples(CoverageKernel::trapezoid, words);
  std::size_t met = 0;
  for_each_voxel(block_for(one).window().box, [&](const Vec3i& v) {
    for (std::size_t n = 0; n < samples.size(); ++n) met += solid.distance(Vec3(v) + Vec3(samples.offset[n]), 0.0) == 0.0 ? 1 : 0;
  });
  return static_cast<double>(met) / static_cast<double>(samples.size());
}

}  // namespace

TEST_CASE("coverage: removed mass is the swept volume within 3 % down to a radius of 1 voxel, whatever way, offset, sub-step and speed") {
  for (const bool ball : {true, false})
    for (const double radius : {1.0, 1.5, 2.0, 3.0, 5.0, 8.0}) {
      Excess excess;
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        CAPTURE(seed);
        CAPTURE(radius);
        CAPTURE(ball);
        const SolidCase one{.ball = ball, .radius = radius, .way = std::array{0.0, 2.3, 6.1, 11.9}[seed % 4], .seed = seed};
        const SweptSolid solid = random_solid(one);
        Voxmap voxmap = block_for(one);
        ErosionConfig config{.subvoxel = true, .clear_below = 0.0f};
        config.longest_substep = std::array{0.25, 0.5, 1.0}[seed % 3];
        Erosion erosion = subvoxel_erosion(solid, kAtOnce, config);
        const double removed = sweep_through(voxmap, erosion, solid, std::array{1, 7, 60}[seed / 4 % 3]);
        excess.add(removed / solid.volume() - 1.0);
        CHECK(std::abs(removed / solid.volume() - 1.0) < 0.03);
      }
      MESSAGE(name_of(ball) << " of " << radius << " voxels: removed mass off by " << excess.text());
    }
}

TEST_CASE(
    "coverage: what a tool at rest removes is its volume within 3 % down to a radius of 1 voxel, wherever it stands; 64 samples miss "
    "that") {
  // At rest nothing averages: the count of samples within a still shape is all there is. 40 positions and turns of each; coverage_samples.h
  // has figures of 400.
  double worst_plain = 0.0;
  for (const bool ball : {true, false})
    for (const double radius : {1.0, 1.5}) {
      Excess excess;
      for (std::uint64_t seed = 101; seed <= 140; ++seed) {
        CAPTURE(seed);
        CAPTURE(radius);
        CAPTURE(ball);
        const SolidCase one{.ball = ball, .radius = radius, .way = 0.0, .seed = seed};
        const SweptSolid solid = random_solid(one);
        Voxmap voxmap = block_for(one);
        Erosion erosion = subvoxel_erosion(solid, kAtOnce);
        const double removed = sweep_through(voxmap, erosion, solid, 1);
        excess.add(removed / solid.volume() - 1.0);
        CHECK(std::abs(removed / solid.volume() - 1.0) < 0.03);
        if (ball && radius == 1.0) worst_plain = std::max(worst_plain, std::abs(count_of_samples(solid, one, 1) / solid.volume() - 1.0));
      }
      MESSAGE(name_of(ball) << " of " << radius << " voxels at rest: removed mass off by " << excess.text());
    }
  MESSAGE("ball of 1 voxel counted with 64 samples: at worst " << 100.0 * worst_plain << " %");
  CHECK(worst_plain > 0.035);
}

TEST_CASE("coverage: a cell is all or nothing without it, and 3 % is missed") {
  double worst = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SolidCase one{.radius = 2.0, .seed = seed};
    const SweptSolid solid = random_solid(one);
    Voxmap voxmap = block_for(one);
    Erosion erosion = make_erosion(solid.points(0.5 * solid.voxel, kAtOnce));
    worst = std::max(worst, std::abs(sweep_through(voxmap, erosion, solid, 7) / solid.volume() - 1.0));
  }
  CHECK(worst > 0.2);
}

TEST_CASE("coverage: volume inside the 0.5 level is the swept volume within 3 % from a cylinder of 4 and a ball of 8 voxels") {
  const std::array<std::string, 3> names{"cell", "trapezoid", "wide"};
  for (const CoverageKernel kernel : {CoverageKernel::cell, CoverageKernel::trapezoid, CoverageKernel::wide})
    for (const bool ball : {true, false})
      for (const double radius : {1.0, 2.0, 3.0, 4.0, 6.0, 8.0}) {
        Excess excess;
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
          const SolidCase one{.ball = ball, .radius = radius, .way = 2.0 * radius, .seed = seed};
          SweptSolid solid = random_solid(one);
          // A hole is drilled along the cylinder's axis; its ends' edges are no part of what the radius says, so they lie far apart.
          if (!ball) {
            solid.height = 8.0 * radius * solid.voxel;
            solid.way = 2.0 * radius * glm::normalize(solid.from.linear[2]);
            solid.from.offset -= solid.from.linear * Vec3(0.0, 0.0, 4.0 * radius * solid.voxel);
          }
          Voxmap voxmap = Block{.dims = Vec3i(static_cast<int>(ball ? 6.0 * radius : 12.0 * radius) + 10), .pitch = solid.voxel}.make();
          const Vec3 middle = 0.5 * Vec3(voxmap.bone().dims() - 1);
          solid.from.offset += middle - (solid.from * Vec3(0.0, 0.0, ball ? solid.radius : 0.5 * solid.height) + 0.5 * solid.way);
          solid.from.offset += Vec3(0.1, 0.3, 0.45) * static_cast<double>(seed);
          Erosion erosion = subvoxel_erosion(solid, kAtOnce, {.subvoxel = true, .kernel = kernel, .clear_below = 0.0f});
          (void)sweep_through(voxmap, erosion, solid, 9);
          excess.add(hollow(voxmap.window()) / solid.volume() - 1.0);
        }
        MESSAGE(names[static_cast<std::size_t>(kernel)] << ", " << name_of(ball) << " of " << radius << " voxels: 0.5 volume off by "
                                                        << excess.text());
        if (kernel == CoverageKernel::trapezoid && radius >= (ball ? 8.0 : 4.0)) CHECK(excess.worst < 0.03);
      }
}
