#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/lab/sliding.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

/// One line per model, at one depth, of one figure.
PlotPanel panel_of(const std::vector<SlidingRow>& rows, double depth_voxel, const std::string& label, double (*figure)(const SlidingRow&)) {
  PlotPanel panel;
  panel.y_label = label;
  panel.from_zero = true;
  for (const SlidingRow& row : rows) {
    if (row.depth_voxel != depth_voxel) continue;
    auto series = std::find_if(panel.series.begin(), panel.series.end(), [&](const PlotSeries& s) { return s.name == row.model; });
    if (series == panel.series.end()) series = panel.series.insert(series, PlotSeries{row.model, {}, {}});
    series->x.push_back(row.tilt_deg);
    series->y.push_back(figure(row));
  }
  return panel;
}

}  // namespace

std::vector<CostRow> sliding_cost_rows(const std::vector<SlidingRow>& rows, const std::string& tool) {
  std::vector<CostRow> out;
  for (const SlidingRow& row : rows) {
    CostRow common;
    common.subject = fmt::format("sliding, {}, {:g} voxel deep", tool, row.depth_voxel);
    common.model = row.model;
    common.knob = "tilt_deg";
    common.setting = row.tilt_deg;
    common.median_us = row.median_us;
    common.p99_us = row.p99_us;
    const auto add = [&](const char* name, double error, const char* unit, const char* reference) {
      common.error_name = name;
      common.error = error;
      common.unit = std::string(unit);
      common.reference = reference;
      out.push_back(common);
    };
    add("mean_force_off", row.mean_N - row.true_N, "N", "k x closed-form translation distance along the normal");
    add("largest_step", row.largest_step_N, "N", "the force a step before");
    add("rms_step", row.rms_step_N, "N", "the force a step before");
    add("ripple", row.ripple, "-", "mean force along the normal");
  }
  return out;
}

Status write_sliding(const std::vector<SlidingRow>& rows, const std::string& folder) {
  if (rows.empty()) return Error{ErrorCode::internal, "there are no rows to draw", {}};
  Plot plot;
  plot.x_label = "tilt of the plate [deg]";
  plot.panel_height_px = 220;
  std::vector<double> depths;
  for (const SlidingRow& row : rows)
    if (std::find(depths.begin(), depths.end(), row.depth_voxel) == depths.end()) depths.push_back(row.depth_voxel);
  for (const double depth : depths) {
    // NaN if a model has no force: its line is interrupted.
    plot.panels.push_back(panel_of(rows, depth, fmt::format("step over mean, {:g} voxel deep [-]", depth), [](const SlidingRow& row) {
      return row.mean_N > 0.0 ? row.largest_step_N / row.mean_N : std::numeric_limits<double>::quiet_NaN();
    }));
    plot.panels.push_back(
        panel_of(rows, depth, fmt::format("ripple, {:g} voxel deep [-]", depth), [](const SlidingRow& row) { return row.ripple; }));
  }
  return write_svg(plot, folder + "/sliding.svg");
}

}  // namespace burrhole
