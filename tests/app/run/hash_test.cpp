// Same scene, same bits: voxels and forces; a session's hand brings both back, and one bit of it changed does not.

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "app/session/recorded_hand.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

struct Hashes {
  std::uint64_t voxels = 0, forces = 0;
  friend bool operator==(const Hashes&, const Hashes&) = default;
};

Hashes hashes_of(DrillRun& run) { return {run.voxel_hash(), run.simulation().force_hash()}; }

SmallScene tremulous(std::vector<std::string> sets = {}) {
  SmallScene scene{.record = true, .sets = std::move(sets)};
  scene.sets.insert(scene.sets.begin(), {"hand.tremor_mm=0.1", "tool.erosion_scale=2", "duration_s=0.8"});
  return scene;
}

Hashes hashes(std::vector<std::string> sets = {}) {
  DrillRun run(tremulous(std::move(sets)));
  return hashes_of(run.run());
}

TEST_CASE("same bits: a scene run twice gives the same voxels and forces, and bone was removed") {
  DrillRun untouched(tremulous());
  const Hashes once = hashes(), twice = hashes();
  CHECK(once == twice);
  CHECK(once.voxels != untouched.voxel_hash());
}

TEST_CASE("a simulation that is only built publishes no bone, and refuses to run") {
  SimulationOptions options;
  options.runs = false;
  DrillRun built(tremulous(), options);
  CHECK(built.simulation().stage().bone->published() == 0);
  const Status ran = built.simulation().run();
  REQUIRE_FALSE(ran.ok());
  CHECK(ran.error().code == ErrorCode::internal);
  DrillRun usual(tremulous());
  CHECK(usual.simulation().stage().bone->published() == 1);
}

// 0.1 mm of tremor: under 0.0625 mm, a quarter voxel, no erosion point of a tool on the axis ever leaves its voxel and seeds differ in
// forces alone.
TEST_CASE("same bits: another tremor seed gives other forces and another hole") {
  const Hashes one = hashes({"hand.seed=1"}), two = hashes({"hand.seed=2"});
  CHECK(one.forces != two.forces);
  CHECK(one.voxels != two.voxels);
}

TEST_CASE("the paper's grids give what the window's words give, to the words' rounding") {
  // An open loop at rest on the bone: a hand that feels would bounce, and a bounce makes a small difference large.
  const auto forces = [](const std::string& keys) {
    DrillRun run(SmallScene{
        .erosion = false, .contact_keys = keys, .sets = {"hand.feels=false", "tool.spin_rpm=0", "hand.push_N=2", "duration_s=0.15"}});
    std::vector<double> out;
    for (const RunSample& sample : run.run().simulation().samples()) out.push_back(sample.force);
    return out;
  };
  const std::vector<double> words = forces(kPenaltyKeys), floats = forces(std::string(kPenaltyKeys) + "storage = \"vdb\"\n");
  REQUIRE(words.size() == floats.size());
  REQUIRE(floats.back() > 2.0);
  double worst = 0.0;
  for (std::size_t n = 0; n < words.size(); ++n) worst = std::max(worst, std::abs(words[n] - floats[n]));
  MESSAGE("forces up to " << floats.back() << " N differ by at most " << worst << " N");
  // Densities in steps of 1/255 and gradients of half a density a voxel in steps of 1/254 place a plane to 0.008 voxel: 2 um of 20 kN/m.
  CHECK(worst < 0.04);
  CHECK(worst > 0.0);  // they are two ways, not one
}

/// The replay of a session: its steps in the recorded order as `burrhole replay` runs them, or its hand through a run in lockstep.
enum class Order { recorded, lockstep };
Hashes replay(const std::string& path, Order order = Order::recorded) {
  const auto session = SessionReader::open(path);
  REQUIRE_MESSAGE(session.ok(), (session ? "" : session.error().text()));
  auto hand = RecordedHand::create(*session);
  REQUIRE_MESSAGE(hand.ok(), (hand ? "" : hand.error().text()));
  const auto document = TomlDocument::parse(session->meta().scene, session->meta().scene_path);
  REQUIRE(document);
  Issues issues;
  auto loaded =
      load_scene(*document, {}, issues,
                 {.tool_text = session->meta().tool, .progress = {}, .say = {}});  // no tool folder: all that is needed is in the session
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  loaded->scene.duration = static_cast<double>(hand->ticks()) / loaded->scene.servo_hz;
  SimulationOptions options;
  options.hand = &*hand;
  DrillRun run(std::move(*loaded), options);
  if (order == Order::lockstep) return hashes_of(run.run());
  REQUIRE(has_order(*session));
  const Status replayed = run.simulation().run_recorded(*session, *hand);
  REQUIRE_MESSAGE(replayed.ok(), (replayed ? "" : replayed.error().text()));
  return hashes_of(run);
}

/// Copies a session with one bit of one value of one servo row inverted.
void copy_with_flipped_bit(const std::string& from, const std::string& to, const std::string& column, std::int64_t row, int bit) {
  const auto session = SessionReader::open(from);
  REQUIRE(session);
  auto copy = SessionWriter::create(to, session->meta(), {session->streams(), 1000, 1});
  REQUIRE(copy);
  for (std::size_t s = 0; s < session->streams().size(); ++s) {
    const SessionStream& stream = session->streams()[s];
    auto rows = session->rows(stream.name);
    REQUIRE(rows);
    const std::size_t width = stream.columns.size();
    for (std::size_t c = 0; c < width; ++c)
      if (s == 0 && stream.columns[c].name == column) {
        double& value = (*rows)[static_cast<std::size_t>(row) * width + c];
        value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (std::uint64_t{1} << bit));
      }
    for (std::size_t start = 0; start < rows->size(); start += width) REQUIRE(copy->append(s, std::span(*rows).subspan(start, width)));
  }
  REQUIRE(copy->close());
}

TEST_CASE("replay: a lockstep session brings back voxels and forces to the bit, in its recorded order and in lockstep") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  const std::vector<std::vector<std::string>> cases = {{"tool.name=pin", "contact.latency_ticks=2", "duration_s=0.4"},
                                                       {"contact.rate_hz=200", "duration_s=0.4"},
                                                       {"contact.rate_hz=50", "contact.latency_ticks=3", "duration_s=0.4"}};
  for (const std::vector<std::string>& sets : cases) {
    CAPTURE(sets.front());
    DrillRun run(tremulous(sets));
    run_recorded(run, path);
    CHECK(run.simulation().bone_step().removed_mass() > 0.0);
    CHECK(replay(path) == hashes_of(run));
    CHECK(replay(path, Order::lockstep) == hashes_of(run));
  }
}

TEST_CASE("replay: the recorded order holds without contact, without erosion and on the paper's grids") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  const std::vector<std::string> sets{"hand.tremor_mm=0.1", "duration_s=0.4"};
  for (const SmallScene& scene :
       {SmallScene{.contact = false, .record = true, .sets = sets}, SmallScene{.erosion = false, .record = true, .sets = sets},
        SmallScene{.record = true, .contact_keys = std::string(kPenaltyKeys) + "storage = \"vdb\"\n", .sets = sets}}) {
    DrillRun run(scene);
    run_recorded(run, path);
    CHECK(replay(path) == hashes_of(run));
  }
}

TEST_CASE("replay: one bit of one hand row changes the forces") {
  const TemporaryFolder folder;
  DrillRun run(tremulous());
  run_recorded(run, folder.file("run.sqlite"));
  const Hashes recorded = hashes_of(run);
  // Row 500 of 800, in bone. Bit 20 of a height of millimetres is a tenth of a picometre; bit 0 of it may drown in rounding.
  copy_with_flipped_bit(folder.file("run.sqlite"), folder.file("flipped.sqlite"), "hand_z", 500, 20);
  CHECK(replay(folder.file("flipped.sqlite")).forces != recorded.forces);
  // The copy itself does no harm.
  copy_with_flipped_bit(folder.file("run.sqlite"), folder.file("copy.sqlite"), "no such column", 0, 0);
  CHECK(replay(folder.file("copy.sqlite")) == recorded);
}

}  // namespace
}  // namespace burrhole::test
