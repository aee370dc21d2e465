#include "app/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "app/report/csv.h"
#include "app/report/decimate.h"
#include "app/report/file.h"
#include "app/report/gnuplot.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

// Sizes [px]. The right margin holds the names of the bands, the top one the rows of event names.
constexpr int kLeft = 84, kRight = 118, kBottom = 58, kTop = 14, kGap = 16;
constexpr int kAxisName = 18;  // centre of the name of a y axis
constexpr int kRowHeight = 16, kFontSize = 12;
constexpr double kCharWidth = 6.3;    // mean advance of a 12 px sans serif letter, enough to keep names apart
constexpr double kLabelPitch = 13.0;  // least distance between the names of two bands

// Dark enough for white paper, and apart for the colour-blind (after Okabe and Ito).
constexpr const char* kLineColors[] = {"#0b5394", "#c4501b", "#1b7f5c", "#8a4f9e", "#555555"};
constexpr const char* kBandColors[] = {"#f1e7d4", "#f9f4ea"};

struct Range {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  /// A range that an axis can show: not empty, not a point.
  [[nodiscard]] Range drawable() const {
    if (lo > hi) return {0.0, 1.0};
    if (lo == hi) return {lo - 0.5, hi + 0.5};
    return *this;
  }
};

/// Where a panel lies on the picture [px from the bottom].
struct Place {
  double bottom = 0.0, top = 0.0;
};

Range x_range(const Plot& plot) {
  Range range;
  for (const PlotPanel& panel : plot.panels)
    for (const PlotSeries& series : panel.series)
      for (const double x : series.x) range.include(x);
  return range.drawable();
}

Range y_range(const PlotPanel& panel) {
  Range range;
  for (const PlotSeries& series : panel.series)
    for (const double y : series.y) range.include(y);
  for (const PlotBand& band : panel.bands) {
    range.include(band.from);
    range.include(band.to);
  }
  if (panel.from_zero) range.include(0.0);
  range = range.drawable();
  // Room for the line's own width; an axis that starts at zero keeps its zero on the frame.
  const double room = 0.06 * (range.hi - range.lo);
  return {panel.from_zero && range.lo == 0.0 ? 0.0 : range.lo - room, range.hi + room};
}

/// A name of an event as a flag: its pole is the event's line, its text runs to the right.
struct Flag {
  double pole_px = 0.0;  // from the left
  double text_px = 0.0;
  std::size_t row = 0;  // from the frame upwards
};

/// Right to left, each flag flies one row above every pole that its text would cross, so no pole strikes a name through.
std::vector<Flag> make_flags(const Plot& plot, const Range& x) {
  const double px_per_x = (plot.width_px - kLeft - kRight) / (x.hi - x.lo);
  std::vector<Flag> flags(plot.events.size());
  std::vector<std::size_t> order(flags.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return plot.events[a].x > plot.events[b].x; });
  for (std::size_t n = 0; n < order.size(); ++n) {
    Flag& flag = flags[order[n]];
    const double width = kCharWidth * static_cast<double>(plot.events[order[n]].label.size() + 1);
    flag.pole_px = kLeft + (plot.events[order[n]].x - x.lo) * px_per_x;
    flag.text_px = std::min(flag.pole_px - 2.0, plot.width_px - width);
    for (std::size_t later = 0; later < n; ++later) {
      const Flag& other = flags[order[later]];
      if (other.text_px < flag.text_px + width) flag.row = std::max(flag.row, other.row + 1);
    }
  }
  return flags;
}

/// Data of one series as a named block; a value that is not finite becomes a blank line, where gnuplot breaks the line.
std::string data_block(const PlotSeries& series, const std::string& name, int width_px) {
  BH_ASSERT(series.x.size() == series.y.size());
  std::string out = name + " << EOD\n";
  for (const std::size_t i : decimate(series.x, series.y, static_cast<std::size_t>(width_px))) {
    if (std::isfinite(series.x[i]) && std::isfinite(series.y[i]))
      out += shortest_number(series.x[i]) + ' ' + shortest_number(series.y[i]) + '\n';
    else
      out += '\n';
  }
  // A block without a point is an error to gnuplot; one outside every range draws nothing.
  return out + "\n1e300 1e300\nEOD\n";
}

/// Shaded bands with their names to the right, moved apart where bands are thin.
std::string band_commands(const PlotPanel& panel, const Range& y, const Place& place, int width_px, int height_px) {
  std::string out;
  const double px_per_y = (place.top - place.bottom) / (y.hi - y.lo);
  std::vector<std::size_t> order(panel.bands.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto middle = [&](std::size_t i) { return 0.5 * (panel.bands[i].from + panel.bands[i].to); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return middle(a) < middle(b); });
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < order.size(); ++n) {
    const PlotBand& band = panel.bands[order[n]];
    out += fmt::format(
        "set object {} rectangle from graph 0, first {} to graph 1, first {} behind fillcolor rgb \"{}\" fillstyle solid noborder\n", n + 1,
        shortest_number(band.from), shortest_number(band.to), kBandColors[n % std::size(kBandColors)]);
    last = std::max((middle(order[n]) - y.lo) * px_per_y, last + kLabelPitch);
    const double y_px = panel.y_down ? place.top - last : place.bottom + last;
    out += fmt::format("set label {} at screen {:.5f}, screen {:.5f} left textcolor rgb \"#6b5d42\" font \",11\"\n",
                       gnuplot_quoted(band.label), (width_px - kRight + 8.0) / width_px, y_px / height_px);
  }
  return out;
}

/// Vertical lines of the events; their names only above the first panel.
std::string event_commands(const Plot& plot, const std::vector<Flag>& flags, bool first_panel, const Place& place, int height_px) {
  std::string out;
  for (std::size_t i = 0; i < plot.events.size(); ++i) {
    const double reach_px = first_panel ? place.top + 3.0 + kRowHeight * static_cast<double>(flags[i].row) : place.top;
    out += fmt::format(
        "set arrow {} from screen {:.5f}, graph 0 to screen {:.5f}, screen {:.5f} nohead front linecolor rgb \"#8c8c8c\" dashtype (4,3)\n",
        i + 1, flags[i].pole_px / plot.width_px, flags[i].pole_px / plot.width_px, reach_px / height_px);
    if (first_panel)
      out += fmt::format("set label {} at screen {:.5f}, screen {:.5f} left textcolor rgb \"#444444\" font \",11\"\n",
                         gnuplot_quoted(plot.events[i].label), flags[i].text_px / plot.width_px, (reach_px + 7.0) / height_px);
  }
  return out;
}

/// Rows of a panel's legend: columns of three.
std::size_t legend_rows(const PlotPanel& panel) { return panel.series.size() > 1 ? std::min<std::size_t>(panel.series.size(), 3) : 0; }

/// The legend gets room of its own above the data, so that it never covers a line.
Range with_legend_room(const Range& y, const PlotPanel& panel, int panel_height_px) {
  constexpr double kLegendRow = 19.0;
  const double taken = kLegendRow * static_cast<double>(legend_rows(panel));
  const double room = (y.hi - y.lo) * taken / (panel_height_px - taken);
  return panel.y_down ? Range{y.lo - room, y.hi} : Range{y.lo, y.hi + room};
}

std::string series_commands(const PlotPanel& panel, std::size_t panel_index) {
  std::string out = legend_rows(panel) > 0 ? "set key top left Left reverse vertical maxrows 3 samplen 2\n" : "unset key\n";
  out += "plot ";
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    out += fmt::format("{}$p{}_{} using 1:2 with lines linewidth 1.6 linecolor rgb \"{}\" title {}", i > 0 ? ", \\\n     " : "",
                       panel_index, i, kLineColors[i % std::size(kLineColors)], gnuplot_quoted(panel.series[i].name));
  }
  return out + '\n';
}

std::string panel_commands(const Plot& plot, std::size_t index, const std::vector<Flag>& flags, const Place& place, int height_px) {
  const PlotPanel& panel = plot.panels[index];
  const Range y = with_legend_room(y_range(panel), panel, plot.panel_height_px);
  const bool last = index + 1 == plot.panels.size();
  std::string out = fmt::format("unset object\nunset label\nunset arrow\nset bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
                                place.bottom / height_px, place.top / height_px);
  out += fmt::format("set yrange [{}:{}]\n", shortest_number(panel.y_down ? y.hi : y.lo), shortest_number(panel.y_down ? y.lo : y.hi));
  // A label of our own: gnuplot's ylabel moves with the width of the numbers, so those of stacked panels would not line up.
  out += fmt::format("set label {} at screen {:.5f}, screen {:.5f} center rotate\n", gnuplot_quoted(panel.y_label),
                     kAxisName / double(plot.width_px), 0.5 * (place.bottom + place.top) / height_px);
  out += last ? fmt::format("set format x \"%g\"\nset xlabel {} offset 0,0.3\n", gnuplot_quoted(plot.x_label))
              : "set format x \"\"\nunset xlabel\n";
  out += band_commands(panel, y, place, plot.width_px, height_px);
  out += event_commands(plot, flags, index == 0, place, height_px);
  return out + series_commands(panel, index);
}

}  // namespace

std::string plot_script(const Plot& plot) {
  const Range x = x_range(plot);
  const std::vector<Flag> flags = make_flags(plot, x);
  std::size_t row_count = 0;
  for (const Flag& flag : flags) row_count = std::max(row_count, flag.row + 1);
  const int count = static_cast<int>(plot.panels.size());
  const int top = kTop + kRowHeight * static_cast<int>(row_count);
  const int height = top + count * plot.panel_height_px + (count - 1) * kGap + kBottom;

  std::string out =
      fmt::format("set encoding utf8\nset terminal svg size {},{} dynamic noenhanced font \"Helvetica,{}\" background \"white\"\n",
                  plot.width_px, height, kFontSize);
  for (std::size_t p = 0; p < plot.panels.size(); ++p)
    for (std::size_t s = 0; s < plot.panels[p].series.size(); ++s)
      out += data_block(plot.panels[p].series[s], fmt::format("$p{}_{}", p, s), plot.width_px);
  out += "set multiplot\nset border 3 linecolor rgb \"#666666\"\nset tics nomirror out scale 0.6\n";
  out += "set grid linecolor rgb \"#dddddd\" linewidth 0.6 dashtype solid\n";
  out += fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n", double(kLeft) / plot.width_px,
                     double(plot.width_px - kRight) / plot.width_px);
  out += fmt::format("set xrange [{}:{}]\n", shortest_number(x.lo), shortest_number(x.hi));
  for (std::size_t p = 0; p < plot.panels.size(); ++p) {
    const double panel_top = height - top - static_cast<double>(p) * (plot.panel_height_px + kGap);
    out += panel_commands(plot, p, flags, {panel_top - plot.panel_height_px, panel_top}, height);
  }
  return out + "unset multiplot\n";
}

Result<std::string> draw_svg(const Plot& plot, const std::string& gnuplot) {
  Result<std::string> svg = run_gnuplot(plot_script(plot), gnuplot);
  // Browsers show a title as a tooltip over the whole plot, and this one names only the program.
  constexpr std::string_view kTitle = "<title>Gnuplot</title>";
  if (const std::size_t at = svg ? svg->find(kTitle) : std::string::npos; at != std::string::npos) svg->erase(at, kTitle.size());
  return svg;
}

Status write_svg(const Plot& plot, const std::string& path) {
  const Result<std::string> svg = draw_svg(plot);
  if (!svg) return svg.error();
  return write_file(path, *svg);
}

}  // namespace burrhole
