/// app/cli/scene_bar.h: the scale of colours that a scene's pictures need.   Units, frame  none.   Errors  none.   Thread  any.
#pragma once

#include <optional>

#include "app/scene/scene.h"
#include "app/view/color_bar.h"

namespace burrhole::cli {

/// @returns that of an effect; nothing without one.
[[nodiscard]] inline std::optional<ColorBar> bar_of(const Scene& scene) {
  const auto* bar = scene.find<ColorBar>();
  return bar != nullptr ? std::optional(*bar) : std::nullopt;
}

}  // namespace burrhole::cli
