// The steps on threads: what was recorded feeds the same steps again to the same bits, and whatever ends a run, the hand is left without
// force.
#include "app/run/live_run.h"

#include <doctest/doctest.h>

#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/view/texels.h"
#include "haptics/servo/realtime.h"
#include "tests/support/drill_scene.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Touches down after 0.1 s and drills: 1.2 s by the clock.
SmallScene short_scene() { return {.sets = {"duration_s=1.2", "hand.standoff_mm=0.5"}}; }

struct Replayed {
  Status status;
  std::uint64_t voxels = 0, forces = 0, sent = 0;
};

Replayed replay_of(const LoadedScene& loaded, const std::string& path) {
  auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  SimulationOptions options;
  options.hand = &*hand;
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  REQUIRE(simulation);
  Replayed out;
  out.status = simulation->run_recorded(*session, *hand);
  out.voxels = simulation->voxmap().hash();
  out.forces = simulation->force_hash();
  out.sent = simulation->sent_hash();
  return out;
}

void change(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  REQUIRE(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
}

/// Keeps the texture that a display would show.
class TextureSink final : public FrameSink {
 public:
  Status start(const VolumeView& volume, const TriangleMesh&) override {
    dims_ = volume.dims;
    texels = volume.normal_opacity;
    field = volume.field;
    return {};
  }
  void update(const TexelBox& part) override {
    const VoxelBox whole{Vec3i(0), dims_};
    std::size_t n = 0;
    for (int k = part.box.lo.z; k < part.box.hi.z; ++k)
      for (int j = part.box.lo.y; j < part.box.hi.y; ++j)
        for (int i = part.box.lo.x; i < part.box.hi.x; ++i, ++n) {
          texels[whole.offset_of({i, j, k})] = part.normal_opacity[n];
          field[whole.offset_of({i, j, k})] = part.field[n];
        }
    ++parts;
  }
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override {
    added.push_back(mesh);
    return {};
  }
  Status draw(const std::string& name, const FrameView&, int, int, Hash64&) override {
    if (name == throws_at) throw std::runtime_error("a picture that cannot be drawn");
    names.push_back(name);
    return {};
  }
  std::vector<Rgba8> texels;
  std::vector<std::uint16_t> field;
  std::vector<std::string> names;
  std::vector<std::shared_ptr<const AddedMesh>> added;
  std::string throws_at;
  int parts = 0;

 private:
  Vec3i dims_{0};
};

/// The scene's own hand; remembers the last force that it was given.
class LastForce final : public HandSource {
 public:
  explicit LastForce(const LoadedScene& loaded) : hand_(loaded, [] {}) {}
  const HandState& read() noexcept override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept override {
    last = on_hand.force;
    largest = std::max(largest, glm::length(last));
    hand_.apply(on_hand);
  }
  Vec3 last{0.0};
  double largest = 0.0;

 private:
  WatchedHand hand_;
};

}  // namespace

TEST_CASE("live: a session recorded on threads replays to the same voxels, contact forces and forces sent, in every bit") {
  const TemporaryFolder folder;
  const std::string path = folder.file("live.sqlite");
  SimulationOptions options;
  options.live = true;
  DrillRun run(short_scene(), options);
  run_recorded(run, path);
  Simulation& simulation = run.simulation();
  REQUIRE(simulation.live());
  CHECK(simulation.live()->unrecorded == 0);
  // All round the first window was read before the run; on a busy machine later slides may come before the thread that reads ahead.
  // A sanitizer lets the run miss most ticks, and the tool may not reach the first slide; where it does, blocks read ahead serve it.
  const bool slid = simulation.live()->prefetched_blocks + simulation.live()->prefetch_misses > 0;
  CHECK((slid || test::kSanitized));
  CHECK((simulation.live()->prefetched_blocks > 0) == slid);
  MESSAGE("blocks taken by slides: ", simulation.live()->prefetched_blocks, " read ahead, ", simulation.live()->prefetch_misses,
          " at once");
  CHECK(simulation.bone_step().removed_mass() > 0.0);
  CHECK(simulation.progress().peak_force > 1.0);
  const Replayed replayed = replay_of(run.loaded(), path);
  REQUIRE_MESSAGE(replayed.status.ok(), (replayed.status ? "" : replayed.status.error().text()));
  CHECK(replayed.voxels == run.voxel_hash());
  CHECK(replayed.forces == simulation.force_hash());
  CHECK(replayed.sent == simulation.sent_hash());
}

TEST_CASE("live: a record whose steps were changed or lost is refused or comes to other bits, never passed off as the run") {
  const TemporaryFolder folder;
  const std::string path = folder.file("live.sqlite");
  SimulationOptions options;
  options.live = true;
  DrillRun run(short_scene(), options);
  run_recorded(run, path);
  std::filesystem::copy_file(path, folder.file("lost.sqlite"));
  change(folder.file("lost.sqlite"), "DELETE FROM ends; DELETE FROM blocks WHERE stream = 1 AND first_row > 0");
  const Replayed lost = replay_of(run.loaded(), folder.file("lost.sqlite"));
  CHECK(!lost.status.ok());
  // Lockstep with the same hand: another order of steps, other forces.
  auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  SimulationOptions in_lockstep;
  in_lockstep.hand = &*hand;
  DrillRun again(short_scene(), in_lockstep);
  CHECK(again.run().simulation().force_hash() != run.simulation().force_hash());
}

TEST_CASE("live: a run that a signal ends while it presses fades, and replays to the same forces") {
  const TemporaryFolder folder;
  const std::string path = folder.file("stopped.sqlite");
  std::atomic<bool> stop{false};
  SimulationOptions options;
  options.live = true;
  options.stop = &stop;
  options.progress = [&](double, const DrillProgress& progress) { stop = stop || progress.peak_force > 1.0; };
  SmallScene scene = short_scene();
  scene.sets.push_back("duration_s=20");
  DrillRun run(scene, options);
  run_recorded(run, path);
  const LiveReport& live = *run.simulation().live();
  CHECK(live.stopped);
  CHECK(live.last.gain == 0.0);  // the soft stop came to its end
  CHECK((live.faults & kServoStopped) != 0);
  const Replayed replayed = replay_of(run.loaded(), path);
  REQUIRE_MESSAGE(replayed.status.ok(), (replayed.status ? "" : replayed.status.error().text()));
  CHECK(replayed.sent == run.simulation().sent_hash());
  CHECK(replayed.forces == run.simulation().force_hash());
}

TEST_CASE("live: of a killed run all is replayed that its last rows name") {
  const TemporaryFolder folder;
  const std::string path = folder.file("killed.sqlite");
  SimulationOptions options;
  options.live = true;
  DrillRun run(short_scene(), options);
  run_recorded(run, path);
  // What a kill leaves: no hashes, no ends, and servo rows that name results which are not there any more.
  change(path,
         "DELETE FROM hashes; DELETE FROM ends; DELETE FROM blocks WHERE stream = 1 AND first_row ="
         " (SELECT max(first_row) FROM blocks WHERE stream = 1)");
  const Replayed killed = replay_of(run.loaded(), path);
  CHECK_MESSAGE(killed.status.ok(), (killed.status ? "" : killed.status.error().text()));
  CHECK(killed.sent != run.simulation().sent_hash());
}

TEST_CASE("TickPlan: a tick that is past is taken at once, the newest, and never two in a row") {
  constexpr std::int64_t kPeriod = 1000;
  TickPlan plan(0, kPeriod);
  CHECK(plan.next(-5).due == 0);
  CHECK(plan.next(900).due == 1000);  // in time
  const TickPlan::Tick late = plan.next(2300);
  CHECK(late.due == 2000);
  CHECK(late.ticks == 1);
  const TickPlan::Tick given_up = plan.next(3700);  // late again: the tick of 3000 is given up
  CHECK(given_up.due == 4000);
  CHECK(given_up.ticks == 2);
  CHECK(plan.next(4100).due == 5000);
  const TickPlan::Tick stall = plan.next(20'450);
  CHECK(stall.due == 20'000);
  CHECK(stall.ticks == 15);
  // A loop that computes for one and a half periods: no tick is counted twice or lost, and it waits in every second.
  std::int64_t now = 20'450, waits = 0, last = 20'000;
  for (int n = 0; n < 1000; ++n) {
    now += 3 * kPeriod / 2;
    const TickPlan::Tick tick = plan.next(now);
    CHECK(tick.due == last + static_cast<std::int64_t>(tick.ticks) * kPeriod);
    last = tick.due;
    if (tick.due > now) {
      ++waits;
      now = tick.due;
    }
  }
  CHECK(waits >= 500);
}

TEST_CASE("live: what the display was sent is the bone as it is, whenever it asked") {
  TextureSink sink;
  SimulationOptions options;
  options.live = true;
  options.sink = &sink;
  SmallScene scene = short_scene();
  scene.display = true;
  DrillRun run(scene, options);
  run.run();
  CHECK(sink.parts > 0);
  const VolumeView now = make_volume_view(run.simulation().voxmap());
  CHECK(sink.texels == now.normal_opacity);
  CHECK(sink.field == now.field);
  CHECK(sink.names.front() == "before");
  CHECK(sink.names.back() == "cutaway");
}

TEST_CASE("live: what effects show reaches the display whole, while their steps change it") {
  TextureSink sink;
  SimulationOptions options;
  options.live = true;
  options.sink = &sink;
  SmallScene scene = short_scene();
  scene.display = true;
  scene.volume = kSkullPatchKeys;
  scene.sets.push_back("tool.erosion_scale=20");
  DrillRun run(load_text(scene_text(scene) + "\n[dust]\n[bleeding]\n[dura]\nradius_mm = 3\nspacing_mm = 0.5\n", scene.sets), options);
  run.run();
  REQUIRE(sink.added.size() >= 2);  // before the cut, and after it
  for (const std::shared_ptr<const AddedMesh>& mesh : sink.added) {
    REQUIRE(mesh != nullptr);
    CHECK(mesh->colors.size() == mesh->vertices.size());
    for (const auto& triangle : mesh->triangles)
      for (const std::uint32_t corner : triangle) REQUIRE(corner < mesh->vertices.size());
  }
  CHECK(figure(run.simulation(), "dust", "removed_mm3") > 0.0);
  std::size_t most = 0;
  for (const std::shared_ptr<const AddedMesh>& mesh : sink.added) most = std::max(most, mesh->triangles.size());
  CHECK(most > sink.added.front()->triangles.size());  // chips beside the sheet, which the bit then tears
}

TEST_CASE("live: script, time, a signal, and an exception in a picture all leave the hand without force") {
  const LoadedScene loaded = load_small(short_scene());
  for (const char* how : {"time", "signal", "exception"}) {
    CAPTURE(how);
    LastForce hand(loaded);
    TextureSink sink;
    std::atomic<bool> stop{false};
    SimulationOptions options;
    options.live = true;
    options.hand = &hand;
    options.stop = &stop;
    SmallScene scene = short_scene();
    if (how == std::string("exception")) {
      scene.display = true;
      options.sink = &sink;
      sink.throws_at = "during";
      scene.sets.push_back("duration_s=20");
      scene.sets.push_back("tool.erosion_scale=20");
    }
    if (how == std::string("signal")) {
      scene.sets.push_back("duration_s=20");
      options.progress = [&](double time, const DrillProgress&) { stop = stop || time > 0.6; };
    }
    DrillRun run(scene, options);
    if (how == std::string("exception"))
      CHECK_THROWS_AS((void)run.simulation().run(), std::runtime_error);
    else
      CHECK(run.simulation().run().ok());
    CHECK(hand.largest > 0.5);
    CHECK(hand.last == Vec3(0.0));
  }
}

TEST_CASE("live: bone kept in the paper's grids is refused before anything runs") {
  SimulationOptions options;
  options.live = true;
  const LoadedScene loaded = load_small({.contact_keys = std::string(kPenaltyKeys) + "storage = \"vdb\"\n"});
  Issues issues;
  CHECK(Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues) == nullptr);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().message.find("storage") != std::string::npos);
}
