/// app/cli/choose.h: the program without a command: a window in which a person chooses a scene, or a recorded session to watch.
///   Thread  main.   Errors  unavailable: no display, no OpenGL 4.5 core, or no window in this build; with the next step.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole::cli {

/// @returns the words of the command that was chosen, {"drill", ...} or {"replay", ...}; none if the window was closed.
[[nodiscard]] Result<std::vector<std::string>> choose_command();

}  // namespace burrhole::cli
