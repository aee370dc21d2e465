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
  bool covered = false;   ///< whether another lies on it
};

/// @returns the layer of each series of a panel. Two curves coincide if they have the same x and, on a quarter of their segments or more,
/// y within `near` [unit of the axis]. Only series without a style of their own count.
[[nodiscard]] std::vector<CurveLayer> curve_layers(const PlotPanel& panel, double near);

/// @returns the style of the series of that number: colours in turn, and after each round of them the next dash. A curve that covers others
/// is dashed, and the covered one is wider, so that it shows beside and between the dashes.
[[nodiscard]] std::string turn_style(std::size_t number, const CurveLayer& layer = {});

/// @returns whether the series of a panel need samples in the legend that are long enough for dashes; layers of its series.
[[nodiscard]] bool has_dashes(const std::vector<CurveLayer>& layers);

}  // namespace burrhole
