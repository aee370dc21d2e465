/// app/window/chooser.h: a window with a list, from which a person chooses what to do; and from there files, and a place on the bone of a scan.
///   Thread  main.   Errors  unavailable: no display, or no OpenGL 4.5 core. What cannot be opened is one line in the window.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string>

#include "app/window/selection.h"
#include "app/window/skull_site.h"
#include "core/base/result.h"
#include "core/tool/tool.h"

namespace burrhole {

struct ChooserConfig {
  bool light = false;
  double text_scale = 1.0;         ///< [-] of the desktop's own scale
  int width = 1100, height = 720;  ///< [pixels]
  TriangleMesh bit{}, solid{};     ///< that stands on the bone of a scan: as drawn, and as it erodes
};

/// What a person has chosen: a line of the list, a scene file, or a place on a scan.
struct Chosen {
  std::optional<std::size_t> line{};
  std::string scene{};  ///< path; empty: none
  std::optional<DrillSite> site{};
  SkullSource source{};  ///< of the site
};

/// Shows the list until something is chosen. @param stop set by a signal handler: ends it; may be null.
/// @returns nothing if the person closed the window.
[[nodiscard]] Result<std::optional<Chosen>> choose_in_window(const std::string& title, std::span<const Choice> choices,
                                                             const ChooserConfig& config, const std::atomic<bool>* stop);

}  // namespace burrhole
