// The same hole in a bone that was moved and turned, and by every model of contact and every law of erosion.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  std::string contact = kHeldKeys;
  std::vector<std::string> sets = {};
  bool spindle = false;
};

/// Runs and checks what holds of any form: bone went, the numbers are numbers, nothing left the window, the servo found no fault.
DrillRun drilled(const Form& form, const std::vector<std::string>& common) {
  SmallScene scene{.spindle = form.spindle, .contact_keys = form.contact, .sets = common};
  scene.sets.insert(scene.sets.end(), form.sets.begin(), form.sets.end());
  DrillRun run(scene);
  Simulation& simulation = run.run().simulation();
  const DrillProgress& p = simulation.progress();
  const Swing& swing = simulation.stage().servo->swing();
  MESSAGE(form.name << ": depth " << p.depth * 1e3 << " mm, removed " << simulation.bone_step().removed_mass() * 1e9 << " mm3, peak "
                    << p.peak_force << " N, " << slowest_spin(simulation) * 60.0 << " rpm at the slowest, swings of " << swing.force
                    << " N at " << swing.frequency << " Hz");
  CHECK(std::isfinite(p.depth));
  CHECK(std::isfinite(p.peak_force));
  CHECK(p.peak_force > 1.0);  // what a hand calls contact
  CHECK((simulation.contact_flags() & kContactNotFinite) == 0);
  CHECK(figure(simulation, "erosion", "points_outside") == 0.0);
  // Penalty models of 20 kN/m chatter: the force swings between bone that pushes and none. The tool held back does not.
  const std::uint32_t own = form.contact.find("cutting") != std::string::npos ? 0u : static_cast<std::uint32_t>(kServoSwinging);
  CHECK((simulation.servo_output().faults & ~own) == 0);
  for (const RunSample& sample : simulation.samples()) REQUIRE(std::isfinite(sample.force + sample.depth));
  return run;
}

// A bone that the ball cannot pass without cutting: what it removed is at least the cap of the sphere that its tip is deep, less the
// engaged part that is being cut. So each form is held to the volume that its own depth asks for.
double cap_volume(double depth) {
  constexpr double kRadius = 1e-3;
  const double h = std::clamp(depth, 0.0, kRadius);
  const double cap = std::numbers::pi * h * h * (kRadius - h / 3.0);
  return cap + std::numbers::pi * kRadius * kRadius * std::max(0.0, depth - kRadius);
}

TEST_CASE("every model of contact drills: the tool held back by the surface, planes from gradients or across tool vectors, triangles") {
  const std::string planes = kPenaltyKeys, voxmap = "model = \"voxmap\"\n", of_20_kN = "stiffness_N_per_m = 20e3\n";
  const std::string paper = "mode = \"paper\"\n", vdb = "storage = \"vdb\"\n", coupled = "coupling = \"virtual\"\n";
  const std::string mesh = "model = \"mesh\"\ntool = \"hand\"\n";
  const Form forms[] = {{"surface", kHeldKeys},
                        {"surface, 8-bit records", std::string(kHeldKeys) + "record_bits = \"8\"\n"},
                        {"surface, turning locked", std::string(kHeldKeys) + "turning = \"locked\"\n"},
                        {"gradient-plane", planes},
                        {"gradient-plane in paper mode", planes + paper},
                        {"gradient-plane in the paper's storage", planes + vdb},
                        {"gradient-plane in both", planes + paper + vdb},
                        {"gradient-plane, coupled", planes + coupled},
                        {"voxmap", voxmap},
                        {"voxmap in paper mode", voxmap + paper},
                        {"voxmap, plane of the surface voxel", voxmap + "plane = \"surface\"\n"},
                        {"voxmap, sum", voxmap + "stacking = \"sum\"\n"},
                        {"voxmap, average", voxmap + of_20_kN + "stacking = \"average\"\n"},
                        {"voxmap, deepest", voxmap + of_20_kN + "stacking = \"deepest\"\n"},
                        {"mesh", "model = \"mesh\"\n" + std::string(kHeldKeys)},
                        {"mesh at the hand", mesh + of_20_kN},
                        {"mesh at the hand, deepest", mesh + "stacking = \"deepest\"\n" + of_20_kN},
                        {"mesh at the hand, coupled", mesh + of_20_kN + coupled},
                        // Its body is cut free as fast as the hand feeds, and the hand never comes to call it contact: half the bit.
                        {"voxmap, coupled", voxmap + coupled, {"tool.erosion_scale=0.5"}}};
  for (const Form& form : forms) {
    CAPTURE(form.name);
    const bool held = form.name.starts_with("surface") || form.name == "mesh";
    // A penalty model adds up to what presses the tool out only while it is in shallow: deeper, forces on all sides cancel or their average
    // falls, and a tool that is all in bone feels nothing (docs/accuracy.md). 2 N are a tenth of a millimetre for one plane of 20 kN/m.
    // Bone that collides at any density above 0 holds a tool above the face that sub-voxel removal moves: `check` warns.
    const bool any_density = form.contact.find("paper\"") != std::string::npos;
    DrillRun run = drilled(form, {"duration_s=1", held ? "hand.push_N=10" : "hand.push_N=2",
                                  std::string("erosion.subvoxel=") + (any_density ? "false" : "true")});
    const double removed = run.simulation().bone_step().removed_mass(), depth = run.simulation().progress().depth;
    // A ball of 1 mm that is 0.1 mm deep holds 0.03 mm3, of which 1.7 / s takes more than a tenth in the time after touchdown.
    CHECK(removed > 0.003e-9);
    if (!held) continue;
    // Not past the plate, and what the tip is deep beyond the engaged 0.25 mm and a voxel has been cut.
    CHECK(depth < 1.5e-3);
    CHECK(removed > cap_volume(depth - 0.5e-3));
  }
}

TEST_CASE("every law of erosion drills, with and without sub-voxel removal, and each with a spindle") {
  const std::string whole = "erosion.subvoxel=false";
  const Form forms[] = {{.name = "law rate"},
                        {.name = "law rate, whole voxels", .sets = {whole}},
                        {.name = "law per-update", .sets = {"erosion.law=per-update", "tool.erosion_scale=0.02"}},
                        {.name = "law energy", .sets = {"erosion.law=energy"}},
                        {.name = "law energy, whole voxels", .sets = {"erosion.law=energy", whole}}};
  for (const Form& form : forms) {
    CAPTURE(form.name);
    DrillRun free_running = drilled(form, {"duration_s=1", "hand.push_N=10"});
    CHECK(free_running.simulation().bone_step().removed_mass() > 0.02e-9);
    CHECK(slowest_spin(free_running.simulation()) == 1000.0 / 60.0);

    // mu F r = 0.5 x 10 N x at most 1 mm is at most 5 mN m: a motor that stalls at 10 keeps at least half of its speed.
    Form loaded = form;
    loaded.name += ", with a spindle";
    loaded.spindle = true;
    loaded.sets.insert(loaded.sets.end(), {"spindle.stall_torque_Nm=0.01", "spindle.inertia_kg_m2=1e-6"});
    DrillRun slowed = drilled(loaded, {"duration_s=1", "hand.push_N=10"});
    CHECK(slowed.simulation().bone_step().removed_mass() > 0.02e-9);
    CHECK(slowest_spin(slowed.simulation()) < 0.95 * 1000.0 / 60.0);
    CHECK(slowest_spin(slowed.simulation()) > 0.4 * 1000.0 / 60.0);  // 0.1 for the thrust's ringing at touchdown
    CHECK(slowed.simulation().bone_step().removed_mass() < free_running.simulation().bone_step().removed_mass());
  }
}

TEST_CASE("spindle: a bit that stalls stays engaged by F / K_cut, cuts no further, and stalls for as long as it is pressed") {
  const std::vector<std::string> common{"duration_s=1", "hand.push_N=20", "spindle.stall_torque_Nm=1e-5", "spindle.inertia_kg_m2=1e-9"};
  DrillRun stalled = drilled({.name = "stalled", .spindle = true}, common);
  Simulation& simulation = stalled.simulation();
  CHECK(simulation.bone_step().spin() == 0.0);
  const double engaged = simulation.contact_state().engagement, depth = simulation.progress().deepest;
  MESSAGE("engaged by " << engaged * 1e3 << " mm, tip at most " << depth * 1e3 << " mm deep");
  CHECK(engaged > 0.0);
  // All that is ever deeper than the engagement is what was cut in the steps before it stood, a voxel at most.
  CHECK(depth < engaged + 1.0 * stalled.voxel());
  DrillRun free_running = drilled({.name = "free", .spindle = true}, {"duration_s=1", "hand.push_N=20", "spindle.stall_torque_Nm=1000"});
  CHECK(simulation.bone_step().removed_mass() < 0.05 * free_running.simulation().bone_step().removed_mass());
}

TEST_CASE("spindle: a motor of 1000 N m is not slowed by a hand, and drills what one without it does") {
  const std::vector<std::string> common{"duration_s=0.8"};
  DrillRun without = drilled({.name = "no spindle"}, common);
  DrillRun with = drilled({.name = "strong spindle", .sets = {"spindle.stall_torque_Nm=1000"}, .spindle = true}, common);
  // M / M_stall = 0.5 x 20 N x 1 mm / 1000 N m = 1e-5 of the speed, and of the feed. The volume of a cap rises with the square of its depth.
  constexpr double kSlower = 1e-5, kLess = 2.0 * kSlower;
  CHECK(slowest_spin(with.simulation()) > (1.0 - kSlower) * 1000.0 / 60.0);
  const double removed = without.simulation().bone_step().removed_mass(), depth = without.simulation().progress().depth;
  CHECK(removed > 0.1e-9);
  CHECK(std::abs(with.simulation().progress().depth / depth - 1.0) < kSlower);
  CHECK(std::abs(with.simulation().bone_step().removed_mass() / removed - 1.0) < kLess);
  DrillRun weak = drilled({.name = "weak spindle", .sets = {"spindle.stall_torque_Nm=1"}, .spindle = true}, common);
  CHECK(std::abs(weak.simulation().bone_step().removed_mass() / removed - 1.0) > kLess);  // a thousandth of the strength shows
}

}  // namespace
}  // namespace burrhole::test
