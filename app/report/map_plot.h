/// app/report/map_plot.h: a section through a field as coloured squares with a scale, drawn by gnuplot as SVG.
///   Units  as the map's labels say.   Errors  unavailable without gnuplot; internal with its message.   Thread  any.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/base/value_map.h"

namespace burrhole {

/// @returns the commands for gnuplot, including the data. Pure.
[[nodiscard]] std::string map_script(const ValueMap& map, int width_px);
/// @returns an SVG document.
[[nodiscard]] Result<std::string> draw_map(const ValueMap& map, int width_px, const std::string& gnuplot = "gnuplot");

}  // namespace burrhole
