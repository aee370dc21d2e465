// Scenes that name [servo] and [device]: what they build, and what they leave out.
#include <doctest/doctest.h>

#include <algorithm>

#include "app/job/plan.h"
#include "app/stage/stage.h"
#include "core/config/toml.h"
#include "haptics/device/device_model.h"
#include "tests/support/drill_scene.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

SmallScene with(std::vector<std::string> sets) {
  SmallScene scene{.sets = {"duration_s=2", "hand.standoff_mm=0.5"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  return scene;
}

bool lists(const std::vector<std::string>& names, const std::string& name) { return std::ranges::find(names, name) != names.end(); }

/// The faults of a scene's text, one line each.
std::vector<std::string> faults(const std::string& text) {
  auto document = TomlDocument::parse(text, "scene.toml");
  REQUIRE(document);
  Issues issues;
  (void)read_scene(*document, test_context(), issues);
  std::vector<std::string> out;
  for (const Error& issue : issues) out.push_back(issue.text());
  return out;
}

/// [m/s] of the tip over the last 0.2 s of its advance.
double speed_before_stop(const Simulation& simulation) {
  const auto& samples = simulation.samples();
  const auto last = std::ranges::max_element(samples, {}, &RunSample::depth);
  const auto first = std::ranges::lower_bound(samples, last->time - 0.2, {}, &RunSample::time);
  return (last->depth - first->depth) / (last->time - first->time);
}

}  // namespace

TEST_CASE("[device]: a scene that does not name it builds none, and says so") {
  const LoadedScene loaded = load_small(with({}));
  CHECK(lists(make_plan(loaded).not_built, "device"));
  auto parts = Stage::make(loaded.scene, loaded.scene.effects, loaded.bone, loaded.tool, {});
  REQUIRE(parts);
  CHECK_FALSE((*parts)->figure("device", "shown_force_N").has_value());
}

TEST_CASE("[device]: a falcon drills with all it has at the grip, while bone feels the script's push and records are of the drill") {
  const LoadedScene loaded = load_small(with({"device.name=\"falcon\""}));
  CHECK(!lists(make_plan(loaded).not_built, "device"));
  CHECK(make_plan(loaded).warnings.size() > make_plan(load_small(with({}))).warnings.size());  // forces are scaled, and that is told
  auto parts = Stage::make(loaded.scene, loaded.scene.effects, loaded.bone, loaded.tool, {});
  REQUIRE(parts);
  REQUIRE((*parts)->figure("device", "shown_force_N").has_value());
  DrillRun run(with({"device.name=\"falcon\""}));
  Simulation& simulation = run.run().simulation();
  CHECK(simulation.progress().peak_force > 8.0);  // more than a falcon has: bone's own newtons
  CHECK(simulation.bone_step().removed_mass() > 0.0);
  // Half way through its ramp and later the push is well above what is felt as contact.
  CHECK(simulation.progress().depth > 0.0);
}

TEST_CASE("[device]: with every hand of the list the script drills through the plate and withdraws") {
  for (const HandModel& who : hand_models()) {
    CAPTURE(std::string(who.name));
    DrillRun run(SmallScene{.sets = {"duration_s=30", "tool.erosion_scale=4", "device.hand=\"" + std::string(who.name) + "\""}});
    const Simulation& simulation = run.run().simulation();
    CHECK(simulation.progress().breakthrough_time.has_value());
    // Also where friction of 0.05 N holds the grip up to 0.05 / 135 = 0.4 mm short of where the spring of `arm` leads it.
    CHECK(simulation.end() == RunEnd::done);
  }
}

TEST_CASE("[hand] kind = \"feed\": a bench drills to its stop by speed and by thrust, whether bone ends before it or not") {
  // The plate is 3 mm thick.
  for (const std::string advance : {"feed_mm_per_s = 0.5\n", "feed_mm_per_s = 2.0\nramp_s = 0.1\npush_N = 20.0\n"})
    for (const double stop_mm : {1.5, 4.5}) {
      CAPTURE(advance);
      CAPTURE(stop_mm);
      std::string text = scene_text(SmallScene{});
      const std::string script = "push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0\n";
      const std::size_t at = text.find(script);
      REQUIRE(at != std::string::npos);
      text.replace(at, script.size(), "kind = \"feed\"\nstandoff_mm = 0.5\n" + advance);
      DrillRun run(load_text(text, {"duration_s=40", "tool.erosion_scale=4", "hand.stop_mm=" + std::to_string(stop_mm)}, "feed.toml"));
      const Simulation& simulation = run.run().simulation();
      CHECK(simulation.end() == RunEnd::done);
      const DrillProgress& progress = simulation.progress();
      const bool through = stop_mm > 3.0;
      CHECK(progress.breakthrough_time.has_value() == through);
      // The tip passes the stop by what an erosion step advances it, 20 ms, and by less than that while the coupling is unloaded, 4 ms at
      // 20 N. Where bone ends before the stop, the coupling may be loaded by 20 N / 5 kN/m = 4 mm, which the drill is ahead then.
      const double speed = through ? 0.0 : speed_before_stop(simulation);
      CHECK(progress.deepest > stop_mm * 1e-3 - 1e-9);
      CHECK(progress.deepest < stop_mm * 1e-3 + (through ? 4e-3 : speed * (20e-3 + 4e-3)));
    }
}

TEST_CASE("[device]: an unknown name has its place and the nearest name; a value out of range is refused") {
  const std::string scene = scene_text(with({}));
  const auto found = faults(scene + "\n[device]\nname = \"falkon\"\nhand = \"firmly\"\n");
  REQUIRE(found.size() == 2);
  CHECK(found[0].find("scene.toml:") == 0);
  CHECK(found[0].find("falcon") != std::string::npos);
  CHECK(found[1].find("firm") != std::string::npos);
  CHECK(faults(scene + "\n[device]\ndelay_ticks = 99\n").size() == 1);
  CHECK(faults(scene + "\n[device]\nforce_scale = 2.0\n").size() == 1);
  CHECK(faults(scene + "\n[servo]\nmultirate = \"plane\"\n").size() == 1);
  CHECK(faults(scene + "\n[servo]\nforce_N = 0\n").size() == 1);
  CHECK(faults(scene + "\n[servo]\nslew = 3\n").size() == 1);
}

TEST_CASE("[servo]: the scheme, its rates and the age at which contact is stale follow from the scene") {
  const auto servo_of = [](const std::vector<std::string>& sets) {
    const Scene scene = load_small(with(sets)).scene;
    return servo_config(scene, scene.effects.needs(scene), 0.25e-3);
  };
  const ServoConfig shipped = servo_of({});
  CHECK(shipped.multi_rate.scheme == MultiRateScheme::planes);
  CHECK(shipped.multi_rate.contact_ticks == 1);
  CHECK(shipped.max_contact_age >= 10);
  const ServoConfig slow = servo_of({"contact.rate_hz=20", "servo.multirate=\"hold\""});
  CHECK(slow.multi_rate.scheme == MultiRateScheme::hold);
  CHECK(slow.multi_rate.contact_ticks == 50);
  CHECK(slow.max_contact_age >= 150);
  const ServoConfig fast = servo_of({"servo_hz=6000"});
  CHECK(fast.period == doctest::Approx(1.0 / 6000.0));
  CHECK(fast.multi_rate.contact_ticks == 6);
}

TEST_CASE("[hand]: a push over the largest force on the hand is refused with its place, also over the default; equal is not") {
  const std::string scene = scene_text(with({}));  // pushes with 20 N
  const auto found = faults(scene + "\n[servo]\nforce_N = 19.9\n");
  REQUIRE(found.size() == 1);
  CHECK(found[0] ==
        "scene.toml:20:1: hand.push_N = 20 is over the largest force on the hand, servo.force_N = 19.9: bone could not hold "
        "the hand");
  CHECK(faults(scene + "\n[servo]\nforce_N = 20\n").empty());
  std::string hard = scene;
  hard.replace(hard.find("push_N = 20.0"), 13, "push_N = 201");
  REQUIRE(faults(hard).size() == 1);
  CHECK(faults(hard)[0].find("hand.push_N = 201") != std::string::npos);
  CHECK(faults(scene + "\n[device]\nforce_N = 3\nforce_scale = 1\n").empty());
}

TEST_CASE("[device]: a push that the device cannot render at a set scale is a warning") {
  const auto warned = [](const std::vector<std::string>& sets, const char* of) {
    const std::vector<std::string> lines = make_plan(load_small(with(sets))).warnings;
    return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(of) != std::string::npos; });
  };
  CHECK(warned({"device.force_scale=1"}, "[device] generic renders at most 8 N of hand.push_N = 20"));
  CHECK_FALSE(warned({"device.force_scale=0.4"}, "renders at most"));
  CHECK_FALSE(warned({"device.name=\"generic\""}, "renders at most"));
}

TEST_CASE("[servo]: the energy detector is on with a device, off without, and the scene's keys prevail") {
  const auto energy_of = [](const std::vector<std::string>& sets) {
    const Scene scene = load_small(with(sets)).scene;
    return servo_config(scene, scene.effects.needs(scene), 0.25e-3).energy;
  };
  CHECK(energy_of({}).tolerance == 0.0);
  const EnergyObserverConfig shipped = energy_of({"device.name=\"generic\""});
  CHECK(shipped.delay == 1);
  CHECK(shipped.damping == doctest::Approx(5.0 / (8.0 / 20.0)));                        // of the grip, in newtons of the drill
  CHECK(shipped.tolerance == doctest::Approx(20.0 * (0.5 * 20.0 / 5000.0 + 0.05e-3)));  // the cap is 8 N over the scale
  CHECK(energy_of({"device.name=\"generic\"", "servo.energy_mJ=0"}).tolerance == 0.0);
  CHECK(energy_of({"device.name=\"generic\"", "servo.energy_mJ=3", "servo.relied_on_N_s_per_m=2"}).tolerance == 3e-3);
  CHECK(energy_of({"device.name=\"generic\"", "servo.relied_on_N_s_per_m=2"}).damping == 2.0);
}

TEST_CASE("[servo]: the largest force caps what reaches the hand, not what bone is felt to do") {
  struct Felt {
    double hand = 0.0, bone = 0.0;
  };
  const auto felt = [](double cap) {
    LoadedScene loaded = load_small(with({}));
    loaded.scene.servo.largest_force = cap;  // a scene's own cap is at least its push
    DrillRun run(std::move(loaded));
    Simulation& simulation = run.run().simulation();
    return Felt{glm::length(simulation.servo_output().force), simulation.progress().peak_force};
  };
  const Felt open = felt(200.0), capped = felt(3.0);
  CHECK(open.hand > 3.0);
  CHECK(capped.hand <= 3.0 * (1.0 + 1e-12));
  CHECK(capped.bone > 3.0);
}
