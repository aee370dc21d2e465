/// core/contact/shell_cells.h: lower bounds of the distance of bone in the cell of each shell point, the part of the tool's surface round it.
///   Frame  as named.   Units  distances in voxel edges.   Errors  none.   Thread  built once, used by contact. Never allocates after
///   construction.
///   Source own derivation. The distance d from convex bone is a convex function, so a place at q has d(q) >= d(p) + n.(q - p), n its gradient
///           at the shell point p. On a face of the tool with outward normal m and least curvature k the way to a place at s from p is s along
///           the face and at least k s^2 / 2 back from bone, so
///               d(q) >= d(p) - g s + k s^2 / 2,   g the part of n along the face,   s <= r, the radius of the cell.
///           The minimum over s is the bound. At an edge of the tool only directions into its faces count. In a hollow of radius R the
///           distance may be lower by s^2 / 2 R; there tool and bone conform and g is small.
#pragma once

#include <vector>

#include "core/contact/surface_probe.h"
#include "core/tool/tool.h"
#include "core/tool/tool_surface.h"

namespace burrhole {

class ShellCells {
 public:
  ShellCells() = default;
  /// @param voxel_edge [m] > 0.
  ShellCells(const PointShell& shell, const ToolSurface& surface, double voxel_edge);
  /// Sets hits.lower and the minima of the blocks. Bounds that are less than kSlack below the distance are the distance.
  /// @param bone_from_tool rotation.
  void lower(const Mat3& bone_from_tool, ProbeHits& hits) const noexcept;
  /// Sets hits.lower to the distances.
  static void copy(ProbeHits& hits) noexcept;
  /// [voxels] Distance of shell points, in voxel edges, up to which there may be bone in their cells.
  [[nodiscard]] double reach_of_cutting() const noexcept { return reach_[1]; }
  [[nodiscard]] double reach_of_passive() const noexcept { return reach_[0]; }
  [[nodiscard]] double radius(std::size_t point) const noexcept { return static_cast<double>(cells_[point].radius); }  ///< [voxels]

  static constexpr float kSlack = 0.03f;  ///< [voxels] bone may be deeper by this without being searched for

 private:
  struct Cell {
    Vec3f outward{0.0f}, into{0.0f}, outward2{0.0f}, into2{0.0f}, along{0.0f};  // [-] tool frame
    float radius = 0.0f;                                                        // [voxels]
    float curvature = 0.0f;                                                     // [1/voxels] least
    int faces = 1;                                                              // that meet at the point
  };
  [[nodiscard]] static float drop(const Cell& cell, const Vec3f& normal) noexcept;

  std::vector<Cell> cells_;
  double reach_[2] = {0.0, 0.0};  // of passive points, of those that cut
};

}  // namespace burrhole
