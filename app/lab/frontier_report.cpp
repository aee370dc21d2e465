#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "app/lab/frontier.h"
#include "app/report/csv.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

constexpr std::pair<double, double> kStiffnesses{3.0, 1e5};  // [N/m] of the plots' axes
constexpr std::array<const char*, 4> kHands{"none", "light", "nominal", "firm"};

using Rows = std::vector<const FrontierRow*>;

template <class Wanted>
Rows those(const std::vector<FrontierRow>& rows, const Wanted& wanted) {
  Rows out;
  for (const FrontierRow& row : rows)
    if (wanted(row)) out.push_back(&row);
  return out;
}

std::vector<double> values_of(const Rows& rows, double FrontierRow::*value) {
  std::vector<double> out;
  for (const FrontierRow* row : rows) out.push_back(row->*value);
  return out;
}

PlotSeries curve_of(const Rows& rows, std::string name, const std::string& style, double FrontierRow::*y) {
  return {std::move(name), values_of(rows, &FrontierRow::coupling_damping), values_of(rows, y), style};
}

PlotPanel stiffness_panel(const std::string& title, std::pair<double, double> x_range) {
  PlotPanel panel;
  panel.y_label = "stiffness K [N/m]";
  panel.title = title;
  panel.x_range = x_range;
  panel.y_range = kStiffnesses;
  return panel;
}

/// A grid of two columns with logarithmic y axes.
Plot grid(const std::string& x_label, const std::string& legend) {
  Plot plot;
  plot.x_label = x_label;
  plot.width_px = 940;
  plot.panel_height_px = 250;
  plot.columns = 2;
  plot.log_y = true;
  plot.legend = legend;
  return plot;
}

/// The K-B plane of one device in one hand: shaded from the passive line up to the measured frontier, where it is stable though not
/// passive.
PlotPanel plane_of(const std::vector<FrontierRow>& rows, std::string_view device, std::string_view hand) {
  const auto is = [&](const FrontierRow& row, std::string_view part) {
    return row.part == part && row.device == device && row.hand == hand;
  };
  const Rows linear = those(rows, [&](const FrontierRow& row) { return is(row, "damping"); });
  const Rows let_go = those(rows, [&](const FrontierRow& row) { return is(row, "released"); });
  PlotPanel panel = stiffness_panel(fmt::format("{}, hand: {}", device, hand), {0.0, 40.0});
  panel.series = {curve_of(linear, "measured, preloaded", linked_point_style(kPlotBlue, 7), &FrontierRow::measured),
                  curve_of(linear, "exact sampled system", line_style(kPlotGrey, "1", 0.8), &FrontierRow::exact),
                  curve_of(linear, "linear with delay", line_style(kPlotGreen, "(6,3)", 1.4), &FrontierRow::linear),
                  curve_of(linear, "passive wall (device alone)", line_style(kPlotOrange, "(2,2)", 1.6), &FrontierRow::passive),
                  curve_of(linear, "quantised passive wall", line_style(kPlotOrange, "(8,3,2,3)", 1.2), &FrontierRow::quantised),
                  curve_of(let_go, "measured, released, friction, steps on", linked_point_style(kPlotViolet, 6), &FrontierRow::measured)};
  panel.fills = {{"stable, not passive", values_of(linear, &FrontierRow::coupling_damping), values_of(linear, &FrontierRow::passive),
                  values_of(linear, &FrontierRow::measured)}};
  return panel;
}

Plot plane_page(const std::vector<FrontierRow>& rows, std::string_view device) {
  Plot page = grid("damping B of the coupling [N s/m]", "bottom right");
  for (const char* hand : kHands) page.panels.push_back(plane_of(rows, device, hand));
  return page;
}

PlotPanel rate_panel(const std::vector<FrontierRow>& rows, const std::string& title, std::string_view hand, std::string_view start) {
  PlotPanel panel = stiffness_panel(title, {18.0, 1100.0});
  constexpr std::array<std::pair<const char*, const char*>, 4> kLook{
      {{"hold", kPlotGrey}, {"linear", kPlotOrange}, {"gradient", kPlotGreen}, {"planes", kPlotBlue}}};
  for (const auto& look : kLook) {
    const Rows found = those(rows, [&](const FrontierRow& row) {
      return row.part == "rate" && row.hand == hand && row.start == start && row.scheme == look.first;
    });
    PlotSeries measured{look.first, {}, {}, linked_point_style(look.second, look.first == std::string_view("gradient") ? 4 : 7)};
    PlotSeries exact{"", {}, {}, line_style(look.second, "(2,2)", 1.2)};
    for (const FrontierRow* row : found) {
      const double rate = static_cast<double>(row->servo_hz) / row->contact_ticks;
      measured.x.push_back(rate);
      measured.y.push_back(row->measured);
      exact.x.push_back(rate);
      exact.y.push_back(row->exact);
    }
    panel.series.push_back(std::move(measured));
    panel.series.push_back(std::move(exact));
  }
  return panel;
}

Plot rate_page(const std::vector<FrontierRow>& rows) {
  Plot page = grid("contact rate [Hz]", "top left");
  page.log_x = true;
  page.panels = {rate_panel(rows, "plate, preloaded, nominal hand (dashed: exact)", "nominal", "preloaded"),
                 rate_panel(rows, "sphere of the tool's radius, pressed, friction and steps on", "nominal", "pressed"),
                 rate_panel(rows, "the same, falls 0.5 mm onto it", "nominal", "falls"),
                 rate_panel(rows, "the same, drilling", "nominal", "drilling")};
  return page;
}

CsvTable table_of(const std::vector<FrontierRow>& rows) {
  CsvTable table({"part",
                  "device",
                  "hand",
                  "bone",
                  "start",
                  "scheme",
                  "mass_kg",
                  "damping_N_s_per_m",
                  "spring_N_per_m",
                  "servo_hz",
                  "delay_ticks",
                  "contact_ticks",
                  "latency_ticks",
                  "coupling_N_s_per_m",
                  "measured_N_per_m",
                  "exact_N_per_m",
                  "known_N_per_m",
                  "passive_N_per_m",
                  "quantised_passive_N_per_m",
                  "linear_N_per_m"});
  for (const FrontierRow& r : rows)
    table.add_row({r.part,
                   r.device,
                   r.hand,
                   r.bone,
                   r.start,
                   r.scheme,
                   r.mass,
                   r.damping,
                   r.spring,
                   std::int64_t{r.servo_hz},
                   std::int64_t{r.delay},
                   std::int64_t{r.contact_ticks},
                   std::int64_t{r.latency_ticks},
                   r.coupling_damping,
                   r.measured,
                   r.exact,
                   r.known,
                   r.passive,
                   r.quantised,
                   r.linear});
  return table;
}

std::string rounded(double value) { return std::isnan(value) ? "" : std::isinf(value) ? "above 1e6" : fmt::format("{:.0f}", value); }

void add_known_table(HtmlPage& page, const std::vector<FrontierRow>& rows) {
  std::vector<std::vector<std::string>> cells;
  double worst = 0.0;
  for (const FrontierRow& row : rows) {
    if (row.part != "known") continue;
    const double off = row.measured / row.known - 1.0;
    worst = std::max(worst, std::abs(off));
    cells.push_back({row.device, row.scheme, fmt::format("{}", row.contact_ticks), rounded(row.known), fmt::format("{:.1f}", row.exact),
                     fmt::format("{:.1f}", row.measured), fmt::format("{:+.2f}", 100.0 * off)});
  }
  page.heading("Known limits through the whole loop");
  page.paragraph(
      fmt::format("Exact sampled systems derived elsewhere, against the shipped scene, contact, servo and simulated device: a "
                  "plate under a preload, no friction, steps or caps. The worst is off by {:.2f} %; bisection stops at 0.5 %.",
                  100.0 * worst));
  page.table({"case", "scheme", "contact every [ticks]", "known [N/m]", "exact [N/m]", "measured [N/m]", "off [%]"}, cells);
}

}  // namespace

Status write_frontier(const std::vector<FrontierRow>& rows, const std::string& folder) {
  if (const Status written = table_of(rows).write(folder + "/frontier.csv"); !written) return written;
  HtmlPage html("Stability frontier", "Largest stable stiffness of the coupling, measured through the shipped loop");
  const auto add = [&](const Plot& page, const std::string& name, std::string_view caption) -> Status {
    const auto svg = draw_svg(page);
    if (!svg) return svg.error();
    html.svg(*svg, caption);
    return write_file(folder + "/" + name, *svg);
  };
  html.heading("Contact rate");
  if (const Status drawn =
          add(rate_page(rows), "frontier_rates.svg",
              "Generic device, nominal hand, results one contact period late. There is no theoretical limit for the motion after release.");
      !drawn)
    return drawn;
  html.heading("Stiffness over damping, by device and hand");
  html.paragraph(
      "Servo and contact at 1 kHz, scheme planes. Shaded: stable in this hand, but not passive, so not in any hand. The passive lines "
      "take the device's own damping alone. Released: 0.5 mm above the plate under 2 N, with all limits of the device; no theoretical "
      "limit applies.");
  for (const DeviceModel& device : device_models()) {
    if (std::ranges::none_of(rows, [&](const FrontierRow& row) { return row.part == "damping" && row.device == device.name; })) continue;
    const std::string name = fmt::format("frontier_{}.svg", device.name);
    if (const Status drawn = add(plane_page(rows, device.name), name, device.title); !drawn) return drawn;
  }
  add_known_table(html, rows);
  return write_file(folder + "/frontier.html", html.text());
}

}  // namespace burrhole
