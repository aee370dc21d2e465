/// tests/app/window/controls_rig.h: controls driven by recorded events, and a run that answers them.
///   Frame  approach frame.   Units  SI.
#pragma once

#include <cmath>

#include "app/window/controls.h"

namespace burrhole {

inline constexpr double kStep = 1.0 / 200.0;  // [s]
inline const Pose kWorld{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};

inline WindowEvent key(Key which, bool down) { return {.kind = WindowEvent::Kind::key, .code = static_cast<int>(which), .down = down}; }
inline WindowEvent button(MouseButton which, bool down, double x, double y) {
  return {.kind = WindowEvent::Kind::button, .code = static_cast<int>(which), .down = down, .x = x, .y = y};
}
inline WindowEvent motion(double x, double y) { return {.kind = WindowEvent::Kind::motion, .x = x, .y = y}; }
inline WindowEvent wheel(double steps) { return {.kind = WindowEvent::Kind::scroll, .y = steps}; }
inline WindowEvent focus(bool gained) { return {.kind = WindowEvent::Kind::focus, .down = gained}; }

struct Rig {
  explicit Rig(const ControlsSetup& from = setup()) : controls(from, OrbitCamera(kWorld, 0.0, 0.8, 0.074, 0.005)) {
    controls.set_picture_size(800, 600);
    touch(0.0, GoalHandConfig{}.standoff);
    run(kStep);  // the clocks run
  }
  static ControlsSetup setup() {
    ControlsSetup out;
    out.world_from_approach = kWorld;
    out.tools = {{"a", "text a"}, {"b", "text b"}, {"c", "text c"}};
    return out;
  }
  void handle(const WindowEvent& event, bool taken = false) { controls.handle(event, taken); }
  void press(Key which) {
    handle(key(which, true));
    handle(key(which, false));
  }
  void run(double seconds, const PadState& pad = {}) {
    for (int n = 0; n < std::lround(seconds / kStep); ++n) controls.step(kStep, live, pad);
  }
  /// Bone that carries `newton` with the hand at `height` [m].
  void touch(double newton, double height) {
    live.force = kWorld.rotate(Vec3(0.0, 0.0, newton));
    live.hand.tick = 1;
    live.hand.world_from_hand = {kWorld.rotation, kWorld * Vec3(0.0, 0.0, height)};
  }
  [[nodiscard]] Vec3 place() const { return controls.goal().place; }

  Controls controls;
  LiveState live;
  ControlsConfig config;
};

}  // namespace burrhole
