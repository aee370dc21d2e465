#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "app/lab/mesh_cost.h"
#include "app/report/file.h"
#include "app/report/html.h"
#include "app/report/plot.h"

namespace burrhole {
namespace {

constexpr std::array<const char*, kMeshKinds> kKinds{"pivoting, centres", "pivoting, sub-voxel", "volumeToMesh", "surface nets",
                                                     "surface nets, moved"};
constexpr std::array<const char*, kMeshKinds> kColours{kPlotBlue, kPlotGreen, kPlotOrange, kPlotGrey, kPlotViolet};
constexpr double kMegabyte = 1e6;

using Cells = std::vector<std::vector<std::string>>;

std::vector<std::string> quality_heads() {
  return {"body",
          "mesh",
          "triangles",
          "border edges",
          "non-manifold edges",
          "least angle [deg]",
          "below 20 deg [%]",
          "volume [%]",
          "to surface: mean",
          "p99",
          "max [voxel]",
          "from surface: mean",
          "p99",
          "max [voxel]"};
}

Cells quality_cells(const MeshCost& cost) {
  Cells out;
  for (const MeshQuality& q : cost.qualities)
    out.push_back({q.body, kKinds[static_cast<std::size_t>(q.kind)], fmt::format("{}", q.shape.triangles),
                   fmt::format("{}", q.shape.border_edges), fmt::format("{}", q.shape.non_manifold_edges),
                   fmt::format("{:.1f}", q.shape.least_angle_deg), fmt::format("{:.2f}", q.shape.below_20_percent),
                   fmt::format("{:+.2f}", q.volume_percent), fmt::format("{:.4f}", q.to_surface.mean),
                   fmt::format("{:.3f}", q.to_surface.p99), fmt::format("{:.3f}", q.to_surface.most),
                   fmt::format("{:.4f}", q.from_surface.mean), fmt::format("{:.3f}", q.from_surface.p99),
                   fmt::format("{:.3f}", q.from_surface.most)});
  return out;
}

std::vector<std::string> time_heads(const MeshCost& cost) {
  std::vector<std::string> out{"method"};
  for (const MeshModelTimes& model : cost.models) out.push_back(fmt::format("{}^3 [ms]", model.edge));
  out.emplace_back("longest over shortest");
  for (const MeshModelTimes& model : cost.models) out.push_back(fmt::format("{}^3 [MB]", model.edge));
  return out;
}

Cells time_cells(const MeshCost& cost) {
  Cells out;
  for (std::size_t method = 0; method < kMeshMethods.size(); ++method) {
    std::vector<std::string>& line = out.emplace_back();
    line.emplace_back(kMeshMethods[method].name);
    double longest = 0.0, shortest = 1e300;
    for (const MeshModelTimes& model : cost.models) {
      const double time = model.methods[method].update_ms;
      longest = std::max(longest, time);
      shortest = std::min(shortest, time);
      line.push_back(fmt::format("{:.3g}", time));
    }
    line.push_back(fmt::format("{:.3g}", longest / shortest));
    for (const MeshModelTimes& model : cost.models) line.push_back(fmt::format("{:.3g}", model.methods[method].bytes / kMegabyte));
  }
  return out;
}

Cells bound_cells(const MeshCost& cost) {
  Cells out;
  for (const MeshBound& bound : mesh_bounds(cost))
    out.push_back({bound.name, fmt::format("{:.3g}", bound.value),
                   fmt::format("{} {:g}", bound.at_least ? "at least" : "at most", bound.bound), bound.pass() ? "yes" : "no"});
  return out;
}
const std::vector<std::string> kBoundHeads{"ratio", "value", "bound", "kept"};

const MeshModelTimes& priced_model(const MeshCost& cost) {
  const auto found = std::ranges::find(cost.models, kBoundEdge, &MeshModelTimes::edge);
  return found == cost.models.end() ? cost.models.back() : *found;
}

/// Error of the mesh of one body against the time of an update, and what no other method surpasses in both.
PlotPanel price_panel(const MeshCost& cost, const std::string& body) {
  const MeshModelTimes& model = priced_model(cost);
  PlotPanel panel;
  panel.title = body;
  panel.y_label = "mean distance to the true surface [voxel]";
  double low = 1e300, high = 0.0, first = 1e300, last = 0.0;
  for (std::size_t method = 0; method < kMeshMethods.size(); ++method)
    for (const MeshQuality& q : cost.qualities) {
      if (q.body != body || q.kind != kMeshMethods[method].kind) continue;
      const double time = model.methods[method].update_ms, error = q.to_surface.mean;
      const auto colour = kColours[static_cast<std::size_t>(q.kind)];
      panel.series.push_back(
          {"", {time}, {error}, point_style(colour, kMeshMethods[method].is_local ? 7 : 6, 1.1), {kMeshMethods[method].label}});
      low = std::min(low, error);
      high = std::max(high, error);
      first = std::min(first, time);
      last = std::max(last, time);
    }
  panel.x_range = {0.5 * first, 8.0 * last};
  panel.y_range = {0.5 * low, 2.0 * high};
  return panel;
}

Plot price_plot(const MeshCost& cost) {
  Plot plot;
  plot.x_label = fmt::format("time of an update of 20^3 voxels in {}^3 [ms]", priced_model(cost).edge);
  plot.width_px = 1100;
  plot.panel_height_px = 330;
  plot.columns = 2;
  plot.log_x = plot.log_y = true;
  std::vector<std::string> bodies;
  for (const MeshQuality& q : cost.qualities)
    if (std::ranges::find(bodies, q.body) == bodies.end()) bodies.push_back(q.body);
  for (const std::string& body : bodies) plot.panels.push_back(price_panel(cost, body));
  return plot;
}

Plot growth_plot(const MeshCost& cost) {
  Plot plot;
  plot.x_label = "edge of the model [voxels]";
  plot.width_px = 900;
  plot.panel_height_px = 420;
  plot.columns = 1;
  plot.log_x = plot.log_y = true;
  plot.legend = "above";
  PlotPanel panel;
  panel.title = "an update of 20^3 voxels by the size of the model; dashed: the whole is meshed";
  panel.y_label = "time of an update [ms]";
  panel.x_range = {0.85 * cost.models.front().edge, 1.18 * cost.models.back().edge};
  double low = 1e300, high = 0.0;
  for (std::size_t method = 0; method < kMeshMethods.size(); ++method) {
    const MeshMethod& one = kMeshMethods[method];
    PlotSeries curve{one.name, {}, {}, line_style(kColours[static_cast<std::size_t>(one.kind)], one.is_local ? "1" : "(6,3)", 2.0)};
    for (const MeshModelTimes& model : cost.models) {
      curve.x.push_back(model.edge);
      curve.y.push_back(model.methods[method].update_ms);
      low = std::min(low, curve.y.back());
      high = std::max(high, curve.y.back());
    }
    panel.series.push_back(std::move(curve));
  }
  panel.y_range = {0.5 * low, 2.0 * high};
  plot.panels.push_back(std::move(panel));
  return plot;
}

}  // namespace

std::vector<CostRow> mesh_cost_rows(const MeshCost& cost) {
  std::vector<CostRow> rows;
  const auto figure = [&](const MeshQuality& q, const char* name, const char* unit, double value) {
    rows.push_back({.subject = "mesh of the " + q.body,
                    .model = kKinds[static_cast<std::size_t>(q.kind)],
                    .knob = "",
                    .setting = 0.0,
                    .error_name = name,
                    .error = value,
                    .unit = unit,
                    .reference = q.truth});
  };
  for (const MeshQuality& q : cost.qualities) {
    figure(q, "triangles", "-", static_cast<double>(q.shape.triangles));
    figure(q, "border_edges", "-", static_cast<double>(q.shape.border_edges));
    figure(q, "non_manifold_edges", "-", static_cast<double>(q.shape.non_manifold_edges));
    figure(q, "least_angle", "deg", q.shape.least_angle_deg);
    figure(q, "below_20_deg", "%", q.shape.below_20_percent);
    figure(q, "volume_off", "%", q.volume_percent);
    figure(q, "to_surface_mean", "voxel", q.to_surface.mean);
    figure(q, "to_surface_p99", "voxel", q.to_surface.p99);
    figure(q, "to_surface_worst", "voxel", q.to_surface.most);
    figure(q, "from_surface_mean", "voxel", q.from_surface.mean);
    figure(q, "from_surface_p99", "voxel", q.from_surface.p99);
    figure(q, "from_surface_worst", "voxel", q.from_surface.most);
  }
  for (const MeshModelTimes& model : cost.models)
    for (std::size_t method = 0; method < kMeshMethods.size(); ++method) {
      const MeshTime& time = model.methods[method];
      rows.push_back({.subject = "update of 20^3 voxels",
                      .model = kMeshMethods[method].name,
                      .knob = "model_edge_voxels",
                      .setting = static_cast<double>(model.edge),
                      .error_name = "update_time",
                      .error = time.update_ms,
                      .unit = "ms",
                      .reference = "",
                      .median_us = 1e3 * time.update_ms,
                      .p99_us = 1e3 * time.p99_ms,
                      .bytes = time.bytes});
    }
  return rows;
}

std::string mesh_cost_tables(const MeshCost& cost) {
  std::string out = markdown_table(quality_heads(), quality_cells(cost));
  if (!cost.models.empty())
    out += "\n" + markdown_table(time_heads(cost), time_cells(cost)) + "\n" + markdown_table(kBoundHeads, bound_cells(cost));
  return out;
}

std::string mesh_cost_json(const MeshCost& cost) {
  using Json = nlohmann::ordered_json;
  const std::vector<MeshBound> bounds = cost.models.empty() ? std::vector<MeshBound>{} : mesh_bounds(cost);
  const bool failed = std::ranges::any_of(bounds, [](const MeshBound& bound) { return !bound.pass(); });
  Json out{{"schema", "burrhole.cost_mesh/1"}, {"failed", failed}, {"rows", Json::array()}, {"bounds", Json::array()}};
  for (const CostRow& row : mesh_cost_rows(cost))
    out["rows"].push_back({{"subject", row.subject},
                           {"model", row.model},
                           {"knob", row.knob},
                           {"setting", row.setting},
                           {"error_name", row.error_name},
                           {"error", row.error},
                           {"unit", row.unit},
                           {"reference", row.reference},
                           {"median_us", row.median_us},
                           {"p99_us", row.p99_us},
                           {"bytes", row.bytes}});
  for (const MeshBound& bound : bounds)
    out["bounds"].push_back(
        {{"ratio", bound.name}, {"value", bound.value}, {"bound", bound.bound}, {"at_least", bound.at_least}, {"pass", bound.pass()}});
  return out.dump(2) + "\n";
}

Status write_mesh_cost(const MeshCost& cost, const std::string& folder) {
  if (const Status written = write_cost_csv(mesh_cost_rows(cost), folder + "/cost.csv"); !written) return written;
  if (const Status written = write_file(folder + "/mesh.md", mesh_cost_tables(cost)); !written) return written;
  const auto price = draw_svg(price_plot(cost));
  if (!price) return price.error();
  if (const Status written = write_file(folder + "/mesh.svg", *price); !written) return written;
  const auto growth = draw_svg(growth_plot(cost));
  if (!growth) return growth.error();
  if (const Status written = write_file(folder + "/mesh_growth.svg", *growth); !written) return written;
  HtmlPage html("The price of a mesh", "Accuracy of a mesh of bone against the time of an update while bone is removed");
  html.svg(*price,
           "Mean distance from the mesh to the true surface against the time of an update. Filled: reads the changed box only; open: the "
           "whole.");
  html.svg(*growth, "CPU time of one thread, medians; all methods and sizes interleaved.");
  html.heading("Accuracy and shape");
  html.table(quality_heads(), quality_cells(cost));
  html.heading("Time of an update, and memory");
  html.table(time_heads(cost), time_cells(cost));
  html.heading("Bounds");
  html.table(kBoundHeads, bound_cells(cost));
  return write_file(folder + "/mesh.html", html.text());
}

}  // namespace burrhole
