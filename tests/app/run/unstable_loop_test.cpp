// Unstable loops of hand, device and coupling are warned about before a run and reported after it; stable ones are silent.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "app/job/plan.h"
#include "app/job/summary.h"
#include "app/run/lockstep.h"
#include "app/stage/force_loop.h"
#include "tests/support/drill_scene.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

using Sets = std::vector<std::string>;

Sets joined(Sets a, const Sets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A device that renders forces unscaled, up to 30 N, on a bit at rest that a hand presses with 12 N.
LoadedScene pressed(const Sets& sets) {
  const Sets base{"duration_s=6", "hand.standoff_mm=0.5", "hand.push_N=12", "tool.spin_rpm=0", "device.force_scale=1", "device.force_N=30"};
  return load_small({.sets = joined(base, sets)});
}

/// The line about the loop; empty if there is none.
std::string loop_line(const LoadedScene& loaded) {
  for (const std::string& warning : make_plan(loaded).warnings)
    if (warning.find("is unstable") != std::string::npos) return warning;
  return {};
}

struct Found {
  std::vector<std::string> warnings;  ///< of the servo
  Swing swing;
  double late_change = 0.0;  ///< [N] largest less smallest force in the last half second
};

Found run(const LoadedScene& loaded, double seconds = 4.0) {
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, {}, issues);
  REQUIRE(simulation);
  REQUIRE(simulation->run());
  Found out{fault_warnings(*simulation), simulation->stage().servo->swing()};
  simulation->stage().warn(out.warnings);
  auto parts = Stage::make(loaded.scene, loaded.scene.effects, loaded.bone, loaded.tool, {});
  REQUIRE(parts);
  Lockstep steps(**parts);
  const auto ticks = static_cast<int>(seconds / (*parts)->period), watched = static_cast<int>(0.5 / (*parts)->period);
  double low = 1e9, high = 0.0;
  for (int n = 0; n < ticks; ++n) {
    const double force = glm::length(steps.tick().force);
    if (n < ticks - watched) continue;
    low = std::min(low, force);
    high = std::max(high, force);
  }
  out.late_change = high - low;
  return out;
}

struct Loop {
  const char* name;
  Sets sets;
  const char* over;     ///< what the warning names
  const char* setting;  ///< a setting that it proposes
};
const Loop kLoops[] = {
    {"a coupling of 15880 N/m",
     {"contact.coupling_N_per_m=15880"},
     "coupling_N_per_m = 15880 at device.force_scale 1 is over its limit of 7940",
     "contact.coupling_N_per_m=6300"},
    {"a light hand",
     {"device.hand=\"light\"", "device.stiffness_N_per_m=20", "contact.coupling_N_per_m=10028"},
     "coupling_N_per_m = 10028 at device.force_scale 1 is over its limit of 5035",
     "contact.coupling_N_per_m=4000"},
    {"a damper of 2000 N s/m",
     {"contact.coupling_N_s_per_m=2000"},
     "coupling_N_s_per_m = 2000 at device.force_scale 1 is over its limit of 161.7",
     "contact.coupling_N_s_per_m=80"},
    {"a hand of 5 g",
     {"device.mass_kg=0.005"},
     "coupling_N_per_m = 5000 at device.force_scale 1 is over its limit of 1728",
     "contact.coupling_N_per_m=1300"},
};

}  // namespace

TEST_CASE("unstable loops: each of four is warned about with its limit and a setting, and is reported by the run") {
  for (const Loop& loop : kLoops) {
    CAPTURE(std::string(loop.name));
    const LoadedScene loaded = pressed(loop.sets);
    const std::string line = loop_line(loaded);
    MESSAGE(line);
    CHECK(line.find(loop.over) != std::string::npos);
    const std::string setting(loop.setting);
    const std::string key = setting.substr(8, setting.find('=') - 8), value = setting.substr(setting.find('=') + 1);
    CHECK(line.find(key + " = " + value) != std::string::npos);
    // The energy detector ends it; without that detector the swings do not end, and the other one measures them.
    const Found stopped = run(loaded), swinging = run(pressed(joined(loop.sets, {"servo.energy_mJ=0"})));
    for (const std::string& warning : stopped.warnings) MESSAGE(warning);
    for (const std::string& warning : swinging.warnings) MESSAGE(warning);
    MESSAGE(stopped.late_change << " N, without energy detector " << swinging.late_change);
    REQUIRE(!stopped.warnings.empty());
    CHECK(stopped.warnings.front().find("energy generated") != std::string::npos);
    CHECK(stopped.late_change == 0.0);
    REQUIRE(!swinging.warnings.empty());
    CHECK(swinging.warnings.back().find("limit cycle") != std::string::npos);
    CHECK(swinging.swing.force > 6.0);  // half of the push
  }
}

// At rest the reading alternates by a step at most, which changes the force by that of a step of position, and of a step of the velocity
// that the filter makes of it. Twice that bounds a change between two readings in either direction.
TEST_CASE("unstable loops: with the setting that the warning proposes each is silent and at rest") {
  for (const Loop& loop : kLoops) {
    CAPTURE(std::string(loop.name));
    const LoadedScene loaded = pressed(joined(loop.sets, {loop.setting}));
    CHECK(loop_line(loaded) == "");
    const Found found = run(loaded);
    CHECK(found.warnings.empty());
    CHECK(found.swing.force == 0.0);
    const Needs needs = loaded.scene.effects.needs(loaded.scene);
    const ForceLoop closed = force_loop(loaded.scene, needs);
    const double step = needs.position_step * (closed.stiffness + closed.damping / (closed.period + closed.velocity_time));
    MESSAGE(found.late_change << " N of at most " << 2.0 * step);
    CHECK(found.late_change <= 2.0 * step);
  }
}

TEST_CASE("unstable loops: a hand at 80 % of its limit holds silently, at 120 % it is warned about and reported") {
  for (const char* hand : {"light", "nominal", "firm"}) {
    CAPTURE(std::string(hand));
    // Friction dissipates small swings and hides the limit; the script moves a hand only by a spring.
    Sets sets{std::string("device.hand=\"") + hand + '"', "device.friction_N=0", "device.step_mm=0"};
    if (std::string(hand) == "light") sets.emplace_back("device.stiffness_N_per_m=20");
    const LoadedScene far = pressed(joined(sets, {"contact.coupling_N_per_m=100000"}));
    const double limit = limit_below(force_loop(far.scene, far.scene.effects.needs(far.scene)), &ForceLoop::stiffness);
    const auto at = [&](double part) { return pressed(joined(sets, {"contact.coupling_N_per_m=" + std::to_string(part * limit)})); };
    const LoadedScene below = at(0.8), above = at(1.2);
    MESSAGE(std::string(hand) << ": limit " << limit << " N/m");
    CHECK(loop_line(below) == "");
    const Found quiet = run(below), loud = run(above);
    for (const std::string& warning : loud.warnings) MESSAGE(warning);
    CHECK(quiet.warnings.empty());
    MESSAGE(quiet.late_change << " N against " << loud.late_change);
    CHECK(loop_line(above) != "");
    CHECK(!loud.warnings.empty());
  }
}

TEST_CASE("unstable loops: without [device] the hand on the drill is checked alike, and a hand that feels nothing has no loop") {
  const auto held = [](const Sets& sets) {
    return load_small({.sets = joined({"duration_s=2", "hand.mass_kg=0.1", "tool.spin_rpm=0"}, sets)});
  };
  CHECK(loop_line(held({})) == "");
  const LoadedScene stiff = held({"contact.coupling_N_per_m=80000"});
  MESSAGE(loop_line(stiff));
  CHECK(loop_line(stiff).find(
            "[contact] the loop of hand and coupling is unstable: contact.coupling_N_per_m = 80000 is over its limit of") == 0);
  const Found found = run(stiff, 2.0);
  REQUIRE(!found.warnings.empty());
  CHECK(found.warnings.back().find("limit cycle") != std::string::npos);
  CHECK(loop_line(held({"contact.coupling_N_per_m=80000", "hand.feels=false"})) == "");
}
