/// core/mesh/ball_tables.h: all contacts of a pivoting ball with the voxel centres of a grid, as tables.
///   Why they are finite   A ball of radius 1 or less that has no solid centre inside touches only centres of its cell, the cube of 2 x 2 x 2
///     centres round the centre of the ball: all other centres are at least 1 away. Eight corners have 256 states. Four corners that do
///     not lie in one plane are on one sphere, of radius sqrt(3)/2, and every triangle of corners has a smaller circle or an equal one. So
///     with a radius between sqrt(3)/2 and 1 the ball enters no cell whose solid corners span a volume, passes through no triangle, and
///     touches four centres at most: those of a rectangle, 1 x 1 or 1 x sqrt(2).
///   Tie rule   Such a rectangle is cut along the diagonal through its lowest corner, by k, then j, then i. The rule does not depend on the
///     edge from which the ball comes or on the cell. So both triangles of a rectangle have the same diagonal, and no other tie exists.
///   Frame  index.   Units  voxels.   Errors  none.   Thread  any: constant after construction.
///   Source  the ball: Bernardini et al. 1999, as used by [TellesONeill10] section 3; tables and tie rule: own derivation, docs/mesh.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/geometry.h"

namespace burrhole {

/// [voxel] Any radius between sqrt(3)/2 and 1 gives the same triangles; this is the middle.
inline constexpr double kBallRadius = 0.933;

/// @returns a number below 27 for a step to a neighbour. @pre each component is -1, 0 or 1.
[[nodiscard]] constexpr unsigned step_code(const Vec3i& step) noexcept {
  return static_cast<unsigned>((step.x + 1) + 3 * (step.y + 1) + 9 * (step.z + 1));
}
[[nodiscard]] constexpr Vec3i step_of_code(unsigned code) noexcept {
  const int n = static_cast<int>(code);
  return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
}

/// @returns whether three voxels are corners of one cell.
[[nodiscard]] inline bool share_cell(const Vec3i& a, const Vec3i& b, const Vec3i& c) noexcept {
  const Vec3i size = glm::max(a, glm::max(b, c)) - glm::min(a, glm::min(b, c));
  return size.x <= 1 && size.y <= 1 && size.z <= 1;
}

/// @returns the centre of the ball that rests on three points, on the side from which they are counter-clockwise; none if no ball of this
/// radius touches all three.
[[nodiscard]] std::optional<Vec3> ball_centre(const std::array<Vec3, 3>& points, double radius = kBallRadius);

/// How a ball that touches four points chooses three of them.
enum class TieRule {
  lowest_corner,  ///< the rule above
  first_found,    ///< depends on the edge: for tests, which must find the errors that it makes
};

/// One stop of the ball: one centre, or two at once. Step codes from the first vertex of the edge.
struct PivotStop {
  std::uint8_t hit = 0;
  std::uint8_t tied = 0;    ///< the same as `hit` if there is no second one
  std::uint8_t chosen = 0;  ///< of the two, where both are solid
};
/// All stops of a ball that rolls off a triangle over one of its edges, in the order in which it reaches them.
struct PivotPath {
  std::uint8_t count = 0;
  std::array<PivotStop, 12> stops{};
};

/// Corners of a cell, counter-clockwise from the side of the ball; the lowest first.
using CellTriangle = std::array<std::uint8_t, 3>;
struct CellTriangles {
  std::uint8_t count = 0;
  std::array<CellTriangle, 4> triangles{};

  [[nodiscard]] bool contains(const CellTriangle& triangle) const noexcept;
};

class BallTables {
 public:
  /// @param rule for stops. The triangles of cells follow TieRule::lowest_corner always.
  explicit BallTables(TieRule rule = TieRule::lowest_corner);

  /// @returns the path of the ball on triangle (a, b, c), counter-clockwise, over its edge a b. @param edge step code of b - a.
  /// @param opposite step code of c - a.
  [[nodiscard]] const PivotPath& path(unsigned edge, unsigned opposite) const noexcept { return paths_[edge * 27 + opposite]; }
  /// @returns the triangles of balls whose centre lies in a cell. @param corners bit n is set if cell_corner(n) is solid.
  [[nodiscard]] const CellTriangles& cell(unsigned corners) const noexcept { return cells_[corners]; }

 private:
  void make_path(unsigned edge, unsigned opposite, TieRule rule);
  void make_cell(unsigned corners);

  std::vector<PivotPath> paths_;
  std::array<CellTriangles, 256> cells_{};
};

}  // namespace burrhole
