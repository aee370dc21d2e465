// A person at a live run, played by a few lines: what they do is recorded and replayed to the same bits, what they see is the run.
#include "app/run/live_user.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

#include "app/session/recorded_hand.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

SmallScene user_scene() {
  return {.record = true, .display = true, .sets = {"duration_s=20", "hand={kind=\"mouse\", standoff_mm=0.5, run_up_s=0.1}"}};
}

/// Counts what a display receives.
class CountingSink final : public FrameSink {
 public:
  Status start(const VolumeView&, const TriangleMesh&) override { return {}; }
  void update(const TexelBox& texels) override { texels_ += texels.field.size(); }
  Status change_tool(const TriangleMesh&) override {
    ++tools_;
    return {};
  }
  void forget() override { ++forgotten_; }
  Status draw(const std::string& name, const FrameView&, int, int, Hash64& hash) override {
    hash.add(std::uint64_t{texels_});
    names_.push_back(name);
    texels_at_draw_ = texels_;
    return {};
  }
  std::size_t texels_ = 0, texels_at_draw_ = 0;
  int tools_ = 0, forgotten_ = 0;
  std::vector<std::string> names_;
};

/// Presses with about `push` [N] until the tip is `deep` [m] in bone, then does what `script` says and ends the run.
class ScriptedUser final : public LiveUser {
 public:
  ScriptedUser(double push, double deep, std::vector<Input> script) : push_(push), deep_(deep), script_(script.begin(), script.end()) {}

  GoalMailbox& goals() noexcept override { return goals_; }
  std::optional<Input> next_input() override {
    if (!arrived_ || script_.empty()) return std::nullopt;
    Input next = std::move(script_.front());
    script_.pop_front();
    return next;
  }
  void see(const LiveState& state) override {
    ++seen_;
    last_ = state;
    goal_.spins = true;
    if (!arrived_) {
      const double advance = 2e-3 * (state.time - time_);  // [m] by hand
      goal_.place.z -= state.hand.thrust < push_ ? advance : -advance;
      most_thrust_ = std::max(most_thrust_, state.hand.thrust);
    }
    if (sink_ != nullptr) texels_seen_ = sink_->texels_;
    time_ = state.time;
    if (state.progress.depth > deep_) arrived_ = true;
    if (arrived_) {
      goal_.place.z = 0.5e-3;
      goal_.ends = script_.empty() && state.progress.depth < 0.0;
    }
    goals_.publish(goal_);
  }
  void hear(const std::string& line, bool) override { heard_.push_back(line); }
  std::optional<Input> wait_until_resumed() override {
    if (asked_in_pause_) return std::exchange(asked_in_pause_, std::nullopt);
    ++pauses_;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return std::nullopt;
  }

  GoalMailbox goals_;
  UserGoal goal_{.place = {0.0, 0.0, 0.5e-3}};
  double push_, deep_, time_ = 0.0, most_thrust_ = 0.0;
  std::deque<Input> script_;
  std::optional<Input> asked_in_pause_;
  const CountingSink* sink_ = nullptr;
  std::size_t texels_seen_ = 0;
  bool arrived_ = false;
  int seen_ = 0, pauses_ = 0;
  std::vector<std::string> heard_;
  LiveState last_;
};

struct Outcome {
  std::uint64_t voxels = 0, forces = 0, sent = 0;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};
Outcome outcome_of(DrillRun& run) { return {run.voxel_hash(), run.simulation().force_hash(), run.simulation().sent_hash()}; }

Outcome replay(const std::string& path) {
  SimulationOptions options;
  options.history = true;
  ReplayRun replayed(path, options);
  return outcome_of(replayed.run());
}

Input plain(InputKind kind, const std::string& text = {}) { return {0, kind, 0.0, text, {}}; }
Input tool(const std::string& name) {
  auto text = read_tool_text(name, "small.toml", test_context());
  REQUIRE(text);
  return {0, InputKind::tool, 0.0, name, *text};
}

}  // namespace

TEST_CASE("a user drills, pauses, changes the tool, undoes and ends; a replay of the session has the same bits") {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "session.sqlite").string();
  // The second undo and the checkpoint that does not exist are answered and end nothing.
  ScriptedUser user(20.0, 0.4e-3,
                    {plain(InputKind::checkpoint, "a"), plain(InputKind::pause), tool("pin"), plain(InputKind::undo),
                     plain(InputKind::undo), plain(InputKind::restore, "nowhere"), plain(InputKind::restore, "a")});
  CountingSink sink;
  user.sink_ = &sink;
  SimulationOptions options;
  options.sink = &sink;
  options.live = true;
  options.user = &user;
  options.history = true;
  DrillRun run(user_scene(), options);
  run_recorded(run, path);
  const Outcome recorded = outcome_of(run);

  CHECK(run.simulation().end() == RunEnd::done);
  CHECK(user.pauses_ == 1);
  CHECK(user.heard_.size() == 2);
  CHECK(user.most_thrust_ > 1.0);
  CHECK(user.last_.steps > 10);
  CHECK(user.last_.progress.undone > 0.4e-3);
  CHECK(sink.tools_ == 1);
  CHECK(sink.forgotten_ > 0);
  // Changes reached the display while the run went on, without a picture that asked for them; pictures at events were not drawn.
  CHECK(user.texels_seen_ > 0);
  CHECK(sink.names_ == std::vector<std::string>{"before", "after", "cutaway"});
  // The checkpoint is restored: bone is cut.
  CHECK(run.simulation().stage().history() != nullptr);
  CHECK(recorded.voxels != DrillRun(user_scene(), options).voxel_hash());
  CHECK(replay(path) == recorded);
}

TEST_CASE("a user exports the bone during a pause: the clocks stand, and the session replays to the same bits") {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "session.sqlite").string();
  ScriptedUser user(20.0, 0.4e-3, {plain(InputKind::pause), plain(InputKind::export_bone, "ply")});
  user.asked_in_pause_ = plain(InputKind::export_bone, "stl");
  struct Exported {
    double time;
    std::string format;
    std::uint64_t removed;
  };
  std::vector<Exported> exported;
  SimulationOptions options;
  options.live = true;
  options.user = &user;
  options.history = true;
  options.export_bone = [&](const Voxmap& bone, double time, const std::string& format) -> Result<std::string> {
    exported.push_back({time, format, bone.blocks().size()});
    return std::string("a.") + format;
  };
  DrillRun run(user_scene(), options);
  run_recorded(run, path);
  REQUIRE(exported.size() == 2);
  CHECK(exported.front().format == "stl");
  CHECK(exported.back().format == "ply");
  CHECK(exported.front().removed > 0);
  CHECK(exported.front().time <= exported.back().time);
  CHECK(user.heard_.empty());
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  CHECK(std::ranges::count(session->events(), std::string("export"), &SessionEvent::kind) == 2);
  CHECK(replay(path) == outcome_of(run));
}

TEST_CASE("texels of a user's display are those of the present bone, without a picture that asks for them") {
  ScriptedUser user(20.0, 0.3e-3, {});
  CountingSink sink;
  SimulationOptions options;
  options.sink = &sink;
  options.live = true;
  options.user = &user;
  DrillRun run(user_scene(), options);
  run.run();
  // "before" is drawn at 0 texels; "after" sends the rest.
  CHECK(sink.texels_at_draw_ > 0);
  CHECK(sink.texels_ == sink.texels_at_draw_);
  CHECK(run.simulation().frame_step()->texels_sent() == sink.texels_);
  CHECK(run.simulation().frame_step()->texels_waiting() == 0);
}

TEST_CASE("a user's hand needs a user") {
  Issues issues;
  const LoadedScene loaded = load_small(user_scene());
  CHECK(Simulation::create(loaded.scene, loaded.bone, loaded.tool, {.live = true}, issues) == nullptr);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().code == ErrorCode::unavailable);
}
