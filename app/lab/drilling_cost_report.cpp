#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/lab/drilling_cost.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

constexpr double kFloor = 0.01;  // of the axis of errors: smaller ones are drawn as bounds there
constexpr int kDownwards = 10;   // gnuplot's open triangle that points down
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The points of one knob, in the order of their settings.
using KnobPoints = std::vector<DrillingPoint>;

std::vector<KnobPoints> by_knob(const std::vector<DrillingPoint>& points) {
  std::vector<KnobPoints> out;
  for (const DrillingPoint& point : points) {
    if (out.empty() || out.back().front().knob != point.knob) out.emplace_back();
    out.back().push_back(point);
  }
  for (KnobPoints& one : out) std::ranges::sort(one, {}, &DrillingPoint::setting);
  return out;
}

std::size_t shipped_place(const KnobPoints& points) {
  const auto found = std::ranges::find_if(points, [](const DrillingPoint& p) { return p.setting == p.shipped; });
  return static_cast<std::size_t>(found - points.begin());
}

// ---- sentences

std::string setting_text(const DrillingPoint& point) { return fmt::format("{:.4g} {}", point.setting, point.unit); }

/// An error against the finer run: one below the error of that run itself is not known any better.
std::string against_finer(const char* what, double error, double own, int decimals, const char* unit) {
  if (std::abs(error) < own) return fmt::format("{} below the reference's own error of {:.{}f} {}", what, own, decimals, unit);
  const std::string known = std::isnan(own) ? "" : fmt::format(" +- {:.{}f}", own, decimals);
  return fmt::format("{:+.{}f}{} {} of {}", error, decimals, known, unit, what);
}

std::string errors_text(const DrillingPoint& p) {
  if (p.early_stops > 0.0) return fmt::format("{:+.1f} % of volume and {:.0f} runs that ended early", p.volume_percent, p.early_stops);
  return fmt::format("{:+.1f} % of volume, {} and {}", p.volume_percent, against_finer("time", p.time_percent, p.own.time_percent, 1, "%"),
                     against_finer("plunge", p.plunge_mm, p.own.plunge_mm, 2, "mm"));
}

std::string neighbour_text(const DrillingPoint& p, const DrillingPoint& shipped) {
  return fmt::format("; {} takes {:.2f} of the CPU time and {:.2f} of the memory, with {}", setting_text(p), p.cpu_s / shipped.cpu_s,
                     p.bytes / shipped.bytes, errors_text(p));
}

std::string sentence_of(const KnobPoints& points) {
  const std::size_t at = shipped_place(points);
  const DrillingPoint& shipped = points[at];
  std::string out = fmt::format("`{}`: the default, {}, has errors of {}", shipped.knob, setting_text(shipped), errors_text(shipped));
  if (at > 0) out += neighbour_text(points[at - 1], shipped);
  if (at + 1 < points.size()) out += neighbour_text(points[at + 1], shipped);
  return out + fmt::format(" (time and plunge against {}).", shipped.reference);
}

// ---- plots

struct Curve {
  const char* name;
  const char* colour;
  double DrillingPoint::*value;
  double DrillingPoint::Own::*own = nullptr;  ///< of the finer run itself
};
constexpr Curve kErrors[] = {{"volume [%]", kPlotBlue, &DrillingPoint::volume_percent},
                             {"time to breakthrough [%]", kPlotOrange, &DrillingPoint::time_percent, &DrillingPoint::Own::time_percent},
                             {"plunge [mm]", kPlotGreen, &DrillingPoint::plunge_mm, &DrillingPoint::Own::plunge_mm},
                             {"ripple of the feed [%]", kPlotViolet, &DrillingPoint::ripple_percent}};

/// The power of ten above all that is drawn.
double top_of(const std::vector<KnobPoints>& knobs) {
  double most = 1.0;
  for (const KnobPoints& points : knobs)
    for (const DrillingPoint& point : points) {
      for (const Curve& curve : kErrors) most = std::fmax(most, std::abs(point.*curve.value));
      most = std::fmax(most, point.cpu_s / points[shipped_place(points)].cpu_s);
    }
  return std::pow(10.0, std::floor(std::log10(most)) + 1.0);
}

/// Errors of one knob, its CPU time over the default's, and a line at the default.
PlotPanel panel_of(const KnobPoints& points, double top) {
  const DrillingPoint& shipped = points[shipped_place(points)];
  PlotPanel panel;
  panel.title = fmt::format("{} [{}]", shipped.knob, shipped.unit);
  panel.y_label = "error, in its unit; CPU ratio [-]";
  panel.y_range = {0.8 * kFloor, top};
  panel.x_range = {0.85 * points.front().setting, 1.18 * points.back().setting};
  panel.series.push_back({"default", {shipped.setting, shipped.setting}, {0.8 * kFloor, top}, line_style("#000000", "(4,3)", 1.0)});
  for (const Curve& curve : kErrors) {
    const auto n = static_cast<std::size_t>(&curve - kErrors);
    PlotSeries series{curve.name, {}, {}, nested_style(curve.colour, n, std::size(kErrors))};
    PlotSeries bounds{"", {}, {}, point_style(curve.colour, kDownwards, 0.8 + 0.3 * static_cast<double>(std::size(kErrors) - n), 1.2)};
    for (const DrillingPoint& point : points) {
      const double error = std::abs(point.*curve.value), own = curve.own != nullptr ? point.own.*curve.own : 0.0;
      const double bound = std::fmax(own, kFloor);  // of an own error that is not known, the floor
      const bool known = !(error < bound);
      series.x.push_back(point.setting);
      series.y.push_back(known ? error : kNone);  // NaN breaks the curve
      bounds.x.push_back(point.setting);
      bounds.y.push_back(known ? kNone : bound);
    }
    panel.series.push_back(std::move(series));
    panel.series.push_back(std::move(bounds));
  }
  panel.series.push_back({"upper bound of an error", {}, {}, point_style(kPlotGrey, kDownwards, 1.2, 1.2)});
  PlotSeries cpu{"CPU time over the default [-]", {}, {}, line_style(kPlotGrey, "(8,4)", 2.0)};
  for (const DrillingPoint& point : points) {
    cpu.x.push_back(point.setting);
    cpu.y.push_back(point.cpu_s / shipped.cpu_s);
  }
  panel.series.push_back(std::move(cpu));
  return panel;
}

Plot plot_of(const std::vector<KnobPoints>& knobs) {
  Plot plot;
  plot.x_label = "setting";
  plot.width_px = 1600;
  plot.panel_height_px = 240;
  plot.columns = 5;
  plot.log_x = plot.log_y = true;
  plot.legend = "above";
  const double top = top_of(knobs);
  for (const KnobPoints& points : knobs) plot.panels.push_back(panel_of(points, top));
  return plot;
}

// ---- tables

std::string with_sign(double value, int decimals) { return std::isnan(value) ? "-" : fmt::format("{:+.{}f}", value, decimals); }
/// An error against the finer run with that run's own, or "below" it.
std::string against_cell(double error, double own, int decimals) {
  if (std::isnan(error) || std::isnan(own)) return with_sign(error, decimals);
  if (std::abs(error) < own) return fmt::format("below {:.{}f}", own, decimals);
  return fmt::format("{:+.{}f} +- {:.{}f}", error, decimals, own, decimals);
}
std::string cell(double value) { return std::isnan(value) ? "-" : fmt::format("{:.3g}", value); }

std::vector<std::string> heads() {
  std::vector<std::string> out{"setting"};
  for (const DrillingFigure& figure : drilling_figures()) {
    std::string name = figure.name;
    std::ranges::replace(name, '_', ' ');
    out.push_back(fmt::format("{} [{}]", name, figure.unit));
  }
  out.emplace_back("memory [MB]");
  return out;
}

std::vector<std::string> line_of(const DrillingPoint& point, const std::string& mark) {
  std::string setting = fmt::format("{} = {:.4g}", point.knob, point.setting);
  if (point.setting == point.shipped) setting = mark + setting + mark + " (default)";
  std::vector<std::string> out{setting};
  for (const DrillingFigure& figure : drilling_figures())
    out.push_back(figure.own != nullptr ? against_cell(point.*figure.value, point.own.*figure.own, 3) : cell(point.*figure.value));
  out.push_back(fmt::format("{:.0f}", point.bytes * 1e-6));
  return out;
}

/// Tables of docs, with the figures that decide.
std::string markdown(const std::vector<KnobPoints>& knobs) {
  std::string out =
      "| setting | volume [%] | mass [%] | diameter [mm] | time [%] | plunge [mm] | its spread [mm] | ripple [%] | wall [um] | CPU [s] | "
      "memory [MB] |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const KnobPoints& points : knobs)
    for (const DrillingPoint& p : points) {
      const bool shipped = p.setting == p.shipped;
      out += fmt::format("| {0}`{1}` = {2:.4g}{0} | {3} | {4} | {5} | {6} | {7} | {8} | {9:.1f} | {10:.1f} | {11:.1f} | {12:.0f} |\n",
                         shipped ? "**" : "", p.knob, p.setting, with_sign(p.volume_percent, 2), with_sign(p.mass_percent, 2),
                         with_sign(p.outer_mm, 3), against_cell(p.time_percent, p.own.time_percent, 2),
                         against_cell(p.plunge_mm, p.own.plunge_mm, 3), cell(p.spread_mm), p.ripple_percent, p.roughness_um, p.cpu_s,
                         p.bytes * 1e-6);
    }
  out += "\n";
  for (const KnobPoints& points : knobs) out += "- " + sentence_of(points) + "\n";
  return out;
}

}  // namespace

std::vector<std::string> drilling_sentences(const std::vector<DrillingPoint>& points) {
  std::vector<std::string> out;
  for (const KnobPoints& one : by_knob(points)) out.push_back(sentence_of(one));
  return out;
}

Status write_drilling_cost(const std::vector<DrillingPoint>& points, const std::string& bit, const std::string& folder) {
  if (const Status written = write_cost_csv(drilling_cost_rows(points, bit), folder + "/cost.csv"); !written) return written;
  const std::vector<KnobPoints> knobs = by_knob(points);
  if (const Status written = write_file(folder + "/drilling.md", markdown(knobs)); !written) return written;
  const auto svg = draw_svg(plot_of(knobs));
  if (!svg) return svg.error();
  if (const Status written = write_file(folder + "/drilling.svg", *svg); !written) return written;
  HtmlPage html("What drilling costs", "One setting at a time round the defaults: a hole of the " + bit + " bit through a plate");
  html.svg(*svg,
           "Absolute errors; dotted lines mark the defaults. A triangle that points down is an upper bound: the error is below the finer "
           "run's own, or below 0.01. Volume against the closed form; time and plunge against a finer run. CPU time and memory of the run "
           "with the default hand, over "
           "the default.");
  html.heading("Setting by setting");
  for (const std::string& sentence : drilling_sentences(points)) html.paragraph(sentence);
  std::vector<std::vector<std::string>> cells;
  for (const KnobPoints& one : knobs)
    for (const DrillingPoint& point : one) cells.push_back(line_of(point, ""));
  html.table(heads(), cells);
  return write_file(folder + "/drilling.html", html.text());
}

}  // namespace burrhole
