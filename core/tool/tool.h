/// core/tool/tool.h: a loaded bit: shell points for contact, erosion points for removal, meshes for drawing.
///   Frame  tool frame: origin at the tip on the rotational axis, +z up the shaft.   Units  SI.   Errors  none.
///   Thread any; immutable once made.   Source [AcostaLiu07] sections 2 (point shell) and 3 (erosion points).
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

/// Sample points of the tool's surface. All vectors have the same size; inward_normals point into the tool (the tool vectors of the paper).
struct PointShell {
  std::vector<Vec3> positions;        ///< [m]
  std::vector<Vec3> inward_normals;   ///< [-] length 1
  std::vector<std::uint8_t> cutting;  ///< 1 if the point belongs to a region and a face with erosion factors > 0
  [[nodiscard]] std::size_t size() const noexcept { return positions.size(); }
};

/// Centres of the cells of a voxelised bit, surface and interior. A point represents a cube of edge `pitch`.
struct ErosionPoints {
  double pitch = 0.0;           ///< [m] cell edge
  std::vector<Vec3> positions;  ///< [m] sorted k, j, i (i fastest) on the lattice of the tool
  std::vector<float> factors;   ///< [1/rev] erosion factor e: lambda [1/s] = e * spin [rev/s]
  [[nodiscard]] std::size_t size() const noexcept { return positions.size(); }
};

/// Triangles for drawing; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3f> positions;        ///< [m]
  std::vector<Vec3f> normals;          ///< [-] outward, length 1, one per vertex
  std::vector<std::uint32_t> indices;  ///< three per triangle
};

struct CuttingField;
class ToolSurface;

/// A bit ready for use.
struct Tool {
  std::string name;
  std::string title;
  PointShell shell;
  ErosionPoints erosion;
  TriangleMesh mesh;  ///< the solid that the spinning bit sweeps
  TriangleMesh look;  ///< for pictures: with flutes and cutting edges, or the mesh of the tool file
  bool turns = true;  ///< rotates about its axis; false for a blade and for a part that does not rotate with the bit
  int teeth = 2;      ///< [-] cutting edges that pass a place in a revolution, >= 1
  std::shared_ptr<const CuttingField> cutting;  ///< core/tool/cutting_field.h; null unless ToolOptions requests it
  std::shared_ptr<const ToolSurface> surface;   ///< core/tool/tool_surface.h: the surface between the points of the shell
  double bound_radius = 0.0;                    ///< [m] all shell and erosion points lie within this distance of the origin
  Vec3 bound_lo{0.0};                           ///< [m] bounding box of shell and erosion points, tool frame
  Vec3 bound_hi{0.0};                           ///< [m] upper corner
};

}  // namespace burrhole
