// Names of points: none over another, near their points, and the same in the SVG that gnuplot draws.
#include "app/report/plot_labels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "app/report/plot.h"
#include "tests/support/svg_names.h"

namespace burrhole {
namespace {

constexpr PlotBox kFrame{{0.0, 0.0}, {320.0, 240.0}};

PointName name_at(double x, double y) { return {{x, y}, 14.0, 11.0}; }

/// CPU times [ms] and accuracies with clusters, as a Pareto front of pictures has them, and a legend in the upper left corner.
Plot clustered_plot() {
  PlotSeries front{"front", {}, {}, point_style(kPlotBlue, 6, 1.2, 1.4)};
  const double kX[] = {2.8,  3.1,  3.6,  4.0,  4.1,  8.7,  9.0,  9.9,  10.0,  17.2, 17.9,
                       18.1, 20.0, 33.0, 60.0, 61.0, 69.0, 83.0, 88.0, 104.0, 300.0};
  const double kY[] = {25.4, 25.4, 31.6, 31.7, 31.8, 35.8, 36.0, 36.3, 36.4, 38.2, 38.9,
                       39.4, 39.8, 40.0, 40.7, 40.9, 41.6, 42.8, 46.9, 49.5, 53.4};
  for (std::size_t n = 0; n < std::size(kX); ++n) {
    front.x.push_back(kX[n]);
    front.y.push_back(kY[n]);
    front.labels.push_back(std::to_string(n + 1));
  }
  PlotSeries joined = front;
  joined.labels.clear();
  joined.style = line_style(kPlotBlue, "1", 1.6);
  joined.name = "joined";
  Plot plot;
  plot.x_label = "CPU time [ms]";
  plot.width_px = 430;
  plot.panel_height_px = 260;
  plot.columns = 1;
  plot.log_x = true;
  plot.panels.push_back({.y_label = "PSNR [dB]", .series = {joined, front}, .bands = {}, .title = "cluster"});
  return plot;
}

TEST_CASE("plot names: no two boxes overlap, however dense the points are, and each stays in the frame and off the legend") {
  const unsigned seed = 4711;
  MESSAGE("seed " << seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 40; ++round) {
    const double spread = 2.0 + 6.0 * round;
    std::uniform_real_distribution<double> off(-spread, spread);
    std::vector<PointName> names;
    PanelContents contents{.frame = kFrame, .covered = {{{0.0, 180.0}, {120.0, 240.0}}}};
    for (int n = 0; n < 20; ++n) {
      names.push_back(name_at(std::clamp(160.0 + off(random), 1.0, 319.0), std::clamp(100.0 + off(random), 1.0, 239.0)));
      contents.marks.push_back(names.back().at);
    }
    const auto placed = place_names(names, contents);
    REQUIRE(placed.size() == names.size());
    for (std::size_t n = 0; n < placed.size(); ++n) {
      REQUIRE(placed[n]);
      CHECK(kFrame.contains(placed[n]->box));
      CHECK_FALSE(placed[n]->box.overlaps(contents.covered[0]));
      for (std::size_t m = 0; m < n; ++m) CHECK_FALSE(placed[n]->box.overlaps(placed[m]->box));
      // Further away than beside its marker, a line leads to it.
      const PlotPoint near{std::clamp(names[n].at.x, placed[n]->box.lo.x, placed[n]->box.hi.x),
                           std::clamp(names[n].at.y, placed[n]->box.lo.y, placed[n]->box.hi.y)};
      const double distance = std::hypot(near.x - names[n].at.x, near.y - names[n].at.y);
      CHECK(placed[n]->leader.has_value() == (distance > 8.0));
      if (placed[n]->leader) CHECK(std::hypot(placed[n]->leader->to.x - near.x, placed[n]->leader->to.y - near.y) < 1e-9);
    }
  }
}

TEST_CASE("plot names: a point by itself has its name beside it, away from its curve, and a full frame leaves a name out") {
  const PointName name = name_at(100.0, 100.0);
  const auto alone = place_names({&name, 1}, {.frame = kFrame, .marks = {name.at}});
  REQUIRE(alone[0]);
  CHECK_FALSE(alone[0]->leader);
  CHECK(alone[0]->box.hi.x < 100.0);
  CHECK(alone[0]->box.lo.y > 100.0);
  // A curve through the upper left.
  const auto beside = place_names({&name, 1}, {.frame = kFrame, .marks = {name.at}, .lines = {{{0.0, 200.0}, {100.0, 100.0}}}});
  REQUIRE(beside[0]);
  CHECK_FALSE(beside[0]->box.overlaps(alone[0]->box));
  CHECK_FALSE(beside[0]->leader);
  const auto full = place_names({&name, 1}, {.frame = kFrame, .covered = {kFrame}});
  CHECK_FALSE(full[0]);
}

TEST_CASE("plot names: in an SVG all names are drawn and no two intersect; at a fixed offset from their points they would") {
  const auto svg = draw_svg(clustered_plot());
  if (!svg && svg.error().code == ErrorCode::unavailable) return;  // no gnuplot
  REQUIRE(svg.ok());
  const std::vector<test::SvgText> names = test::svg_texts(*svg, 10.0);
  CHECK(names.size() == 21);
  CHECK(test::intersecting_pairs(names) == 0);
  // The markers, of type 6, in the order of their numbers.
  static const std::regex kMark(R"re(<use xlink:href='#gpPt5' transform='translate\(([0-9.]+),([0-9.]+)\))re");
  std::vector<test::SvgText> offset;
  for (std::sregex_iterator at(svg->begin(), svg->end(), kMark), end; at != end; ++at)
    offset.push_back({std::stod((*at)[1]) - 5.0, std::stod((*at)[2]) - 8.0, 10.0, std::to_string(offset.size() + 1)});
  CHECK(offset.size() >= 21);
  CHECK(test::intersecting_pairs(offset) > 3);
}

TEST_CASE("plot: of curves that coincide each is narrower than those under it, and a legend above a grid is over its panels") {
  constexpr std::size_t kCurves = 4;
  Plot plot;
  plot.columns = 5;
  plot.width_px = 1600;
  plot.legend = "above";
  for (int p = 0; p < 5; ++p) {
    PlotPanel panel{.y_label = "error", .series = {}, .bands = {}, .title = "same"};
    for (std::size_t n = 0; n < kCurves; ++n)
      panel.series.push_back(
          {"curve with quite a long name " + std::to_string(n), {1.0, 2.0, 3.0}, {1.0, 3.0, 2.0}, nested_style(kPlotBlue, n, kCurves)});
    for (const char* name : {"curve of another kind 4", "curve of another kind 5"})
      panel.series.push_back({name, {1.0, 3.0}, {1.0, 1.0}, line_style(kPlotGrey, "(8,4)", 2.0)});
    plot.panels.push_back(panel);
  }
  const auto svg = draw_svg(plot);
  if (!svg && svg.error().code == ErrorCode::unavailable) return;  // no gnuplot
  REQUIRE(svg.ok());
  std::vector<double> widths;
  static const std::regex kCurve(R"re(<g id="gnuplot_plot_[0-9a-z]+"[^>]*>[\s\S]*?stroke-width="([0-9.]+)")re");
  for (std::sregex_iterator at(svg->begin(), svg->end(), kCurve), end; at != end; ++at) widths.push_back(std::stod((*at)[1]));
  REQUIRE(widths.size() == 6 * (kCurves + 2));  // the legend's samples, then five panels
  for (std::size_t n = 0; n + 1 < kCurves; ++n) CHECK(widths[kCurves + 2 + n] > widths[kCurves + 3 + n] + 0.5);
  // The names of the legend have one baseline, above the title.
  static const std::regex kName(R"re(translate\([0-9.]+,([0-9.]+)\)[^<]*<text>(curve [a-z ]+ [0-5]|same)</text>)re");
  std::vector<double> legend;
  double title = 0.0;
  for (std::sregex_iterator at(svg->begin(), svg->end(), kName), end; at != end; ++at) {
    if ((*at)[2] == "same")
      title = std::stod((*at)[1]);
    else
      legend.push_back(std::stod((*at)[1]));
  }
  REQUIRE(legend.size() == 6);
  CHECK(*std::ranges::max_element(legend) - *std::ranges::min_element(legend) < 1.0);
  CHECK(*std::ranges::max_element(legend) < title - 8.0);
  // The panels have the ticks that they have with a legend inside.
  const auto ticks = [](const std::string& text) {
    static const std::regex kTick(R"re([0-9.]+,[0-9.]+ L[0-9.]+,[0-9.]+)re");
    std::ptrdiff_t count = 0;
    static const std::regex kPath(R"re(<path stroke='rgb\(102, 102, 102\)'\s+d='([^']*)')re");
    for (std::sregex_iterator at(text.begin(), text.end(), kPath), end; at != end; ++at) {
      const std::string path = (*at)[1];
      count += std::distance(std::sregex_iterator(path.begin(), path.end(), kTick), std::sregex_iterator());
    }
    return count;
  };
  plot.legend = "top left";
  const auto inside = draw_svg(plot);
  REQUIRE(inside.ok());
  CHECK(ticks(*svg) == ticks(*inside));
  CHECK(ticks(*svg) > 20);
}

}  // namespace
}  // namespace burrhole
