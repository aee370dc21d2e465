// A scene is what it calls for: an effect whose table is absent leaves no force, no hole, no column, no timer behind.

#include <doctest/doctest.h>

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
  const std::vector<std::string> hand{"hand_x",  "hand_y",  "hand_z",  "hand_vx", "hand_vy", "hand_vz",  "hand_qw",
                                      "hand_qx", "hand_qy", "hand_qz", "thrust",  "phase",   "hand_tick"};
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
}

}  // namespace
}  // namespace burrhole::test
