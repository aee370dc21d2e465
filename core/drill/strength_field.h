/// core/drill/strength_field.h: the exposure of a tool as a table in its own frame. Each voxel of a box reads its exposure from the table.
///   Frame   tool frame, lattice of voxel edge / 3.   Units  SI; weights as the caller gives them.   Errors  none.   Thread  simulation.
///   Source  own derivation. A table node has the exposure of a voxel centred there and aligned with the tool: for each point its weight
///           times the share of the point's cube (edge pitch) that lies in the voxel. Voxels of another orientation, and a node up to 1/6
///           voxel away on each axis, make it an approximation: the rim of the tool is blurred by less than half a voxel, and the total is
///           kept within a few per mille.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drill/exposure.h"

namespace burrhole {

/// Arguments of the SIMD kernel: 16.16 fixed point in nodes, lanes along a row of the box.
struct StrengthTable {
  const std::int32_t* table;
  Vec3i size;  // nodes
  Vec3i step;  // [nodes] from voxel to voxel
};

struct StrengthRow {
  Vec3i start;            // [nodes] position of the first voxel
  std::int32_t from, to;  // [voxels] range of the row that are read; the others stay 0
  std::int64_t* sums;
};

class StrengthField {
 public:
  StrengthField() = default;
  /// @param weights one per point, finite and >= 0. @param voxel_edge [m] > 0. Takes about a microsecond per point.
  StrengthField(const ErosionPoints& points, std::span<const double> weights, double voxel_edge);

  [[nodiscard]] double voxel_edge() const noexcept { return voxel_edge_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return table_.size() * sizeof(std::int32_t); }
  /// Fills `field`, placed around the tool inside the erodible box. Same bits at every SIMD level.
  void look_up(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field) const;

 private:
  class RowCut;
  void measure_extent();

  Vec3 origin_{0.0};      // [m] of the first node
  double spacing_ = 1.0;  // [m]
  Vec3i size_{0};         // nodes; the outermost are 0
  double unit_ = 1.0;
  double voxel_edge_ = 0.0;
  std::vector<std::int32_t> table_;
  // [nodes] All values > 0 lie inside this half-open box, this ball and this tube around the tool's axis.
  Vec3i lo_{0}, hi_{0};
  Vec3 middle_{0.0};
  double ball_ = 0.0, tube_ = 0.0;
};

}  // namespace burrhole
