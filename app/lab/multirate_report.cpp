#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "app/lab/multirate.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

// Colours as in the frontier's plots, scheme by scheme.
constexpr std::array<std::pair<const char*, const char*>, 4> kLook{
    {{"hold", kPlotGrey}, {"linear", kPlotOrange}, {"gradient", kPlotGreen}, {"planes", kPlotBlue}}};

PlotPanel panel_of(const std::vector<CostRow>& rows, const std::string& title, const std::string& subject, const std::string& error_name) {
  const bool kept = error_name == "stiffness_kept";
  PlotPanel panel;
  panel.title = title;
  panel.y_label = kept ? "stiffness kept [-]" : "force off, rms [% of mean force]";
  panel.x_range = {18.0, 1100.0};
  panel.y_range = kept ? std::pair{0.03, 2.0} : std::pair{0.1, 200.0};
  for (const auto& look : kLook) {
    PlotSeries curve{look.first, {}, {}, linked_point_style(look.second, look.first == std::string_view("gradient") ? 4 : 7)};
    for (const CostRow& row : rows) {
      if (row.subject != subject || row.error_name != error_name || row.model != look.first) continue;
      curve.x.push_back(row.setting);
      curve.y.push_back(row.error);
    }
    panel.series.push_back(std::move(curve));
  }
  return panel;
}

std::string cell(double value, int decimals) { return std::isnan(value) ? "" : fmt::format("{:.{}f}", value, decimals); }

}  // namespace

Status write_multirate(const std::vector<CostRow>& rows, const std::string& folder) {
  if (const Status written = write_cost_csv(rows, folder + "/cost.csv"); !written) return written;
  Plot page;
  page.x_label = "contact rate [Hz]";
  page.width_px = 940;
  page.panel_height_px = 250;
  page.columns = 2;
  page.log_x = page.log_y = true;
  page.legend = "bottom left";
  page.panels = {panel_of(rows, "sliding over a sphere", "sliding over a sphere", "force_rms_off"),
                 panel_of(rows, "drilling into a sphere", "drilling into a sphere", "force_rms_off"),
                 panel_of(rows, "pressed onto a sphere", "pressed onto a sphere", "stiffness_kept"),
                 panel_of(rows, "drilling into a sphere", "drilling into a sphere", "stiffness_kept")};
  const auto svg = draw_svg(page);
  if (!svg) return svg.error();
  if (const Status written = write_file(folder + "/multirate.svg", *svg); !written) return written;
  HtmlPage html("The price of multi-rate", "Contact slower than the servo: what the force and the stable stiffness lose");
  html.svg(*svg,
           "Above: how far the force is off that of servo and contact at 4 kHz without latency, the same motion given. Below: largest "
           "stable stiffness over that "
           "of the same scheme at 1 kHz; generic device, nominal hand, results one contact period late.");
  std::vector<std::vector<std::string>> cells;
  for (const CostRow& row : rows)
    cells.push_back({row.subject, row.model, cell(row.setting, 0), row.error_name, cell(row.error, 3), row.unit, cell(row.median_us, 2),
                     cell(row.p99_us, 2)});
  html.table({"subject", "scheme", "contact [Hz]", "figure", "value", "unit", "servo step, median [us]", "p99 [us]"}, cells);
  return write_file(folder + "/multirate.html", html.text());
}

}  // namespace burrhole
