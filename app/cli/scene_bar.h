/// app/cli/scene_bar.h: the scale of colours that a scene's pictures need.   Units, frame  none.   Errors  none.   Thread  any.
#pragma once

#include <optional>

#include "app/scene/scene.h"
#include "app/view/heat_mesh.h"

namespace burrhole::cli {

/// @returns that of [heat.picture]; nothing without it.
[[nodiscard]] inline std::optional<ColorBar> bar_of(const Scene& scene) {
  const auto* heat = scene.find<HeatPictureConfig>();
  return heat != nullptr ? std::optional(color_bar(*heat)) : std::nullopt;
}

}  // namespace burrhole::cli
