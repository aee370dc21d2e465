#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/engine/quality.h"
#include "app/lab/pareto.h"
#include "app/lab/render_cost.h"
#include "app/render/png.h"
#include "app/report/file.h"
#include "app/report/gnuplot.h"
#include "app/report/html.h"

namespace burrhole {
namespace {

/// The points of one subject and method, those of the front numbered from 1.
struct Cloud {
  std::vector<DrawnPoint> all, front;
};

Cloud cloud_of(const RenderCost& cost, const std::string& subject, const std::string& method) {
  Cloud out;
  std::vector<PricedPoint> priced;
  for (const DrawnPoint& point : cost.points)
    if (point.subject == subject && point.method == method) {
      out.all.push_back(point);
      priced.push_back({point.median_us, point.psnr});
    }
  for (const std::size_t n : pareto_front(priced)) out.front.push_back(out.all[n]);
  return out;
}

using Figure = double DrawnPoint::*;

std::string block(const std::string& name, const std::vector<DrawnPoint>& points, Figure figure, bool (*wanted)(const DrawnPoint&)) {
  std::string out = name + " << EOD\n";
  int number = 0;
  for (const DrawnPoint& point : points) {
    ++number;
    if (wanted(point)) out += fmt::format("{:.5g} {:.5g} {}\n", point.median_us * 1e-3, point.*figure, number);
  }
  return out + "1e30 1e30 0\nEOD\n";  // a block without a point is an error to gnuplot
}

struct Panel {
  std::string title, y_label, subject, method;
  Figure figure;  ///< drawn against cost; the front is that of the PSNR whatever it is
};

std::string panel_script(const RenderCost& cost, const Panel& panel, std::size_t n) {
  const Cloud cloud = cloud_of(cost, panel.subject, panel.method), slices = cloud_of(cost, panel.subject, "slices");
  const auto any = [](const DrawnPoint&) { return true; };
  const auto plain = [](const DrawnPoint& p) { return !p.quality.finish; };
  const auto finished = [](const DrawnPoint& p) { return p.quality.finish; };
  const auto shipped = [](const DrawnPoint& p) { return p.quality == DrawingQuality{.supersample = 2}; };
  const bool rays = panel.method == "rays";
  std::string out = block(fmt::format("$plain{}", n), cloud.all, panel.figure, plain) +
                    block(fmt::format("$finish{}", n), cloud.all, panel.figure, finished) +
                    block(fmt::format("$shipped{}", n), cloud.all, panel.figure, shipped) +
                    block(fmt::format("$front{}", n), cloud.front, panel.figure, any) +
                    block(fmt::format("$slices{}", n), rays ? slices.all : std::vector<DrawnPoint>{}, panel.figure, any);
  double low = 1e30, high = -1e30, cheap = 1e30, dear = 0.0;
  for (const auto* points : {&cloud.all, rays ? &slices.all : &cloud.front})
    for (const DrawnPoint& point : *points) {
      low = std::min(low, point.*panel.figure);
      high = std::max(high, point.*panel.figure);
      cheap = std::min(cheap, point.median_us * 1e-3);
      dear = std::max(dear, point.median_us * 1e-3);
    }
  const double margin = 0.08 * (high - low);
  out += fmt::format("set title {} offset 0,-0.6\nset ylabel {}\nset xrange [{:.4g}:{:.4g}]\nset yrange [{:.4g}:{:.4g}]\n",
                     gnuplot_quoted(panel.title), gnuplot_quoted(panel.y_label), 0.7 * cheap, 1.5 * dear, std::max(0.0, low - margin),
                     high + margin);
  out += n == 0 ? "set key opaque top left Left reverse samplen 2 font \",10\"\n" : "unset key\n";
  out += fmt::format(
      "plot $front{0} using 1:2 with lines linewidth 1.6 linecolor rgb \"#0b5394\" title \"Pareto front of PSNR\", "
      "$plain{0} using 1:2 with points pointtype 6 pointsize 0.7 linecolor rgb \"#999999\" title \"rays, no finish\", "
      "$finish{0} using 1:2 with points pointtype 7 pointsize 0.6 linecolor rgb \"#c4501b\" title \"rays, finish\", "
      "$slices{0} using 1:2 with points pointtype 8 pointsize 0.9 linecolor rgb \"#1b7f5c\" title \"slices\", "
      "$front{0} using 1:2 with points pointtype 6 pointsize 1.2 linewidth 1.4 linecolor rgb \"#0b5394\" notitle, "
      "$shipped{0} using 1:2 with points pointtype 3 pointsize 1.4 linewidth 1.6 linecolor rgb \"#000000\" title \"as shipped\", "
      "$front{0} using 1:2:(sprintf(\"%d\", $3)) with labels offset -0.7,0.8 font \",9\" textcolor rgb \"#0b5394\" notitle\n",
      n);
  return out;
}

std::string pareto_script(const RenderCost& cost) {
  std::vector<Panel> panels;
  std::vector<std::string> subjects;
  for (const DrawnPoint& point : cost.points)
    if (std::ranges::find(subjects, point.subject) == subjects.end()) subjects.push_back(point.subject);
  for (const std::string& subject : subjects) {
    panels.push_back({subject + ", surface", "PSNR to the best [dB]", subject, "rays", &DrawnPoint::psnr});
    panels.push_back({subject + ", surface", "FLIP to the best [-]", subject, "rays", &DrawnPoint::flip});
    panels.push_back({subject + ", translucent", "PSNR to the best [dB]", subject, "translucent", &DrawnPoint::psnr});
  }
  std::string out = fmt::format(
      "set encoding utf8\nset terminal svg size 1290,{} dynamic noenhanced font \"Helvetica,12\" background \"white\"\n"
      "set multiplot layout {},3 margins 0.055,0.99,{},0.95 spacing 0.06,0.13\n"
      "set border 3 linecolor rgb \"#666666\"\nset tics nomirror out scale 0.6\nset grid linecolor rgb \"#dddddd\" linewidth 0.6\n"
      "set logscale x\nset xtics (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)\nset xlabel \"CPU time of a picture [ms]\" offset "
      "0,0.5\n",
      340 * subjects.size() + 20, subjects.size(), subjects.size() > 1 ? "0.08" : "0.16");
  for (std::size_t n = 0; n < panels.size(); ++n) out += panel_script(cost, panels[n], n);
  return out + "unset multiplot\n";
}

/// The rows of quality_front.inc.
std::string front_text(const RenderCost& cost) {
  std::string out =
      "// Written by `burrhole cost render`: knobs (step [voxel], bisections, finish, supersample, resolution), relative cost, PSNR "
      "[dB].\n";
  for (const auto& [method, name] : {std::pair{"rays", "kSurfaceFront"}, std::pair{"translucent", "kTranslucentFront"}}) {
    out += fmt::format("constexpr std::array {}{{\n", name);
    for (const FrontRow& row : front_of(cost.points, method))
      out += fmt::format("    QualityPoint{{{{{:g}, {}, {}, {}, {:g}}}, {:.4g}, {:.3f}}},\n", row.quality.step_voxels,
                         row.quality.bisections, row.quality.finish, row.quality.supersample, row.quality.resolution, row.cost, row.psnr);
    out += "};\n";
  }
  return out;
}

std::string cell(double value, int decimals) {
  if (std::isinf(value)) return "equal";
  return std::isnan(value) ? "" : fmt::format("{:.{}f}", value, decimals);
}

void add_fronts(HtmlPage& html, const RenderCost& cost) {
  html.heading("The fronts");
  std::vector<std::vector<std::string>> cells;
  for (const char* method : {"rays", "translucent"})
    for (const char* subject : {"skull patch", "drilled hole"}) {
      int number = 0;
      for (const DrawnPoint& point : cloud_of(cost, subject, method).front)
        cells.push_back(
            {fmt::format("{}, {}, {}: {}", subject, method, ++number, quality_text(point.quality, method == std::string("translucent"))),
             cell(point.median_us * 1e-3, 1), cell(point.over_shipped, 3), cell(point.psnr, 2), cell(point.ssim, 4), cell(point.flip, 4)});
    }
  html.table({"point", "CPU [ms]", "over shipped", "PSNR [dB]", "SSIM", "FLIP"}, cells);
}

/// One line a setting: the rows of cost.csv that differ in their figure alone are put side by side.
void add_knobs(HtmlPage& html, const RenderCost& cost) {
  html.heading("Knob by knob");
  std::vector<std::vector<std::string>> cells;
  std::string last;
  for (const CostRow& row : cost.rows) {
    if (row.knob == "rays a pixel" || row.error_name == "time_over_shipped") continue;
    const std::string key = row.subject + row.model + row.knob + fmt::format("{}", row.setting) + row.reference;
    if (key != last)
      cells.push_back({fmt::format("{}: {}", row.subject, row.model), fmt::format("{} = {:g}", row.knob, row.setting), row.reference,
                       cell(row.median_us * 1e-3, 1), cell(row.p99_us * 1e-3, 1)});
    last = key;
    cells.back().push_back(cell(row.error, row.error_name == "psnr" ? 2 : 4));
  }
  html.table({"what", "knob", "reference", "CPU [ms]", "p99 [ms]", "PSNR [dB]", "SSIM", "FLIP"}, cells);
}

}  // namespace

Status write_render_cost(const RenderCost& cost, const std::string& folder) {
  if (Status written = write_cost_csv(cost.rows, folder + "/cost.csv"); !written) return written;
  HtmlPage html("What drawing costs", "Accuracy of a picture against the CPU time of all threads that drew it; " + cost.driver);
  const bool with_front = std::ranges::any_of(cost.points, [](const DrawnPoint& point) { return point.method == "rays"; });
  if (with_front) {
    if (Status written = write_file(folder + "/quality_front.inc", front_text(cost)); !written) return written;
    auto svg = run_gnuplot(pareto_script(cost), "gnuplot");
    if (!svg) return svg.error();
    constexpr std::string_view kTitle = "<title>Gnuplot</title>";  // a tooltip that names only the program
    if (const std::size_t at = svg->find(kTitle); at != std::string::npos) svg->erase(at, kTitle.size());
    if (Status written = write_file(folder + "/render.svg", *svg); !written) return written;
    html.svg(
        *svg,
        "Every combination of step, bisections, finish, rays a pixel and resolution. Numbers name the points of the front in the table "
        "below; FLIP is shown for the same points. FLIP: 67 pixels a degree.");
    add_fronts(html, cost);
  }
  html.begin_pictures();
  for (const NamedImage& picture : cost.pictures) {
    const std::string path = folder + "/" + picture.name + ".png";
    if (Status written = write_png(path, picture.image); !written) return written;
    if (Status added = html.picture(path, picture.caption); !added) return added;
  }
  html.end_pictures();
  add_knobs(html, cost);
  return write_file(folder + "/render.html", html.text());
}

}  // namespace burrhole
