#include <algorithm>

#include "app/lab/contact_accuracy.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

/// Contents of a panel: one error, on some bones, against depth.
struct PanelChoice {
  std::string error_name;
  std::string y_label;
  bool plates = true;  ///< or the curved bones and those with edges
  bool noisy = false;
};

/// One line per bone, for the first tool in the table.
PlotPanel error_panel(const std::vector<CostRow>& rows, const PanelChoice& choice) {
  PlotPanel panel;
  panel.y_label = choice.y_label;
  panel.from_zero = true;
  const std::string tool = rows.front().subject.substr(0, rows.front().subject.find(" on "));
  for (const CostRow& row : rows) {
    if (row.error_name != choice.error_name || row.model != "gradient-plane, words" || !row.subject.starts_with(tool + " on ")) continue;
    const std::string bone = row.subject.substr(tool.size() + 4);
    if (bone.starts_with("plate") != choice.plates || (bone.find("noise") != std::string::npos) != choice.noisy) continue;
    auto series = std::find_if(panel.series.begin(), panel.series.end(), [&](const PlotSeries& s) { return s.name == bone; });
    if (series == panel.series.end()) series = panel.series.insert(series, PlotSeries{bone, {}, {}});
    series->x.push_back(row.setting);
    series->y.push_back(row.error);
  }
  return panel;
}

Plot error_plot(const std::vector<CostRow>& rows) {
  Plot plot;
  plot.x_label = "depth of the tip [voxel]";
  plot.panel_height_px = 220;
  for (const PanelChoice& choice : {PanelChoice{"own_law_worst_length", "off its law, plates [voxel]", true, false},
                                    PanelChoice{"own_law_worst_length", "the same, noisy [voxel]", true, true},
                                    PanelChoice{"own_law_worst_length", "off its law, curved [voxel]", false, false},
                                    PanelChoice{"translation_median", "off k x translation distance, plates [%]", true, false}}) {
    PlotPanel panel = error_panel(rows, choice);
    if (!panel.series.empty()) plot.panels.push_back(std::move(panel));
  }
  return plot;
}

Plot force_plot(const std::vector<ForceCurve>& curves) {
  Plot plot;
  plot.x_label = "depth of the tip [mm]";
  plot.panel_height_px = 240;
  for (const ForceCurve& curve : curves) {
    PlotPanel panel;
    panel.y_label = curve.tool + " [N]";
    panel.from_zero = true;
    // The first two coincide: the wider one is seen on both sides of the narrower one.
    panel.series = {{"gradient-plane", curve.depth_mm, curve.model_N, line_style(kPlotBlue, "1", 5.0)},
                    {"average of exact depths", curve.depth_mm, curve.law_N, line_style(kPlotOrange, "1", 1.6)},
                    {"k x translation distance", curve.depth_mm, curve.translation_N, line_style(kPlotGreen, "(8,4)", 5.0)},
                    {"mesh", curve.depth_mm, curve.mesh_N, line_style(kPlotViolet, "1", 1.6)}};
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace

Status write_contact_accuracy(const std::vector<CostRow>& rows, const std::vector<ForceCurve>& curves, const std::string& folder) {
  if (rows.empty()) return Error{ErrorCode::internal, "there are no rows to write", {}};
  if (const Status written = write_cost_csv(rows, folder + "/cost.csv"); !written) return written;
  if (const Status drawn = write_svg(error_plot(rows), folder + "/contact_error.svg"); !drawn) return drawn;
  return write_svg(force_plot(curves), folder + "/contact_force.svg");
}

}  // namespace burrhole
