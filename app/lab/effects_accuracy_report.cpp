#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/lab/effects_accuracy.h"

namespace burrhole {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNotable = 0.03;    // [-] error of a value of the scene that is named
constexpr double kPlotFloor = 0.01;  // [%] smaller errors are drawn there
constexpr double kPlotTop = 200.0;   // [%]
constexpr double kLeastTime = 1e-3;  // [ms/s] smaller times are drawn there
constexpr const char* kColours[] = {kPlotBlue, kPlotOrange, kPlotGreen, kPlotViolet};
constexpr const char* kOrdinals[] = {"first figure named", "second", "third", "fourth"};
constexpr int kDot = 7, kRing = 6, kDownwards = 10, kCross = 2;  // gnuplot's points

std::string percent(double share) {
  if (std::isnan(share)) return "absent";
  const double value = 100.0 * share;
  if (value == 0.0) return "0";
  return value < 0.01 ? "<0.01" : fmt::format(fmt::runtime(value < 1.0 ? "{:.2f}" : value < 10.0 ? "{:.1f}" : "{:.0f}"), value);
}

bool acts(const FigureErrors& errors) { return errors.trend == LadderTrend::falls || errors.trend == LadderTrend::stays; }

std::string errors_text(const Ladder& ladder, const std::vector<FigureErrors>& errors, std::size_t run) {
  std::vector<std::string> parts;
  for (std::size_t n = 0; n < errors.size(); ++n)
    if (acts(errors[n])) parts.push_back(fmt::format("{} {}", ladder.figures[n].name, percent(errors[n].errors[run])));
  return parts.empty() ? "without effect" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string with_along(const Ladder& ladder) {
  return ladder.along.empty() ? ladder.knob : fmt::format("{}, and {}", ladder.knob, fmt::join(ladder.along, ", "));
}

std::string setting_text(double setting) { return fmt::format("{:.5g}", setting); }

std::vector<std::string> line_of(const Ladder& ladder, const LadderRun& run, std::string setting, std::string errors) {
  return {ladder.table,
          with_along(ladder),
          std::move(setting),
          std::move(errors),
          fmt::format("{:.3g}", run.time_ms),
          fmt::format("{:.4g}", run.bytes / 1e3)};
}

/// What of a key is to be explained; empty: nothing.
std::vector<std::string> notes_of(const Ladder& ladder) {
  const std::vector<FigureErrors> errors = ladder_errors(ladder);
  std::vector<std::string> out;
  for (const std::string& line : ladder.refused) out.push_back((ladder.knob.empty() ? "not drilled: " : "not drilled with ") + line);
  if (ladder.runs.empty()) return out;
  for (std::size_t n = 0; n < errors.size(); ++n)
    if (errors[n].trend == LadderTrend::none) out.push_back("no run has " + ladder.figures[n].name);
  if (!has_effect(errors)) {
    out.emplace_back("changes no figure in this scene: without effect");
    return out;
  }
  const auto usual = static_cast<std::size_t>(std::ranges::find(ladder.runs, 1.0, &LadderRun::multiple) - ladder.runs.begin());
  for (std::size_t n = 0; n < errors.size(); ++n) {
    if (!acts(errors[n]) || usual >= ladder.runs.size()) continue;
    const double error = errors[n].errors[usual];
    if (!(error <= kNotable))
      out.push_back(fmt::format("{} is off by {} % at {}, the value of the scene", ladder.figures[n].name, percent(error),
                                setting_text(ladder.runs[usual].setting)));
    if (errors[n].trend != LadderTrend::stays) continue;
    std::vector<std::string> steps;
    for (const double one : errors[n].errors) steps.push_back(percent(one));
    out.push_back(fmt::format("{} does not converge: {} %", ladder.figures[n].name, fmt::join(steps, ", ")));
  }
  return out;
}

// ---- plots

double drawn(double share) { return std::isnan(share) ? kNone : std::clamp(100.0 * share, kPlotFloor, kPlotTop); }

/// Adds the curve of one figure; points below the axis are open triangles that point down, the value of the scene has a ring.
/// @param settings whether points have their value of the key.
void add_curve(const Ladder& ladder, const std::vector<double>& errors, const char* colour, bool settings, PlotPanel& out) {
  PlotSeries curve{"", {}, {}, linked_point_style(colour, kDot), {}};
  PlotSeries below{"", {}, {}, point_style(colour, kDownwards, 1.3, 1.5), {}}, ring{"", {}, {}, point_style(colour, kRing, 2.0, 1.6), {}};
  for (std::size_t n = 0; n < errors.size(); ++n) {
    const LadderRun& run = ladder.runs[n];
    const double x = std::max(run.time_ms, kLeastTime), y = drawn(errors[n]);
    curve.x.push_back(x);
    curve.y.push_back(y);
    if (settings) curve.labels.push_back(setting_text(run.setting));
    if (y == kPlotFloor) {
      below.x.push_back(x);
      below.y.push_back(y);
    }
    if (run.multiple == 1.0) {
      ring.x.push_back(x);
      ring.y.push_back(y);
    }
  }
  for (PlotSeries* series : {&curve, &below, &ring})
    if (!series->x.empty()) out.series.push_back(std::move(*series));
}

/// The price of the reference, at the foot of the panel.
void add_reference(const Ladder& ladder, const char* colour, PlotPanel& out) {
  out.series.push_back({"",
                        {std::max(ladder.reference.time_ms, kLeastTime)},
                        {kPlotFloor},
                        point_style(colour, kCross, 1.6, 1.8),
                        {setting_text(ladder.reference.setting)}});
}

/// Room beside the points, and a line at the error that is named.
void finish_panel(PlotPanel& panel) {
  double lo = std::numeric_limits<double>::infinity(), hi = 0.0;
  for (const PlotSeries& series : panel.series)
    for (const double x : series.x) {
      lo = std::min(lo, x);
      hi = std::max(hi, x);
    }
  if (!(hi > 0.0)) return;
  panel.x_range = {lo / 1.5, hi * 1.5};
  panel.series.push_back({"", {lo / 1.5, hi * 1.5}, {100.0 * kNotable, 100.0 * kNotable}, line_style(kPlotGrey, "(4,4)", 1.0), {}});
}

Plot grid_of_panels() {
  Plot plot;
  plot.x_label = "time of the effect's steps [ms per simulated second]";
  plot.width_px = 1600;
  plot.panel_height_px = 250;
  plot.columns = 3;
  plot.log_x = plot.log_y = true;
  plot.legend = "above";
  return plot;
}

PlotPanel panel_of(std::string title) {
  PlotPanel panel;
  panel.title = std::move(title);
  panel.y_label = "error [%]";
  panel.y_range = {0.7 * kPlotFloor, kPlotTop};
  return panel;
}

}  // namespace

std::vector<CostRow> ladder_rows(const std::vector<Ladder>& ladders) {
  std::vector<CostRow> rows;
  for (const Ladder& ladder : ladders) {
    const std::vector<FigureErrors> errors = ladder_errors(ladder);
    for (std::size_t n = 0; n < ladder.runs.size(); ++n)
      for (std::size_t f = 0; f < errors.size(); ++f) {
        const bool has_error = acts(errors[f]);
        CostRow row{.subject = "effect " + ladder.table,
                    .model = "",
                    .knob = with_along(ladder),
                    .setting = ladder.runs[n].setting,
                    .error_name = ladder.figures[f].name + (has_error ? "" : ": without effect"),
                    .error = has_error ? 100.0 * errors[f].errors[n] : kNone,
                    .unit = "%",
                    .reference = fmt::format("{:g}", ladder.reference.setting)};
        row.median_us = 1e3 * ladder.runs[n].time_ms;
        row.bytes = ladder.runs[n].bytes;
        rows.push_back(std::move(row));
      }
  }
  return rows;
}

std::vector<std::string> ladder_heads() { return {"effect", "key", "value", "error of its figures [%]", "time [ms/s]", "memory [kB]"}; }

std::vector<std::vector<std::string>> ladder_cells(const std::vector<Ladder>& ladders) {
  std::vector<std::vector<std::string>> out;
  for (const Ladder& ladder : ladders) {
    const std::vector<FigureErrors> errors = ladder_errors(ladder);
    for (std::size_t n = 0; n < ladder.runs.size(); ++n) {
      const LadderRun& run = ladder.runs[n];
      out.push_back(
          line_of(ladder, run, setting_text(run.setting) + (run.multiple == 1.0 ? ", the scene's" : ""), errors_text(ladder, errors, n)));
    }
    if (!ladder.runs.empty()) out.push_back(line_of(ladder, ladder.reference, setting_text(ladder.reference.setting), "reference"));
  }
  return out;
}

std::vector<std::string> ladder_notes(const std::vector<Ladder>& ladders) {
  std::vector<std::string> out;
  for (const Ladder& ladder : ladders)
    for (const std::string& note : notes_of(ladder))
      out.push_back(fmt::format("[{}]{}{}: {}", ladder.table, ladder.knob.empty() ? "" : ", ", ladder.knob, note));
  return out;
}

Plot ladder_plot(const std::vector<Ladder>& ladders) {
  Plot plot = grid_of_panels();
  for (const Ladder& ladder : ladders) {
    const std::vector<FigureErrors> errors = ladder_errors(ladder);
    if (ladder.general || !has_effect(errors)) continue;
    PlotPanel panel = panel_of("");
    std::vector<std::string> names;
    for (std::size_t n = 0; n < errors.size(); ++n) {
      names.push_back(ladder.figures[n].name);
      const char* const colour = kColours[n % std::size(kColours)];
      panel.series.push_back({kOrdinals[n % std::size(kOrdinals)], {}, {}, linked_point_style(colour, kDot), {}});  // for the legend
      if (acts(errors[n])) add_curve(ladder, errors[n].errors, colour, n == 0, panel);
    }
    panel.title = fmt::format("{}: {}", ladder.knob, fmt::join(names, ", "));
    add_reference(ladder, kPlotGrey, panel);
    finish_panel(panel);
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

Plot general_ladder_plot(const std::vector<Ladder>& ladders) {
  Plot plot = grid_of_panels();
  std::vector<std::string> tables, knobs;
  const auto note = [](std::vector<std::string>& list, const std::string& name) {
    if (std::ranges::find(list, name) == list.end()) list.push_back(name);
  };
  for (const Ladder& ladder : ladders)
    if (ladder.general && !ladder.runs.empty()) {
      note(tables, ladder.table);
      note(knobs, ladder.knob);
    }
  for (const std::string& table : tables) {
    PlotPanel panel = panel_of(table);
    for (std::size_t n = 0; n < knobs.size(); ++n)
      panel.series.push_back({knobs[n], {}, {}, linked_point_style(kColours[n % std::size(kColours)], kDot), {}});  // for the legend
    for (const Ladder& ladder : ladders) {
      if (!ladder.general || ladder.runs.empty() || ladder.table != table) continue;
      panel.title = fmt::format("{}: {}", table, ladder.figures.front().name);
      const auto number = static_cast<std::size_t>(std::ranges::find(knobs, ladder.knob) - knobs.begin());
      const char* const colour = kColours[number % std::size(kColours)];
      const FigureErrors first = ladder_errors(ladder).front();
      if (!acts(first)) continue;
      add_curve(ladder, first.errors, colour, true, panel);
      add_reference(ladder, colour, panel);
    }
    finish_panel(panel);
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace burrhole
