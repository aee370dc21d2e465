/// app/window/window_state.h: what the three threads of a window share, behind one lock: the person's controls and what they see of the run.
///   main    hands events to the controls and steps it 200 times a second
///   run     takes inputs, reports the state (LiveUser)
///   render  reads state and controls for a picture, and hands it the buttons of the panel
///   Frame  world.   Units  SI.   Errors  none.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/job/summary.h"
#include "app/run/live_user.h"
#include "app/run/simulation.h"
#include "app/view/color_bar.h"
#include "app/window/controls.h"
#include "core/base/result.h"
#include "core/voxel/label_table.h"

namespace burrhole {

enum class RunStage { loading, drilling, writing, ended };

/// A line for the person, with the time at which it was said.
struct MessageLine {
  double time = 0.0;  ///< [s] of state time
  std::string text;
  bool warning = false;
};

/// What a person may know of the plan before the first cut.
struct WindowPlan {
  std::string title;
  Approach approach;
  LabelTable labels{};  ///< of the user
  Pose world_from_bone, world_from_approach;
  double spin_rpm = 0.0;             ///< full speed of the drive
  double reference_push = 0.0;       ///< [N] thrust of the scene's script, a mark on the gauge; 0: none
  double largest_push = 0.0;         ///< [N] of the arm
  double users_push = 0.0;           ///< [N] of the arm of a person who takes a demonstration over
  bool one_eye = true;               ///< the picture is that of the camera: no stereo, no workbench
  bool demonstration = false;        ///< the scene's script drills
  bool bone_moves = false;           ///< the scene has [motion]: depth, layers and bone left along the planned axis have no meaning
  std::uint32_t instruments = 0;     ///< InstrumentSwitch that the scene's effects read
  std::optional<ColorBar> scale{};   ///< of colours that effects show; absent: there is none
  std::vector<MessageLine> marks{};  ///< of a watched session: what happened when [s]; empty in a run
};

/// State for one picture.
struct WindowView {
  RunStage stage = RunStage::loading;
  LiveState live;
  CameraView camera;
  CameraMode mode = CameraMode::orbit;
  ViewCut cut;
  UserGoal goal;
  DisplayRequests requests;
  bool paused = false, fine = false, locked_on = false, pad = false;
  std::uint32_t instruments_on = 0;  ///< InstrumentSwitch
  double held_push = 0.0;            ///< [N] that stays when nothing presses; 0: the hand rests lightly
  std::string tool;
  double turned = 0.0;  ///< [rev] of the spindle, for the picture of the bit
  double time = 0.0;    ///< [s] of state time
  std::vector<MessageLine> lines;
  std::optional<Transport> transport{};  ///< of a watched session
};

class WindowState final : public LiveUser {
 public:
  WindowState() = default;

  // Run thread.
  /// The run is ready; before this call there is no controls.
  void begin(const WindowPlan& plan, const ControlsSetup& setup, const OrbitCamera& camera, const std::string& tool);
  void finish(const Result<RunSummary>& summary);
  GoalMailbox& goals() noexcept override { return goals_; }
  std::optional<Input> next_input() override;
  void see(const LiveState& state) override;
  void hear(const std::string& line, bool warning) override { say(line, warning); }
  std::optional<Input> wait_until_resumed() override;
  void ended() override;
  bool took_over() override;

  /// For a replay that has computed all steps before `time` [s]. @returns the head; null after the end of the window.
  [[nodiscard]] std::optional<Transport> watch(double time);
  /// The session ends at `time` [s], before the end of its record.
  void end_watching_at(double time);
  /// Waits until the person may have moved the head.
  void wait_for_head();

  // Main thread.
  void handle(const WindowEvent& event);
  void step(double dt, const PadState& pad);
  /// A paused run goes on, to find that it was stopped.
  void stop_waiting();

  /// Stage, goal and requests alone; it does not count as a picture.
  [[nodiscard]] WindowView view_of_controls();

  // Render thread.
  [[nodiscard]] WindowView view();
  [[nodiscard]] WindowPlan plan();
  /// Calls f with the controls under the lock; nothing before begin().
  void with_controls(const std::function<void(Controls&)>& f);
  void set_picture_size(int width, int height);
  void take_mouse(bool taken) noexcept { mouse_taken_.store(taken, std::memory_order_relaxed); }
  [[nodiscard]] bool has_events();  ///< that no picture shows yet
  /// Events since the last call, for the panel.
  [[nodiscard]] std::vector<WindowEvent> take_events();
  [[nodiscard]] std::optional<RunSummary> summary();
  [[nodiscard]] std::string failure();  ///< of the run; empty: none
  /// There is no picture at all: the window closes.
  void fail(const Error& error);
  /// The same, of an exception. Needs no memory.
  void fail(std::exception_ptr thrown) noexcept;
  [[nodiscard]] std::optional<Error> error();  ///< of fail()
  /// @returns the time [s] since the first event that came after the last call; call it when a picture that shows it is on the screen.
  [[nodiscard]] std::optional<double> take_latency();

  // Any thread.
  void say(const std::string& line, bool warning = false);
  /// The window is to go.
  void close() noexcept { closed_.store(true, std::memory_order_release); }
  [[nodiscard]] bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }
  [[nodiscard]] RunStage stage();

 private:
  std::mutex mutex_;
  std::condition_variable resumed_;
  std::unique_ptr<Controls> controls_;
  WindowPlan plan_;
  LiveState live_;
  RunStage stage_ = RunStage::loading;
  std::vector<WindowEvent> events_;
  std::vector<MessageLine> lines_;
  std::string tool_, failure_;
  std::optional<RunSummary> summary_;
  std::optional<Error> error_;
  std::exception_ptr thrown_;
  std::optional<std::chrono::steady_clock::time_point> waits_since_;  // first event that no picture shows yet
  bool shown_soon_ = false;                                           // the picture being drawn shows it
  double time_ = 0.0, turned_ = 0.0;
  bool pad_ = false, ending_ = false, closing_ = false;
  int width_ = 1, height_ = 1;
  GoalMailbox goals_;
  std::atomic<bool> mouse_taken_{false}, closed_{false};
};

}  // namespace burrhole
