// Steps of [dura] take no memory, also with a tool of more points that was taken up during the run.

#include <doctest/doctest.h>

#include "tests/support/drill_scene.h"
#include "tests/support/memory_trap.h"

namespace burrhole::test {
namespace {

/// Without contact and erosion the tool goes through the bone, to the dura 5 mm below its face.
LoadedScene scene_of(const char* tool, const char* dura) {
  const std::vector<std::string> sets{"duration_s=0.1", std::string("tool.name=") + tool, "volume.extent_mm=[16.0, 16.0, 12.0]",
                                      "volume.spacing_mm=0.5", "volume.dura_mm=1.0"};
  return load_text(scene_text({.volume = kSkullPatchKeys, .contact = false, .erosion = false}) + dura, sets);
}

/// @returns blocks of memory that bone steps take with the tool of another scene, from above the dura to 0.8 mm below it.
std::uint64_t taken_by(DrillRun& run, const LoadedScene& other) {
  Stage& stage = run.simulation().stage();
  REQUIRE(stage.change_tool(other.tool));
  ContactState found = stage.contact->state();
  std::uint64_t out = 0;
  for (int n = 0; n < 40; ++n) {
    found.world_from_tool.translation = Vec3(0.0, 0.0, -3.8e-3 - 0.05e-3 * n);
    clear_trap();
    on_trap([&] { stage.cut(found); });
    if (n > 0) out += trapped().allocations;  // the window moves once
  }
  return out;
}

}  // namespace

TEST_CASE("dura: a tool of more points that is taken up takes no memory in the steps that press it on the dura") {
  const char* const dura = "[dura]\nradius_mm = 6\nspacing_mm = 0.6\n";
  const LoadedScene pin = scene_of("pin", "");
  DrillRun with(scene_of("ball", dura)), without(scene_of("ball", ""));
  REQUIRE(pin.tool.shell.positions.size() > 2 * with.loaded().tool.shell.positions.size());
  for (DrillRun* run : {&with, &without}) run->run();
  const std::uint64_t expected = taken_by(without, pin);
  CHECK(taken_by(with, pin) == expected);
  CHECK(figure(with.simulation(), "dura", "pressed_s") > 0.0);
  // The trap sees a block.
  clear_trap();
  on_trap([] { break_the_rules(); });
  CHECK(trapped().allocations == 2);
}

}  // namespace burrhole::test
