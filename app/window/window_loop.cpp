#include "app/window/window_loop.h"

#include <algorithm>
#include <chrono>

#include "app/stage/instruments.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;
constexpr double kPoll = 1.0 / 200.0;  // [s] of the main thread: events, goal, held keys

constexpr double kLongestStep = 0.05;  // [s] of a held key, also where the main thread was stalled for longer
constexpr double kBeyondBone = 0.02;   // [m] how far a person can push through: the hands then lie on the bone

}  // namespace

void start_window(WindowState& state, Viewer& viewer, const LoadedScene& loaded, const WindowStart& start, const Simulation& simulation) {
  const Stage& stage = simulation.stage();
  const DisplayConfig& display = *loaded.scene.find<DisplayConfig>();
  const Pose world_from_approach = stage.world_from_approach();
  const double thickness = stage.approach.thickness;
  ControlsSetup setup;
  setup.bone_moves = loaded.scene.effects.has("motion");
  setup.instruments = instruments_of(loaded.scene.effects);
  if (loaded.scene.goal_hand) setup.hand = *loaded.scene.goal_hand;
  setup.world_from_approach = world_from_approach;
  setup.tools = start.tools;
  setup.deepest = thickness + kBeyondBone;
  setup.demonstration = start.demonstration;
  setup.transport = start.transport;
  setup.text_scale = start.text_scale;
  WindowPlan plan;
  plan.title = loaded.scene.title;
  plan.approach = stage.approach;
  plan.labels = labels_of(loaded.bone->notes());
  plan.world_from_bone = loaded.scene.volume.world_from_bone;
  plan.world_from_approach = world_from_approach;
  plan.spin_rpm = loaded.scene.tool.spin / kRevPerMinute;
  plan.reference_push = start.reference_push;
  plan.largest_push = loaded.scene.goal_hand ? loaded.scene.goal_hand->push : 2.0 * loaded.scene.hand.push;
  plan.users_push = setup.hand.push;
  plan.demonstration = start.demonstration;
  plan.bone_moves = setup.bone_moves;
  plan.instruments = setup.instruments;
  plan.one_eye = display.stereo.mode == StereoMode::off && !display.stereo.workbench;
  if (const auto* scale = loaded.scene.find<ColorBar>()) plan.scale = *scale;
  plan.marks = start.marks;
  state.begin(plan, setup, OrbitCamera(world_from_approach, display.azimuth, display.elevation, display.distance, 0.8 * thickness),
              start.tool);
  FrameView base = make_frame_view(display, plan.world_from_bone, world_from_approach, thickness, false);
  base.table = find_table(display, stage.voxmap->bone(), plan.world_from_bone, world_from_approach);
  viewer.set_base(base, world_from_approach, stage.tool->turns);
}

bool wants_quad(const LoadedScene& loaded) { return loaded.scene.find<DisplayConfig>()->stereo.mode == StereoMode::quad; }

void poll_window(GlfwWindow& window, WindowState& state, RunSwitches& switches, const std::function<bool(const WindowView&)>& stops,
                 const std::function<void()>& ready) {
  auto before = Steady::now();
  bool full = false, is_ready = false;
  while (!(state.closed() && switches.finished.load(std::memory_order_acquire))) {
    window.wait(kPoll);
    const auto now = Steady::now();
    state.step(std::min(kLongestStep, std::chrono::duration<double>(now - before).count()), window.pad());
    before = now;
    const WindowView view = state.view_of_controls();
    if (!is_ready && view.stage == RunStage::drilling) {
      is_ready = true;
      ready();
    }
    if (window.is_lost() && !state.closed()) {
      switches.lost = !switches.finished.load(std::memory_order_acquire);
      state.close();
    }
    const bool signalled = switches.signal != nullptr && switches.signal->load(std::memory_order_relaxed);
    if (signalled || state.closed() || stops(view)) {
      switches.stop = true;
      state.stop_waiting();
    }
    if (signalled && switches.finished.load(std::memory_order_acquire)) state.close();
    if (view.requests.full_screen != full) window.set_full_screen(full = view.requests.full_screen);
  }
}

}  // namespace burrhole
