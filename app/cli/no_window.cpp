// Commands in a build without window.
#include "app/cli/choose.h"
#include "app/cli/drill_window.h"

namespace burrhole::cli {
namespace {

Error no_window() {
  return {ErrorCode::unavailable, "this build has no window: --offscreen drills without one, and replay works without --view", {}};
}

}  // namespace

void add_view_options(CLI::App&, WindowOptions&) {}

void add_window_options(CLI::App& command, WindowOptions& options) { command.add_flag("--window", options.asked, "not in this build"); }

Result<bool> prepare_window(WindowOptions& options, SceneOption&, bool) {
  if (options.asked) return no_window();
  return false;
}

Result<RunSummary> drill_scene_in_window(const LoadedScene&, const WindowOptions&, const DrillingFiles&, bool) { return no_window(); }

Result<ViewedSession> view_session_in_window(const std::string&, const WindowOptions&, bool) { return no_window(); }

Result<std::vector<std::string>> choose_command() {
  return Error{ErrorCode::unavailable,
               "this build has no window to choose in: burrhole drill parietal drills, burrhole --help lists the commands",
               {}};
}

}  // namespace burrhole::cli
