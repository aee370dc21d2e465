#include "app/report/plot_range.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <regex>

#include "app/report/csv.h"

namespace burrhole {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kEndless = std::numeric_limits<double>::infinity();
constexpr double kMost = std::numeric_limits<double>::max(), kDenormal = std::numeric_limits<double>::denorm_min();
constexpr double kAwkward[] = {kNone, kEndless, -kEndless, kMost,  -kMost, kDenormal, -kDenormal,
                               0.0,   -0.0,     1e290,     -1e290, 1e-290, 1e20,      1.0};

TEST_CASE("plot range: every axis has a length that its numbers show, whatever the data") {
  for (const bool log : {false, true})
    for (const double a : kAwkward)
      for (const double b : kAwkward)
        for (const double nearby : {b, std::nextafter(a, kEndless)}) {
          INFO(a << " and " << nearby << ", logarithmic: " << log);
          PlotPanel panel{.y_label = "", .series = {{"", {a, nearby}, {nearby, a}}}, .bands = {{"", a, nearby}}};
          for (const bool set : {false, true})
            for (const bool from_zero : {false, true}) {
              panel.from_zero = from_zero;
              if (set) panel.x_range = panel.y_range = std::pair{a, nearby};
              for (const PlotRange& axis : {x_axis_of({&panel, 1}, log), y_axis_of(panel, log)}) {
                CHECK(std::isfinite(axis.lo));
                CHECK(axis.hi < 1e299);
                CHECK((!log || axis.lo > 0.0));
                CHECK(axis.hi - axis.lo >= 1e-9 * std::max(std::abs(axis.lo), std::abs(axis.hi)));
                CHECK(axis.hi > axis.lo);
              }
            }
        }
}

TEST_CASE("plot range: an axis holds its data, and a given range that it can have stays") {
  PlotPanel panel{.y_label = "", .series = {{"", {3.0, 5.0}, {0.01, 0.01}}}, .bands = {}};
  CHECK(x_axis_of({&panel, 1}, false).lo == 3.0);
  CHECK(x_axis_of({&panel, 1}, false).hi == 5.0);
  for (const bool log : {false, true}) {
    CHECK(y_axis_of(panel, log).lo < 0.01);
    CHECK(y_axis_of(panel, log).hi > 0.01);
  }
  panel.y_range = {-1.0, 2.0};
  CHECK(y_axis_of(panel, false).lo == -1.0);
  CHECK(y_axis_of(panel, false).hi == 2.0);
  CHECK(y_axis_of(panel, true).lo > 0.0);  // no logarithmic axis begins below 0
}

/// @returns a plot of data, ranges, bands, events and fills of awkward numbers.
Plot make_awkward(std::mt19937& random, bool grid) {
  const auto value = [&] { return kAwkward[random() % std::size(kAwkward)]; };
  const auto values = [&](std::size_t count) {
    std::vector<double> out(count);
    for (double& one : out) one = value();
    return out;
  };
  Plot plot{.x_label = "x", .panels = {}, .events = {}};
  plot.columns = grid ? 2 : 0;
  plot.log_x = random() % 2 == 0;
  plot.log_y = random() % 2 == 0;
  if (grid && random() % 2 == 0) plot.legend = "above";
  for (std::size_t panels = 1 + random() % 3; panels > 0; --panels) {
    PlotPanel panel{.y_label = "y", .series = {}, .bands = {}};
    for (std::size_t series = random() % 3; series > 0; --series) {
      const std::size_t count = random() % 4;
      panel.series.push_back(
          {random() % 2 == 0 ? "s" : "", values(count), values(count), random() % 2 == 0 ? "" : point_style("#000000", 7, 1.0)});
      if (random() % 2 == 0) panel.series.back().labels.assign(count, "name");
    }
    if (random() % 2 == 0) panel.bands = {{"band", value(), value()}, {"band", 0.5, 0.75}, {"band", value(), value()}};
    if (random() % 3 == 0) panel.x_range = {value(), value()};
    if (random() % 3 == 0) panel.y_range = {value(), value()};
    if (const std::size_t count = random() % 4; random() % 3 == 0) panel.fills = {{"fill", values(count), values(count), values(count)}};
    plot.panels.push_back(std::move(panel));
  }
  if (!grid)
    for (std::size_t events = random() % 3; events > 0; --events) plot.events.push_back({value(), "event"});
  return plot;
}

TEST_CASE("plot: no number that is not finite reaches gnuplot, and gnuplot draws every plot of awkward numbers") {
  const std::regex not_finite("(^|[^a-z\"])[-+]?(inf|nan)([^a-z\"]|$)");
  for (unsigned seed = 0; seed < 400; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    const Plot plot = make_awkward(random, seed % 2 == 0);
    const std::string script = plot_script(plot);
    std::smatch found;
    CHECK_MESSAGE(!std::regex_search(script, found, not_finite), found.str());
    if (seed % 8 > 1) continue;  // gnuplot takes some 30 ms a plot
    const Result<std::string> svg = draw_svg(plot);
    if (!svg && svg.error().code == ErrorCode::unavailable) continue;  // no gnuplot
    CHECK_MESSAGE(svg.ok(), svg.error().text());
  }
}

TEST_CASE("plot: a panel without a value that can be drawn says so, and no other does") {
  const auto says = [](const PlotSeries& series, bool log) {
    Plot plot{.x_label = "x", .panels = {{.y_label = "y", .series = {series}, .bands = {}}}, .events = {}};
    plot.log_y = log;
    return plot_script(plot).find("\"no data\"") != std::string::npos;
  };
  CHECK(says({"s", {}, {}}, false));
  CHECK(says({"s", {0.0, 1.0, kNone}, {kNone, kEndless, 1.0}}, false));
  CHECK_FALSE(says({"s", {0.0, 1.0}, {kNone, 0.0}}, false));
  CHECK(says({"s", {0.0, 1.0}, {kNone, 0.0}}, true));
  CHECK_FALSE(says({"s", {0.0, 1.0}, {kNone, 1.0}}, true));
}

}  // namespace
}  // namespace burrhole
