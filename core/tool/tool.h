/// core/tool/tool.h: what a bit is once loaded: where it feels, where it cuts, how it looks.
///   Frame  tool frame: origin at the tip on the rotational axis, +z up the shaft.   Units  SI.
///   Source [AcostaLiu07] sections 2 (point shell) and 3 (erosion points).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

inline constexpr std::size_t kMaxShellPoints = 200'000;
inline constexpr std::size_t kMaxErosionPoints = 20'000'000;

/// Sample points of the tool's surface. Sizes agree; inward_normals have length 1 and point into the tool (the paper's tool vectors).
struct PointShell {
  std::vector<Vec3> positions;        ///< [m]
  std::vector<Vec3> inward_normals;   ///< [-]
  std::vector<std::uint8_t> cutting;  ///< 1 where the point belongs to a region and a face whose erosion factors are above 0
  [[nodiscard]] std::size_t size() const noexcept { return positions.size(); }
};

/// Centres of the cells of a voxelised bit, surface and inside. A point stands for a cube of edge `pitch`.
struct ErosionPoints {
  double pitch = 0.0;           ///< [m]
  std::vector<Vec3> positions;  ///< [m]; sorted k, j, i (i fastest) on the tool's own lattice
  std::vector<float> factors;   ///< erosion factor e [1/rev]: lambda [1/s] = e * spin [rev/s]
  [[nodiscard]] std::size_t size() const noexcept { return positions.size(); }
};

/// Triangles for drawing; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3f> positions;        ///< [m]
  std::vector<Vec3f> normals;          ///< outward, length 1, one a vertex
  std::vector<std::uint32_t> indices;  ///< three a triangle
};

struct CuttingField;

/// A bit ready for use.
struct Tool {
  std::string name;
  std::string title;
  PointShell shell;
  ErosionPoints erosion;
  TriangleMesh mesh;                            ///< the solid that the turning bit sweeps
  TriangleMesh look;                            ///< with its flutes and edges, for pictures; the file's own of a mesh
  bool turns = true;                            ///< about its axis; false of a blade and of what stands still beside the bit
  std::shared_ptr<const CuttingField> cutting;  ///< core/tool/cutting_field.h; null unless ToolOptions asked for it
  double bound_radius = 0.0;                    ///< [m] all shell and erosion points lie within this distance of the origin
  Vec3 bound_lo{0.0};                           ///< [m] bounding box of shell and erosion points, tool frame
  Vec3 bound_hi{0.0};
};

}  // namespace burrhole
