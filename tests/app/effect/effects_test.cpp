// A scene is what it calls for: an effect whose table is absent leaves no force, no hole, no column, no timer behind.

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

const std::vector<std::string> kShort{"duration_s=0.6"};

std::vector<std::string> column_names(const SmallScene& scene) {
  std::vector<std::string> names;
  for (const SessionStream& stream : session_layout(DrillRun(scene).simulation().stage()).streams)
    for (const SessionColumn& column : stream.columns) names.push_back(stream.name + "." + column.name);
  return names;
}

TEST_CASE("no [contact]: nothing is felt, no force exists and the tool is where the hand is") {
  DrillRun run(SmallScene{.contact = false, .sets = kShort});
  Simulation& simulation = run.run().simulation();
  CHECK(simulation.progress().peak_force == 0.0);
  CHECK(simulation.servo_output().force == Vec3(0.0));
  CHECK(simulation.contact_state().engagement == 0.0);
  CHECK(simulation.contact_state().world_from_tool.translation == simulation.servo_output().hand.world_from_hand.translation);
  CHECK_FALSE(simulation.stage().figure("contact", "points").has_value());
  CHECK(simulation.timing("contact").count == 0);
  CHECK(simulation.servo_output().hand.phase == HandPhase::approach);
  // It drills all the same: erosion needs a tool that moves, not a force.
  CHECK(simulation.bone_step().removed_mass() > 0.0);
  CHECK(simulation.timing("servo").count == 600);
}

TEST_CASE("no [erosion]: nothing is removed and nothing of erosion runs") {
  DrillRun run(SmallScene{.erosion = false, .sets = kShort});
  const std::uint64_t untouched = run.voxel_hash();
  Simulation& simulation = run.run().simulation();
  CHECK(run.voxel_hash() == untouched);
  CHECK(simulation.bone_step().removed_mass() == 0.0);
  CHECK(simulation.timing("erosion").count == 0);
  CHECK(simulation.timing("gradient").count == 0);
  CHECK(simulation.progress().peak_force > 15.0);
}

TEST_CASE("window: a copy holds what its contact model and the monitor read, and not a byte more") {
  const std::string planes = kPenaltyKeys;
  struct Case {
    std::string contact;
    ContactFields fields;
  };
  const ContactFields density{.density = true, .gradient = false, .words = false, .records = {}};
  ContactFields words = density, records8 = density, records16 = density;
  words.words = true;
  records8.records = RecordPrecision::bits8;
  records16.records = RecordPrecision::bits16;
  const Case cases[] = {{"model = \"voxmap\"\n", density}, {planes, words}, {"record_bits = \"8\"\n", records8}, {kHeldKeys, records16}};
  for (const Case& c : cases) {
    CAPTURE(c.contact);
    DrillRun run(SmallScene{.contact_keys = c.contact, .sets = {"duration_s=0.2"}});
    REQUIRE(run.run().simulation().bone_step().publisher() != nullptr);
    ContactWindowPublisher& publisher = *run.simulation().bone_step().publisher();
    const ContactWindow& copy = publisher.exchange().latest();
    // Arrays keep the room of the largest window so far.
    CHECK(copy.bytes() == copy.density.size() * bytes_a_voxel(c.fields));
    CHECK(copy.density.size() == copy.box.count());
    CHECK(copy.gradient.empty());
    CHECK(copy.words.size() == (c.fields.words ? copy.box.count() : 0));
    CHECK(copy.stiffness.size() == (c.fields.records ? copy.box.count() : 0));
    const std::size_t records = std::visit([](const auto& array) { return array.size(); }, copy.records);
    CHECK(records == (c.fields.records ? copy.box.count() : 0));
    // What the publisher keeps besides the one copy of a run in lockstep is made of the same fields: nothing where the copy has density alone.
    if (!c.fields.words && !c.fields.records) CHECK(publisher.bytes() == copy.bytes());
    CHECK(run.simulation().bone_step().grids() == nullptr);
  }
}

TEST_CASE("erosion: state between steps is kept with sub-voxel removal only, by either law that knows it") {
  for (const std::string law : {"erosion.law=rate", "erosion.law=energy", "erosion.law=per-update"})
    for (const bool subvoxel : {true, false}) {
      if (law.ends_with("per-update") && subvoxel) continue;
      CAPTURE(law);
      CAPTURE(subvoxel);
      std::vector<std::string> sets{law, "duration_s=0.4"};
      if (law.ends_with("per-update")) sets.push_back("tool.erosion_scale=0.02");  // e s >= 1 would empty a voxel at once
      if (!law.ends_with("per-update")) sets.push_back(std::string("erosion.subvoxel=") + (subvoxel ? "true" : "false"));
      DrillRun run(SmallScene{.sets = sets});
      const double bytes = figure(run.run().simulation(), "erosion", "bytes");
      CHECK(run.simulation().bone_step().removed_mass() > 0.0);
      CHECK((bytes > 0.0) == subvoxel);
      // The tool's own field of distances is made for sub-voxel removal alone.
      CHECK((run.loaded().tool.cutting != nullptr) == subvoxel);
    }
  DrillRun none(SmallScene{.erosion = false, .sets = kShort});
  CHECK_FALSE(none.simulation().stage().figure("erosion", "bytes").has_value());
  CHECK(none.loaded().tool.cutting == nullptr);
}

TEST_CASE("no [spindle]: the spin is what is asked for, to the bit, and nothing of a spindle runs") {
  DrillRun run(SmallScene{.sets = kShort});
  BoneStep& bone = run.run().simulation().bone_step();
  CHECK(bone.spin() == run.loaded().scene.tool.spin);
  CHECK_FALSE(run.simulation().stage().figure("spindle", "slowest_rpm").has_value());
  CHECK(run.simulation().timing("spindle").count == 0);
}

TEST_CASE("[spindle]: a column of its own, a value a step of bone, as slow as its torque says") {
  const TemporaryFolder folder;
  DrillRun run(SmallScene{.spindle = true,
                          .record = true,
                          .sets = {"duration_s=0.8", "erosion.rate_hz=100", "spindle.stall_torque_Nm=0.02", "spindle.inertia_kg_m2=1e-6"}});
  run_recorded(run, folder.file("run.sqlite"));
  const std::vector<double> spin = session_column(folder.file("run.sqlite"), "spin");
  REQUIRE(spin.size() == 80);
  CHECK(spin.front() == 1000.0 / 60.0);
  CHECK(*std::ranges::min_element(spin) == doctest::Approx(slowest_spin(run.simulation())).epsilon(1e-12));  // rpm and back
  CHECK(run.simulation().timing("spindle").count == 80);
  // Steady, after its 5 ms: n = n0 (1 - mu F r / M_stall), r between 0.4 and all of the ball's millimetre where it cuts.
  const double share = spin.back() * 60.0 / 1000.0, load = 0.5 * 20.0 * 1e-3 / 0.02;
  MESSAGE("spins at " << share << " of its free speed under 20 N");
  CHECK(share > 1.0 - load);
  CHECK(share < 1.0 - 0.4 * load);
}

TEST_CASE("no [display], no [record]: no frame, no image, no row") {
  DrillRun run(SmallScene{.sets = kShort});
  Simulation& simulation = run.run().simulation();
  CHECK(simulation.frame_step() == nullptr);
  CHECK_FALSE(simulation.image_hash().has_value());
  CHECK(simulation.timing("record").count == 0);
}

TEST_CASE("[record]: a row a servo tick, and the run itself is the same to the bit") {
  const TemporaryFolder folder;
  DrillRun plain(SmallScene{.sets = kShort}), recorded(SmallScene{.record = true, .sets = kShort});
  plain.run();
  run_recorded(recorded, folder.file("run.sqlite"));
  CHECK(recorded.voxel_hash() == plain.voxel_hash());
  CHECK(recorded.simulation().force_hash() == plain.simulation().force_hash());
  CHECK(recorded.simulation().timing("record").count == 600);
  const auto session = SessionReader::open(folder.file("run.sqlite"));
  REQUIRE(session);
  CHECK(session->row_count(kServoStream) == 600);
  CHECK(session->row_count(kContactStream) == 600);
  const int bone_hz = recorded.loaded().scene.effects.needs(recorded.loaded().scene).simulation_hz;
  CHECK(session->row_count(kBoneStream) == static_cast<std::uint64_t>(0.6 * bone_hz));
}

TEST_CASE("session columns: those of the effects that are there, and no others") {
  const std::vector<std::string> always = column_names({.contact = false, .erosion = false});
  CHECK(std::ranges::find(always, "servo.hand_z") != always.end());
  CHECK(std::ranges::find(always, "contact.window") != always.end());
  CHECK(std::ranges::find(always, "bone.published") != always.end());
  // What `scene` has beyond that, in order.
  const auto more = [&](const SmallScene& scene) {
    std::vector<std::string> names = column_names(scene);
    for (const std::string& name : always) CHECK(std::erase(names, name) == 1);
    return names;
  };
  std::vector<std::string> tool;
  for (const char* name :
       {"tool_x", "tool_y", "tool_z", "force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z", "engagement", "flags"})
    tool.push_back(std::string("contact.") + name);
  CHECK(more({.contact = true, .erosion = false}) == tool);
  CHECK(more({.contact = false, .erosion = true}) == std::vector<std::string>{"bone.removed_mass"});
  tool.push_back("bone.removed_mass");
  CHECK(more({.contact = true, .erosion = true}) == tool);
  tool.push_back("bone.spin");
  CHECK(more({.spindle = true}) == tool);
}

}  // namespace
}  // namespace burrhole::test
