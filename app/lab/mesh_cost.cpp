#include "app/lab/mesh_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>

#include "app/lab/local_net.h"
#include "app/lab/mesh_bodies.h"
#include "app/lab/vdb_mesher.h"
#include "core/mesh/ball_mesh.h"

namespace burrhole {
namespace {

constexpr std::size_t kQualityFigures = 12;
constexpr std::size_t kModelFigures = 3 * kMeshMethods.size() + 2;
enum Method : std::size_t { kUpdate, kUpdateSurface, kFull, kFullSurface, kContours, kContoursBox, kNet, kNetMoved };

Result<BallMesh> make_ball_mesh(const VoxelBox& box, bool subvoxel) { return BallMesh::create(box, {.subvoxel = subvoxel}); }

/// @returns the mesh of a body after the update.
Result<SurfaceMesh> mesh_of(const MeshBody& body, MeshKind kind) {
  if (kind == MeshKind::contours) {
    VdbMesher mesher(body.block_after());
    mesher.extract();
    return mesher.surface();
  }
  if (kind == MeshKind::net || kind == MeshKind::net_moved) {
    LocalNet net(body.box, kind == MeshKind::net_moved);
    net.fill(body.block_before());
    net.update(body.block_after(), body.changed);
    return net.surface();
  }
  auto mesh = make_ball_mesh(body.box, kind == MeshKind::ball_surface);
  if (!mesh) return mesh.error();
  mesh->fill(body.block_before());
  mesh->update(body.block_after(), body.changed);
  return mesh->surface();
}

/// Figures of all kinds of mesh of a body: kQualityFigures each.
Result<Study::Figures> measure_body(const std::string& name) {
  const auto body = make_mesh_body(name);
  if (!body) return body.error();
  const std::vector<KnownPoint> points = sample_surface(body->surface);
  Study::Figures out;
  for (std::size_t kind = 0; kind < kMeshKinds; ++kind) {
    const auto mesh = mesh_of(*body, static_cast<MeshKind>(kind));
    if (!mesh) return mesh.error();
    if (mesh->indices.empty()) return Error{ErrorCode::internal, "no triangle in the mesh of the " + name, {}};
    const MeshShape shape = measure_mesh_shape(*mesh);
    const MeshDistance to = distance_to_surface(*mesh, body->surface, points), from = distance_to_mesh(points, *mesh);
    for (const double figure : {static_cast<double>(shape.triangles), static_cast<double>(shape.border_edges),
                                static_cast<double>(shape.non_manifold_edges), 100.0 * (shape.volume / body->volume - 1.0),
                                shape.least_angle_deg, shape.below_20_percent, to.mean, to.p99, to.most, from.mean, from.p99, from.most})
      out.push_back(figure);
  }
  return out;
}

/// A model with a mesh of each method.
class TimedModel {
 public:
  [[nodiscard]] static Result<std::unique_ptr<TimedModel>> create(int edge) {
    auto out = std::unique_ptr<TimedModel>(new TimedModel(edge));
    for (const bool subvoxel : {false, true}) {
      auto mesh = make_ball_mesh(out->model_.box, subvoxel), full = make_ball_mesh(out->model_.box, subvoxel);
      if (!mesh) return mesh.error();
      if (!full) return full.error();
      mesh->fill(out->model_.block());
      out->meshes_.push_back(std::move(mesh).value());
      out->full_.push_back(std::move(full).value());
    }
    for (LocalNet& net : out->nets_) net.fill(out->model_.block());
    return out;
  }

  void time(std::size_t method) {
    model_.set_before();
    if (kMeshMethods[method].is_local) act(method);
    if (method == kContours) vdb_.write(model_.block(), model_.changed);
    model_.set_after();
    const std::uint64_t touched = meshes_[0].work().triangles_touched();
    const double start = cpu_now();
    act(method);
    times_[method].push_back(1e3 * (cpu_now() - start));
    if (method == kUpdate) touched_ = static_cast<double>(meshes_[0].work().triangles_touched() - touched);
    // Sizes while this method's mesh is the last that was made.
    bytes_[method] = static_cast<double>(bytes_of(method));
  }

  void report(Study::Figures& out) const {
    for (const std::vector<double>& times : times_) out.push_back(at_share(times, 0.5));
    for (const std::vector<double>& times : times_) out.push_back(at_share(times, 0.99));
    for (const double bytes : bytes_) out.push_back(bytes);
    out.push_back(static_cast<double>(full_[0].half_edges().triangles()));
    out.push_back(touched_);
  }

 private:
  explicit TimedModel(int edge)
      : model_(make_mesh_model(edge)), vdb_(model_.block()), nets_{LocalNet(model_.box, false), LocalNet(model_.box, true)} {}

  void act(std::size_t method) {
    const DensityBlock block = model_.block();
    switch (method) {
      case kUpdate:
      case kUpdateSurface:
        return meshes_[method - kUpdate].update(block, model_.changed);
      case kFull:
      case kFullSurface:
        return full_[method - kFull].fill(block);
      case kContours:
        vdb_.write(block, model_.changed);
        return vdb_.extract();
      case kContoursBox:
        return vdb_.extract_box(block, model_.changed);
      default:
        return nets_[method - kNet].update(block, model_.changed);
    }
  }

  [[nodiscard]] std::size_t bytes_of(std::size_t method) const {
    switch (method) {
      case kUpdate:
      case kUpdateSurface:
        return meshes_[method - kUpdate].bytes();
      case kFull:
      case kFullSurface:
        return full_[method - kFull].bytes();
      case kContours:
      case kContoursBox:
        return vdb_.bytes();
      default:
        return nets_[method - kNet].bytes();
    }
  }

  MeshModel model_;
  VdbMesher vdb_;
  std::array<LocalNet, 2> nets_;
  std::vector<BallMesh> meshes_, full_;  // at the centres, sub-voxel
  std::array<std::vector<double>, kMeshMethods.size()> times_;
  std::array<double, kMeshMethods.size()> bytes_{};
  double touched_ = 0.0;
};

/// Figures of all sizes, kModelFigures each. Sizes and methods are interleaved, so that load of the machine is in all of them.
Result<Study::Figures> measure_times(const MeshCostOptions& options) {
  std::vector<std::unique_ptr<TimedModel>> models;
  for (const int edge : options.edges) {
    auto model = TimedModel::create(edge);
    if (!model) return model.error();
    models.push_back(std::move(model).value());
  }
  for (int round = 0; round < std::max(options.updates, options.wholes); ++round)
    for (const auto& model : models)
      for (std::size_t method = 0; method < kMeshMethods.size(); ++method)
        if (round < (kMeshMethods[method].is_local ? options.updates : options.wholes)) model->time(method);
  Study::Figures out;
  for (const auto& model : models) model->report(out);
  return out;
}

std::vector<std::string> bodies_of(const MeshCostOptions& options) { return options.bodies.empty() ? mesh_body_names() : options.bodies; }

void add_body(const std::string& name, const Study::Figures& figures, MeshCost& out) {
  const double* next = figures.data();
  for (std::size_t kind = 0; kind < kMeshKinds; ++kind, next += kQualityFigures)
    out.qualities.push_back({.body = name,
                             .truth = name == "patch" ? "0.5 level of the trilinear density" : "closed form",
                             .kind = static_cast<MeshKind>(kind),
                             .shape = {.triangles = static_cast<std::size_t>(next[0]),
                                       .border_edges = static_cast<std::size_t>(next[1]),
                                       .non_manifold_edges = static_cast<std::size_t>(next[2]),
                                       .least_angle_deg = next[4],
                                       .below_20_percent = next[5]},
                             .volume_percent = next[3],
                             .to_surface = {next[6], next[7], next[8]},
                             .from_surface = {next[9], next[10], next[11]}});
}

void add_models(const std::vector<int>& edges, const Study::Figures& figures, MeshCost& out) {
  constexpr std::size_t kCount = kMeshMethods.size();
  const double* next = figures.data();
  for (const int edge : edges) {
    MeshModelTimes model{.edge = edge};
    for (std::size_t n = 0; n < kCount; ++n) model.methods[n] = {next[n], next[kCount + n], next[2 * kCount + n]};
    model.triangles = next[3 * kCount];
    model.touched = next[3 * kCount + 1];
    out.models.push_back(model);
    next += kModelFigures;
  }
}

}  // namespace

MeshCostOptions quick_mesh_cost() { return {.bodies = {}, .edges = {64, 128, 256}, .updates = 11, .wholes = 3}; }

std::size_t count_of_trials(const MeshCostOptions& options) { return bodies_of(options).size() + (options.edges.empty() ? 0 : 1); }

Result<MeshCost> measure_mesh_cost(const MeshCostOptions& options) {
  Study own({}, count_of_trials(options));
  Study& study = options.study != nullptr ? *options.study : own;
  MeshCost out;
  for (const std::string& name : bodies_of(options)) {
    StudyTrial trial{.key = {}, .name = "mesh of the " + name, .figures = kMeshKinds * kQualityFigures};
    trial.key.add("mesh").add(name);
    const auto figures = study.run(trial, [&] { return measure_body(name); });
    if (!figures) return figures.error();
    add_body(name, *figures, out);
  }
  if (options.edges.empty()) return out;
  StudyTrial trial{.key = {}, .name = "times of updates", .figures = options.edges.size() * kModelFigures};
  trial.key.add("mesh times").add(options.updates).add(options.wholes);
  for (const int edge : options.edges) trial.key.add(edge);
  const auto figures = study.run(trial, [&] { return measure_times(options); });
  if (!figures) return figures.error();
  add_models(options.edges, *figures, out);
  return out;
}

std::vector<MeshBound> mesh_bounds(const MeshCost& cost) {
  std::vector<MeshBound> out;
  for (const std::size_t update : {std::size_t{kUpdate}, std::size_t{kUpdateSurface}}) {
    const std::size_t full = update - kUpdate + kFull;
    const char* name = kMeshMethods[update].name;
    double longest = 0.0, shortest = 1e300;
    for (const MeshModelTimes& model : cost.models) {
      const double time = model.methods[update].update_ms, time_full = model.methods[full].update_ms;
      longest = std::max(longest, time);
      shortest = std::min(shortest, time);
      if (model.edge != kBoundEdge) continue;
      out.push_back({fmt::format("{}: full pivoting over an update, {}^3", name, kBoundEdge), time_full / time, 50.0, true});
      out.push_back({fmt::format("{}: time per touched triangle over that of full pivoting, {}^3", name, kBoundEdge),
                     (time / model.touched) / (time_full / model.triangles), 1.3, false});
    }
    out.push_back({fmt::format("{}: longest over shortest update, {}^3 to {}^3", name, cost.models.front().edge, cost.models.back().edge),
                   longest / shortest, 1.5, false});
  }
  return out;
}

}  // namespace burrhole
