/// app/window/controls.h: what keys, mouse and game pad mean: goal of the hand, camera, inputs of the run, and requests of the display.
///   It knows no window system and reads no clock, so recorded events give the same results.
///   Frame  approach frame.   Units  SI; pixels of the window.   Errors  none.   Thread  one at a time.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/run/live_user.h"
#include "app/scene/load.h"
#include "app/view/view.h"
#include "app/window/held_input.h"
#include "app/window/orbit_camera.h"
#include "app/window/transport.h"
#include "app/window/view_cut.h"
#include "app/window/window_event.h"
#include "haptics/hand/hand_switches.h"

namespace burrhole {

/// Speeds with which keys move the goal. Fine control divides them by `fine`.
struct ControlsConfig {
  double advance = 0.010;       ///< [m/s] towards bone, without contact
  double press = 0.0025;        ///< [m/s] the same in contact: times the stiffness of the arm it is the growth of the thrust
  double withdraw = 0.030;      ///< [m/s]
  double slide = 0.008;         ///< [m/s] across the axis
  double tilt = 0.5;            ///< [rad/s]
  double wheel = 0.0005;        ///< [m] a step of the wheel without contact
  double wheel_press = 0.0002;  ///< [m] the same in contact
  double fine = 5.0;            ///< [-]
  double aside = 0.003;         ///< [m] of the goal across the axis from the hand in contact, at most: times the stiffness, 15 N
  double touch = 0.5;           ///< [N] force that counts as contact
  double turn = 0.008;          ///< [rad/pixel] of the camera
  double turn_by_key = 1.2;     ///< [rad/s]
  double jump = 1.0;            ///< [s] of a key in a watched session
  double jump_fine = 0.01;      ///< [s] with fine control
  double light = 3.0;           ///< [N] push of a hand that rests on bone
  double relax = 0.25;          ///< [s] time constant with which the push falls to what is held, once nothing presses
  double wax = 0.3;             ///< [s] for which its switch is on: longer than a step of bone
  double pad_idle = 0.15;       ///< [-] share of a stick's way that moves nothing
};

/// What the controls must know of the run.
struct ControlsSetup {
  GoalHandConfig hand;
  Pose world_from_approach;
  double deepest = 0.1;                  ///< [m] of the goal below the entry
  std::vector<ToolText> tools;           ///< the first ten have the keys 1 to 9 and 0
  bool demonstration = false;            ///< the scene's script drills until the person takes over
  bool bone_moves = false;               ///< the scene has [motion]: with Alt, keys move the bone
  std::uint32_t instruments = 0;         ///< InstrumentSwitch that effects of the scene read
  double text_scale = 1.0;               ///< [-] of texts, of the desktop's own scale
  std::optional<Transport> transport{};  ///< of a watched session: keys and mouse move its head and the camera, and no goal
};

/// What the person asks of the display.
struct DisplayRequests {
  bool help = false;        ///< all keys are shown
  bool lab = false;         ///< the panel shows everything
  bool hints = true;        ///< of the first start
  bool screenshot = false;  ///< one, to be taken and cleared
  bool full_screen = false;
  bool slices = false;                      ///< through the tip
  bool asks_end = false;                    ///< the question whether to end is shown
  double text_scale = 0.0;                  ///< [-] of the desktop's own scale; 0: as at the start
  std::optional<DrawingQuality> quality{};  ///< of a picture at rest; absent: the scene's
  std::optional<SurfaceLights> lights{};    ///< absent: the scene's
};

class Controls {
 public:
  Controls(const ControlsSetup& setup, const OrbitCamera& camera, const ControlsConfig& config = {});

  /// Size of the part of the window that shows the picture; drags that begin outside it mean nothing.
  void set_picture_size(int width, int height) noexcept;
  /// @param taken whether the panel has taken the mouse; its keys are never taken.
  void handle(const WindowEvent& event, bool taken);
  /// Advances by `dt` [s]: held keys, pad, and the reach of the arm.
  void step(double dt, const LiveState& now, const PadState& pad);

  [[nodiscard]] const UserGoal& goal() const noexcept { return goal_; }
  [[nodiscard]] OrbitCamera& camera() noexcept { return camera_; }
  [[nodiscard]] ViewCut& cut() noexcept { return cut_; }
  [[nodiscard]] DisplayRequests& requests() noexcept { return requests_; }
  [[nodiscard]] const std::vector<ToolText>& tools() const noexcept { return setup_.tools; }
  [[nodiscard]] Transport* transport() noexcept { return setup_.transport ? &*setup_.transport : nullptr; }  ///< null: a run
  [[nodiscard]] bool paused() const noexcept { return paused_; }
  [[nodiscard]] bool fine() const noexcept;
  /// @returns the push [N] that stays when nothing presses, as the wheel or a demonstration has set it; 0: the hand rests lightly.
  [[nodiscard]] double held_push() const noexcept;
  [[nodiscard]] bool locked_on() const noexcept { return locked_on_; }  ///< the drive stays on without a held key

  // What keys do, for buttons.
  void change_tool(std::size_t index);
  void undo() { (void)ask(InputKind::undo); }
  void reset() { (void)ask(InputKind::reset); }
  /// @returns whether the run will store it.
  bool checkpoint(const std::string& name) { return ask(InputKind::checkpoint, name); }
  void restore(const std::string& name) { (void)ask(InputKind::restore, name); }
  /// A file of the bone as it is, for a printer or another program; also during a pause, a demonstration and in a watched session.
  void export_bone() { (void)ask(InputKind::export_bone, "stl"); }
  /// Switches suction or irrigation on, or off if it is on; applies wax. The person is answered where the scene has no such instrument.
  void use_instrument(InstrumentSwitch instrument);
  [[nodiscard]] std::uint32_t instruments_on() const noexcept { return instruments_on_; }
  void toggle_pause();
  void toggle_cut() noexcept;
  /// Takes a demonstration over, from where the hand is.
  void take_over() noexcept;
  /// Nothing is held any more: the push falls to that of a resting hand.
  void relax() noexcept { rest_ = 0.0; }
  void change_text(bool larger) noexcept;
  void lock_drive(bool on) noexcept { locked_on_ = on; }
  void straighten() noexcept;
  void back_to_entry() noexcept;
  void end() noexcept;
  /// @returns why something was not done, one line for the person; empty: nothing to say.
  [[nodiscard]] std::string take_answer() { return std::exchange(answer_, {}); }
  /// @returns the next input for the run.
  [[nodiscard]] std::optional<Input> take_input();
  [[nodiscard]] bool has_query() const noexcept;
  /// @returns the next query (is_query()), past other inputs; for a paused run.
  [[nodiscard]] std::optional<Input> take_query();

 private:
  void press(Key key);
  /// A key that changes the size of texts, with Ctrl. @returns whether it is one.
  bool press_text(Key key);
  /// A key of a watched session. @returns whether it is one.
  bool press_watching(Key key);
  void scroll(double steps);
  void drag(double dx, double dy);
  /// @returns whether the run gets the input.
  bool ask(InputKind kind, const std::string& text = {}, const std::string& data = {});
  /// The goal may move: the clocks run, and the run goes on.
  [[nodiscard]] bool moves() const noexcept { return runs_ && !paused_ && !goal_.ends && is_own(); }
  /// The person moves the hand: no script does, and no record.
  [[nodiscard]] bool is_own() const noexcept { return !setup_.transport && (!setup_.demonstration || goal_.takes_over); }
  void turn_by_keys(double dt);
  void move_by_keys(double dt);
  void press_pad(const PadState& pad);
  void move_by_pad(double dt, const PadState& pad);
  [[nodiscard]] bool has_bone() const { return setup_.bone_moves && (held(Key::left_alt) || held(Key::right_alt)); }
  /// Asks for the switches that the held keys and the instruments stand for, if they have changed.
  void ask_switches(double dt);
  [[nodiscard]] std::uint32_t bone_switches() const;
  void keep_in_reach();
  /// Without a key or trigger that presses, the goal in contact moves back until the push is that which is held.
  void relax_push(double dt);
  [[nodiscard]] double light_lead() const noexcept { return config_.light / setup_.hand.dynamics.stiffness; }  // [m]
  void slide(double right, double up);
  void advance(double towards_bone, double dt);
  [[nodiscard]] bool held(Key key) const { return held_.has(key); }
  [[nodiscard]] double scale() const noexcept { return fine() ? 1.0 / config_.fine : 1.0; }

  ControlsSetup setup_;
  OrbitCamera camera_;
  ViewCut cut_;
  ControlsConfig config_;
  DisplayRequests requests_;
  UserGoal goal_;
  HeldInput held_;
  double x_ = 0.0, y_ = 0.0;  // [pixels] of the pointer
  int width_ = 1, height_ = 1;
  double rest_ = 0.0;         // [m] of the goal beyond the hand that is held
  bool moves_along_ = false;  // a key or the pad moves the goal along the axis
  bool runs_ = false, paused_ = false, locked_on_ = false, touches_ = false, in_bone_ = false, spins_ = false;
  std::string answer_;
  Vec3 hand_{0.0};       // [m] approach frame, as last seen
  double thrust_ = 0.0;  // [N] as last seen
  PadState pad_before_;
  std::deque<Input> inputs_;
  std::uint32_t switches_ = 0;        // as asked for last
  std::uint32_t instruments_on_ = 0;  // InstrumentSwitch
  double wax_left_ = 0.0;             // [s]
};

}  // namespace burrhole
