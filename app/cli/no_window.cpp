// `burrhole drill` in a build without window.
#include "app/cli/drill_window.h"

namespace burrhole::cli {

void add_window_options(CLI::App& command, WindowWish& wish) { command.add_flag("--window", wish.asked, "not in this build"); }

Result<bool> prepare_window(WindowWish& wish, SceneOption&, bool) {
  if (wish.asked) return Error{ErrorCode::unavailable, "this build has no window", {}};
  return false;
}

Result<RunSummary> drill_scene_in_window(const LoadedScene&, const WindowWish&, const DrillingFiles&, bool) {
  return Error{ErrorCode::unavailable, "this build has no window", {}};
}

}  // namespace burrhole::cli
