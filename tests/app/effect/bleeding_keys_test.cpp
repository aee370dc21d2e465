// [bleeding] in a scene: hide_mm by the time in which the hole fills, what suction takes and wax stops, and down by the hole's capacity under
// oblique gravity.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/rotation.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kRadius = 2e-3, kThickness = 5e-3;  // [m] of the punch; of the bone

/// Down along an axis to 5.5 mm in half a second, then back to 3 mm above the bone.
class GivenHand final : public HandSource {
 public:
  explicit GivenHand(const Vec3& axis) : axis_(glm::normalize(axis)) { state_.world_from_hand.rotation = rotation_from_z(-axis_); }
  const HandState& read() noexcept override {
    const double t = static_cast<double>(tick_) * 1e-3;
    const double depth = t < 0.5 ? -1e-3 + 13e-3 * t : std::max(-3e-3, 5.5e-3 - 43e-3 * (t - 0.5));
    state_.world_from_hand.translation = axis_ * depth;
    state_.spin = t < 0.7 ? 1.0 : 0.0;
    state_.tick = tick_++;
    return state_;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  Vec3 axis_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

/// 5 mm of nearly level skull, 3 mm of it diploe of one hardness, through which a flat cylinder of 4 mm goes without contact.
struct Bled {
  GivenHand hand;
  std::unique_ptr<DrillRun> run;
  [[nodiscard]] double of(const char* name) const { return figure(run->simulation(), "bleeding", name); }
};
Bled bled(const std::string& keys, const std::vector<std::string>& sets, const Vec3& axis = {0.0, 0.0, -1.0}) {
  Bled out{GivenHand(axis), nullptr};
  SmallScene scene{.volume = kSkullPatchKeys,
                   .contact = false,
                   .sets = {"tool.name=\"punch\"", "tool.erosion_scale=1e4", "volume.extent_mm=[10.0, 10.0, 10.0]",
                            "volume.curvature_mm=1000", "volume.outer_table_mm=1.0", "volume.inner_table_mm=1.0", "volume.porosity=0.0",
                            fmt::format("approach.axis=[{}, {}, {}]", axis.x, axis.y, axis.z)}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  SimulationOptions options;
  options.hand = &out.hand;
  out.run = std::make_unique<DrillRun>(load_text(scene_text(scene) + "[bleeding]\n" + keys, scene.sets), options);
  out.run->run();
  return out;
}

/// [m^3] Plain twin: what of a cylinder that is bored along an axis through a level plate lies below the lowest place of its rim, in cubes of 0.05 mm.
double capacity(const Vec3& axis, const Vec3& down) {
  const Vec3 along = glm::normalize(axis), to_ground = glm::normalize(down);
  double rim = 0.0;  // [m] along `to_ground`, the farthest place of the rim
  constexpr int kPlaces = 3600;
  for (int n = 0; n < kPlaces; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kPlaces;
    const Vec3 side = rotation_from_z(along) * Vec3(kRadius * std::cos(angle), kRadius * std::sin(angle), 0.0);
    rim = std::max(rim, glm::dot(side - along * (side.z / along.z), to_ground));  // in the plane z = 0
  }
  constexpr double kCube = 5e-5;
  double sum = 0.0;
  for (int k = 0; k < 100; ++k)
    for (int j = -100; j < 100; ++j)
      for (int i = -100; i < 100; ++i) {
        const Vec3 p((i + 0.5) * kCube, (j + 0.5) * kCube, -(k + 0.5) * kCube);
        const Vec3 aside = p - along * glm::dot(p, along);
        if (glm::length(aside) < kRadius && glm::dot(p, to_ground) > rim) sum += kCube * kCube * kCube;
      }
  return sum;
}

}  // namespace

namespace {
/// 2 mm of blood in the hole a second: 5 mm of it are 52 of 13,000 Pa, and no pore closes, so the flow is constant within 0.4 %.
constexpr const char* kSteady = "conductance_mm_per_s_kPa = 0.2\npressure_kPa = 13\ncoagulation_s = 1e6\nfilm_s = 0.01\n";
}  // namespace

TEST_CASE("bleeding: the floor is hidden from the time on at which the flow has filled the hole to hide_mm") {
  // A level of h needs A h of blood: from one depth to another it takes A (h2 - h1) / Q. The hole's area is known to 1 % (cut voxels), a time to a step.
  const auto hidden = [](double depth) {
    return bled(kSteady + fmt::format("hide_mm = {}\n", depth), {"duration_s=4.0", "erosion.rate_hz=200"});
  };
  const double area = std::numbers::pi * kRadius * kRadius;
  const Bled first = hidden(1.0);
  const double flow = first.of("flow_ml_per_min") * 1e-6 / 60.0;
  for (const double depth : {0.5, 2.0, 4.0}) {
    CAPTURE(depth);
    const double later = first.of("floor_hidden_s") - hidden(depth).of("floor_hidden_s");
    const double expected = area * (depth - 1.0) * 1e-3 / flow, off = 0.015 * std::abs(expected) + 2 * 0.005;
    MESSAGE("hidden from " << depth << " mm on: later by " << later << " s, expected " << expected);
    CHECK(std::abs(later - expected) < off);
    CHECK(std::abs(later - area * (1.1 * depth - 1.0) * 1e-3 / flow) > off);  // sabotage
  }
}

TEST_CASE("bleeding: suction takes suction_ml_per_min as long as there is blood, and wax_s later wax lets the flow go on for that time") {
  const auto run = [](const std::string& keys, double seconds, const char* name) {
    return bled(kSteady + keys, {fmt::format("duration_s={}", seconds), "erosion.rate_hz=200"}).of(name);
  };
  // Below the flow of 1.5 ml/min the hole is never empty again.
  const double flow = run("", 4.0, "flow_ml_per_min");
  REQUIRE(flow > 1.2);
  for (const double suction : {0.5, 1.0})
    CHECK(run(fmt::format("suction_ml_per_min = {}\n", suction), 4.0, "sucked_ml") -
              run(fmt::format("suction_ml_per_min = {}\n", suction), 2.5, "sucked_ml") ==
          doctest::Approx(suction * 1.5 / 60.0).epsilon(1e-9));
  // Above it, what flows, but for a film of 0.01 s of it.
  CHECK(run("suction_ml_per_min = 100\n", 4.0, "sucked_ml") ==
        doctest::Approx(run("suction_ml_per_min = 100\n", 4.0, "bled_ml")).epsilon(0.005));
  // Wax comes with a step of 5 ms, so two of them may differ by one.
  const auto waxed = [&](double time) { return run(fmt::format("wax = \"after\"\nwax_s = {}\n", time), 4.0, "bled_ml"); };
  const double first = waxed(1.5);
  for (const double time : {2.0, 3.0})
    CHECK(waxed(time) - first == doctest::Approx(flow * (time - 1.5) / 60.0).epsilon(0.004 + 0.005 / (time - 1.5)));
}

TEST_CASE("bleeding: the hole holds what lies below the lowest place of its rim, along `down`") {
  // A vertical cylinder of the length L under gravity that leans by t: pi R^2 (L - R tan t). For an oblique one the sign of the direction counts. The level is known to
  // a layer, the largest height of a step to the next voxel, over the hole's section across gravity; the volume to 1 %.
  constexpr double kEdge = 0.125e-3;
  struct Case {
    Vec3 axis, down;
  };
  const Vec3 straight(0.0, 0.0, -1.0), oblique(0.3, 0.0, -1.0);
  for (const Case& one : {Case{straight, {0.0, 0.0, -1.0}},
                          {straight, {0.5, 0.0, -1.0}},
                          {straight, {0.0, -1.0, -1.0}},
                          {straight, {-0.6, 0.6, -1.0}},
                          {oblique, {0.5, 0.0, -1.0}},
                          {oblique, {-0.5, 0.0, -1.0}}}) {
    CAPTURE(one.down.x);
    CAPTURE(one.down.y);
    const auto found = [&](const Vec3& down) {
      return 1e-6 *
             bled(fmt::format("down = [{}, {}, {}]\n", down.x, down.y, down.z), {"duration_s=0.9", "volume.spacing_mm=0.125"}, one.axis)
                 .of("hole_ml");
    };
    const double expected = capacity(one.axis, one.down), held = found(one.down);
    const Vec3 to_ground = glm::normalize(one.down), size = glm::abs(to_ground);
    const double section = std::numbers::pi * kRadius * kRadius / glm::dot(glm::normalize(one.axis), to_ground);
    const double off = kEdge * std::max({size.x, size.y, size.z}) * section + 0.01 * expected;
    MESSAGE("down (" << one.down.x << ", " << one.down.y << "): " << held * 1e9 << " mm3, expected " << expected * 1e9 << ", within "
                     << off * 1e9);
    CHECK(std::abs(held - expected) < off);
    // Sabotage: the wrong side, and a tenth more of a large lean.
    if (one.axis.x != 0.0) CHECK(std::abs(held - capacity(one.axis, one.down * Vec3(-1.0, 1.0, 1.0))) > off);
    if (one.down.y == -1.0) CHECK(std::abs(held - capacity(one.axis, one.down * Vec3(1.0, 1.1, 1.0))) > off);
  }
  // Upwards it holds nothing, but for less than the layer of voxels at the bone's surface.
  CHECK(bled("down = [0, 0, 1]\n", {"duration_s=0.9", "volume.spacing_mm=0.125"}).of("hole_ml") <
        std::numbers::pi * kRadius * kRadius * kEdge * 1e6);
  // The vertical one has the closed form.
  for (const double lean : {0.5, 1.0})
    CHECK(capacity(straight, {lean, 0.0, -1.0}) ==
          doctest::Approx(std::numbers::pi * kRadius * kRadius * (kThickness - kRadius * lean)).epsilon(0.01));
}

}  // namespace burrhole::test
