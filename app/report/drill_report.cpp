#include "app/report/drill_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/map_plot.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

/// Appends a tile if the value applies.
void add_tile(std::vector<HtmlTile>& tiles, const char* name, const std::optional<double>& value, int decimals, const char* unit,
              bool alert = false) {
  if (value) tiles.push_back({name, fmt::format("{:.{}f}", *value, decimals), unit, alert});
}

std::vector<HtmlTile> key_figures(const DrillReport& report) {
  const bool plunged = report.plunge_mm.value_or(0.0) > report.plunge_limit_mm;
  std::vector<HtmlTile> tiles;
  add_tile(tiles, "Plunge, without support", report.plunge_mm, 2, "mm", plunged);
  add_tile(tiles, "Tip beyond the bone", report.beyond_mm, 2, "mm");
  add_tile(tiles, "Axis clear of bone", report.breakthrough_s, 2, "s");
  add_tile(tiles, "Tip out of the bone", report.tip_out_s, 2, "s");
  add_tile(tiles, "Support lost", report.support_lost_s, 2, "s");
  add_tile(tiles, "Depth when the axis was clear", report.depth_mm_at_breakthrough, 2, "mm");
  add_tile(tiles, "Bone thickness", report.thickness_mm, 2, "mm");
  add_tile(tiles, "Peak force", report.peak_force_N, 2, "N");
  add_tile(tiles, "Angle to the surface normal", report.angle_deg, 1, "°");
  add_tile(tiles, "Hole, outside", report.hole_diameter_mm, 2, "mm");
  add_tile(tiles, "Hole, inside", report.inner_diameter_mm, 2, "mm");
  add_tile(tiles, "Cross-section clear of bone", report.cleared_percent, 0, "%");
  add_tile(tiles, "Bone removed", report.removed_mm3, 1, "mm³");
  add_tile(tiles, "Bone removed, by mass", report.removed_mass_mm3, 1, "mm³");
  add_tile(tiles, "Duration", report.duration_s, 2, "s");
  return tiles;
}

/// One sentence on the end of the run.
std::string verdict(const DrillReport& report) {
  if (!report.through || !report.breakthrough_s)
    return report.outcome.empty() ? "The run ended before the bone was drilled through." : report.outcome;
  const std::string out = exit_sentence({report.breakthrough_s, report.tip_out_s, report.support_lost_s, report.plunge_mm});
  if (!report.plunge_mm) return out + ".";
  const bool more = *report.plunge_mm > report.plunge_limit_mm;
  return out + fmt::format(", which is {} {:.2f} mm.", more ? "more than" : "within", report.plunge_limit_mm);
}

std::string result_text(const DrillReport& report) {
  const std::string line = fmt::format("Result: {} ({})", report.result, report.reason);
  return report.flags.empty() ? line + "."
                              : fmt::format("{}. Flags: {} (burrhole docs outcome defines them).", line, fmt::join(report.flags, ", "));
}

/// All clocks count: a step of simulation that is missed cuts no bone, although the servo was on time.
std::string missed_text(const DrillReport& report) {
  if (report.missed.empty()) return "Missed steps: none, in lockstep.";
  std::string out = "Missed steps:";
  for (const DrillReport::Missed& clock : report.missed)
    out += fmt::format("{} {} of {} of the {} clock", &clock == &report.missed.front() ? "" : ",", clock.missed, clock.all, clock.clock);
  return out + ".";
}

constexpr double kLast = 3.0, kLongest = 8.0;  // [s] at the end of a run, which are drawn larger if it is more than twice as long
constexpr int kWide = 900, kNarrow = 460;      // [px] of a plot

constexpr double kFeedContact = 1.0, kFeedQuantile = 0.99, kFeedRoom = 1.5;  // [N], [-], [-] of feed_axis()

/// @returns the axis of the feed [mm/s], by the drilling phase: forward speeds with bone under the bit from a time on, up to the deepest
/// position. The brief fastest hundredth of them, the approach and the retreat do not count. Nothing if there is no such phase.
std::optional<std::pair<double, double>> feed_axis(const DrillReport& report, double from) {
  const std::size_t count = report.time_s.size();
  if (report.force_N.size() != count || report.depth_mm.size() != count || report.speed_mm_s.size() != count) return std::nullopt;
  const auto deepest = static_cast<std::size_t>(std::ranges::max_element(report.depth_mm) - report.depth_mm.begin());
  std::vector<double> feeds;
  for (std::size_t n = 0; n <= deepest && n < count; ++n)
    if (report.time_s[n] >= from && report.force_N[n] > kFeedContact && report.speed_mm_s[n] > 0.0 && std::isfinite(report.speed_mm_s[n]))
      feeds.push_back(report.speed_mm_s[n]);
  if (feeds.empty()) return std::nullopt;
  std::ranges::sort(feeds);
  const double top = kFeedRoom * feeds[static_cast<std::size_t>(kFeedQuantile * static_cast<double>(feeds.size() - 1))];
  return std::pair{-0.25 * top, top};
}

/// Speeds off the scale are drawn at its end, as a curve of their own that says how far they go.
void clip_feed(PlotPanel& panel, const std::pair<double, double>& axis) {
  PlotSeries& feed = panel.series.front();
  PlotSeries beyond{"", feed.x, feed.y, line_style(kPlotOrange, "1", 4.0)};
  double least = 0.0, most = 0.0;
  for (std::size_t n = 0; n < feed.y.size(); ++n) {
    if (!std::isfinite(feed.y[n])) {
      beyond.y[n] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const bool inside = feed.y[n] >= axis.first && feed.y[n] <= axis.second;
    least = std::min(least, feed.y[n]);
    most = std::max(most, feed.y[n]);
    beyond.y[n] = inside ? std::numeric_limits<double>::quiet_NaN() : std::clamp(feed.y[n], axis.first, axis.second);
    if (!inside) feed.y[n] = std::numeric_limits<double>::quiet_NaN();
  }
  panel.from_zero = false;
  panel.y_range = axis;
  if (least >= axis.first && most <= axis.second) return;
  beyond.name = least < axis.first && most > axis.second ? fmt::format("off the scale, {:.3g} to {:.3g} mm/s", least, most)
                                                         : fmt::format("off the scale, to {:.3g} mm/s", least < axis.first ? least : most);
  panel.series.push_back(std::move(beyond));
}

/// @param from [s] start of the plot. @param width [px].
Plot make_plot(const DrillReport& report, double from, int width) {
  Plot plot;
  plot.x_label = "Time (s)";
  plot.width_px = width;
  const auto first = std::ranges::lower_bound(report.time_s, from) - report.time_s.begin();
  const std::vector<double> time(report.time_s.begin() + first, report.time_s.end());
  const auto add_panel = [&](const char* y_label, const char* name, const std::vector<double>& y) -> PlotPanel* {
    if (y.size() != report.time_s.size() || time.empty()) return nullptr;
    plot.panels.push_back({.y_label = y_label, .series = {{name, time, {y.begin() + first, y.end()}}}, .bands = {}});
    return &plot.panels.back();
  };
  if (PlotPanel* force = add_panel("Force (N)", "force", report.force_N)) force->from_zero = true;
  if (PlotPanel* depth = add_panel("Depth (mm)", "depth of the tip", report.depth_mm)) {
    depth->y_down = true;
    for (const DrillReport::Layer& layer : report.layers) depth->bands.push_back({layer.name, layer.from_mm, layer.to_mm});
  }
  if (PlotPanel* speed = add_panel("Feed (mm/s)", "feed of the tip", report.speed_mm_s)) {
    speed->from_zero = true;
    if (const auto axis = feed_axis(report, from)) clip_feed(*speed, *axis);
  }
  for (const DrillReport::Event& event : report.events)
    if (event.time_s >= from) plot.events.push_back({event.time_s, event.text});
  return plot;
}

/// Appends the plots from a time on. @returns unavailable without gnuplot.
Status add_plot(const DrillReport& report, double from, const std::string& caption, HtmlPage& page) {
  const auto wide = draw_svg(make_plot(report, from, kWide));
  if (!wide) return wide.error();
  const auto narrow = draw_svg(make_plot(report, from, kNarrow));
  if (!narrow) return narrow.error();
  page.svg(*wide, *narrow, caption);
  return {};
}

Status add_plots(const DrillReport& report, HtmlPage& page) {
  if (make_plot(report, 0.0, kWide).panels.empty()) return {};
  page.heading("Course");
  const std::string layers = "Depth is that of the tip along the axis, from the entry; the shaded layers are the bone as loaded.";
  Status drawn = add_plot(report, 0.0, report.layers.empty() ? "" : layers, page);
  // From half a second before the breakthrough on, if that is not long ago.
  const double end = report.time_s.back(), through = report.breakthrough_s.value_or(end) - 0.5;
  const double last = std::min(kLongest, std::max(kLast, end - through));
  if (drawn && end - report.time_s.front() > 2.0 * last)
    drawn = add_plot(report, end - last, fmt::format("The last {:.1f} s.", last), page);
  if (drawn) return {};
  // A page without its plot is useful. Any error other than a missing program is our bug.
  if (drawn.error().code != ErrorCode::unavailable) return drawn;
  page.paragraph("No plot: " + drawn.error().message + ".");
  return {};
}

Status add_maps(const DrillReport& report, HtmlPage& page) {
  for (const ValueMap& map : report.maps) {
    const auto wide = draw_map(map, kWide);
    const auto narrow = wide ? draw_map(map, kNarrow) : wide;
    if (!narrow && narrow.error().code == ErrorCode::unavailable) {
      page.paragraph("No map: " + narrow.error().message + ".");
      return {};
    }
    if (!narrow) return narrow.error();
    if (&map == &report.maps.front()) page.heading("Maps");
    page.svg(*wide, *narrow, map.caption);
  }
  return {};
}

Status add_pictures(const DrillReport& report, HtmlPage& page) {
  if (report.pictures.empty()) return {};
  page.heading("Pictures");
  page.begin_pictures();
  for (const DrillReport::Picture& picture : report.pictures)
    if (const Status added = page.picture(picture.png_path, picture.caption); !added) return added;
  page.end_pictures();
  return {};
}

void add_layers(const DrillReport& report, HtmlPage& page) {
  if (report.layer_rows.empty()) return;
  page.heading("Layers of bone");
  const auto text = [](const std::optional<double>& value) { return value ? fmt::format("{:.1f}", *value) : std::string("-"); };
  std::vector<std::vector<std::string>> rows;
  for (const DrillReport::LayerRow& row : report.layer_rows)
    rows.push_back({row.name, fmt::format("{:.2f}", row.thickness_mm), fmt::format("{:.2f}", row.time_s), text(row.mean_N),
                    text(row.peak_N), fmt::format("{:.1f}", row.removed_mm3)});
  page.table({"Layer", "Thickness on the axis (mm)", "Time of the tip (s)", "Mean force (N)", "Largest force (N)", "Removed (mm\u00b3)"},
             rows);
}

void add_tables(const DrillReport& report, HtmlPage& page) {
  if (!report.events.empty()) {
    page.heading("Events");
    std::vector<std::vector<std::string>> rows;
    for (const DrillReport::Event& event : report.events) rows.push_back({event.text, fmt::format("{:.3f}", event.time_s)});
    page.table({"Event", "Time (s)"}, rows);
  }
  if (!report.timing.empty()) {
    page.begin_details("Computation time");
    std::vector<std::vector<std::string>> rows;
    for (const DrillReport::Timing& step : report.timing) {
      rows.push_back({step.name, std::to_string(step.count), fmt::format("{:.1f}", step.p50_us), fmt::format("{:.1f}", step.p99_us),
                      fmt::format("{:.1f}", step.p999_us), fmt::format("{:.1f}", step.max_us)});
    }
    page.table({"Step", "Calls", "Median (µs)", "99th percentile (µs)", "99.9th (µs)", "Longest (µs)"}, rows);
    page.paragraph(missed_text(report));
    page.end_details();
  }
  if (!report.hashes.empty()) {
    page.heading("Hashes of the results");
    std::vector<std::vector<std::string>> rows;
    for (const DrillReport::Hash& hash : report.hashes) rows.push_back({hash.name, hash.value});
    page.table({"Of", "Hash"}, rows);
  }
  if (!report.made.empty()) {
    page.heading("Made by");
    std::vector<std::vector<std::string>> rows;
    for (const DrillReport::Made& made : report.made) rows.push_back({made.name, made.value});
    page.table({"", ""}, rows);
  }
}

}  // namespace

std::string exit_sentence(const ExitFigures& exit) {
  std::string out = "The bone was drilled through";
  out += exit.breakthrough_s ? fmt::format(": the axis was clear after {:.2f} s", *exit.breakthrough_s) : std::string(" round a core");
  if (exit.tip_out_s) out += fmt::format(", the tip came out after {:.2f} s", *exit.tip_out_s);
  if (!exit.plunge_mm) return out;
  if (!exit.support_lost_s) return out + ", the bone carried the thrust to the end, and the plunge is 0.00 mm";
  return out + fmt::format(", the bone carried the thrust until {:.2f} s, and the tip then plunged {:.2f} mm", *exit.support_lost_s,
                           *exit.plunge_mm);
}

Result<std::string> make_drill_report(const DrillReport& report) {
  HtmlPage page(report.title, report.scene);
  page.paragraph(verdict(report));
  if (!report.result.empty()) page.paragraph(result_text(report));
  if (!report.setting.empty()) page.paragraph(report.setting);
  for (const std::string& warning : report.warnings) page.paragraph("Warning: " + warning + ".");
  page.tiles(key_figures(report));
  if (const Status added = add_plots(report, page); !added) return added.error();
  add_layers(report, page);
  if (const Status added = add_maps(report, page); !added) return added.error();
  if (const Status added = add_pictures(report, page); !added) return added.error();
  add_tables(report, page);
  return page.text();
}

Status write_drill_report(const DrillReport& report, const std::string& path) {
  const Result<std::string> page = make_drill_report(report);
  if (!page) return page.error();
  return write_file(path, *page);
}

}  // namespace burrhole
