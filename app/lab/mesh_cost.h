/// app/lab/mesh_cost.h: the price of a mesh of bone that follows drilling: accuracy and shape of the mesh, time of an update, memory.
///   Methods   ball pivoting (core/mesh) by updates and anew, OpenVDB's volumeToMesh of the whole and of the changed box, surface nets of the changed
///     box (local_net.h).
///   Units   in the names.   Errors   those of a phantom and of a study; unavailable without gnuplot.
///   Thread  one; times are CPU times of this thread, and all that are compared are of the same call, interleaved.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/mesh_measures.h"
#include "app/lab/study.h"

namespace burrhole {

/// A mesh, as its triangles are; methods that make the same one share it.
enum class MeshKind : std::size_t { ball_centres, ball_surface, contours, net, net_moved };
inline constexpr std::size_t kMeshKinds = 5;

struct MeshMethod {
  const char* name;
  const char* label;  ///< in the plot
  MeshKind kind;
  bool is_local;  ///< reads the changed box only
};
inline constexpr std::array<MeshMethod, 8> kMeshMethods{
    {{"pivoting, centres", "pivot", MeshKind::ball_centres, true},
     {"pivoting, sub-voxel", "pivot sub-voxel", MeshKind::ball_surface, true},
     {"full pivoting, centres", "full pivot", MeshKind::ball_centres, false},
     {"full pivoting, sub-voxel", "full pivot sub-voxel", MeshKind::ball_surface, false},
     {"volumeToMesh", "volumeToMesh", MeshKind::contours, false},
     {"volumeToMesh, box", "volumeToMesh box", MeshKind::contours, true},
     {"surface nets, box", "nets", MeshKind::net, true},
     {"surface nets moved, box", "nets moved", MeshKind::net_moved, true}}};

/// Of one mesh of one body, after bone was removed by an update.
struct MeshQuality {
  std::string body, truth;
  MeshKind kind{};
  MeshShape shape;
  double volume_percent = 0.0;  ///< error of the volume [%]
  MeshDistance to_surface;      ///< [voxel] from the mesh to the true surface
  MeshDistance from_surface;    ///< [voxel] from the true surface to the mesh
};

/// Of one method and one size of model.
struct MeshTime {
  double update_ms = 0.0;  ///< median
  double p99_ms = 0.0;     ///< the largest, with less than a hundred updates
  double bytes = 0.0;      ///< [bytes] mesh and what the method keeps beside the density
};
struct MeshModelTimes {
  int edge = 0;  ///< [voxels]
  std::array<MeshTime, kMeshMethods.size()> methods{};
  double triangles = 0.0;  ///< [-] of the whole, by ball pivoting
  double touched = 0.0;    ///< [-] removed and added by an update of it
};

struct MeshCost {
  std::vector<MeshQuality> qualities;  ///< body by body, kinds in their order
  std::vector<MeshModelTimes> models;  ///< sizes ascending
};

struct MeshCostOptions {
  std::vector<std::string> bodies;            ///< of mesh_body_names(); empty: all
  std::vector<int> edges{64, 128, 256, 512};  ///< [voxels] of the models; with kBoundEdge, if bounds are asked for
  int updates = 41;                           ///< timed ones per method that reads the box only
  int wholes = 7;                             ///< timed ones of the others
  Study* study = nullptr;                     ///< runs the trials; null: nothing is kept
};
inline constexpr int kBoundEdge = 256;  ///< [voxels] of the model of the first two bounds
/// @returns the options of --quick: the same bodies and bounds, no model of 512^3, fewer repeats.
[[nodiscard]] MeshCostOptions quick_mesh_cost();
[[nodiscard]] std::size_t count_of_trials(const MeshCostOptions& options);
[[nodiscard]] Result<MeshCost> measure_mesh_cost(const MeshCostOptions& options);

/// A ratio of times within one call, and its bound.
struct MeshBound {
  std::string name;
  double value = 0.0, bound = 0.0;  ///< [-]
  bool at_least = false;            ///< value >= bound is required; otherwise value <= bound
  [[nodiscard]] bool pass() const noexcept { return at_least ? value >= bound : value <= bound; }
};
/// @returns for both kinds of pivoting: full pivoting over update at kBoundEdge, at least 50; time per touched triangle over that of full
/// pivoting, at most 1.3; longest over shortest update of all sizes, at most 1.5. @pre there is a model of kBoundEdge.
[[nodiscard]] std::vector<MeshBound> mesh_bounds(const MeshCost& cost);

[[nodiscard]] std::vector<CostRow> mesh_cost_rows(const MeshCost& cost);
/// @returns the tables as they are printed and stand in docs.
[[nodiscard]] std::string mesh_cost_tables(const MeshCost& cost);
/// @returns the rows of cost.csv and the bounds as JSON, schema burrhole.cost_mesh/1; null where a value does not apply.
[[nodiscard]] std::string mesh_cost_json(const MeshCost& cost);
/// Writes cost.csv, mesh.md, mesh.svg, mesh_growth.svg and mesh.html into a folder. `unavailable` without gnuplot: the first two are written.
[[nodiscard]] Status write_mesh_cost(const MeshCost& cost, const std::string& folder);

}  // namespace burrhole
