// [erosion] law = "progressive" in a scene: each key changes what it names, and the account is that of bone.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

/// A pin of 2 mm that is pressed with 20 N on a plate of 3 mm for two seconds. @returns a figure of [erosion].
double drilled(std::vector<std::string> sets, const char* name = "removed_mass_mm3") {
  sets.insert(sets.end(), {"tool.name=\"pin\"", "erosion.law=\"progressive\"", "duration_s=2.0", "hand.ramp_s=0.2"});
  DrillRun run(load_small(SmallScene{.sets = sets}));
  run.run();
  return figure(run.simulation(), "erosion", name);
}

}  // namespace

TEST_CASE("progressive law: each key changes what it names") {
  const double removed = drilled({});
  REQUIRE(removed > 0.5);
  // Bone takes work in proportion to the share's inverse; the bit waits for it, so the hole is about as much shallower.
  CHECK(drilled({"erosion.work_share=0.0085"}) < 0.6 * removed);
  CHECK(drilled({"erosion.cutting_ratio=0.1"}) < 0.6 * removed);
  // Ten times the strain at fracture is some ten times the toughness.
  CHECK(drilled({"erosion.curve=[{strain=0.00676, stress_MPa=115}, {strain=0.31, stress_MPa=133}]"}) < 0.6 * removed);
  // 20 N on the whole face of 3.1 mm2: 6 MPa, far below the yield point. What goes is what first touches, on a few voxels.
  CHECK(drilled({"erosion.bearing_share=1.0"}) < 0.1 * removed);
  CHECK(drilled({"erosion.bearing_share=1.0"}, "largest_stress_MPa") < drilled({}, "largest_stress_MPa"));
  CHECK(drilled({"tool.spin_rpm=0"}) == 0.0);
}

}  // namespace burrhole::test
