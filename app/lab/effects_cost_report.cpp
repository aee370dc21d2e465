#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/lab/effects_cost.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

using Cells = std::vector<std::vector<std::string>>;

double figure_of(const EffectRun& run, std::string_view name) {
  for (const auto& [known, value] : run.figures)
    if (known == name) return value;
  return std::nan("");
}

std::string number_text(double value, const char* format = "{:.4g}") {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

const std::vector<std::string> kPriceHeads{"effect",    "drilled",     "without [ms/s]",  "with [ms/s]",      "costs [ms/s]",
                                           "share [%]", "memory [kB]", "bone and forces", "breakthrough [s]", "plunge [mm]"};

/// @returns the words for an effect that the scene names: its price includes that of the tables that require it.
std::string named_text(const EffectPrice& price) {
  return price.requiring.empty() ? "named by the scene" : fmt::format("named by the scene, with [{}]", fmt::join(price.requiring, "], ["));
}

Cells price_cells(const EffectsCost& cost) {
  Cells out;
  for (const EffectPrice& p : cost.prices) {
    if (!p.refused.empty()) {
      out.push_back(
          {p.table, p.named ? "not without it: " + p.refused : "needs keys: " + p.refused, "-", "-", "-", "-", "-", "-", "-", "-"});
      continue;
    }
    const EffectRun &without = p.named ? p.other : p.scene, &with = p.named ? p.scene : p.other;
    out.push_back({p.table, p.named ? named_text(p) : p.given, fmt::format("{:.1f}", without.cpu_ms), fmt::format("{:.1f}", with.cpu_ms),
                   fmt::format("{:+.1f}", p.added_ms()), fmt::format("{:+.1f}", 100.0 * p.added_ms() / without.cpu_ms),
                   fmt::format("{:.1f}", with.bytes / 1e3), with.bits == without.bits ? "same bits" : "changed",
                   number_text(figure_of(p.other, "breakthrough_s"), "{:.2f}"), number_text(figure_of(p.other, "plunge_mm"), "{:.2f}")});
  }
  return out;
}

const std::vector<std::string> kKnobHeads{"effect",  "key",   "default",     "value", "figure that changes most",
                                          "default", "value", "costs [ms/s]"};

Cells knob_cells(const EffectsCost& cost) {
  Cells out;
  for (const EffectKnob& k : cost.knobs)
    out.push_back({k.table, k.key, number_text(k.fallback), number_text(k.value), k.figure.empty() ? "none: the run is the same" : k.figure,
                   k.figure.empty() ? "-" : number_text(k.before), k.figure.empty() ? "-" : number_text(k.after),
                   fmt::format("{:+.1f}", k.cpu_ms - k.fallback_ms)});
  return out;
}

Plot price_plot(const EffectsCost& cost) {
  Plot plot;
  plot.x_label = "memory of the effect [kB]";
  plot.width_px = 900;
  plot.panel_height_px = 420;
  plot.columns = 1;
  plot.log_x = true;
  PlotPanel panel;
  panel.title = "what an effect costs";
  panel.y_label = "CPU time it adds to a simulated second [ms]";
  for (const EffectPrice& p : cost.prices) {
    if (!p.refused.empty()) continue;
    const double bytes = std::max(0.01, (p.named ? p.scene : p.other).bytes / 1e3);
    panel.series.push_back({"", {bytes}, {p.added_ms()}, point_style(p.named ? kPlotBlue : kPlotOrange, 7, 1.2), {p.table}});
  }
  plot.panels.push_back(std::move(panel));
  return plot;
}

nlohmann::ordered_json run_json(const EffectRun& run) {
  nlohmann::ordered_json out{
      {"cpu_ms_per_s", run.cpu_ms}, {"bytes", run.bytes}, {"hash", run.bits}, {"figures", nlohmann::ordered_json::object()}};
  for (const auto& [name, value] : run.figures) out["figures"][name] = value;  // not a number becomes null
  return out;
}

nlohmann::ordered_json ladder_json(const Ladder& ladder) {
  using Json = nlohmann::ordered_json;
  const std::vector<FigureErrors> errors = ladder_errors(ladder);
  const bool ran = !ladder.reference.figures.empty();
  const auto if_ran = [ran](double value) { return ran ? Json(value) : Json(); };
  Json out{{"table", ladder.table},
           {"key", ladder.knob.empty() ? Json() : Json(ladder.knob)},
           {"with", ladder.along},
           {"refused", ladder.refused},
           {"has_effect", has_effect(errors)},
           {"reference", if_ran(ladder.reference.setting)},
           {"reference_ms_per_s", if_ran(ladder.reference.time_ms)},
           {"reference_bytes", if_ran(ladder.reference.bytes)},
           {"values", Json::array()}};
  for (std::size_t n = 0; n < ladder.runs.size(); ++n) {
    const LadderRun& run = ladder.runs[n];
    Json one{{"value", run.setting},
             {"of_the_scene", run.multiple == 1.0},
             {"ms_per_s", run.time_ms},
             {"bytes", run.bytes},
             {"errors", Json::object()}};
    for (std::size_t f = 0; f < errors.size(); ++f)
      one["errors"][ladder.figures[f].name] = errors[f].trend == LadderTrend::unaffected ? Json() : Json(errors[f].errors[n]);
    out["values"].push_back(std::move(one));
  }
  return out;
}

/// Writes the plots of errors against time that have a panel. @returns them.
Result<std::vector<std::string>> write_ladder_plots(const EffectsCost& cost, const std::string& folder) {
  std::vector<std::string> out;
  const std::pair<Plot, const char*> plots[] = {{ladder_plot(cost.ladders), "effects_accuracy.svg"},
                                                {general_ladder_plot(cost.ladders), "effects_general.svg"}};
  for (const auto& [plot, name] : plots) {
    if (plot.panels.empty()) continue;
    auto svg = draw_svg(plot);
    if (!svg) return svg.error();
    if (const Status written = write_file(fmt::format("{}/{}", folder, name), *svg); !written) return written.error();
    out.push_back(std::move(*svg));
  }
  return out;
}

}  // namespace

std::vector<CostRow> effects_cost_rows(const EffectsCost& cost) {
  std::vector<CostRow> rows;
  for (const EffectPrice& p : cost.prices) {
    if (!p.refused.empty()) continue;
    CostRow row{.subject = "effect " + p.table,
                .model = p.given,
                .knob = "",
                .setting = 0.0,
                .error_name = "time_added",
                .error = p.added_ms(),
                .unit = "ms/s",
                .reference = "the scene without it"};
    row.bytes = (p.named ? p.scene : p.other).bytes;
    rows.push_back(std::move(row));
  }
  for (const EffectKnob& k : cost.knobs)
    rows.push_back({.subject = "effect " + k.table,
                    .model = "",
                    .knob = k.key,
                    .setting = k.value,
                    .error_name = k.figure.empty() ? "unchanged" : k.figure,
                    .error = k.figure.empty() ? 0.0 : k.after - k.before,
                    .unit = "",
                    .reference = fmt::format("{:g}, the default", k.fallback)});
  for (CostRow& row : ladder_rows(cost.ladders)) rows.push_back(std::move(row));
  return rows;
}

std::string effects_cost_tables(const EffectsCost& cost) {
  std::string out;
  const auto add = [&out](const std::string& part) { out += (out.empty() ? "" : "\n") + part; };
  if (!cost.prices.empty()) add(markdown_table(kPriceHeads, price_cells(cost)));
  if (!cost.knobs.empty()) add(markdown_table(kKnobHeads, knob_cells(cost)));
  if (cost.ladders.empty()) return out;
  add(markdown_table(ladder_heads(), ladder_cells(cost.ladders)));
  std::string notes;
  for (const std::string& note : ladder_notes(cost.ladders)) notes += "- " + note + "\n";
  if (!notes.empty()) add(notes);
  return out;
}

std::string effects_cost_json(const EffectsCost& cost) {
  using Json = nlohmann::ordered_json;
  Json out{{"schema", "burrhole.cost_effects/1"}, {"effects", Json::array()}, {"knobs", Json::array()}};
  for (const EffectPrice& p : cost.prices) {
    Json one{{"table", p.table},
             {"named", p.named},
             {"given", p.given},
             {"requiring", p.requiring},
             {"refused", p.refused.empty() ? Json() : Json(p.refused)}};
    if (p.refused.empty()) {
      one["scene"] = run_json(p.scene);
      one[p.named ? "without" : "with"] = run_json(p.other);
    }
    out["effects"].push_back(std::move(one));
  }
  for (const EffectKnob& k : cost.knobs)
    out["knobs"].push_back({{"table", k.table},
                            {"key", k.key},
                            {"default", k.fallback},
                            {"value", k.value},
                            {"figure", k.figure.empty() ? Json() : Json(k.figure)},
                            {"before", k.before},
                            {"after", k.after},
                            {"cpu_ms_per_s", k.cpu_ms},
                            {"default_cpu_ms_per_s", k.fallback_ms}});
  out["accuracy"] = Json::array();
  for (const Ladder& ladder : cost.ladders) out["accuracy"].push_back(ladder_json(ladder));
  return out.dump(2) + "\n";
}

Status write_effects_cost(const EffectsCost& cost, const std::string& folder) {
  if (const Status written = write_cost_csv(effects_cost_rows(cost), folder + "/cost.csv"); !written) return written;
  if (const Status written = write_file(folder + "/effects.md", effects_cost_tables(cost)); !written) return written;
  HtmlPage html("The price of effects", "CPU time and memory of each effect of a scene, and what its keys change");
  if (!cost.prices.empty()) {
    const auto plot = draw_svg(price_plot(cost));
    if (!plot) return plot.error();
    if (const Status written = write_file(folder + "/effects.svg", *plot); !written) return written;
    html.svg(*plot, "Blue: effects that the scene names; orange: others, added to it. Medians of runs that took turns.");
    html.heading("With and without");
    html.table(kPriceHeads, price_cells(cost));
  }
  if (!cost.knobs.empty()) {
    html.heading("Keys at half and at twice their default");
    html.table(kKnobHeads, knob_cells(cost));
  }
  if (!cost.ladders.empty()) {
    html.heading("What accuracy costs");
    const auto plots = write_ladder_plots(cost, folder);
    if (!plots) return plots.error();
    for (const std::string& plot : *plots)
      html.svg(
          plot,
          "Error against a finer run, and time of the effect's steps, from coarse to fine; numbers are values of the key, a ring marks "
          "that of the scene, a triangle an error below the axis.");
    html.table(ladder_heads(), ladder_cells(cost.ladders));
    for (const std::string& note : ladder_notes(cost.ladders)) html.paragraph(note);
  }
  return write_file(folder + "/effects.html", html.text());
}

}  // namespace burrhole
