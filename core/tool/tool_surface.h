/// core/tool/tool_surface.h: the surface of a bit as a whole, not as points: the place of it that is nearest to a point outside.
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any; immutable once made. nearest() never allocates.
///   Source own derivation. A bit is a union of solids, so the place nearest to a point outside all of them is that of the nearest solid, and
///           no part of it is covered by another. Solids of revolution are polygons or half ellipses in the meridian half-plane, boxes are
///           boxes: closed forms, and for ellipsoids an iteration of a fixed number of rounds. A mesh is searched by a tree of boxes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/assert.h"
#include "core/base/bounds.h"
#include "core/base/geometry.h"
#include "core/tool/shape.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

struct MeshToolSpec;
struct ToolSpec;

/// A smooth face of the tool at one of its points.
struct ToolFace {
  Vec3 outward{0.0};  ///< [-] length 1
  Vec3 into{0.0};     ///< [-] where the face ends at the point: the direction into the face, across its edge; zero inside the face
};

/// The faces that meet at a point of the surface: one inside a face, two at a convex edge; none where it is not so simple (a corner, an apex,
/// the joint of two solids), and none on a mesh.
struct ToolFaces {
  ToolFace face[2]{};
  std::size_t count = 0;
  double cell_radius = 0.0;  ///< [m] no place of the surface nearby is farther than this from the nearest point of the shell
};

class ToolSurface {
 public:
  explicit ToolSurface(const ToolSpec& spec);
  ToolSurface(const MeshToolSpec& spec, const SurfaceMesh& mesh);

  /// @returns the place of the surface nearest to p; empty where p is inside the tool or on its surface.
  [[nodiscard]] std::optional<Vec3> nearest(const Vec3& p) const noexcept BH_REALTIME;
  /// @returns the faces at a point of the shell.
  [[nodiscard]] ToolFaces faces_at(const Vec3& p) const noexcept;
  /// @returns whether the material at p belongs to a region that cuts, of a mesh: to its cutting heights. False outside the tool.
  [[nodiscard]] bool cuts_at(const Vec3& p) const noexcept;
  /// @returns the number of a region by its name in the tool file; nothing if no region or several have it, or the tool is a mesh.
  [[nodiscard]] std::optional<std::size_t> find_region(std::string_view name) const noexcept;
  /// @returns the region that owns the material at p: the first that contains it, outside all of them the nearest. 0 of a mesh.
  [[nodiscard]] std::size_t region_at(const Vec3& p) const noexcept;
  /// @returns heights [m] at which regions begin and end, not sorted.
  [[nodiscard]] std::vector<double> region_heights() const;

 private:
  struct Part {
    std::string name;
    Solid solid;
    double cell_radius = 0.0;  ///< [m]
    bool cuts = false;
  };
  struct Triangle {
    Vec3 a{0.0}, b{0.0}, c{0.0};
  };
  /// A node of the tree holds triangles [first, last); its halves follow at `left` and `left + 1` unless it is a leaf.
  struct Node {
    Bounds box;
    std::uint32_t first = 0, last = 0, left = 0;
  };
  void divide(std::size_t node, int depth);
  [[nodiscard]] std::optional<Vec3> nearest_of_mesh(const Vec3& p) const noexcept;

  std::vector<Part> parts_;
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
  double mesh_cell_radius_ = 0.0;
  double cut_from_ = 0.0, cut_to_ = -1.0;  // [m] heights between which a mesh cuts
};

}  // namespace burrhole
