#include "app/window/session_view.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "app/job/bone_exports.h"
#include "app/job/provenance.h"
#include "app/run/start_thread.h"
#include "app/session/recorded_hand.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/zone_state.h"
#include "core/base/caught_error.h"
#include "core/base/hash.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;
constexpr auto kFrame = std::chrono::microseconds(16'000);  // between two states that the window is given

/// The thread that replays.
class Replayer {
 public:
  Replayer(const SessionReader& session, const LoadedScene& loaded, const SessionView& view, WindowState& state, Viewer& viewer,
           RunSwitches& switches)
      : session_(&session),
        loaded_(&loaded),
        view_(&view),
        state_(&state),
        viewer_(&viewer),
        switches_(&switches),
        exports_({view.viewer.folder, loaded.bone, [&state](const std::string& line, bool failed) { state.say(line, failed); }}) {}

  [[nodiscard]] const SessionViewed& viewed() const noexcept { return viewed_; }
  /// Replays until the window is to go.
  Status run() {
    auto sink = viewer_->make_sink(*loaded_->scene.find<DisplayConfig>(), {});
    if (!sink) return sink.error();
    sink_ = std::move(sink).value();
    while (!ended_)
      if (Status done = replay(); !done) return done;
    return {};
  }

 private:
  /// From the start of the session until the head goes back before what was computed, or the window is to go.
  Status replay() {
    auto hand = RecordedHand::create(*session_);
    if (!hand) return hand.error();
    hand_ = &*hand;
    SimulationOptions options;
    options.sink = sink_.get();
    options.hand = hand_;
    options.restore_path = view_->restore_path;
    options.stop = &stop_;
    options.history = !session_->inputs().empty();
    options.samples = false;
    options.watch = [this](double time) { return follow_head(time); };
    Issues issues;
    const auto simulation = Simulation::create(loaded_->scene, loaded_->bone, loaded_->tool, options, issues);
    if (!simulation) return issues.front();
    simulation_ = simulation.get();
    stop_ = false;
    shown_.reset();
    if (!std::exchange(started_, true)) start();
    if (Status ran = simulation->run_recorded(*session_, *hand); !ran) return ran;
    if (stop_) return {};
    state_->end_watching_at(simulation->time());
    if (!std::exchange(compared_, true)) compare();
    return follow_head(simulation->time());
  }

  void start() {
    WindowStart start;
    start.tool = loaded_->tool.name;
    start.text_scale = view_->viewer.text_scale;
    const double period = simulation_->stage().period;
    start.transport = Transport(static_cast<double>(hand_->ticks()) * period, period);
    for (const SessionEvent& event : session_->events())
      start.marks.push_back(
          {event.time_s, event.text.empty() || event.kind == "breakthrough" ? event.kind : fmt::format("{}: {}", event.kind, event.text),
           event.kind == "fault" || event.kind == "refused"});
    start_window(*state_, *viewer_, *loaded_, start, *simulation_);
  }

  /// Called when all steps before `time` were computed. @returns when the next is wanted; sets stop_ if none is.
  Status follow_head(double time) {
    for (;;) {
      const auto head = switches_->stop ? std::nullopt : state_->watch(time);
      ended_ = ended_ || !head;
      if (!head || head->is_behind()) {
        stop_ = true;
        return {};
      }
      const bool waits = head->has_arrived() || time >= head->duration();
      const bool is_due = waits ? shown_ != time : Steady::now() - shown_at_ >= kFrame;
      if (!head->seeks()) export_asked(time);
      if (!head->seeks() && is_due)
        if (Status shown = show(time); !shown) return shown;
      if (!waits) return {};
      state_->wait_for_head();
    }
  }

  /// Writes the bone at `time` as often as the person has asked for it.
  void export_asked(double time) {
    while (const auto input = state_->next_input()) {
      simulation_->voxmap().write_back();
      const auto file = exports_.begin(simulation_->voxmap(), time, input->text);
      if (!file) state_->say(file.error().message, true);
    }
  }

  Status show(double time) {
    Stage& stage = simulation_->stage();
    stage.gather(true);
    if (Status sent = simulation_->frame_step()->send(); !sent) return sent;
    LiveState now;
    const auto tick = static_cast<std::uint64_t>(time / stage.period + 0.5);
    if (const HandState* hand = hand_->at(std::min<std::uint64_t>(tick, hand_->ticks() - 1))) now.hand = *hand;
    const ContactState& contact = simulation_->contact_state();
    now.world_from_tool = contact.world_from_tool;
    now.world_from_rest = contact.bone.world_from_rest;
    now.force = stage.servo->output().force;
    now.progress = simulation_->progress();
    if (const DrillClutch* const clutch = stage.graph.find(slots::kClutch)) now.driven = clutch->engaged;
    now.removed = simulation_->bone_step().removed_mass();
    if (stage.graph.is_written(slots::kZone.name)) {
      const ZoneState& zone = *stage.graph.find(slots::kZone);
      now.zone = ZoneReading{zone.distance, zone.level};
    }
    now.time = time;
    state_->see(now);
    shown_ = time;
    shown_at_ = Steady::now();
    return {};
  }

  /// Says whether the replay has the results of the run.
  void compare() {
    int known = 0;
    bool same = true;
    for (const SessionHash& hash : session_->hashes()) {
      std::uint64_t own = 0;
      if (hash.kind == "voxels")
        own = simulation_->voxmap().hash();
      else if (hash.kind == "forces")
        own = simulation_->force_hash();
      else if (hash.kind == "sent")
        own = simulation_->sent_hash();
      else
        continue;  // of pictures
      ++known;
      same = same && hash.value == hash_text(own);
    }
    viewed_ = {known > 0, same};
    const std::string line = known == 0 ? "The run was cut short: its results cannot be compared"
                             : same     ? "Bone and forces are those of the run, bit for bit"
                                        : "Bone or forces DIFFER from those of the run";
    state_->say(line, known == 0 || !same);
    if (view_->say) view_->say(line);
  }

  const SessionReader* session_;
  const LoadedScene* loaded_;
  const SessionView* view_;
  WindowState* state_;
  Viewer* viewer_;
  RunSwitches* switches_;
  std::unique_ptr<PictureSink> sink_;
  RecordedHand* hand_ = nullptr;      // of the present replay()
  Simulation* simulation_ = nullptr;  // of the present replay()
  std::atomic<bool> stop_{false};
  bool started_ = false, ended_ = false, compared_ = false;
  BoneExports exports_;
  SessionViewed viewed_;
  std::optional<double> shown_;  // [s]
  Steady::time_point shown_at_{};
};

}  // namespace

Result<SessionViewed> view_session(const SessionReader& session, const LoadedScene& loaded, const SessionView& view) {
  if (loaded.scene.find<DisplayConfig>() == nullptr) return bad_input("a window needs the table [display]", loaded.scene.file);
  auto window = GlfwWindow::create("session of " + run_title(loaded) + " - burrhole", view.width, view.height, wants_quad(loaded));
  if (!window) return window.error();
  WindowState state;
  Viewer viewer(*window, state, view.make_sink, view.viewer);
  window->set_handler([&](const WindowEvent& event) { state.handle(event); });
  RunSwitches switches;
  switches.signal = view.stop;

  std::thread drawing, replaying;
  if (Status started = start_thread(drawing, [&] { viewer.loop(); }); !started) return started.error();
  Status ran;
  SessionViewed viewed;
  const Status replays = start_thread(replaying, [&] {
    Replayer replayer(session, loaded, view, state, viewer, switches);
    try {
      ran = replayer.run();
    } catch (...) {
      ran = caught_error();
    }
    viewed = replayer.viewed();
    state.close();
    viewer.release();
    switches.finished = true;
  });
  if (!replays) return viewer.end_unused(drawing, replays.error());
  poll_window(
      *window, state, switches, [](const WindowView& shown) { return shown.goal.ends; },
      [&] {
        if (view.say) view.say("window: ready");
      });
  replaying.join();
  drawing.join();
  if (const auto error = state.error()) return *error;
  if (switches.lost) return Error{ErrorCode::unavailable, "the display was lost", {}};
  if (!ran) return ran.error();
  return viewed;
}

}  // namespace burrhole
