/// app/report/plot.h: stacked panels over one shared x axis, drawn by gnuplot as SVG.
///   Units  as the labels say; the caller converts. Values that are not finite break a line.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

struct PlotSeries {
  std::string name;          ///< in the legend, which is drawn when a panel has more than one
  std::vector<double> x, y;  ///< equal sizes; x does not fall. Long series are decimated, peaks stay
};

/// A shaded stretch of the y axis, such as a layer of bone.
struct PlotBand {
  std::string label;
  double from = 0.0, to = 0.0;
};

/// A vertical line through every panel, named above the first.
struct PlotEvent {
  double x = 0.0;
  std::string label;
};

struct PlotPanel {
  std::string y_label;  ///< with its unit
  std::vector<PlotSeries> series;
  std::vector<PlotBand> bands;
  bool y_down = false;     ///< larger values lower, as depth is thought of
  bool from_zero = false;  ///< the axis holds 0 even if the data do not
};

struct Plot {
  std::string x_label;  ///< with its unit
  std::vector<PlotPanel> panels;
  std::vector<PlotEvent> events;
  int width_px = 900;
  int panel_height_px = 190;
};

/// @returns the commands for gnuplot, data inside. Pure: the same plot gives the same text.
[[nodiscard]] std::string plot_script(const Plot& plot);

/// @returns an SVG document. Errors: unavailable if there is no gnuplot; internal with gnuplot's own words if it refuses the script.
[[nodiscard]] Result<std::string> draw_svg(const Plot& plot, const std::string& gnuplot = "gnuplot");

/// draw_svg into a file.
[[nodiscard]] Status write_svg(const Plot& plot, const std::string& path);

}  // namespace burrhole
