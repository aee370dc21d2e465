// What depends on the edge of the volume: the same plate is drilled in volumes of 64 to 2048 voxels per edge.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "app/bench/areas.h"
#include "app/bench/growth_run.h"
#include "app/bench/stopwatch.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

constexpr int kBaseline = 256, kQuickBaseline = 128;  // [voxels]
constexpr int kSparse = 2048;                         // [voxels] with the bar for memory
constexpr double kSparseMemory = 4.0;                 // [GiB]
constexpr int kRounds = 3;
constexpr double kMegabyte = 1e6, kGibi = 1024.0 * 1024.0 * 1024.0;
// [N] An index coordinate below 2048 is rounded by 2^-43 voxel edges, which is 3e-17 m. The coupling has less than 1e5 N/m: 3e-12 N for each
// of some hundred roundings before the force settles.
constexpr double kForceTolerance = 1e-9;
// [m^3] Sums of float remainders times the volume of a voxel, 1.6e-11 m^3, each rounded by 6e-8: some thousand of them may differ.
constexpr double kMassTolerance = 1e-14;

/// A cost that rows and plot show.
struct Quantity {
  const char *name, *unit;
  double per_unit;  // factor from SI to the unit
  double GrowthRun::*member;
  const char* colour;  // of its line in the plot; null: not plotted
  int point;           // of gnuplot
  bool of_start = false;
};
constexpr std::array kQuantities{
    Quantity{"contact tick", "us", 1e6, &GrowthRun::contact, kPlotBlue, 6},
    Quantity{"bone step", "ms", 1e3, &GrowthRun::bone_step, kPlotOrange, 4},
    Quantity{"publishing", "us", 1e6, &GrowthRun::publishing, kPlotGreen, 8},
    Quantity{"undo", "CPU-ms", 1e3, &GrowthRun::undo, kPlotViolet, 10},
    Quantity{"drilling", "CPU-ms", 1e3, &GrowthRun::drilling, nullptr, 0},
    Quantity{"texels of a bone step", "CPU-ms", 1e3, &GrowthRun::texels, kPlotGrey, 12},
    Quantity{"picture", "CPU-ms", 1e3, &GrowthRun::picture, kPlotGrey, 5},
    Quantity{"first picture", "CPU-s", 1.0, &GrowthRun::first, kPlotBlue, 7, true},
    Quantity{"load", "CPU-s", 1.0, &GrowthRun::load, kPlotOrange, 9, true},
    Quantity{"bone model", "MB", 1.0 / kMegabyte, &GrowthRun::model_bytes, nullptr, 0},
    Quantity{"peak memory of drilling", "MB", 1.0 / kMegabyte, &GrowthRun::peak, kPlotGreen, 11, true},
    Quantity{"peak memory with pictures", "MB", 1.0 / kMegabyte, &GrowthRun::peak_drawn, kPlotViolet, 13, true},
};

struct Volume {
  int edge = 0;                 // [voxels]
  std::vector<GrowthRun> runs;  // one per round

  [[nodiscard]] double cost(const Quantity& quantity) const {
    std::vector<double> values;
    for (const GrowthRun& run : runs) values.push_back(run.*quantity.member);
    return median(std::move(values));
  }
};

/// @returns the values, each replaced by that of the baseline if they differ by at most the tolerance.
std::vector<double> within(double tolerance, const std::vector<double>& baseline, std::vector<double> values) {
  for (std::size_t n = 0; n < std::min(values.size(), baseline.size()); ++n)
    if (std::abs(values[n] - baseline[n]) <= tolerance) values[n] = baseline[n];
  return values;
}

/// The tool must do the same in both volumes, and undo must restore both.
bool results_agree(Bench& bench, const std::string& name, const GrowthRun& baseline, const GrowthRun& run) {
  return bench.require(name, run.removed > 0.0, "no bone was removed") &&
         bench.require(name, run.hashes.size() == 2 && run.hashes[0] != run.hashes[1], "nothing was undone") &&
         bench.agree(name + ": bone", bytes_of(baseline.hashes), bytes_of(run.hashes)) &&
         bench.agree(name + ": forces", bytes_of(baseline.forces), bytes_of(within(kForceTolerance, baseline.forces, run.forces))) &&
         bench.agree(name + ": removed bone", bytes_of(std::vector{baseline.removed}),
                     bytes_of(within(kMassTolerance, {baseline.removed}, {run.removed})));
}

bool runs_agree(Bench& bench, const Volume& baseline, const Volume& volume) {
  const std::string name = fmt::format("{} voxels per edge", volume.edge);
  return std::ranges::all_of(volume.runs, [&](const GrowthRun& run) { return results_agree(bench, name, baseline.runs.front(), run); });
}

void add_rows(Bench& bench, const Volume& baseline, const Volume& volume) {
  for (const Quantity& quantity : kQuantities)
    bench.add_cost(fmt::format("{}: {} over {} voxels per edge", quantity.name, volume.edge, baseline.edge), quantity.unit,
                   quantity.per_unit, {.baseline = baseline.cost(quantity), .value = volume.cost(quantity)});
  if (volume.edge != kSparse) return;
  double peak = 0.0;
  for (const GrowthRun& run : volume.runs) peak = std::max(peak, run.peak_drawn);
  bench.add_absolute(fmt::format("{} voxels per edge, drilled and drawn: peak memory", volume.edge), "GiB", peak / kGibi, true,
                     {.ship = kSparseMemory, .aim = {}});
}

/// Two panels: costs of drilling and drawing, then those of the start.
Plot make_plot(const std::vector<Volume>& volumes) {
  Plot plot{.x_label = "voxels per edge", .panels = std::vector<PlotPanel>(2), .events = {}};
  for (PlotPanel& panel : plot.panels) panel.y_label = fmt::format("over {} voxels per edge [-]", volumes.front().edge);
  plot.panels[0].y_range = {0.7, 100.0};
  plot.panels[1].y_range = {0.7, 1000.0};
  for (const Quantity& quantity : kQuantities) {
    if (quantity.colour == nullptr) continue;
    PlotSeries series{.name = quantity.name, .x = {}, .y = {}, .style = linked_point_style(quantity.colour, quantity.point)};
    for (const Volume& volume : volumes) {
      series.x.push_back(volume.edge);
      series.y.push_back(volume.cost(quantity) / volumes.front().cost(quantity));
    }
    plot.panels[quantity.of_start ? 1 : 0].series.push_back(std::move(series));
  }
  plot.panel_height_px = 260;
  plot.log_x = plot.log_y = true;
  return plot;
}

/// Runs all volumes, interleaved, so that other load of the machine affects all alike.
Result<std::vector<Volume>> run_volumes(const Bench& bench) {
  std::vector<Volume> out;
  for (const int edge : growth_edges())
    if (!bench.quick() || edge <= kQuickBaseline) out.push_back({.edge = edge, .runs = {}});
  for (int round = 0; round < (bench.quick() ? 1 : kRounds); ++round)
    for (Volume& volume : out) {
      auto run = run_growth_apart(volume.edge, bench.quick());
      if (!run) return run.error();
      volume.runs.push_back(std::move(run).value());
    }
  return out;
}

}  // namespace

std::vector<int> growth_edges() { return {64, 128, 256, 512, 1024, kSparse}; }

Status bench_growth(Bench& bench) {
  const auto volumes = run_volumes(bench);
  if (!volumes) return volumes.error();
  const int edge = bench.quick() ? kQuickBaseline : kBaseline;
  const Volume& baseline = *std::ranges::find(*volumes, edge, &Volume::edge);
  for (const Volume& volume : *volumes)
    if (volume.edge != edge && runs_agree(bench, baseline, volume)) add_rows(bench, baseline, volume);
  if (bench.quick() || !bench.disagreements().empty()) return {};
  if (const Status drawn = write_svg(make_plot(*volumes), bench.folder() + "/growth.svg"); !drawn)
    fmt::print(stderr, "bench: growth.svg: {}\n", drawn.error().text());  // the rows do not need gnuplot
  return {};
}

}  // namespace burrhole
