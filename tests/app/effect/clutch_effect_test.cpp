// [clutch] in a scene: a small perforator in a plate, with each failure; undo, replay, tables that are refused.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "app/stage/drill_clutch.h"
#include "core/drill/clutch.h"
#include "tests/core/drill/step_tool.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr const char* kWidePlate = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [10.0, 10.0, 8.0]
above_mm = 1.5
thickness_mm = 3.0
hardness = 0.8
)";

/// The tool file of step_tool.h; it exists as long as the process.
std::string step_path() {
  static const TemporaryFolder folder;
  const std::string path = folder.file("step.toml");
  if (!std::filesystem::exists(path)) std::ofstream(path) << step_tool_text({.inner_factor = 0.1, .outer_factor = 0.5});
  return path;
}

/// The plate drilled by the step tool: 28 N, of which the tip carries five sixths: 80 / (80 + 20) of equal areas would be 0.8. Feed: F/K e s / h = 0.83 mm/s.
LoadedScene plate(const std::string& clutch, const std::vector<std::string>& sets = {}, const std::string& volume = kWidePlate,
                  const std::string& contact = "cutting_N_per_m = 70e3\n") {
  std::vector<std::string> all{"tool.name=\"" + step_path() + "\"", "hand.push_N=28.0", "duration_s=12.0"};
  all.insert(all.end(), sets.begin(), sets.end());
  return load_text(scene_text({.volume = volume, .contact_keys = contact}) + clutch, all);
}

struct Outcome {
  double plunge = 0.0, reached = 0.0;  // [m]
  double releases = 0.0, torque_after = -1.0, took = -1.0, released = -1.0, engaged = -1.0, forward = 0.0, removed = 0.0;
  std::uint64_t voxels = 0, forces = 0;
  HandPhase phase = HandPhase::approach;
  double end = 0.0;  // [s]
};

Outcome outcome_of(DrillRun& run) {
  const Simulation& simulation = run.simulation();
  Outcome out;
  const DrillProgress& progress = simulation.progress();
  out.plunge = progress.loss ? progress.loss->plunge : -1.0;
  out.reached = progress.deepest;
  const auto get = [&](const char* name, double absent) { return simulation.stage().figure("clutch", name).value_or(absent); };
  out.releases = get("releases", 0.0);
  out.torque_after = get("torque_after_release_Nm", -1.0);
  out.took = get("release_took_ms", -1.0);
  out.released = get("released_s", -1.0);
  out.engaged = get("engaged_s", -1.0);
  out.forward = get("tip_forward_mm", -1.0);
  out.removed = figure(simulation, "erosion", "removed_mass_mm3");
  out.voxels = run.voxel_hash();
  out.forces = simulation.force_hash();
  out.phase = run.simulation().servo_output().hand.phase;
  out.end = static_cast<double>(run.simulation().servo_output().hand.tick) * 1e-3;
  return out;
}

Outcome drill(const std::string& clutch, const std::vector<std::string>& sets = {}, const std::string& volume = kWidePlate,
              const std::string& contact = "cutting_N_per_m = 70e3\n") {
  DrillRun run(plate(clutch, sets, volume, contact));
  run.run();
  return outcome_of(run);
}

struct Twin {
  double released = -1.0, lost = 0.0, releases = 0.0;  // [s] of the last release; its loss of reaction; how many
  double engaged = -1.0;                               // [s] of the first engagement
};
/// The clutch in steps of 1 us under a reaction [N] per step of `dt`.
Twin follow(const std::vector<double>& reaction, const ClutchConfig& c, double dt) {
  const double left = 1.0 - c.wear, stiffness = left * c.stiffness;
  const double preload = left * c.engage_force - stiffness * c.travel, least = left * c.engage_force - stiffness * c.teeth;
  Twin out;
  double x = 0.0, lost = 0.0;
  bool engaged = false, supported = false;
  const auto parts = std::lround(dt * 1e6);
  for (std::size_t n = 0; n < reaction.size(); ++n) {
    const double from = static_cast<double>(n) * dt;
    if (reaction[n] < least && supported) lost = from;
    supported = reaction[n] >= least;
    for (long part = 0; part < parts; ++part) {
      x = std::clamp(x + 1e-6 / c.damping * (reaction[n] - preload - stiffness * x), 0.0, c.travel);
      const double now = from + 1e-6 * static_cast<double>(part);
      if (!engaged) {
        engaged = x >= 0.999 * c.travel;
        if (engaged && out.engaged < 0.0) out.engaged = now;
      } else if (x < c.travel - c.teeth) {
        engaged = false;
        out = {now, lost, out.releases + 1.0, out.engaged};
      }
    }
  }
  return out;
}

/// Errors of a scene that does not load, or whose run cannot be made.
std::vector<std::string> errors_of(const std::string& clutch, const std::string& tool) {
  auto document = TomlDocument::parse(scene_text({.volume = kWidePlate}) + clutch, "small.toml");
  REQUIRE(document.ok());
  REQUIRE(document->set("tool.name=\"" + tool + "\"").ok());
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  if (loaded) {
    const auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
    if (simulation) REQUIRE(issues.empty());
  }
  std::vector<std::string> out;
  for (const Error& issue : issues) {
    CHECK((issue.code == ErrorCode::bad_input || issue.code == ErrorCode::out_of_range));  // both are exit code 2
    out.push_back(issue.text());
  }
  return out;
}

bool has(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("clutch: at breakthrough it stops the drill, the torque is zero, the hand feels it, and the plunge is less than without") {
  const Outcome without = drill(""), with = drill("[clutch]\n");
  MESSAGE("plunge " << without.plunge * 1e3 << " mm without, " << with.plunge * 1e3 << " mm with; released at " << with.released
                    << " s, took " << with.took << " ms; reached " << without.reached * 1e3 << ", " << with.reached * 1e3 << " mm");
  CHECK(with.releases == 1.0);
  CHECK(with.torque_after == 0.0);
  CHECK(with.phase == HandPhase::done);
  CHECK(with.end - with.released < 3.0);  // reaction, release and withdrawal
  CHECK(with.forward == doctest::Approx(1.5));
  CHECK(with.reached < without.reached);
  CHECK(with.removed < without.removed);
  CHECK(with.reached > 2.9e-3);  // the tip is through
  // No clutch, no figure, no column.
  DrillRun plain(plate(""));
  CHECK_FALSE(plain.simulation().stage().figure("clutch", "releases").has_value());
  for (const Clock clock : {Clock::servo, Clock::contact, Clock::simulation})
    for (const StepColumn& column : plain.simulation().stage().graph.columns(clock)) CHECK(column.name != kEngagedColumn);
}

TEST_CASE("clutch: it releases when the recorded reaction of the tip says so: the closed form, from the step at which support is lost") {
  const TemporaryFolder folder;
  DrillRun run(plate("[record]\n[clutch]\nengage_N = 15\n", {"erosion.rate_hz=100"}));
  run_recorded(run, folder.file("run.sqlite"));
  const std::vector<double> reaction = session_column(folder.file("run.sqlite"), "tip_reaction"),
                            on = session_column(folder.file("run.sqlite"), kEngagedColumn);
  const ClutchConfig config{.engage_force = 15.0};
  const Twin twin = follow(reaction, config, 0.01), sabotaged = follow(reaction, {.engage_force = 15.0, .teeth = 0.1e-3}, 0.01);
  const Outcome out = outcome_of(run);
  // The twin's steps are 1 us; c/k is 33 ms, so x is wrong by 3e-5 of itself, and the instant by 1e-5 s.
  CHECK(out.released == doctest::Approx(twin.released).epsilon(1e-5));
  CHECK(out.took == doctest::Approx(1e3 * (twin.released - twin.lost)).epsilon(2e-3));
  CHECK(out.releases == twin.releases);
  CHECK(on.back() == 0.0);
  CHECK(std::ranges::count(on, 1.0) > 100);
  // Sabotage: a twin whose teeth part at nearly the force that engages them.
  CHECK(std::abs(sabotaged.released - out.released) > 1e-3);
}

// Of travel_mm alone the release does not change: the preload is engage_N - spring x travel_mm, so that the teeth part at the same reaction.
TEST_CASE("clutch: each key of the spring moves engagement and release to the instants of the closed form under the recorded reaction") {
  struct Case {
    std::string keys;
    ClutchConfig config;
  };
  const Case cases[] = {
      {"engage_N = 18\n", {.engage_force = 18.0}}, {"spring_N_per_mm = 6\n", {.stiffness = 6000.0}},  {"travel_mm = 3\n", {.travel = 3e-3}},
      {"teeth_mm = 0.2\n", {.teeth = 0.2e-3}},     {"damping_N_s_per_m = 400\n", {.damping = 400.0}}, {"wear = 0.3\n", {.wear = 0.3}}};
  const TemporaryFolder folder;
  for (const Case& one : cases) {
    CAPTURE(one.keys);
    DrillRun run(plate("[record]\n[clutch]\n" + one.keys, {"erosion.rate_hz=100"}));
    run_recorded(run, folder.file("run.sqlite"));
    const std::vector<double> reaction = session_column(folder.file("run.sqlite"), "tip_reaction");
    const Outcome out = outcome_of(run);
    const Twin twin = follow(reaction, one.config, 0.01), usual = follow(reaction, {}, 0.01);
    REQUIRE(out.releases > 0.0);
    CHECK(out.releases == twin.releases);
    CHECK(std::abs(out.released - twin.released) < 2e-5);  // as above: steps of 1 us
    CHECK(std::abs(out.engaged - twin.engaged) < 2e-5);
    // Sabotage: the twin with the default of that key.
    CHECK(std::abs(out.released - usual.released) + std::abs(out.engaged - usual.engaged) > 2e-4);
  }
}

TEST_CASE("clutch: once released, each drill turns on by half the turns of its time of running down, at the speed of the drive") {
  constexpr double kSpin = 1000.0 / 60.0;  // [rev/s]
  struct Turns {
    double inner, outer;
  };
  const auto turns_of = [](const std::string& keys) {
    DrillRun run(plate("[clutch]\n" + keys));
    run.run();
    REQUIRE(figure(run.simulation(), "clutch", "releases") == 1.0);
    return Turns{figure(run.simulation(), "clutch", "inner_turns_after_release"),
                 figure(run.simulation(), "clutch", "outer_turns_after_release")};
  };
  const Turns usual = turns_of(""), inner = turns_of("inner_stop_s = 0.2\n"), outer = turns_of("outer_stop_s = 0.1\n"),
              both = turns_of("inner_stop_s = 0.1\nouter_stop_s = 0.2\n");
  CHECK(usual.inner + usual.outer == 0.0);
  // The speed falls at a constant rate; sums of ten steps.
  CHECK(inner.inner == doctest::Approx(0.5 * 0.2 * kSpin).epsilon(1e-12));
  CHECK(inner.outer == 0.0);
  CHECK(outer.inner == 0.0);
  CHECK(outer.outer == doctest::Approx(0.5 * 0.1 * kSpin).epsilon(1e-12));
  CHECK(both.inner == doctest::Approx(0.5 * 0.1 * kSpin).epsilon(1e-12));
  CHECK(both.outer == doctest::Approx(0.5 * 0.2 * kSpin).epsilon(1e-12));
}

TEST_CASE("clutch: its failures: late release, worn spring, no release at low speed, early release in soft bone") {
  const Outcome rigid = drill(""), usual = drill("[clutch]\n");
  const Outcome late = drill("[clutch]\nrelease_delay_s = 0.3\n"), worn = drill("[clutch]\nwear = 1\n"),
                half = drill("[clutch]\nwear = 0.5\n");
  MESSAGE("reached " << usual.reached * 1e3 << ", late " << late.reached * 1e3 << ", no spring " << worn.reached * 1e3 << ", half "
                     << half.reached * 1e3 << ", rigid " << rigid.reached * 1e3 << " mm");
  CHECK(late.releases == 1.0);
  CHECK(late.took == doctest::Approx(usual.took + 300.0).epsilon(1e-9));
  CHECK(late.reached > usual.reached);
  CHECK(worn.releases == 0.0);
  // So nothing stops the drill: all of the hole of 6 mm is gone from 3 mm of plate, its rim by the table within a quarter of a voxel of 0.25 mm. How far a drill
  // plunges then is no measure: starts 0.05 mm apart change it by millimetres.
  const double hole = std::numbers::pi * 9.0 * 3.0;
  for (const Outcome* out : {&rigid, &worn}) CHECK(out->removed == doctest::Approx(hole).epsilon(2.0 * 0.0625 / 3.0));
  CHECK(usual.removed < 0.9 * hole);
  CHECK(worn.reached > usual.reached);
  CHECK(half.engaged < usual.engaged);
  CHECK(half.released >= usual.released);
  // A spindle that the torque slows below the least speed.
  const std::string slow = "[spindle]\nstall_torque_Nm = 0.2\n";
  const Outcome stuck = drill(slow + "[clutch]\nleast_spin_rpm = 999\n"), moving = drill(slow + "[clutch]\nleast_spin_rpm = 1\n");
  MESSAGE("slow: released after " << stuck.took << " ms, else " << moving.took << " ms; reached " << stuck.reached * 1e3 << ", "
                                  << moving.reached * 1e3 << " mm");
  CHECK(moving.releases == 1.0);
  CHECK(stuck.took > moving.took);
  CHECK(stuck.reached > moving.reached);
  // All of the plate is softer than 0.81: the clutch never engages, and nothing is cut.
  const Outcome soft = drill("[clutch]\nsoft_hardness = 0.81\n", {"duration_s=4.0"});
  CHECK(soft.removed == 0.0);
  CHECK(soft.releases == 0.0);
  // In a skull the diploe is soft: released there, with bone ahead.
  const std::string skull = R"(source = "phantom:skull_patch"
spacing_mm = 0.25
extent_mm = [10.0, 10.0, 9.0]
above_mm = 1.5
thickness_mm = 5.0
)";
  const Outcome early = drill("[clutch]\nsoft_hardness = 0.5\n", {"duration_s=8.0"}, skull);
  MESSAGE("early: " << early.releases << " releases, reached " << early.reached * 1e3 << " mm");
  CHECK(early.releases >= 1.0);
  CHECK(early.reached < 4.0e-3);
}

TEST_CASE("clutch: each key changes what it names") {
  const Outcome usual = drill("[clutch]\n");
  CHECK(drill("[clutch]\ntravel_mm = 2\n").forward == doctest::Approx(2.0));
  CHECK(drill("[clutch]\nouter_stop_s = 0.5\n").removed > usual.removed);
  CHECK(drill("[clutch]\nrelease_delay_s = 0.1\n").took == doctest::Approx(usual.took + 100.0).epsilon(1e-9));
  // 1000 rpm; bone of hardness 0.8.
  const std::vector<std::string> brief{"duration_s=3.0"};
  CHECK(drill("[clutch]\nleast_spin_rpm = 999\n", brief).engaged == usual.engaged);
  CHECK(drill("[clutch]\nleast_spin_rpm = 1001\n", brief).engaged < 0.0);
  CHECK(drill("[clutch]\nsoft_hardness = 0.79\n", brief).engaged == usual.engaged);
  CHECK(drill("[clutch]\nsoft_hardness = 0.81\n", brief).engaged < 0.0);
  // The regions by name: with the drills exchanged the ledge, not the tip, holds the clutch.
  CHECK(drill("[clutch]\ninner = \"outer drill\"\nouter = \"inner drill\"\n", brief).engaged !=
        doctest::Approx(usual.engaged).epsilon(1e-6));
}

TEST_CASE("clutch: a table that is wrong, or a tool without inner and outer drill, is refused at its place") {
  const auto refused = [](const std::string& keys, const std::string& part) {
    const std::vector<std::string> errors = errors_of("[clutch]\n" + keys, step_path());
    CAPTURE(keys);
    REQUIRE(errors.size() == 1);
    CHECK(has(errors, part));
    CHECK(has(errors, "small.toml:"));
  };
  CHECK(errors_of("[clutch]\n", step_path()).empty());
  refused("engage = 12\n", "engage_N");
  refused("engage_N = 0\n", "engage_N");
  refused("wear = 1.1\n", "wear");
  refused("release_delay_s = -1\n", "release_delay_s");
  refused("teeth_mm = 1.5\n", "travel_mm");
  refused("engage_N = 4\n", "spring");
  refused("outer = \"inner drill\"\n", "same region");
  refused("inner = \"tip\"\n", "region \"tip\"");
  for (const char* const tool : {"ball", "pin", "round_burr_5mm"}) {
    const std::vector<std::string> errors = errors_of("[clutch]\n", tool);
    REQUIRE(errors.size() == 1);
    CHECK(has(errors, "inner drill"));
    CHECK(has(errors, "perforator_14_11"));
    CHECK(has(errors, "small.toml:"));
  }
}

TEST_CASE("clutch: after a reset it is released, and engages anew on the bone that is back") {
  SimulationOptions options;
  options.history = true;
  DrillRun run(plate("[clutch]\n", {"duration_s=2.0"}), options);
  run.run();
  Stage& stage = run.simulation().stage();
  REQUIRE(stage.graph.find(slots::kClutch)->engaged);
  const std::uint64_t engagements = stage.graph.find(slots::kClutch)->engagements;
  REQUIRE(stage.reset());
  CHECK_FALSE(stage.graph.find(slots::kClutch)->engaged);
  CHECK(figure(run.simulation(), "clutch", "tip_reaction_N") == 0.0);
  CHECK(figure(run.simulation(), "clutch", "releases") == 0.0);
  CHECK(stage.graph.find(slots::kClutch)->engagements == engagements);
}

TEST_CASE("clutch: a replay has the same bits") {
  const TemporaryFolder folder;
  DrillRun run(plate("[record]\n[spindle]\n[friction]\n[clutch]\ninner_stop_s = 0.03\nouter_stop_s = 0.05\n"));
  run_recorded(run, folder.file("run.sqlite"));
  ReplayRun replay(folder.file("run.sqlite"));
  const Outcome first = outcome_of(run), second = outcome_of(replay.run());
  CHECK(first.voxels == second.voxels);
  CHECK(first.forces == second.forces);
  CHECK(first.released == second.released);
  CHECK(first.releases == 1.0);
}

TEST_CASE("clutch: bone steps of 1 to 100 ms, any law, extreme speed, a thin shell, no bone, tremor: finite, and no torque once released") {
  struct Case {
    std::vector<std::string> sets;
    std::string volume = kWidePlate;
    std::string contact = "cutting_N_per_m = 70e3\n";
  };
  const std::string thin = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [10.0, 10.0, 8.0]
above_mm = 1.5
thickness_mm = 1.0
hardness = 0.8
)";
  const std::string empty = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [10.0, 10.0, 8.0]
above_mm = 1.5
thickness_mm = 3.0
hardness = 0.0
)";
  const std::vector<Case> cases{{{"erosion.rate_hz=1000", "duration_s=5.0"}},
                                {{"erosion.rate_hz=10"}},
                                {{"erosion.law=energy"}},
                                {{"erosion.subvoxel=false"}},
                                {{"erosion.law=per-update", "tool.erosion_scale=0.02"}},
                                {{"erosion.law=threshold"}},
                                {{"tool.spin_rpm=200000"}},
                                {{"hand.tremor_mm=0.3"}},
                                {{}, kWidePlate, kPenaltyKeys},
                                {{}, thin},
                                {{}, empty}};
  for (const Case& one : cases) {
    CAPTURE(one.sets.size() > 0 ? one.sets.front() : one.volume);
    const Outcome out = drill("[clutch]\n", one.sets, one.volume, one.contact);
    for (const double value : {out.reached, out.removed, out.forward, out.released, out.engaged}) CHECK(std::isfinite(value));
    CHECK(out.torque_after <= 0.0);
    CHECK(out.forward >= 0.0);
    CHECK(out.forward <= 1.5);
  }
}

}  // namespace burrhole::test
