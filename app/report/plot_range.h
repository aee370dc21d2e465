/// app/report/plot_range.h: what an axis of a plot can show, and the ranges of axes. No range makes gnuplot refuse a plot, whatever the data.
///   Units  of the axes.   Thread  any.
#pragma once

#include <limits>
#include <span>

#include "app/report/plot.h"

namespace burrhole {

/// @returns whether an axis can show a value: not NaN, within 1e290, and on a logarithmic axis from 1e-290 on.
[[nodiscard]] bool can_be_drawn(double value, bool log) noexcept;

struct PlotRange {
  double lo = std::numeric_limits<double>::infinity();   ///< [unit of the axis]
  double hi = -std::numeric_limits<double>::infinity();  ///< [unit of the axis]; below lo: no value

  /// A value that cannot be drawn changes nothing.
  void include(double value, bool log) noexcept;
  /// @returns whether an axis can have this range: limits that can be drawn, and a length that numbers along it show.
  [[nodiscard]] bool is_drawable(bool log) const noexcept;
  /// @returns this range, or one around it that is drawable; [0, 1], or [0.1, 1] if logarithmic, if it holds no value.
  [[nodiscard]] PlotRange drawable(bool log) const noexcept;
};

/// @returns the x axis of one panel, or of all that share one: as given, if an axis can have that range, or else that of the data.
[[nodiscard]] PlotRange x_axis_of(std::span<const PlotPanel> panels, bool log) noexcept;
/// @returns the y axis of a panel, in the same way, with room above and below the data.
[[nodiscard]] PlotRange y_axis_of(const PlotPanel& panel, bool log) noexcept;

}  // namespace burrhole
