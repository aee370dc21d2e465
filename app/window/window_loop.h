/// app/window/window_loop.h: what windows have in common: the start of state and viewer, and the loop of the main thread.
///   Frame  world.   Units  SI.   Errors  none.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "app/window/viewer.h"

namespace burrhole {

/// What a person sees and can do at the start.
struct WindowStart {
  std::vector<ToolText> tools{};         ///< that the person can take
  std::string tool{};                    ///< name of the scene's
  double reference_push = 0.0;           ///< [N] of the scene's script; 0: none
  bool demonstration = false;            ///< the scene's own hand drills
  double text_scale = 1.0;               ///< [-] of texts, of the desktop's own scale
  std::optional<Transport> transport{};  ///< of a watched session
  std::vector<MessageLine> marks{};      ///< on its time line
};

/// Gives state and viewer what a run is about, before its first tick. Run thread.
void start_window(WindowState& state, Viewer& viewer, const LoadedScene& loaded, const WindowStart& start, const Simulation& simulation);

/// @returns whether the scene shows each eye from a buffer of its own. The scene must have [display].
[[nodiscard]] bool wants_quad(const LoadedScene& loaded);

/// What ends a run, and what it has come to.
struct RunSwitches {
  const std::atomic<bool>* signal = nullptr;  ///< from outside; null: none
  std::atomic<bool> stop{false};              ///< to the run
  std::atomic<bool> finished{false};          ///< from the run
  bool lost = false;                          ///< the display was lost before the run had finished
};

/// Hands events to the state until the run has finished and the window is to go. Main thread.
/// @param stops whether the run is to stop, besides signals and closing. @param ready called once, when the first state is shown.
void poll_window(GlfwWindow& window, WindowState& state, RunSwitches& switches, const std::function<bool(const WindowView&)>& stops,
                 const std::function<void()>& ready);

}  // namespace burrhole
