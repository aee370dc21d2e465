#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/core/drill/drill_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPitch = 0.5e-3;
const Vec3i kVoxel(3, 4, 5);

/// One voxel under eight points at rest: sub-steps of dt until it is gone.
struct OneVoxel {
  float occupancy = 1.0f, hardness = 1.0f;
  double lambda = 100.0;  ///< [1/s], e s
  double dt = 1e-3;       ///< [s]
  ErosionConfig config{};

  int left_surface = 0;  ///< sub-steps until density < 0.5, counted from 1
  int gone = 0;          ///< until remaining is 0
  bool monotone = true;

  void run(int most) {
    Voxmap voxmap = Block{.dims = Vec3i(8), .pitch = kPitch, .occupancy = occupancy, .hardness = hardness}.make();
    Erosion erosion = make_erosion(one_voxel(kPitch, 1.0f), config);
    const Affine pose = upright_pose(kPitch, Vec3(kVoxel));
    const std::size_t at = voxmap.window().box.offset_of(kVoxel);
    float before = 1.0f;
    for (int n = 1; n <= most && gone == 0; ++n) {
      voxmap.commit(erosion.step(voxmap, {pose, pose}, lambda, dt).changed);
      const float left = voxmap.window().remaining[at];
      monotone = monotone && left >= 0.0f && left < before;
      before = left;
      if (left_surface == 0 && voxmap.window().density[at] < 0.5f) left_surface = n;
      if (left == 0.0f) gone = n;
    }
  }
};

/// First sub-step at or after time t [s]. The cases keep t / dt away from whole numbers, so float rounding cannot decide.
int first_substep(double t, double dt) {
  const double steps = t / dt;
  REQUIRE(std::abs(steps - std::round(steps)) > 1e-3);
  return static_cast<int>(std::ceil(steps));
}

double scale_of(float hardness) { return std::max(0.1, static_cast<double>(hardness)); }

}  // namespace

TEST_CASE(
    "erosion rate: a voxel leaves the surface and is zeroed at exactly the first sub-step due, whatever occupancy, hardness and rate") {
  int cases = 0;
  for (const float occupancy : {0.55f, 0.7f, 0.85f, 1.0f})
    for (const float hardness : {0.0f, 0.05f, 0.1f, 0.33f, 1.0f})
      for (const double lambda : {7.3, 105.36, 411.0}) {
        CAPTURE(occupancy);
        CAPTURE(hardness);
        CAPTURE(lambda);
        OneVoxel voxel{.occupancy = occupancy, .hardness = hardness, .lambda = lambda};
        voxel.run(3000);
        const double b0 = static_cast<double>(occupancy), h = scale_of(hardness);
        const double least = static_cast<double>(voxel.config.minimum_density);
        CHECK(voxel.left_surface == first_substep(std::log(2.0 * b0) * h / lambda, voxel.dt));
        CHECK(voxel.gone == first_substep(std::log(b0 / least) * h / lambda, voxel.dt));
        ++cases;
      }
  CHECK(cases == 60);
}

TEST_CASE(
    "erosion rate: over 100 sub-steps and more the two times of a voxel are ln(2 occ) h/lambda and ln(b0/b_min) h/lambda within 1 %") {
  double worst = 0.0;
  for (const float occupancy : {0.8f, 1.0f})
    for (const float hardness : {0.4f, 1.0f})
      for (const double steps : {100.37, 300.41}) {
        const double surface = std::log(2.0 * static_cast<double>(occupancy)), h = scale_of(hardness);
        OneVoxel voxel{.occupancy = occupancy, .hardness = hardness, .lambda = surface * h / (steps * 1e-3)};
        voxel.run(5000);
        const double gone = std::log(static_cast<double>(occupancy) / 0.05) * h / voxel.lambda;
        worst = std::max(worst, std::abs(voxel.left_surface * voxel.dt / (steps * 1e-3) - 1.0));
        worst = std::max(worst, std::abs(voxel.gone * voxel.dt / gone - 1.0));
      }
  MESSAGE("largest relative error of a time " << worst);
  CHECK(worst < 0.01);
}

TEST_CASE("erosion rate: doubling e s halves the time of a voxel, doubling hardness within 0.1..1 doubles it") {
  const auto time = [](float hardness, double lambda) {
    OneVoxel voxel{.hardness = hardness, .lambda = lambda};
    voxel.run(20000);
    return voxel.gone;
  };
  // A time is rounded up to a sub-step: up to one sub-step on each side of the ratio, 0.3 % of the shortest time here.
  for (const float hardness : {0.2f, 0.5f, 1.0f}) {
    const int slow = time(hardness, 0.7), fast = time(hardness, 1.4);
    CHECK(std::abs(slow - 2 * fast) <= 2);
    CHECK(fast > 300);
  }
  for (const float hardness : {0.1f, 0.25f, 0.5f}) {
    const int soft = time(hardness, 0.8), hard = time(2.0f * hardness, 0.8);
    CHECK(std::abs(hard - 2 * soft) <= 2);
    CHECK(soft > 300);
  }
  CHECK(time(0.0f, 0.8) == time(0.1f, 0.8));  // the least hardness of the law
}

TEST_CASE("erosion rate: e s dt from 0.0001 to 100 neither stalls nor leaves 0..1, it falls at every sub-step to exactly 0") {
  for (const double exponent : {1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0, 100.0})
    for (const float minimum : {0.05f, 0.001f}) {
      CAPTURE(exponent);
      OneVoxel voxel{.lambda = exponent / 1e-3, .config = {.minimum_density = minimum}};
      voxel.run(80000);
      CHECK(voxel.monotone);
      const double due = std::log(1.0 / static_cast<double>(minimum)) / exponent;
      // Each of n sub-steps rounds remaining by at most 6e-8 of itself: n * 6e-8 of the exponent's n.
      CHECK(std::abs(voxel.gone - std::ceil(due)) <= due * 6e-8 / exponent + 1e-9);
    }
}

TEST_CASE("erosion rate: matches per-update at rate f by lambda = -f ln(1 - e s), 105.4 1/s for 0.1 at 1 kHz") {
  const double lambda = -1000.0 * std::log(1.0 - 0.1);
  CHECK(std::abs(lambda - 105.4) < 0.05);
  Voxmap by_rate = Block{.dims = Vec3i(8), .pitch = kPitch}.make(), by_update = Block{.dims = Vec3i(8), .pitch = kPitch}.make();
  ErosionPoints point{.pitch = kPitch, .positions = {Vec3(0.0)}, .factors = {1.0f}};
  Erosion rate = make_erosion(point), update = make_erosion(point, {.law = ErosionLaw::per_update});
  const Affine pose = upright_pose(kPitch, Vec3(kVoxel) + 0.2);
  const std::size_t at = by_rate.window().box.offset_of(kVoxel);
  double worst = 0.0;
  int gone_rate = 0, gone_update = 0;
  for (int n = 1; n <= 40; ++n) {
    by_rate.commit(rate.step(by_rate, {pose, pose}, lambda, 1e-3).changed);
    by_update.commit(update.step(by_update, {pose, pose}, 0.1, 1e-3).changed);
    const double a = static_cast<double>(by_rate.window().remaining[at]), b = static_cast<double>(by_update.window().remaining[at]);
    worst = std::max(worst, std::abs(a - b));
    if (gone_rate == 0 && a == 0.0) gone_rate = n;
    if (gone_update == 0 && b == 0.0) gone_update = n;
  }
  MESSAGE("lambda " << lambda << " 1/s, largest difference of remaining " << worst << ", zeroed at update " << gone_rate << " and "
                    << gone_update);
  CHECK(worst < 30 * 6e-8);  // a float rounding in each of up to 29 updates
  CHECK(gone_rate == 29);    // ln(20) / 0.10536 = 28.4
  CHECK(gone_update == 29);
}

TEST_CASE("erosion per-update: eq. 4 as printed, once for each point in the voxel and update, without hardness") {
  for (const float hardness : {0.0f, 0.3f, 1.0f}) {
    Voxmap voxmap = Block{.dims = Vec3i(8), .pitch = kPitch, .occupancy = 0.9f, .hardness = hardness}.make();
    const double q = 0.2 * kPitch;
    ErosionPoints points{.pitch = q, .positions = {Vec3(0.0), Vec3(q, 0.0, 0.0), Vec3(0.0, -q, q)}, .factors = {0.01f, 0.02f, 0.0005f}};
    Erosion erosion = make_erosion(points, {.law = ErosionLaw::per_update});
    const Affine pose = upright_pose(kPitch, Vec3(kVoxel));
    double expected = 1.0;
    for (int n = 0; n < 5; ++n) {
      const ErosionOutcome outcome = erosion.step(voxmap, {pose, pose}, 5.0, 123.0);
      voxmap.commit(outcome.changed);
      for (const float e : points.factors) expected *= 1.0 - static_cast<double>(e) * 5.0;
      CHECK(outcome.touched == 1);  // voxels, whatever number of points lies in one
      CHECK(std::abs(static_cast<double>(voxmap.window().remaining[voxmap.window().box.offset_of(kVoxel)]) - expected) < 15 * 6e-8);
    }
  }
}

TEST_CASE("erosion per-update: e s at or above 1 gives exactly 0, never less, and a density below the minimum becomes 0") {
  for (const double spin : {1.0, 1.5, 1e6, 0.951}) {
    CAPTURE(spin);
    Voxmap voxmap = Block{.dims = Vec3i(8), .pitch = kPitch}.make();
    ErosionPoints point{.pitch = kPitch, .positions = {Vec3(0.0)}, .factors = {1.0f}};
    Erosion erosion = make_erosion(point, {.law = ErosionLaw::per_update});
    const Affine pose = upright_pose(kPitch, Vec3(kVoxel));
    const ErosionOutcome outcome = erosion.step(voxmap, {pose, pose}, spin, 1e-3);
    voxmap.commit(outcome.changed);
    CHECK(voxmap.window().remaining[voxmap.window().box.offset_of(kVoxel)] == 0.0f);
    CHECK(outcome.changed.size() == 1);
    CHECK(outcome.changed.bounds() == VoxelBox{kVoxel, kVoxel + 1});
    const double cell = kPitch * kPitch * kPitch;
    CHECK(std::abs(outcome.removed_mass - cell) < 1e-12 * cell);
  }
}

TEST_CASE("erosion: nothing happens, and the hash stays, at spin 0, without time, without points and with factors 0") {
  Voxmap voxmap = random_block(Vec3i(12), kPitch, 3);
  const Affine pose = upright_pose(kPitch, Vec3(4.0));
  const ErosionPath path{pose, moved(pose, Vec3(2.0, 1.0, 0.0))};
  const std::uint64_t hash = voxmap.hash();
  for (const ErosionLaw law : {ErosionLaw::rate, ErosionLaw::per_update}) {
    Erosion erosion = make_erosion(lattice(Ball{1.2e-3}, 0.25e-3, 5.0f), {.law = law});
    Erosion blunt = make_erosion(lattice(Ball{1.2e-3}, 0.25e-3, 0.0f), {.law = law});
    Erosion empty = make_erosion({}, {.law = law});
    for (const ErosionOutcome& outcome :
         {erosion.step(voxmap, path, 0.0, 1e-3), erosion.step(voxmap, path, -5.0, 1e-3), erosion.step(voxmap, path, 300.0, 0.0),
          erosion.step(voxmap, path, std::numeric_limits<double>::quiet_NaN(), 1e-3), blunt.step(voxmap, path, 300.0, 1e-3),
          empty.step(voxmap, path, 300.0, 1e-3)}) {
      CHECK(outcome.removed_mass == 0.0);
      CHECK(outcome.touched == 0);
      CHECK(outcome.changed.empty());
    }
  }
  CHECK(voxmap.hash() == hash);
  CHECK(missing_mass(voxmap) == 0.0);
}
