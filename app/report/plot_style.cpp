#include "app/report/plot_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr const char* kLineColors[] = {kPlotBlue, kPlotOrange, kPlotGreen, kPlotViolet, kPlotGrey};
// One for each round of the colours: with these, 15 lines of a panel differ. Each pattern repeats in the sample of the legend.
constexpr const char* kLineDashes[] = {"1", "(8,4)", "(2,3)"};
constexpr std::size_t kColors = std::size(kLineColors), kDashes = std::size(kLineDashes), kSolid = 0;
constexpr double kLineWidth = 1.6, kCoveredWidth = 3.4;

bool coincide(const PlotSeries& a, const PlotSeries& b, double near) {
  if (a.x != b.x || a.x.size() < 2) return false;
  const auto meet = [&](std::size_t n) { return std::abs(a.y[n] - b.y[n]) <= near; };
  std::size_t same = 0;
  for (std::size_t n = 1; n < a.y.size(); ++n) same += meet(n - 1) && meet(n) ? 1 : 0;
  return 4 * same >= a.y.size() - 1;
}

}  // namespace

std::vector<CurveLayer> curve_layers(const PlotPanel& panel, double near) {
  std::vector<CurveLayer> out(panel.series.size());
  for (std::size_t n = 0; n < out.size(); ++n)
    for (std::size_t under = 0; under < n; ++under) {
      const PlotSeries &upper = panel.series[n], &lower = panel.series[under];
      if (!upper.style.empty() || !lower.style.empty() || !coincide(upper, lower, near)) continue;
      if (out[under].below >= out[n].below) out[n].on = under;
      out[n].below = std::max(out[n].below, out[under].below + 1);
      out[under].covered = true;
    }
  return out;
}

std::string turn_style(std::size_t number) {
  return line_style(kLineColors[number % kColors], kLineDashes[number / kColors % kDashes], kLineWidth);
}

std::vector<std::string> turn_styles(const std::vector<CurveLayer>& layers) {
  std::vector<std::string> out;
  std::vector<std::size_t> dashes;
  const auto is_taken = [&](std::size_t dash) {
    for (std::size_t earlier = dashes.size() % kColors; earlier < dashes.size(); earlier += kColors)
      if (dashes[earlier] == dash) return true;
    return false;
  };
  for (const CurveLayer& layer : layers) {
    const std::size_t number = dashes.size();
    const auto shows = [&](std::size_t dash) { return layer.below == 0 || (dash != kSolid && dash != dashes[layer.on]); };
    std::size_t chosen = number / kColors + layer.below;
    std::optional<std::size_t> free, seen;
    for (std::size_t dash = chosen; dash < chosen + kDashes; ++dash) {
      if (is_taken(dash % kDashes)) continue;
      if (!free) free = dash;
      if (!seen && shows(dash % kDashes)) seen = dash;
    }
    chosen = seen.value_or(free.value_or(chosen)) % kDashes;
    dashes.push_back(chosen);
    out.push_back(
        line_style(kLineColors[number % kColors], kLineDashes[chosen], layer.covered && layer.below == 0 ? kCoveredWidth : kLineWidth));
  }
  return out;
}

bool has_dashes(const std::vector<CurveLayer>& layers) {
  return layers.size() > std::size(kLineColors) || std::ranges::any_of(layers, [](const CurveLayer& layer) { return layer.below > 0; });
}

std::string line_style(const char* colour, const char* dash, double width) {
  return fmt::format("with lines linewidth {} linecolor rgb \"{}\" dashtype {}", width, colour, dash);
}
std::string linked_point_style(const char* colour, int type) {
  return fmt::format("with linespoints linewidth 1.2 linecolor rgb \"{}\" pointtype {} pointsize {}", colour, type, type < 7 ? 1.0 : 0.6);
}
std::string nested_style(const char* colour, std::size_t n, std::size_t count) {
  constexpr int kOpen[] = {4, 6, 8, 12};
  BH_ASSERT(n < count && count <= std::size(kOpen));
  const double above = static_cast<double>(count - 1 - n);
  return fmt::format("with linespoints linewidth {} linecolor rgb \"{}\" pointtype {} pointsize {}", 1.0 + 0.7 * above, colour, kOpen[n],
                     0.6 + 0.3 * above);
}
std::string point_style(const char* colour, int type, double size, double width) {
  return fmt::format("with points pointtype {} pointsize {} linewidth {} linecolor rgb \"{}\"", type, size, width, colour);
}

}  // namespace burrhole
