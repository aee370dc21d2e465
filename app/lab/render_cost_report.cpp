#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/lab/pareto.h"
#include "app/lab/render_cost.h"
#include "app/render/png.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"
#include "app/view/quality.h"

namespace burrhole {
namespace {

/// The points of one subject and method; those of the Pareto front are numbered from 1.
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

/// Points of the cloud that are wanted, drawn against cost [ms].
template <class Wanted>
PlotSeries points_of(const std::vector<DrawnPoint>& points, Figure figure, std::string name, std::string style, const Wanted& wanted) {
  PlotSeries out{std::move(name), {}, {}, std::move(style)};
  for (const DrawnPoint& point : points) {
    if (!wanted(point)) continue;
    out.x.push_back(point.median_us * 1e-3);
    out.y.push_back(point.*figure);
  }
  return out;
}

struct Panel {
  std::string title, y_label, subject, method;
  Figure figure;  ///< plotted against cost; the Pareto front is always that of the PSNR
};

PlotPanel panel_of(const RenderCost& cost, const Panel& choice) {
  const Cloud cloud = cloud_of(cost, choice.subject, choice.method), slices = cloud_of(cost, choice.subject, "slices");
  const auto any = [](const DrawnPoint&) { return true; };
  const auto plain = [](const DrawnPoint& p) { return !p.quality.finish; };
  const auto finished = [](const DrawnPoint& p) { return p.quality.finish; };
  const auto shipped = [](const DrawnPoint& p) { return p.quality == DrawingQuality{.supersample = 2}; };
  const bool rays = choice.method == "rays";
  PlotPanel panel;
  panel.title = choice.title;
  panel.y_label = choice.y_label;
  PlotSeries front = points_of(cloud.front, choice.figure, "", point_style(kPlotBlue, 6, 1.2, 1.4), any);
  for (std::size_t n = 0; n < front.x.size(); ++n) front.labels.push_back(std::to_string(n + 1));
  panel.series = {points_of(cloud.front, choice.figure, "Pareto front of PSNR", line_style(kPlotBlue, "1", 1.6), any),
                  points_of(cloud.all, choice.figure, "rays, no finish", point_style("#999999", 6, 0.7), plain),
                  points_of(cloud.all, choice.figure, "rays, finish", point_style(kPlotOrange, 7, 0.6), finished),
                  points_of(rays ? slices.all : std::vector<DrawnPoint>{}, choice.figure, "slices", point_style(kPlotGreen, 8, 0.9), any),
                  std::move(front),
                  points_of(cloud.all, choice.figure, "as shipped", point_style("#000000", 3, 1.4, 1.6), shipped)};
  double low = 1e30, high = -1e30, cheap = 1e30, dear = 0.0;
  for (const auto* points : {&cloud.all, rays ? &slices.all : &cloud.front})
    for (const DrawnPoint& point : *points) {
      low = std::min(low, point.*choice.figure);
      high = std::max(high, point.*choice.figure);
      cheap = std::min(cheap, point.median_us * 1e-3);
      dear = std::max(dear, point.median_us * 1e-3);
    }
  const double margin = 0.08 * (high - low);
  panel.x_range = {0.7 * cheap, 1.5 * dear};
  panel.y_range = {std::max(0.0, low - margin), high + margin};
  return panel;
}

Plot pareto_plot(const RenderCost& cost) {
  std::vector<std::string> subjects;
  for (const DrawnPoint& point : cost.points)
    if (std::ranges::find(subjects, point.subject) == subjects.end()) subjects.push_back(point.subject);
  Plot plot;
  plot.x_label = "CPU time of a picture [ms]";
  plot.width_px = 1290;
  plot.panel_height_px = 260;
  plot.columns = 3;
  plot.log_x = true;
  for (const std::string& subject : subjects)
    for (const Panel& panel : {Panel{subject + ", surface", "PSNR to the best [dB]", subject, "rays", &DrawnPoint::psnr},
                               Panel{subject + ", surface", "FLIP to the best [-]", subject, "rays", &DrawnPoint::flip},
                               Panel{subject + ", translucent", "PSNR to the best [dB]", subject, "translucent", &DrawnPoint::psnr}})
      plot.panels.push_back(panel_of(cost, panel));
  return plot;
}

/// The rows of quality_front.inc.
std::string pareto_text(const RenderCost& cost) {
  std::string out =
      "// Written by `burrhole cost render`: knobs (step [voxel], bisections, finish, supersample, resolution), relative cost, PSNR "
      "[dB].\n";
  for (const auto& [method, name] : {std::pair{"rays", "kSurfaceFront"}, std::pair{"translucent", "kTranslucentFront"}}) {
    out += fmt::format("constexpr std::array {}{{\n", name);
    for (const ParetoRow& row : pareto_rows(cost.points, method))
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

void add_pareto_fronts(HtmlPage& html, const RenderCost& cost) {
  html.heading("The Pareto fronts");
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

/// One line per setting: the rows of cost.csv that differ only in their figure are combined.
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

std::vector<ParetoRow> pareto_rows(const std::vector<DrawnPoint>& points, const std::string& method) {
  struct Sum {
    ParetoRow row;
    int count = 0;
  };
  std::vector<Sum> sums;
  for (const DrawnPoint& point : points) {
    if (point.method != method) continue;
    auto sum = std::ranges::find_if(sums, [&](const Sum& one) { return one.row.quality == point.quality; });
    if (sum == sums.end()) sum = sums.insert(sum, Sum{{point.quality, 0.0, point.psnr}, 0});
    sum->row.cost += point.over_shipped;
    sum->row.psnr = std::min(sum->row.psnr, point.psnr);
    ++sum->count;
  }
  std::vector<PricedPoint> priced;
  for (Sum& sum : sums) {
    sum.row.cost /= sum.count;
    priced.push_back({sum.row.cost, sum.row.psnr});
  }
  std::vector<ParetoRow> front;
  for (const std::size_t n : pareto_front(priced)) front.push_back(sums[n].row);
  const double first = front.empty() ? 1.0 : front.front().cost;
  for (ParetoRow& row : front) row.cost /= first;
  return front;
}

Status write_render_cost(const RenderCost& cost, const std::string& folder) {
  if (Status written = write_cost_csv(cost.rows, folder + "/cost.csv"); !written) return written;
  HtmlPage html("What drawing costs", "Accuracy of a picture against the CPU time of all threads that drew it; " + cost.driver);
  const bool with_front = std::ranges::any_of(cost.points, [](const DrawnPoint& point) { return point.method == "rays"; });
  if (with_front) {
    if (Status written = write_file(folder + "/quality_front.inc", pareto_text(cost)); !written) return written;
    const auto svg = draw_svg(pareto_plot(cost));
    if (!svg) return svg.error();
    if (Status written = write_file(folder + "/render.svg", *svg); !written) return written;
    html.svg(*svg,
             "Every combination of step, bisections, finish, rays a pixel and resolution. Numbers refer to the points of the Pareto front "
             "in the table "
             "below; FLIP is shown for the same points. FLIP: 67 pixels a degree.");
    add_pareto_fronts(html, cost);
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
