#include "app/report/map_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/gnuplot.h"
#include "app/report/plot_range.h"
#include "core/base/color_ramp.h"

namespace burrhole {
namespace {

// Sizes [px] round the field of the map.
constexpr int kLeft = 70, kRight = 118, kTop = 34, kBottom = 58, kFontSize = 12;

std::string palette() {
  std::string stops;
  for (const RampStop& stop : kValueRamp)
    stops += fmt::format("{}{:g} \"#{:02x}{:02x}{:02x}\"", stops.empty() ? "" : ", ", stop.share, stop.color.r, stop.color.g, stop.color.b);
  return "set palette defined (" + stops + ")\n";
}

}  // namespace

std::string map_script(const ValueMap& map, int width_px) {
  PlotRange scale;
  for (const float value : map.values) scale.include(static_cast<double>(value), false);
  scale = scale.drawable(false);
  const double half = 0.5 * map.pitch;
  const double right = map.x + map.pitch * static_cast<double>(map.columns), below = map.y + map.pitch * static_cast<double>(map.rows);
  const int field = width_px - kLeft - kRight;
  const double shape = static_cast<double>(map.rows) / static_cast<double>(std::max<std::size_t>(1, map.columns));
  const int height = std::clamp(static_cast<int>(std::lround(static_cast<double>(field) * shape)), 80, 900);
  std::string out =
      fmt::format("set encoding utf8\nset terminal svg size {},{} dynamic noenhanced font \"Helvetica,{}\" background \"white\"\n",
                  width_px, height + kTop + kBottom, kFontSize);
  out += "$map << EOD\n";
  for (std::size_t row = 0; row < map.rows; ++row) {
    for (std::size_t column = 0; column < map.columns; ++column) {
      const auto value = static_cast<double>(map.values[row * map.columns + column]);
      out += can_be_drawn(value, false) ? fmt::format("{:.4g} ", value) : std::string("NaN ");
    }
    out += '\n';
  }
  out += "EOD\n";
  const double all = static_cast<double>(height + kTop + kBottom), wide = static_cast<double>(width_px);
  out += fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
      kLeft / wide, (width_px - kRight) / wide, kBottom / all, (kBottom + height) / all);
  out += "set border linecolor rgb \"#666666\"\nset tics nomirror out scale 0.6\nunset key\n";
  out += palette();
  out += fmt::format("set title {} offset 0,-0.5\nset xlabel {}\nset ylabel {}\nset cblabel {}\n", gnuplot_quoted(map.title),
                     gnuplot_quoted(map.x_label), gnuplot_quoted(map.y_label), gnuplot_quoted(map.unit));
  out += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\nset cbrange [{}:{}]\n", map.x - half, right - half, below - half,
                     map.y - half, scale.lo, scale.hi);
  out += fmt::format("plot $map matrix using ({0}+$1*{2}):({1}+$2*{2}):3 with image pixels\n", map.x, map.y, map.pitch);
  return out;
}

Result<std::string> draw_map(const ValueMap& map, int width_px, const std::string& gnuplot) {
  Result<std::string> svg = run_gnuplot(map_script(map, width_px), gnuplot, "</svg>");
  constexpr std::string_view kTooltip = "<title>Gnuplot</title>";  // names only the program
  if (const std::size_t at = svg ? svg->find(kTooltip) : std::string::npos; at != std::string::npos) svg->erase(at, kTooltip.size());
  return svg;
}

}  // namespace burrhole
