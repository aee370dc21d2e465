// Scenes that name [servo] and [device]: what they build, and what they leave out.
#include <doctest/doctest.h>

#include <algorithm>

#include "app/job/plan.h"
#include "app/stage/stage.h"
#include "core/config/toml.h"
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

TEST_CASE("[servo]: the largest force caps what reaches the hand, not what bone is felt to do") {
  struct Felt {
    double hand = 0.0, bone = 0.0;
  };
  const auto felt = [](const std::string& cap) {
    DrillRun run(with({"servo.force_N=" + cap}));
    Simulation& simulation = run.run().simulation();
    return Felt{glm::length(simulation.servo_output().force), simulation.progress().peak_force};
  };
  const Felt open = felt("200"), capped = felt("3");
  CHECK(open.hand > 3.0);
  CHECK(capped.hand <= 3.0 * (1.0 + 1e-12));
  CHECK(capped.bone > 3.0);
}
