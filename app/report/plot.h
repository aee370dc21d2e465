/// app/report/plot.h: panels of lines and points, drawn by gnuplot as SVG: stacked over one shared x axis, or in a grid.
///   Units  as the labels say; the caller converts. A value that no axis can show (plot_range.h) breaks a line; an event or band of one is
///   left out, and a range of one is that of the data. A panel without a value that can be drawn says "no data".
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

// Dark enough for white paper, and apart for the colour-blind (after Okabe and Ito).
inline constexpr const char* kPlotBlue = "#0b5394";
inline constexpr const char* kPlotOrange = "#c4501b";
inline constexpr const char* kPlotGreen = "#1b7f5c";
inline constexpr const char* kPlotViolet = "#8a4f9e";
inline constexpr const char* kPlotGrey = "#555555";

struct PlotSeries {
  std::string name;  ///< in the legend, which is drawn when a panel has more than one; empty: not there
  /// [units of the axes] equal sizes. A series with over five points per pixel is decimated; peaks are kept; its x must not decrease.
  std::vector<double> x, y;
  std::string style{};  ///< as line_style() or point_style() make it; empty: a line, five colours in turn, then dashed, then dotted
  std::vector<std::string> labels{};  ///< near each point, none over another; empty: none
};

/// @param dash gnuplot's dash type: "1" or lengths such as "(6,3)"
[[nodiscard]] std::string line_style(const char* colour, const char* dash, double width);
/// @param type gnuplot's; those below 7 are drawn larger, so that a curve under another is seen
[[nodiscard]] std::string linked_point_style(const char* colour, int type);
/// Of the n-th curve from the bottom, n < count <= 4: curves that coincide become narrower upwards, with smaller open markers, so that each is seen.
[[nodiscard]] std::string nested_style(const char* colour, std::size_t n, std::size_t count);
[[nodiscard]] std::string point_style(const char* colour, int type, double size, double width = 1.0);

/// An area between two curves, under the series; values are clamped to the panel's y_range, which is given.
struct PlotFill {
  std::string name;                 ///< in the legend
  std::vector<double> x, from, to;  ///< [units of the axes]
};

/// A shaded range of the y axis, such as a layer of bone.
struct PlotBand {
  std::string label;
  double from = 0.0, to = 0.0;  ///< [unit of the y axis]
};

/// A vertical line through every panel, with its name above the first.
struct PlotEvent {
  double x = 0.0;  ///< [unit of the x axis]
  std::string label;
};

struct PlotPanel {
  std::string y_label;  ///< including its unit
  std::vector<PlotSeries> series;
  std::vector<PlotBand> bands;
  bool y_down = false;                                            ///< larger values lower, as depth is thought of
  bool from_zero = false;                                         ///< the axis holds 0 even if the data do not
  std::string title{};                                            ///< in a grid
  std::optional<std::pair<double, double>> x_range{}, y_range{};  ///< of the axes; without one that of the data. x_range: in a grid
  std::vector<PlotFill> fills{};
};

struct Plot {
  std::string x_label;  ///< including its unit
  std::vector<PlotPanel> panels;
  std::vector<PlotEvent> events;
  int width_px = 900;  ///< of the picture
  int panel_height_px = 190;
  int columns = 0;  ///< of a grid, filled row by row, each panel with axes of its own; 0: stacked over one x axis
  bool log_x = false, log_y = false;
  /// Place of the legend, in a grid that of the first panel alone: gnuplot's words, in the panel; or "above", over the whole grid.
  std::string legend = "top left";
};

/// @returns the commands for gnuplot, including the data. Pure: the same plot gives the same text.
[[nodiscard]] std::string plot_script(const Plot& plot);

/// @returns an SVG document. Errors: unavailable without gnuplot; internal with the message of gnuplot if it rejects the script.
[[nodiscard]] Result<std::string> draw_svg(const Plot& plot, const std::string& gnuplot = "gnuplot");

/// Writes draw_svg() to a file.
[[nodiscard]] Status write_svg(const Plot& plot, const std::string& path);

}  // namespace burrhole
