#include "app/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "app/report/csv.h"
#include "app/report/decimate.h"
#include "app/report/file.h"
#include "app/report/gnuplot.h"
#include "app/report/plot_labels.h"
#include "app/report/plot_range.h"
#include "app/report/plot_style.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

// Sizes [px]. The right margin contains the names of the bands, if there are any, the top margin the rows of event names.
constexpr int kLeft = 84, kRightOfBands = 118, kRight = 26, kBottom = 58, kTop = 14, kGap = 16;
constexpr int kTitle = 30, kGridRight = 14;  // in a grid: above each panel, and to its right
constexpr double kFarAway = 1e6;             // of what lies outside a frame
constexpr int kLegendAbove = 26;             // height of a legend of one row above a grid
constexpr int kAxisName = 18;                // centre of the name of a y axis
constexpr int kRowHeight = 16, kFontSize = 12;
constexpr int kNameFont = 10;         // of the names of points
constexpr double kCharWidth = 6.3;    // mean advance of a 12 px sans serif letter; used to separate names
constexpr double kLabelPitch = 13.0;  // smallest distance between the names of two bands

constexpr const char* kAxesStyle =
    "set border 3 linecolor rgb \"#666666\"\nset xtics nomirror out scale 0.6\nset ytics nomirror out scale 0.6\n"
    "set grid linecolor rgb \"#dddddd\" linewidth 0.6 dashtype solid\n";
constexpr double kLegendRow = 19.0;    // height of a row of the legend
constexpr double kKeySample = 46.0;    // the line sample of a legend, with the space before and after it
constexpr std::size_t kUsualRows = 3;  // of a legend: the height of a panel holds these

constexpr double kCoincide = 0.005;  // [-] of the axis: curves nearer than this cover each other
constexpr const char* kBandColors[] = {"#f1e7d4", "#f9f4ea"};

/// Where a panel's frame lies on the picture [px from the left and the bottom].
struct Place {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
};

/// The right margin of stacked panels, which share it.
int right_margin(const Plot& plot) {
  return std::ranges::any_of(plot.panels, [](const PlotPanel& panel) { return !panel.bands.empty(); }) ? kRightOfBands : kRight;
}

/// The name of an event: its text runs to the right of the event's line.
struct Flag {
  double pole_px = 0.0;  // from the left
  double text_px = 0.0;
  std::size_t row = 0;  // from the frame upwards
};

/// From right to left, each name is placed one row above every line that its text would cross, so that no line crosses a name.
std::vector<Flag> make_flags(const Plot& plot, const PlotRange& x) {
  const double px_per_x = (plot.width_px - kLeft - right_margin(plot)) / (x.hi - x.lo);
  std::vector<Flag> flags(plot.events.size());
  std::vector<std::size_t> order(flags.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return plot.events[a].x > plot.events[b].x; });
  for (std::size_t n = 0; n < order.size(); ++n) {
    Flag& flag = flags[order[n]];
    const double width = kCharWidth * static_cast<double>(plot.events[order[n]].label.size() + 1);
    flag.pole_px = std::clamp(kLeft + (plot.events[order[n]].x - x.lo) * px_per_x, -kFarAway, kFarAway);
    flag.text_px = std::min(flag.pole_px - 2.0, plot.width_px - width);
    for (std::size_t later = 0; later < n; ++later) {
      const Flag& other = flags[order[later]];
      if (other.text_px < flag.text_px + width) flag.row = std::max(flag.row, other.row + 1);
    }
  }
  return flags;
}

/// Data of one series as a named block; a value that cannot be drawn becomes a blank line, where gnuplot breaks the line.
std::string data_block(const Plot& plot, const PlotSeries& series, const std::string& name) {
  BH_ASSERT(series.x.size() == series.y.size() && (series.labels.empty() || series.labels.size() == series.x.size()));
  std::string out = name + " << EOD\n";
  for (const std::size_t i : decimate(series.x, series.y, static_cast<std::size_t>(plot.width_px))) {
    if (can_be_drawn(series.x[i], plot.log_x) && can_be_drawn(series.y[i], plot.log_y))
      out += shortest_number(series.x[i]) + ' ' + shortest_number(series.y[i]) + '\n';
    else
      out += '\n';
  }
  // A block without a point is an error to gnuplot; one outside every range draws nothing.
  return out + "\n1e300 1e300\nEOD\n";
}

std::string fill_block(const Plot& plot, const PlotFill& fill, const PlotRange& y, const std::string& name) {
  BH_ASSERT(fill.x.size() == fill.from.size() && fill.x.size() == fill.to.size());
  std::string out = name + " << EOD\n";
  bool has_points = false;
  for (std::size_t n = 0; n < fill.x.size(); ++n) {
    const bool drawn = can_be_drawn(fill.x[n], plot.log_x) && !std::isnan(fill.from[n]) && !std::isnan(fill.to[n]);
    has_points = has_points || drawn;
    out += drawn ? fmt::format("{} {} {}\n", shortest_number(fill.x[n]), shortest_number(std::clamp(fill.from[n], y.lo, y.hi)),
                               shortest_number(std::clamp(fill.to[n], y.lo, y.hi)))
                 : "\n";
  }
  return out + (has_points ? "EOD\n" : "1e300 1e300 1e300\nEOD\n");  // as in data_block()
}

/// @returns whether a panel has nothing to draw.
bool is_empty(const Plot& plot, const PlotPanel& panel) {
  const auto can = [&](const PlotSeries& series) {
    for (std::size_t n = 0; n < series.x.size(); ++n)
      if (can_be_drawn(series.x[n], plot.log_x) && can_be_drawn(series.y[n], plot.log_y)) return true;
    return false;
  };
  const auto fills = [&](const PlotFill& fill) {
    return std::ranges::any_of(fill.x, [&](double x) { return can_be_drawn(x, plot.log_x); });
  };
  return std::ranges::none_of(panel.series, can) && std::ranges::none_of(panel.fills, fills);
}

/// Shaded bands with their names to the right, separated where bands are thin.
std::string band_commands(const PlotPanel& panel, const PlotRange& y, const Place& place, int width_px, int height_px) {
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
    last = std::max(std::clamp((middle(order[n]) - y.lo) * px_per_y, -kFarAway, kFarAway), last + kLabelPitch);
    const double y_px = panel.y_down ? place.top - last : place.bottom + last;
    out += fmt::format("set label {} at screen {:.5f}, screen {:.5f} left textcolor rgb \"#6b5d42\" font \",11\"\n",
                       gnuplot_quoted(band.label), (width_px - kRightOfBands + 8.0) / width_px, y_px / height_px);
  }
  return out;
}

/// Vertical lines of the events; names above the first panel only.
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

/// Rows of the legend of a panel: three, or as many as it takes for its columns to fit beside each other.
std::size_t legend_rows(const Plot& plot, const PlotPanel& panel) {
  const std::size_t count = panel.series.size();
  if (count < 2) return 0;
  std::size_t longest = 0;
  for (const PlotSeries& series : panel.series) longest = std::max(longest, series.name.size());
  const double room = plot.width_px - kLeft - right_margin(plot), column = kKeySample + kCharWidth * static_cast<double>(longest);
  const std::size_t columns = std::max<std::size_t>(1, static_cast<std::size_t>(room / column));
  return std::max(std::min(count, kUsualRows), (count + columns - 1) / columns);
}

/// The height of each stacked panel: a legend of more than the usual rows makes it higher.
int stacked_height(const Plot& plot) {
  std::size_t rows = kUsualRows;
  for (const PlotPanel& panel : plot.panels) rows = std::max(rows, legend_rows(plot, panel));
  return plot.panel_height_px + static_cast<int>(kLegendRow * static_cast<double>(rows - kUsualRows));
}

/// The legend has its own space above the data, so that it covers no line.
PlotRange with_legend_room(const PlotRange& y, const PlotPanel& panel, std::size_t rows, int panel_height_px) {
  const double taken = kLegendRow * static_cast<double>(rows);
  const double room = (y.hi - y.lo) * taken / (panel_height_px - taken);
  return panel.y_down ? PlotRange{y.lo - room, y.hi} : PlotRange{y.lo, y.hi + room};
}

/// Share of the length of an axis at a value.
double share_of(const PlotRange& axis, bool log, double value) {
  const double share =
      log ? (std::log(value) - std::log(axis.lo)) / (std::log(axis.hi) - std::log(axis.lo)) : (value - axis.lo) / (axis.hi - axis.lo);
  return std::clamp(share, -kFarAway, kFarAway);
}

/// Axes of a panel on the picture.
struct Axes {
  PlotRange x, y;
  bool log_x = false, log_y = false, y_down = false;
  Place place;

  /// @returns where a point is drawn [px]; nothing where it cannot be.
  [[nodiscard]] std::optional<PlotPoint> at(double px, double py) const {
    if (!can_be_drawn(px, log_x) || !can_be_drawn(py, log_y)) return std::nullopt;
    const double right = share_of(x, log_x, px), up = share_of(y, log_y, py);
    return PlotPoint{place.left + right * (place.right - place.left), place.bottom + (y_down ? 1.0 - up : up) * (place.top - place.bottom)};
  }
};

/// Markers and curves of a panel.
PanelContents contents_of(const PlotPanel& panel, const Axes& axes) {
  PanelContents out{.frame = {{axes.place.left, axes.place.bottom}, {axes.place.right, axes.place.top}}};
  for (const PlotSeries& series : panel.series) {
    const bool marks = series.style.find("points") != std::string::npos;
    const bool joined = series.style.empty() || series.style.find("lines") != std::string::npos;
    std::optional<PlotPoint> last;
    for (std::size_t n = 0; n < series.x.size(); ++n) {
      const auto at = axes.at(series.x[n], series.y[n]);
      if (at && marks) out.marks.push_back(*at);
      if (at && last && joined) out.lines.push_back({*last, *at});
      last = at;
    }
  }
  return out;
}

/// Names beside their points, with lines to those that are further away. @param legend in the panel, where no name is placed.
std::string name_commands(const Plot& plot, const PlotPanel& panel, const Axes& axes, int height_px, const std::optional<PlotBox>& legend) {
  std::vector<PointName> names;
  std::vector<std::string> texts;
  for (const PlotSeries& series : panel.series)
    for (std::size_t n = 0; n < series.labels.size(); ++n) {
      const auto at = axes.at(series.x[n], series.y[n]);
      if (!at) continue;
      const double width = kCharWidth * kNameFont / kFontSize * static_cast<double>(series.labels[n].size());
      names.push_back({*at, width + 4.0, kNameFont + 1.0});
      texts.push_back(series.labels[n]);
    }
  if (names.empty()) return {};
  PanelContents contents = contents_of(panel, axes);
  if (legend) contents.covered.push_back(*legend);
  const auto screen = [&](const PlotPoint& p) { return fmt::format("screen {:.5f}, screen {:.5f}", p.x / plot.width_px, p.y / height_px); };
  const auto placed = place_names(names, contents);
  std::string out;
  for (std::size_t n = 0; n < placed.size(); ++n) {
    if (!placed[n]) continue;
    if (placed[n]->leader)
      out += fmt::format("set arrow from {} to {} nohead linecolor rgb \"#8c8c8c\" linewidth 0.7\n", screen(placed[n]->leader->from),
                         screen(placed[n]->leader->to));
    out += fmt::format("set label {} at {} center textcolor rgb \"#333333\" font \",{}\"\n", gnuplot_quoted(texts[n]),
                       screen(placed[n]->box.middle()), kNameFont);
  }
  return out;
}

/// The box of the legend in the frame of a grid's first panel, a little larger than gnuplot draws it.
PlotBox legend_box(const PlotPanel& panel, const std::string& where, const Place& place) {
  constexpr double kSample = 56.0, kRow = 16.0, kChar = 5.6, kEdge = 8.0;
  std::size_t longest = 0, rows = 0;
  for (const PlotSeries& series : panel.series) {
    longest = std::max(longest, series.name.size());
    rows += series.name.empty() ? 0 : 1;
  }
  const double width = kSample + kChar * static_cast<double>(longest), height = kEdge + kRow * static_cast<double>(rows);
  const double left = where.find("right") != std::string::npos ? place.right - width : place.left;
  const double bottom = where.find("bottom") != std::string::npos ? place.bottom : place.top - height;
  return {{left, bottom}, {left + width, bottom + height}};
}

std::string titled(const std::string& name) { return name.empty() ? "notitle" : "title " + gnuplot_quoted(name); }

/// @param layers of the series, from curve_layers().
std::string series_commands(const PlotPanel& panel, std::size_t panel_index, const std::vector<CurveLayer>& layers) {
  std::vector<std::string> parts;
  const std::vector<std::string> styles = turn_styles(layers);
  for (std::size_t i = 0; i < panel.fills.size(); ++i)
    parts.push_back(fmt::format("$f{}_{} using 1:2:3 with filledcurves linecolor rgb \"{}\" {}", panel_index, i, kBandColors[0],
                                titled(panel.fills[i].name)));
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const PlotSeries& series = panel.series[i];
    const std::string block = fmt::format("$p{}_{}", panel_index, i);
    parts.push_back(fmt::format("{} using 1:2 {} {}", block, series.style.empty() ? styles[i] : series.style, titled(series.name)));
  }
  if (parts.empty()) parts.emplace_back("NaN notitle");  // gnuplot refuses a plot of nothing
  std::string out = "plot ";
  for (const std::string& part : parts) out += (&part == parts.data() ? "" : ", \\\n     ") + part;
  return out + '\n';
}

/// Room for the frame, the y axis and its name. A label of our own: gnuplot's ylabel moves with the width of the numbers, so those of
/// stacked panels would not line up.
std::string frame_commands(const Plot& plot, const PlotPanel& panel, const PlotRange& y, const Place& place, int height_px) {
  std::string out = "unset object\nunset label\nunset arrow\n";
  for (const auto& [side, at] : {std::pair{'l', place.left / plot.width_px}, std::pair{'r', place.right / plot.width_px},
                                 std::pair{'b', place.bottom / height_px}, std::pair{'t', place.top / height_px}})
    out += fmt::format("set {}margin at screen {:.5f}\n", side, at);
  if (is_empty(plot, panel)) out += "set label \"no data\" at graph 0.5, graph 0.5 center textcolor rgb \"#666666\"\n";
  out += fmt::format("set yrange [{}:{}]\n", shortest_number(panel.y_down ? y.hi : y.lo), shortest_number(panel.y_down ? y.lo : y.hi));
  return out + fmt::format("set label {} at screen {:.5f}, screen {:.5f} center rotate\n", gnuplot_quoted(panel.y_label),
                           (place.left - kLeft + kAxisName) / plot.width_px, 0.5 * (place.bottom + place.top) / height_px);
}

std::string stacked_panel(const Plot& plot, std::size_t index, const std::vector<Flag>& flags, const Place& place, int height_px) {
  const PlotPanel& panel = plot.panels[index];
  const std::size_t rows = legend_rows(plot, panel);
  const PlotRange y = with_legend_room(y_axis_of(panel, plot.log_y), panel, rows, stacked_height(plot));
  std::string out = frame_commands(plot, panel, y, place, height_px);
  out += index + 1 == plot.panels.size() ? fmt::format("set format x \"%g\"\nset xlabel {} offset 0,0.3\n", gnuplot_quoted(plot.x_label))
                                         : "set format x \"\"\nunset xlabel\n";
  out += band_commands(panel, y, place, plot.width_px, height_px);
  out += event_commands(plot, flags, index == 0, place, height_px);
  out += name_commands(plot, panel, {x_axis_of(plot.panels, plot.log_x), y, plot.log_x, plot.log_y, panel.y_down, place}, height_px, {});
  const std::vector<CurveLayer> layers = curve_layers(panel, kCoincide * (y.hi - y.lo));
  const char* const sample = has_dashes(layers) ? "4" : "2";  // long enough for a dash
  out += rows > 0 ? fmt::format("set key top left Left reverse vertical maxrows {} samplen {}\n", rows, sample) : "unset key\n";
  return out + series_commands(panel, index, layers);
}

std::string log_tics(const PlotRange& x, std::span<const double> steps, int& count) {
  std::string out;
  count = 0;
  for (double decade = std::pow(10.0, std::floor(std::log10(x.lo))); decade <= x.hi; decade *= 10.0)
    for (const double step : steps)
      if (decade * step >= x.lo && decade * step <= x.hi) {
        out += fmt::format("{}{:g}", out.empty() ? "" : ", ", decade * step);
        ++count;
      }
  return "set xtics (" + out + ")\n";
}

/// Marks at 1, 2 and 5 times the powers of ten; at more multiples where these are fewer than three, at the powers alone where they are too many
/// for their texts.
std::string log_tics(const PlotRange& x) {
  constexpr double kPowers[] = {1.0}, kCoarse[] = {1.0, 2.0, 5.0}, kFine[] = {1.0, 1.5, 2.0, 3.0, 5.0, 7.0};
  constexpr int kMost = 12;
  int count = 0;
  const std::string coarse = log_tics(x, kCoarse, count);
  if (count > kMost) return log_tics(x, kPowers, count);
  return count >= 3 ? coarse : log_tics(x, kFine, count);
}

std::string grid_panel(const Plot& plot, std::size_t index, const Place& place, int height_px) {
  const PlotPanel& panel = plot.panels[index];
  const PlotRange x = x_axis_of({&panel, 1}, plot.log_x);
  const PlotRange y = y_axis_of(panel, plot.log_y);
  std::string out = frame_commands(plot, panel, y, place, height_px);
  out += fmt::format("set title {} offset 0,-0.6\nset xlabel {} offset 0,0.5\nset xrange [{}:{}]\n", gnuplot_quoted(panel.title),
                     gnuplot_quoted(plot.x_label), shortest_number(x.lo), shortest_number(x.hi));
  if (plot.log_x) out += log_tics(x);
  const bool above = plot.legend == "above";
  const std::optional<PlotBox> legend = index == 0 && !above ? std::optional(legend_box(panel, plot.legend, place)) : std::nullopt;
  out += name_commands(plot, panel, {x, y, plot.log_x, plot.log_y, panel.y_down, place}, height_px, legend);
  out += index > 0 || above ? "unset key\n" : "set key opaque " + plot.legend + " Left reverse samplen 2 maxrows 8 font \",10\"\n";
  return out + series_commands(panel, index, std::vector<CurveLayer>(panel.series.size()));
}

/// What all panels share, and their data.
std::string opening(const Plot& plot, int height_px) {
  std::string out =
      fmt::format("set encoding utf8\nset terminal svg size {},{} dynamic noenhanced font \"Helvetica,{}\" background \"white\"\n",
                  plot.width_px, height_px, kFontSize);
  for (std::size_t p = 0; p < plot.panels.size(); ++p) {
    const PlotPanel& panel = plot.panels[p];
    for (std::size_t s = 0; s < panel.series.size(); ++s) out += data_block(plot, panel.series[s], fmt::format("$p{}_{}", p, s));
    for (std::size_t f = 0; f < panel.fills.size(); ++f)
      out += fill_block(plot, panel.fills[f], y_axis_of(panel, plot.log_y), fmt::format("$f{}_{}", p, f));
  }
  out += std::string("set multiplot\n") + kAxesStyle;
  if (plot.log_x) out += "set logscale x\n";
  if (plot.log_y) out += "set logscale y\nset format y \"%g\"\n";
  return out;
}

std::string stacked_script(const Plot& plot) {
  const PlotRange x = x_axis_of(plot.panels, plot.log_x);
  const std::vector<Flag> flags = make_flags(plot, x);
  std::size_t row_count = 0;
  for (const Flag& flag : flags) row_count = std::max(row_count, flag.row + 1);
  const int count = static_cast<int>(plot.panels.size());
  const int top = kTop + kRowHeight * static_cast<int>(row_count);
  const int panel_height = stacked_height(plot), height = top + count * panel_height + (count - 1) * kGap + kBottom;
  std::string out = opening(plot, height);
  out += fmt::format("set xrange [{}:{}]\n", shortest_number(x.lo), shortest_number(x.hi));
  for (std::size_t p = 0; p < plot.panels.size(); ++p) {
    const double panel_top = height - top - static_cast<double>(p) * (panel_height + kGap);
    const Place place{kLeft, double(plot.width_px - right_margin(plot)), panel_top - panel_height, panel_top};
    out += stacked_panel(plot, p, flags, place, height);
  }
  return out;
}

/// Rows of a legend over a grid: as many as its names need.
std::size_t rows_above(const Plot& plot) {
  double longest = 0.0, count = 0.0;
  for (const PlotSeries& series : plot.panels.front().series) {
    longest = std::max(longest, static_cast<double>(series.name.size()));
    count += series.name.empty() ? 0.0 : 1.0;
  }
  const double columns = std::max(1.0, std::floor(0.98 * plot.width_px / (kKeySample + kCharWidth * longest)));
  return static_cast<std::size_t>(std::max(1.0, std::ceil(count / columns)));
}

int height_above(const Plot& plot) { return kLegendAbove + static_cast<int>(kLegendRow * static_cast<double>(rows_above(plot) - 1)); }

/// The legend of the first panel over a grid: gnuplot breaks a row at the width of a panel, so it is a panel of its own without axes.
std::string legend_above(const Plot& plot, int height_px) {
  const PlotPanel& panel = plot.panels.front();
  std::string out =
      "unset border\nunset xtics\nunset ytics\nunset grid\nset lmargin at screen 0.01\nset rmargin at screen 0.99\nset tmargin at screen "
      "1\n";
  out += fmt::format("set bmargin at screen {:.5f}\nset xrange [1:2]\nset yrange [1:2]\n", 1.0 - double(height_above(plot)) / height_px);
  std::size_t longest = 0;
  for (const PlotSeries& series : panel.series) longest = std::max(longest, series.name.size());
  // gnuplot reserves a third more than a name is wide.
  out += fmt::format("set key center center horizontal Left reverse samplen 3 maxrows {} width -{} font \",11\"\nplot ", rows_above(plot),
                     longest / 4);
  for (std::size_t n = 0; n < panel.series.size(); ++n) {
    const PlotSeries& series = panel.series[n];
    if (series.name.empty()) continue;
    const std::string style = series.style.empty() ? turn_style(n) : series.style;
    out += fmt::format("{}NaN {} {}", out.ends_with("plot ") ? "" : ", ", style, titled(series.name));
  }
  if (out.ends_with("plot ")) out += "NaN notitle";
  return out + "\nset xtics\nset ytics\n" + kAxesStyle;
}

std::string grid_script(const Plot& plot) {
  const int count = static_cast<int>(plot.panels.size()), rows = (count + plot.columns - 1) / plot.columns;
  const int row_height = kTitle + plot.panel_height_px + kBottom, above = plot.legend == "above" ? height_above(plot) : 0;
  const int height = above + rows * row_height;
  const double width = double(plot.width_px) / plot.columns;
  std::string out = opening(plot, height);
  if (above > 0) out += legend_above(plot, height);
  for (int p = 0; p < count; ++p) {
    const double left = width * (p % plot.columns), top = height - above - row_height * (p / plot.columns) - kTitle;
    out +=
        grid_panel(plot, static_cast<std::size_t>(p), {left + kLeft, left + width - kGridRight, top - plot.panel_height_px, top}, height);
  }
  return out;
}

}  // namespace

std::string plot_script(const Plot& plot) {
  const auto no_event = [&](const PlotEvent& event) { return !can_be_drawn(event.x, plot.log_x); };
  const auto no_band = [&](const PlotBand& band) { return !can_be_drawn(band.from, plot.log_y) || !can_be_drawn(band.to, plot.log_y); };
  const auto has_no_band = [&](const PlotPanel& panel) { return std::ranges::any_of(panel.bands, no_band); };
  if (std::ranges::any_of(plot.events, no_event) || std::ranges::any_of(plot.panels, has_no_band)) {
    Plot drawn = plot;
    std::erase_if(drawn.events, no_event);
    for (PlotPanel& panel : drawn.panels) std::erase_if(panel.bands, no_band);
    return plot_script(drawn);
  }
  return (plot.columns > 0 ? grid_script(plot) : stacked_script(plot)) + "unset multiplot\n";
}

Result<std::string> draw_svg(const Plot& plot, const std::string& gnuplot) {
  Result<std::string> svg = run_gnuplot(plot_script(plot), gnuplot, "</svg>");
  // Browsers show a title as a tooltip over the whole plot, and this one names only the program.
  constexpr std::string_view kTooltip = "<title>Gnuplot</title>";
  if (const std::size_t at = svg ? svg->find(kTooltip) : std::string::npos; at != std::string::npos) svg->erase(at, kTooltip.size());
  return svg;
}

Status write_svg(const Plot& plot, const std::string& path) {
  const Result<std::string> svg = draw_svg(plot);
  if (!svg) return svg.error();
  return write_file(path, *svg);
}

}  // namespace burrhole
