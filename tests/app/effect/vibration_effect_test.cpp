// [vibration] in a scene: the size by chips against a twin on the recorded removal, layers and breakthrough, the drilling force, keys, replay.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

LoadedScene scene_of(const std::string& vibration, const SmallScene& scene = {}) {
  return load_text(scene_text(scene) + "\n[record]\n" + vibration, scene.sets);
}
double mean(const std::vector<double>& values, double from, double to) {  // of shares of the run
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  const auto first = static_cast<std::size_t>(from * count), last = static_cast<std::size_t>(to * count);
  for (std::size_t n = first; n < last; ++n) sum += values[n];
  return sum / static_cast<double>(last - first);
}

/// A hand that goes down at 1 mm/s from half a millimetre above the plate to 0.7 mm below it, then up; what it gets does not move it. So runs that
/// differ in their vibration alone cut alike, and contact gives alike.
class GivenHand final : public HandSource {
 public:
  const HandState& read() noexcept override {
    const double t = static_cast<double>(forces.size()) * 1e-3;
    state_.world_from_hand.translation = Vec3(0.0, 0.0, t < 1.2 ? 0.5e-3 - 1e-3 * t : -0.7e-3 + 5e-3 * (t - 1.2));
    state_.tick = forces.size();
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override {
    forces.push_back(on_hand.force);
    sizes.push_back(*size);
  }
  const double* size = nullptr;  // [N] column of [vibration]
  std::vector<Vec3> forces;      // [N] of each tick
  std::vector<double> sizes;     // [N] of each tick

 private:
  HandState state_;
};

GivenHand cut_and_lift(const std::string& keys) {
  GivenHand hand;
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(scene_of("[vibration]\nsource = \"chips\"\n" + keys, {.sets = {"duration_s=1.5", "tool.erosion_scale=20"}}), options);
  for (const Clock clock : {Clock::servo, Clock::contact, Clock::simulation})
    for (const StepColumn& column : run.simulation().stage().graph.columns(clock))
      if (column.name == "vibration") hand.size = column.value;
  REQUIRE(hand.size != nullptr);
  run.run();
  REQUIRE(hand.sizes.size() == 1500);
  REQUIRE(*std::ranges::max_element(hand.sizes) > 2e-3);
  return hand;
}

}  // namespace

TEST_CASE("vibration by chips: its size is that of a twin on the removed bone, by the key fracture_um") {
  const TemporaryFolder folder;
  double fracture = 75e-6;
  SUBCASE("the default") {}
  SUBCASE("half") { fracture = 37.5e-6; }
  SUBCASE("twice") { fracture = 150e-6; }
  DrillRun run(scene_of("[vibration]\nsource = \"chips\"\nfracture_um = " + std::to_string(fracture * 1e6) + "\n",
                        {.sets = {"duration_s=2.5", "tool.name=\"pin\""}}));
  run_recorded(run, folder.file("run.bhs"));
  const std::vector<double> removed = session_column(folder.file("run.bhs"), "removed_mass"),
                            size = session_column(folder.file("run.bhs"), "vibration");
  // From 50 to 90 % of the run, a flat pin of 2 mm in a plate, pressed by 20 N at 1000 rpm: a tangential force of half the thrust, on all teeth.
  const double share = removed.size() > 20 ? 0.4 : 0.0, seconds = 2.5 * share;
  REQUIRE(seconds > 0.0);
  const auto count = static_cast<double>(removed.size());
  const double volume = removed[static_cast<std::size_t>(0.9 * count) - 1] - removed[static_cast<std::size_t>(0.5 * count) - 1];
  const auto teeth = static_cast<double>(run.loaded().tool.teeth);
  const double thickness = volume / seconds / (1000.0 / 60.0) / teeth / (std::numbers::pi * 1e-6);
  const double expected = 0.5 * 20.0 / teeth * thickness / (thickness + fracture);
  INFO("chips of [um] ", thickness * 1e6);
  REQUIRE(thickness > 5e-6);
  // The area of the pin is that of voxel columns, 6 %; the lag of 20 ms does not count in steady cutting.
  CHECK(mean(size, 0.5, 0.9) == doctest::Approx(expected).epsilon(0.08));
  // Sabotage: without the share that breaks it would be the whole force on a tooth.
  CHECK(mean(size, 0.5, 0.9) < 0.7 * 0.5 * 20.0 / teeth);
}

TEST_CASE("vibration by chips: soft bone vibrates more than hard bone, and nothing vibrates behind the bone") {
  const auto with_hardness = [](double hardness) {
    DrillRun run(
        scene_of("[vibration]\nsource = \"chips\"\n", {.sets = {"duration_s=1.5", "volume.hardness=" + std::to_string(hardness)}}));
    run.run();
    return figure(run.simulation(), "vibration", "mean_N");
  };
  CHECK(with_hardness(0.4) > 1.2 * with_hardness(0.8));

  const TemporaryFolder folder;
  DrillRun through(
      scene_of("[vibration]\nsource = \"chips\"\n", {.sets = {"duration_s=8.0", "volume.hardness=0.2", "volume.thickness_mm=1.0"}}));
  run_recorded(through, folder.file("run.bhs"));
  const std::vector<double> size = session_column(folder.file("run.bhs"), "vibration");
  const double most = *std::ranges::max_element(size);
  CHECK(most > 0.1);
  CHECK(size.back() < 0.01 * most);  // the wall of the hole is all that is left to cut
}

TEST_CASE("vibration by chips: the force that turns with the bit is `uneven` of that which turns with each tooth") {
  // Alike in all but this, two runs differ by the force that turns with the bit: of the size u a, a the column `vibration`, once a revolution. Forces
  // of up to 10 N are rounded to 1e-15 of themselves, a few hundred times.
  constexpr double kTurn = 2.0 * std::numbers::pi * 1000.0 / 60.0 * 1e-3;  // [rad] in a tick
  const GivenHand even = cut_and_lift("uneven = 0\n");
  for (const double uneven : {0.2, 0.4, 1.0}) {
    CAPTURE(uneven);
    const GivenHand hand = cut_and_lift("uneven = " + std::to_string(uneven) + "\n");
    CHECK(hand.sizes == even.sizes);
    double worst = 0.0, worst_turn = 0.0, sabotaged = 0.0;
    for (std::size_t n = 300; n < hand.forces.size(); ++n) {  // after the soft start of 0.2 s
      const Vec3 part = hand.forces[n] - even.forces[n], before = hand.forces[n - 1] - even.forces[n - 1];
      worst = std::max(worst, std::abs(glm::length(part) - uneven * hand.sizes[n]));
      sabotaged = std::max(sabotaged, std::abs(glm::length(part) - 1.1 * uneven * hand.sizes[n]));
      CHECK(std::abs(part.z) < 1e-11);
      if (uneven * hand.sizes[n - 1] < 1e-4) continue;
      const double turned = std::atan2(before.x * part.y - before.y * part.x, before.x * part.x + before.y * part.y);
      worst_turn = std::max(worst_turn, std::abs(std::abs(turned) - kTurn));
    }
    CHECK(worst < 1e-11);
    CHECK(worst_turn < 1e-8);
    CHECK(sabotaged > 5e-5);  // a tenth more
  }
}

TEST_CASE("vibration by chips: its size follows the chips with the time constant rise_ms") {
  // The same chips in all runs: from a run of T the size that it goes to is a(n - 1) + (a(n) - a(n - 1)) / (1 - exp(-dt / T)), which another T then
  // follows. Rounding of 1e-16 N grows by 20 of the first division.
  const GivenHand usual = cut_and_lift("");
  for (const double rise : {5.0, 20.0, 80.0, 500.0}) {
    CAPTURE(rise);
    const GivenHand hand = cut_and_lift("rise_ms = " + std::to_string(rise) + "\n");
    double expected = 0.0, wrong = 0.0, worst = 0.0, sabotaged = 0.0;
    for (std::size_t n = 1; n < hand.sizes.size(); ++n) {
      const double goal = usual.sizes[n - 1] + (usual.sizes[n] - usual.sizes[n - 1]) / (1.0 - std::exp(-1.0 / 20.0));
      expected += (goal - expected) * (1.0 - std::exp(-1.0 / rise));
      wrong += (goal - wrong) * (1.0 - std::exp(-0.9 / rise));
      worst = std::max(worst, std::abs(hand.sizes[n] - expected));
      sabotaged = std::max(sabotaged, std::abs(hand.sizes[n] - wrong));
    }
    CHECK(worst < 1e-13);
    CHECK(sabotaged > 1e-5);
  }
}

TEST_CASE("vibration of fixed size: the hand gets its amplitude, cycles_per_rev times a revolution, and nothing at another frequency") {
  const TemporaryFolder folder;
  // Without bone's force the hand gets the vibration alone. 1000 rpm for 0.6 s, after the soft start of 0.2 s: ten revolutions.
  constexpr double kSpin = 1000.0 / 60.0, kTick = 1e-3;
  const auto part_at = [&](const std::string& keys, double frequency) {
    DrillRun run(scene_of("[vibration]\n" + keys, {.contact = false, .erosion = false, .sets = {"duration_s=1.0"}}));
    run_recorded(run, folder.file("steady.bhs"));
    const std::vector<double> force = session_column(folder.file("steady.bhs"), "sent_x");
    REQUIRE(force.size() >= 900);
    double cosine = 0.0, sine = 0.0;
    for (std::size_t n = 300; n < 900; ++n) {
      const double angle = 2.0 * std::numbers::pi * frequency * kTick * static_cast<double>(n);
      cosine += force[n] * std::cos(angle);
      sine += force[n] * std::sin(angle);
    }
    return std::hypot(cosine, sine) / 300.0;  // [N] amplitude
  };
  for (const double cycles : {1.0, 3.0, 7.0}) {
    CAPTURE(cycles);
    const std::string keys = "amplitude_N = 0.3\ncycles_per_rev = " + std::to_string(cycles) + "\n";
    CHECK(part_at(keys, cycles * kSpin) == doctest::Approx(0.3).epsilon(1e-4));
    CHECK(part_at(keys, (cycles + 1.0) * kSpin) < 1e-4);  // sabotage: another number of cycles
  }
  CHECK(part_at("amplitude_N = 0.6\n", kSpin) == doctest::Approx(0.6).epsilon(1e-4));
}

namespace {

/// A hand that goes down through the plate at 1 mm/s, and from kFaster on at 3 mm/s. What it gets does not move it.
class FasterHand final : public HandSource {
 public:
  static constexpr std::size_t kFaster = 700;  // ticks
  const HandState& read() noexcept override {
    const double n = static_cast<double>(forces.size()), slow = static_cast<double>(kFaster);
    state_.world_from_hand.translation = Vec3(0.0, 0.0, 0.2e-3 - 1e-6 * std::min(n, slow) - 3e-6 * std::max(0.0, n - slow));
    state_.tick = forces.size();
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override { forces.push_back(on_hand.force); }
  std::vector<Vec3> forces;  // [N] of each tick

 private:
  HandState state_;
};

/// Without [contact] the drill is where the hand is, and the hand gets the drilling force alone.
FasterHand drill_through(const std::string& keys, const std::vector<std::string>& sets = {}) {
  FasterHand hand;
  SimulationOptions options;
  options.hand = &hand;
  SmallScene scene{.contact = false, .sets = {"duration_s=1.2", "tool.name=\"pin\"", "tool.erosion_scale=1e4"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  DrillRun run(scene_of("[vibration]\namplitude_N = 0\n[vibration.drilling_force]\nallowance_mJ = 1000\n" + keys, scene), options);
  run.run();
  REQUIRE(hand.forces.size() == 1200);
  CHECK(figure(run.simulation(), "vibration", "drilling_limited_ticks") == 0.0);
  return hand;
}

}  // namespace

TEST_CASE("drilling force: its size is resistance_N_s_per_m times the speed, which it follows with the time constant time_constant_ms") {
  // Bone is before the tip from 0.2 s on, so the direction to it has the length 1 from the bone step after that on. The mean of the speed has come to
  // 1 mm/s when it changes, but for exp(-0.7 s / T) of it, and then goes to 3 mm/s: v = 3 - (2 + exp(-0.7 s / T)) exp(-t / T) mm/s. The difference of two places of 1 mm,
  // over a tick of 1 ms, is exact to 1e-15 m/s.
  const auto check = [](double resistance, double time) {
    CAPTURE(resistance);
    CAPTURE(time);
    const FasterHand hand =
        drill_through("resistance_N_s_per_m = " + std::to_string(resistance) + "\ntime_constant_ms = " + std::to_string(time) + "\n");
    double worst = 0.0, stiffer = 0.0, slower = 0.0;
    for (std::size_t n = 300; n < hand.forces.size(); ++n) {
      const double since = static_cast<double>(n) - static_cast<double>(FasterHand::kFaster);
      const auto expected = [&](double k, double constant) {
        const double before = 1.0 - std::exp(-(std::min(since, 0.0) + 700.0) / constant);
        return k * 1e-3 * (since < 0.0 ? before : 3.0 - (3.0 - before) * std::exp(-since / constant));
      };
      const double found = glm::length(hand.forces[n]);
      worst = std::max(worst, std::abs(found - expected(resistance, time)));
      stiffer = std::max(stiffer, std::abs(found - expected(1.1 * resistance, time)));
      slower = std::max(slower, std::abs(found - expected(resistance, 1.1 * time)));
    }
    MESSAGE("resistance " << resistance << ", time constant " << time << ": within " << worst << " N; sabotaged " << stiffer << ", "
                          << slower);
    CHECK(worst < 1e-14 * resistance);  // rounding: some 1e-16 of 3 mm/s, and of places over the tick
    CHECK(stiffer > 1e-4 * resistance);
    CHECK(slower > 1e-5 * resistance);
    CHECK(hand.forces.back().z > 0.99 * glm::length(hand.forces.back()));  // out of the bone
  };
  for (const double resistance : {50.0, 100.0, 400.0}) check(resistance, 10.0);
  for (const double time : {2.0, 50.0, 200.0}) check(100.0, time);
  for (const Vec3& force : drill_through("", {"tool.spin_rpm=0"}).forces) CHECK(glm::length(force) == 0.0);
}

TEST_CASE("drilling force: the keys of its limit give its largest force, allowance over acceleration and square of the tick") {
  // A hand that may accelerate by a = 1e5 m/s2 moves by up to s = v T + a T^2 = 0.1 m in a tick, so the force is at most (E + A) / s. Against this force
  // the hand gives dE = (E + A) dx / s over the way dx, so at the end of a way x with bone ahead (E + A) / s = A / s exp(x / s): 2 % more than A / s for the
  // 2 mm that the hand goes from the face to the last tick. Bone counts as ahead from half a voxel of 0.25 mm before it on (balance_point.h). v T is 3e-5 of s.
  // Bone is found by a step of 20 ms, or the next: at 1 mm/s, up to 0.04 mm of x later.
  const auto check = [](const std::string& keys, double acceleration, double allowance) {
    CAPTURE(keys);
    FasterHand hand;
    SimulationOptions options;
    options.hand = &hand;
    const SmallScene scene{.contact = false, .sets = {"duration_s=1.2", "tool.name=\"pin\"", "tool.erosion_scale=1e4"}};
    DrillRun run(scene_of("[vibration]\namplitude_N = 0\n[vibration.drilling_force]\n" + keys, scene), options);
    run.run();
    CHECK(figure(run.simulation(), "vibration", "drilling_limited_ticks") > 800.0);
    const double s = acceleration * 1e-6, way = 0.5e-3 + 1.5e-3 + 0.125e-3;
    const double peak = figure(run.simulation(), "vibration", "drilling_peak_N");
    MESSAGE("peak " << peak << " N, expected " << allowance / s * std::exp(way / s));
    CHECK(peak == doctest::Approx(allowance / s * std::exp(way / s)).epsilon(0.04e-3 / s + 1e-4));
    // Sabotage: without what the hand has given.
    CHECK(peak > (1.0 + 0.5 * way / s) * allowance / s);
  };
  check("acceleration_m_per_s2 = 1e5\n", 1e5, 1e-3);
  check("acceleration_m_per_s2 = 1e5\nallowance_mJ = 0.5\n", 1e5, 0.5e-3);
  check("acceleration_m_per_s2 = 5e4\nallowance_mJ = 0.5\n", 5e4, 0.5e-3);
}

TEST_CASE("vibration: a replay has the same bits") {
  const TemporaryFolder folder;
  const std::string keys = "[spindle]\n[vibration]\nsource = \"chips\"\n[vibration.drilling_force]\n";
  DrillRun run(scene_of(keys, {.sets = {"duration_s=1.0"}}));
  run_recorded(run, folder.file("run.bhs"));
  ReplayRun replay(folder.file("run.bhs"));
  CHECK(replay.run().run().voxel_hash() == run.voxel_hash());
  CHECK(figure(replay.run().simulation(), "vibration", "mean_N") == figure(run.simulation(), "vibration", "mean_N"));
  CHECK(figure(replay.run().simulation(), "vibration", "drilling_peak_N") == figure(run.simulation(), "vibration", "drilling_peak_N"));
}

TEST_CASE("vibration: what its source does not have is refused with its place") {
  for (const char* const keys : {"source = \"chips\"\namplitude_N = 1\n", "fracture_um = 10\n", "source = \"noise\"\n",
                                 "source = \"chips\"\nfracture_um = 0\n", "drilling_force = 3\n"}) {
    Issues issues;
    const auto document = TomlDocument::parse(scene_text({}) + "\n[vibration]\n" + keys, "small.toml");
    REQUIRE(document);
    const auto loaded = load_scene(*document, test_context(), issues);
    CHECK_FALSE((loaded && issues.empty()));
    REQUIRE_FALSE(issues.empty());
    CHECK(issues.front().text().find("small.toml:") != std::string::npos);
  }
}

}  // namespace burrhole::test
