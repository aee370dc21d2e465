#include "app/lab/frontier_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "app/report/gnuplot.h"

namespace burrhole {
namespace {

std::string named(const std::string& title) { return title.empty() ? "notitle" : "title " + gnuplot_quoted(title); }

std::string data_block(const std::string& name, const LogCurve& curve) {
  std::string out = name + " << EOD\n";
  for (std::size_t n = 0; n < curve.x.size(); ++n)
    if (std::isfinite(curve.y[n]) && curve.y[n] > 0.0) out += fmt::format("{} {}\n", curve.x[n], curve.y[n]);
  return out + "\n1e30 1e30\nEOD\n";  // a block without a point is an error to gnuplot; the empty line breaks the curve
}

std::string fill_block(const std::string& name, const LogPanel& panel) {
  std::string out = name + " << EOD\n";
  for (std::size_t n = 0; n < panel.fill_from.x.size(); ++n)
    out += fmt::format("{} {} {}\n", panel.fill_from.x[n], std::clamp(panel.fill_from.y[n], panel.y_range.first, panel.y_range.second),
                       std::clamp(panel.fill_to.y[n], panel.y_range.first, panel.y_range.second));
  return out + "EOD\n";
}

std::string script_of(const LogPage& page) {
  const int rows = (static_cast<int>(page.panels.size()) + page.columns - 1) / page.columns;
  std::string out =
      fmt::format("set encoding utf8\nset terminal svg size {},{} dynamic noenhanced font \"Helvetica,12\" background \"white\"\n",
                  470 * page.columns, 330 * rows + 40);
  for (std::size_t p = 0; p < page.panels.size(); ++p) {
    if (!page.panels[p].fill_from.x.empty()) out += fill_block(fmt::format("$fill{}", p), page.panels[p]);
    for (std::size_t c = 0; c < page.panels[p].curves.size(); ++c)
      out += data_block(fmt::format("$p{}_{}", p, c), page.panels[p].curves[c]);
  }
  out += fmt::format("set multiplot layout {},{} margins 0.09,0.985,0.11,0.955 spacing 0.1,0.13\n", rows, page.columns);
  out += "set border 3 linecolor rgb \"#666666\"\nset tics nomirror out scale 0.6\nset grid linecolor rgb \"#dddddd\" linewidth 0.6\n";
  out += fmt::format("set logscale y\nset format y \"%g\"\nset xrange [{}:{}]\n", page.x_range.first, page.x_range.second);
  if (page.log_x) out += "set logscale x\nset xtics (20, 50, 100, 200, 500, 1000)\n";
  for (std::size_t p = 0; p < page.panels.size(); ++p) {
    const LogPanel& panel = page.panels[p];
    out += fmt::format("set title {} offset 0,-0.6\nset xlabel {} offset 0,0.5\nset ylabel {} offset 0,0\n", gnuplot_quoted(panel.title),
                       gnuplot_quoted(page.x_label), gnuplot_quoted(panel.y_label));
    out += fmt::format("set yrange [{}:{}]\n", panel.y_range.first, panel.y_range.second);
    out += p == 0 ? "set key opaque " + page.key + " Left reverse samplen 2 maxrows 8 font \",10\"\n" : "unset key\n";
    out += "plot ";
    if (!panel.fill_from.x.empty())
      out += fmt::format("$fill{} using 1:2:3 with filledcurves linecolor rgb \"#f1e7d4\" {}, ", p, named(panel.fill_from.name));
    for (std::size_t c = 0; c < panel.curves.size(); ++c)
      out += fmt::format("{}$p{}_{} using 1:2 {} {}", c > 0 ? ", " : "", p, c, panel.curves[c].style, named(panel.curves[c].name));
    out += "\n";
  }
  return out + "unset multiplot\n";
}

}  // namespace

std::string line_style(const char* colour, const char* dash, double width) {
  return fmt::format("with lines linewidth {} linecolor rgb \"{}\" dashtype {}", width, colour, dash);
}
std::string point_style(const char* colour, int type) {
  return fmt::format("with linespoints linewidth 1.2 linecolor rgb \"{}\" pointtype {} pointsize {}", colour, type, type < 7 ? 1.0 : 0.6);
}

Result<std::string> draw_svg(const LogPage& page) {
  Result<std::string> svg = run_gnuplot(script_of(page), "gnuplot");
  constexpr std::string_view kTitle = "<title>Gnuplot</title>";  // a tooltip that names only the program
  if (const std::size_t at = svg ? svg->find(kTitle) : std::string::npos; at != std::string::npos) svg->erase(at, kTitle.size());
  return svg;
}

}  // namespace burrhole
