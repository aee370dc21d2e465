// [device] in a run: each key changes the recorded motion of the hand, or the force that the device shows, by a stated amount.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kTick = 1e-3, kStandoff = 20e-3, kFeed = 20e-3;  // [s], [m], [m/s]
constexpr double kReading = 1e-15;                                // [m] a few roundings of 20 mm

/// [m] how far the hand has come down at each tick, in the air.
std::vector<double> way_of(const std::string& device) {
  const TemporaryFolder folder;
  DrillRun run(SmallScene{.contact = false,
                          .erosion = false,
                          .record = true,
                          .sets = {"duration_s=0.6", "hand.standoff_mm=20", "hand.feed_mm_per_s=20", device}});
  run_recorded(run, folder.file("run.sqlite"));
  std::vector<double> way = session_column(folder.file("run.sqlite"), "hand_z");
  REQUIRE(way.size() == 600);
  const double start = way.front();  // the standoff, rounded to the device's steps, above an entry that is found to 1e-10 m
  REQUIRE(std::abs(start - kStandoff) < 0.03e-3);
  for (double& z : way) z = start - z;
  return way;
}

/// The grip on the spring of a hand that comes down.
struct GripKeys {
  double mass_kg = 0.25, damping_N_s_per_m = 5, stiffness_N_per_m = 300, friction_N = 0.05, position_scale = 1;
  [[nodiscard]] std::string text() const {
    return fmt::format("device={{mass_kg={}, damping_N_s_per_m={}, stiffness_N_per_m={}, friction_N={}, position_scale={}, step_mm=0}}",
                       mass_kg, damping_N_s_per_m, stiffness_N_per_m, friction_N, position_scale);
  }
  /// m x'' + b x' + k x = k v t from rest, once k v t is the friction; the hand's spring moves at a tick, so half a tick ahead. A reading is a tick late.
  /// The velocity does not change its sign with a damping of more than 0, and friction not its own.
  [[nodiscard]] double way(double time) const {
    const double v = kFeed / position_scale, start = std::max(0.0, friction_N / (stiffness_N_per_m * v) - 0.5 * kTick),
                 t = std::max(0.0, time - kTick - start);
    const double decay = damping_N_s_per_m / (2.0 * mass_kg), turn = std::sqrt(stiffness_N_per_m / mass_kg - decay * decay),
                 lag = v * damping_N_s_per_m / stiffness_N_per_m;
    return position_scale *
           (v * t - lag + std::exp(-decay * t) * (lag * std::cos(turn * t) + (decay * lag - v) / turn * std::sin(turn * t)));
  }
  /// [m] The steps of the spring's end are within k v dt^2 of a ramp's impulse, which moves the grip by this at most.
  [[nodiscard]] double bound() const { return std::sqrt(stiffness_N_per_m / mass_kg) * kTick * kTick * kFeed * 1.5; }
};

double furthest(const std::vector<double>& way, const GripKeys& keys) {
  double out = 0.0;
  for (std::size_t n = 0; n < way.size(); ++n) out = std::max(out, std::abs(way[n] - keys.way(static_cast<double>(n) * kTick)));
  return out;
}

}  // namespace

TEST_CASE("device: mass, damping, stiffness, friction and position_scale give the way of a grip that the hand's spring moves") {
  for (const GripKeys& keys :
       {GripKeys{}, GripKeys{.mass_kg = 0.6}, GripKeys{.damping_N_s_per_m = 9, .friction_N = 0.2},
        GripKeys{.stiffness_N_per_m = 1000, .friction_N = 0.4}, GripKeys{.position_scale = 3}, GripKeys{.position_scale = 0.5}}) {
    CAPTURE(keys.text());
    const std::vector<double> way = way_of(keys.text());
    MESSAGE("within " << furthest(way, keys) << " m of " << keys.bound());
    CHECK(furthest(way, keys) < keys.bound());
    for (double GripKeys::*const key : {&GripKeys::mass_kg, &GripKeys::damping_N_s_per_m, &GripKeys::stiffness_N_per_m,
                                        &GripKeys::friction_N, &GripKeys::position_scale}) {
      GripKeys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(furthest(way, wrong) > 3.0 * keys.bound());
    }
  }
}

TEST_CASE("device: name and hand give mass, damping, stiffness and friction; without a spring of the hand, the arm moves the grip") {
  // An omni of 0.045 kg, 0.5 N s/m and 0.26 N in a firm hand of 0.6 kg, 10 N s/m and 1000 N/m.
  const GripKeys omni{0.645, 10.5, 1000, 0.26, 1};
  const std::vector<double> stepped = way_of("device={name=\"omni\", friction_N=0}");  // of 0.055 mm, from the nearest to 20 mm
  for (const double way : stepped) {
    const double steps = way / 0.055e-3;
    CHECK(std::abs(steps - std::round(steps)) < 1e-9);
  }
  CHECK(std::ranges::any_of(stepped, [](double way) { return std::abs(way - 0.055e-3) < kReading; }));
  CHECK(furthest(way_of("device={name=\"omni\", hand=\"firm\", step_mm=0}"), omni) < omni.bound());
  CHECK(furthest(way_of("device={name=\"omni\", step_mm=0}"), omni) > 3.0 * omni.bound());
  CHECK(furthest(way_of("device={hand=\"firm\", step_mm=0}"), omni) > 3.0 * omni.bound());
  // A generic device in a light hand of 0.05 kg and 0.5 N s/m. The arm of 10 N s/m and 1000 N/m is felt at 8 N for 20.
  for (const double scale : {1.0, 2.0}) {
    const GripKeys light{0.15, 1.0 + 4.0 * scale, 400 * scale, 0.05, scale};
    CHECK(furthest(way_of(fmt::format("device={{hand=\"light\", position_scale={}, step_mm=0}}", scale)), light) < light.bound());
  }
}

TEST_CASE("device: step_mm rounds the position of the grip, and delay_ticks is how late it is known") {
  const auto with = [](double step_mm, int delay, double scale) {
    return way_of(fmt::format("device={{step_mm={}, delay_ticks={}, position_scale={}}}", step_mm, delay, scale));
  };
  for (const double scale : {1.0, 2.5}) {
    const std::vector<double> exact = with(0.0, 0, scale);
    for (const double step_mm : {0.05, 0.2}) {
      const auto rounded = [&](double way, double step) {
        return kStandoff - scale * step * 1e-3 * std::floor((kStandoff - way) / (scale * step * 1e-3) + 0.5);
      };
      const std::vector<double> found = with(step_mm, 0, scale);
      std::size_t other = 0, wrong = 0;
      for (std::size_t n = 0; n < exact.size(); ++n) {
        other += std::abs(found[n] - rounded(exact[n], step_mm)) > kReading ? 1 : 0;
        wrong += std::abs(found[n] - rounded(exact[n], 1.1 * step_mm)) > kReading ? 1 : 0;
      }
      CHECK(other == 0);
      CHECK(wrong > 500);
    }
    for (const std::size_t delay : {1u, 10u, 31u}) {
      const std::vector<double> late = with(0.0, static_cast<int>(delay), scale);
      double worst = 0.0;
      for (std::size_t n = 0; n < late.size(); ++n) worst = std::max(worst, std::abs(late[n] - (n < delay ? 0.0 : exact[n - delay])));
      CHECK(worst < kReading);
      CHECK(std::abs(late[400] - exact[400 - delay + 1]) > 1e-6);  // a tick less
    }
  }
}

TEST_CASE("device: force_scale is the force at the grip over that on the drill, and force_N its limit") {
  struct Pressed {
    double shown = 0.0, sent = 0.0;  // [N] at the grip, on the drill
  };
  const auto pressed = [](const std::string& device, double push) {
    const TemporaryFolder folder;
    DrillRun run(
        SmallScene{.erosion = false,
                   .record = true,
                   .sets = {"duration_s=4.0", "tool.spin_rpm=0", "servo.energy_mJ=0", fmt::format("hand.push_N={}", push), device}});
    run_recorded(run, folder.file("run.sqlite"));
    return Pressed{figure(run.simulation(), "device", "shown_force_N"),
                   std::abs(session_column(folder.file("run.sqlite"), "sent_z").back())};
  };
  // The push is scaled as forces are. At rest the hand's spring has followed, to exp(-3 s / 0.25 s) of its way, and friction holds up to 0.05 N.
  for (const double scale : {0.4, 0.3, 0.1}) {
    const Pressed found = pressed(fmt::format("device={{force_scale={}}}", scale), 20.0);
    MESSAGE("shown " << found.shown << " N of " << found.sent);
    CHECK(found.shown == doctest::Approx(scale * found.sent).epsilon(1e-6).scale(0.0));  // a recorded force has 24 bits
    CHECK(std::abs(found.shown - scale * 20.0) < 0.06);
    CHECK(std::abs(found.shown - 1.1 * scale * 20.0) > 0.06);
  }
  // Absent: the largest force over the push, at most 1.
  CHECK(pressed("device={force_N=5}", 20.0).shown == doctest::Approx(5.0).epsilon(0.0125).scale(0.0));
  CHECK(pressed("device={force_N=5}", 4.0).sent == doctest::Approx(4.0).epsilon(0.0125).scale(0.0));
  CHECK(pressed("device={name=\"omni\", friction_N=0.0}", 20.0).shown == doctest::Approx(3.3).epsilon(0.005).scale(0.0));
  // The limit, where the push is more.
  for (const auto& [scale, force] : {std::pair{1.0, 3.0}, {0.5, 3.0}, {0.5, 6.0}}) {
    const Pressed found = pressed(fmt::format("device={{force_scale={}, force_N={}}}", scale, force), 20.0);
    CHECK(found.shown == doctest::Approx(force).epsilon(1e-12).scale(0.0));
    CHECK(found.sent == doctest::Approx(force / scale).epsilon(1e-6).scale(0.0));
  }
}

}  // namespace burrhole::test
