/// app/cli/choose.h: the program without a command: a window in which a person chooses a scene, or a recorded session to watch.
///   Thread  main.   Errors  unavailable: no OpenGL 4.5 core.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole::cli {

/// @returns the words of the command that was chosen, {"drill", ...} or {"replay", ...}; none if the window was closed; nothing if there is
/// no display, or no window in this build.
[[nodiscard]] Result<std::optional<std::vector<std::string>>> choose_command();

}  // namespace burrhole::cli
