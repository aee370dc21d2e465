/// app/lab/frontier_plot.h: panels with logarithmic axes, shaded between two curves where asked, drawn by gnuplot as SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// Values that are not finite or not above 0 are left out.
struct LogCurve {
  std::string name{};   ///< in the legend; empty: not there
  std::string style{};  ///< as line_style() or point_style() make it
  std::vector<double> x{}, y{};
};
[[nodiscard]] std::string line_style(const char* colour, const char* dash, double width);
/// `type` is gnuplot's; those below 7 are open and drawn larger, so that a curve under another is seen.
[[nodiscard]] std::string point_style(const char* colour, int type);

struct LogPanel {
  std::string title{}, y_label{};
  std::pair<double, double> y_range{};
  std::vector<LogCurve> curves{};
  LogCurve fill_from{}, fill_to{};  ///< shaded between the two, under the curves; empty: nothing
};

struct LogPage {
  std::string x_label{};
  std::pair<double, double> x_range{};
  bool log_x = false;
  int columns = 2;
  std::string key = "top left";  ///< gnuplot's word for where the legend goes, in the first panel
  std::vector<LogPanel> panels{};
};

/// @returns an SVG document. Errors as run_gnuplot().
[[nodiscard]] Result<std::string> draw_svg(const LogPage& page);

}  // namespace burrhole
