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
  for (const SessionColumn& column : session_columns(load_small(scene).scene)) names.push_back(column.name);
  return names;
}

TEST_CASE("no [contact]: nothing is felt, no force exists and the tool is where the hand is") {
  DrillRun run(SmallScene{.contact = false, .sets = kShort});
  Simulation& simulation = run.run().simulation();
  CHECK(simulation.progress().peak_force == 0.0);
  CHECK(simulation.servo_output().force == Vec3(0.0));
  CHECK(simulation.contact_state().engagement == 0.0);
  CHECK(simulation.contact_state().world_from_tool.translation == simulation.servo_output().hand.world_from_hand.translation);
  CHECK(simulation.contact_points() == 0);
  CHECK(simulation.timers().contact.timing().count == 0);
  CHECK(simulation.servo_output().hand.phase == HandPhase::approach);
  // It drills all the same: erosion needs a tool that moves, not a force.
  CHECK(simulation.bone_step().removed_mass() > 0.0);
  CHECK(simulation.timers().servo.timing().count == 600);
}

TEST_CASE("no [erosion]: nothing is removed and nothing of erosion runs") {
  DrillRun run(SmallScene{.erosion = false, .sets = kShort});
  const std::uint64_t untouched = run.voxel_hash();
  Simulation& simulation = run.run().simulation();
  CHECK(run.voxel_hash() == untouched);
  CHECK(simulation.bone_step().removed_mass() == 0.0);
  BoneStepTimers& timers = simulation.bone_step().timers();
  CHECK(timers.erosion.timing().count == 0);
  CHECK(timers.gradient.timing().count == 0);
  CHECK(simulation.progress().peak_force > 15.0);
}

TEST_CASE("window: a copy holds what its contact model and the monitor read, and not a byte more") {
  const std::string planes = kPenaltyKeys;
  struct Case {
    std::string contact;  // empty: no [contact]
    ContactFields fields;
  };
  const ContactFields density{.density = true, .gradient = false, .words = false, .records = {}};
  ContactFields words = density, records8 = density, records16 = density;
  words.words = true;
  records8.records = RecordPrecision::bits8;
  records16.records = RecordPrecision::bits16;
  const Case cases[] = {{"", density},
                        {"model = \"voxmap\"\n", density},
                        {planes, words},
                        {planes + "storage = \"vdb\"\n", density},
                        {"record_bits = \"8\"\n", records8},
                        {kHeldKeys, records16}};
  for (const Case& c : cases) {
    CAPTURE(c.contact);
    DrillRun run(SmallScene{.contact = !c.contact.empty(), .contact_keys = c.contact, .sets = {"duration_s=0.2"}});
    ContactWindowPublisher& publisher = run.run().simulation().bone_step().publisher();
    const ContactWindow& copy = publisher.exchange().latest();
    CHECK(copy.bytes() == copy.box.count() * bytes_a_voxel(c.fields));
    CHECK(copy.density.size() == copy.box.count());
    CHECK(copy.gradient.empty());
    CHECK(copy.words.size() == (c.fields.words ? copy.box.count() : 0));
    CHECK(copy.stiffness.size() == (c.fields.records ? copy.box.count() : 0));
    const std::size_t records = std::visit([](const auto& array) { return array.size(); }, copy.records);
    CHECK(records == (c.fields.records ? copy.box.count() : 0));
    // What the publisher keeps besides the three copies is made of the same fields: nothing where the copies have density alone.
    if (!c.fields.words && !c.fields.records) CHECK(publisher.bytes() <= 3 * copy.bytes());
    CHECK((run.simulation().bone_step().grids() != nullptr) == (c.contact.find("vdb") != std::string::npos));
  }
}

TEST_CASE("coverage: masks are kept with sub-voxel removal only, by either law that knows it") {
  for (const std::string law : {"erosion.law=rate", "erosion.law=energy", "erosion.law=per-update"})
    for (const bool subvoxel : {true, false}) {
      if (law.ends_with("per-update") && subvoxel) continue;
      CAPTURE(law);
      CAPTURE(subvoxel);
      std::vector<std::string> sets{law, "duration_s=0.4"};
      if (law.ends_with("per-update")) sets.push_back("tool.erosion_scale=0.02");  // e s >= 1 would empty a voxel at once
      if (!law.ends_with("per-update")) sets.push_back(std::string("erosion.subvoxel=") + (subvoxel ? "true" : "false"));
      DrillRun run(SmallScene{.sets = sets});
      const Erosion* erosion = run.run().simulation().bone_step().erosion();
      REQUIRE(erosion != nullptr);
      CHECK(run.simulation().bone_step().removed_mass() > 0.0);
      REQUIRE((erosion->coverage() != nullptr) == subvoxel);
      if (subvoxel) CHECK(erosion->coverage()->bytes() > 0);
      // The tool's own field of distances is made for nothing else.
      CHECK((run.loaded().tool.cutting != nullptr) == subvoxel);
    }
  DrillRun none(SmallScene{.erosion = false, .sets = kShort});
  CHECK(none.simulation().bone_step().erosion() == nullptr);
  CHECK(none.loaded().tool.cutting == nullptr);
}

TEST_CASE("no [spindle]: the spin is what is asked for, to the bit, and nothing of a spindle runs") {
  DrillRun run(SmallScene{.sets = kShort});
  BoneStep& bone = run.run().simulation().bone_step();
  CHECK(bone.spindle() == nullptr);
  CHECK(bone.spin() == run.loaded().scene.tool.spin);
  CHECK(bone.slowest_spin() == run.loaded().scene.tool.spin);
  CHECK(bone.timers().spindle.timing().count == 0);
}

TEST_CASE("[spindle]: a column of its own, as slow as its torque says") {
  const TemporaryFolder folder;
  DrillRun run(SmallScene{
      .spindle = true, .record = true, .sets = {"duration_s=0.8", "spindle.stall_torque_Nm=0.02", "spindle.inertia_kg_m2=1e-6"}});
  run_recorded(run, folder.file("run.sqlite"));
  const std::vector<double> spin = session_column(folder.file("run.sqlite"), "spin");
  REQUIRE(spin.size() == 800);
  CHECK(spin.front() == 1000.0 / 60.0);
  CHECK(*std::ranges::min_element(spin) == run.simulation().bone_step().slowest_spin());
  CHECK(run.simulation().bone_step().timers().spindle.timing().count == 80);
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
  CHECK(simulation.timers().record.timing().count == 0);
}

TEST_CASE("[record]: a row a servo tick, and the run itself is the same to the bit") {
  const TemporaryFolder folder;
  DrillRun plain(SmallScene{.sets = kShort}), recorded(SmallScene{.record = true, .sets = kShort});
  plain.run();
  run_recorded(recorded, folder.file("run.sqlite"));
  CHECK(recorded.voxel_hash() == plain.voxel_hash());
  CHECK(recorded.simulation().force_hash() == plain.simulation().force_hash());
  CHECK(recorded.simulation().timers().record.timing().count == 600);
  const auto session = SessionReader::open(folder.file("run.sqlite"));
  REQUIRE(session);
  CHECK(session->row_count() == 600);
}

TEST_CASE("session columns: those of the effects that are there, and no others") {
  const std::vector<std::string> hand{"hand_x",  "hand_y",  "hand_z",  "hand_vx", "hand_vy", "hand_vz",   "hand_qw",
                                      "hand_qx", "hand_qy", "hand_qz", "thrust",  "phase",   "hand_tick", "hand_flags"};
  const std::vector<std::string> contact{"tool_x",   "tool_y",   "tool_z",   "force_x",    "force_y", "force_z",
                                         "torque_x", "torque_y", "torque_z", "engagement", "flags"};
  const auto joined = [](std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  CHECK(column_names({.contact = false, .erosion = false}) == hand);
  CHECK(column_names({.contact = true, .erosion = false}) == joined(hand, contact));
  CHECK(column_names({.contact = false, .erosion = true}) == joined(hand, {"removed_mass"}));
  CHECK(column_names({.contact = true, .erosion = true}) == joined(joined(hand, contact), {"removed_mass"}));
  CHECK(column_names({.spindle = true}) == joined(joined(hand, contact), {"removed_mass", "spin"}));
}

}  // namespace
}  // namespace burrhole::test
