// The same hole in a bone that was moved and turned, and by the other forms of contact and erosion.

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

TEST_CASE("moved and turned bone: the same hole, removed mass within 2 %, depth within 0.05 mm") {
  const std::vector<std::string> sets{"duration_s=1", "hand.tremor_mm=0.04"};
  SmallScene moved{.sets = sets};
  moved.sets.insert(moved.sets.end(), {"volume.position_mm=[12.3,-4.5,30.1]", "volume.turn_deg=[20,-35,50]"});
  DrillRun here(SmallScene{.sets = sets}), there(moved);
  const double mass_here = here.run().simulation().bone_step().removed_mass(),
               mass_there = there.run().simulation().bone_step().removed_mass();
  const double depth_here = here.simulation().progress().depth, depth_there = there.simulation().progress().depth;
  MESSAGE("removed " << mass_here * 1e9 << " and " << mass_there * 1e9 << " mm3, depth " << depth_here * 1e3 << " and " << depth_there * 1e3
                     << " mm");
  REQUIRE(mass_here > 0.5e-9);
  CHECK(std::abs(mass_there / mass_here - 1.0) < 0.02);
  CHECK(std::abs(depth_there - depth_here) < 0.05e-3);
  // Not to the bit: world coordinates round differently, and a shell point on the edge of a voxel may fall to either side.
  CHECK(there.simulation().force_hash() != here.simulation().force_hash());
}

struct Form {
  std::string name;
  std::vector<std::string> sets;
};

TEST_CASE("other forms drill too: paper mode, the penalty form, both, and eq. 4 as printed") {
  const Form forms[] = {{"paper mode", {"contact.mode=paper"}},
                        {"penalty form", {"contact.tool=device", "contact.stiffness_N_per_m=20e3"}},
                        {"penalty form in paper mode", {"contact.tool=device", "contact.mode=paper", "contact.stiffness_N_per_m=20e3"}},
                        {"law per-update", {"erosion.law=per-update", "tool.erosion_scale=0.005"}}};
  for (const Form& form : forms) {
    CAPTURE(form.name);
    SmallScene scene{.sets = form.sets};
    scene.sets.insert(scene.sets.begin(), {"duration_s=1", "hand.push_N=5"});
    DrillRun run(scene);
    Simulation& simulation = run.run().simulation();
    const DrillProgress& p = simulation.progress();
    MESSAGE(form.name << ": depth " << p.depth * 1e3 << " mm, removed " << simulation.bone_step().removed_mass() * 1e9 << " mm3, peak "
                      << p.peak_force << " N");
    CHECK(simulation.bone_step().removed_mass() > 0.02e-9);
    CHECK(std::isfinite(p.depth));
    CHECK(std::isfinite(p.peak_force));
    CHECK(p.peak_force > 1.0);
    CHECK((simulation.contact_flags() & kContactNotFinite) == 0);
    CHECK(simulation.servo_output().faults == 0);
    for (const RunSample& sample : simulation.samples()) REQUIRE(std::isfinite(sample.force + sample.depth));
  }
}

}  // namespace
}  // namespace burrhole::test
