/// app/report/plot_style.h: the styles of curves that have none of their own, so that each is seen.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/report/plot.h"

namespace burrhole {

/// Where a curve lies among those that coincide with it.
struct CurveLayer {
  std::size_t below = 0;  ///< curves under it, one upon the other
  std::size_t on = 0;     ///< number of the uppermost of these, if there are any
  bool covered = false;   ///< whether another lies on it
};

/// @returns the layer of each series of a panel. Two curves coincide if they have the same x and, on a quarter of their segments or more,
/// y within `near` [unit of the axis]. Only series without a style of their own count.
[[nodiscard]] std::vector<CurveLayer> curve_layers(const PlotPanel& panel, double near);

/// @returns the style of the series of that number where none coincide: colours in turn, and after each round of them the next dash.
[[nodiscard]] std::string turn_style(std::size_t number);
/// @returns the styles of the series of a panel: as turn_style(), but a curve that covers others is dashed, with another dash than the one
/// that it lies on, and the lowest one is wider, so that it shows beside and between the dashes. Up to 15 series differ in colour or dash.
[[nodiscard]] std::vector<std::string> turn_styles(const std::vector<CurveLayer>& layers);

/// @returns whether the series of a panel need samples in the legend that are long enough for dashes; layers of its series.
[[nodiscard]] bool has_dashes(const std::vector<CurveLayer>& layers);

}  // namespace burrhole
