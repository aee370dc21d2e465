/// core/drill/strength_field.h: a tool's exposure as a table in its own frame, so that each voxel of a box looks up what it would count.
///   Frame   tool frame, lattice of voxel edge / 3.   Units  SI; weights as the caller gives them.   Thread  simulation.
///   Source  own. A table node holds what a voxel centred there and turned as the tool is would meet: for each point its weight times the
///           share of the point's cube (edge pitch) that lies in the voxel. Voxels turned otherwise, and a node up to 1/6 voxel off on each
///           axis, make it an approximation: the tool's rim is blurred by less than half a voxel, the total is kept within a few per mille.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/drill/exposure.h"

namespace burrhole {

/// What the SIMD kernel is given: 16.16 fixed point in nodes, lanes along a row of the box.
struct StrengthRow {
  const std::int32_t* table;
  Vec3i size;             // nodes
  Vec3i start, step;      // of the first voxel, from voxel to voxel
  std::int32_t from, to;  // voxels of the row that are looked up, the others stay 0
  std::int64_t* sums;
};

class StrengthField {
 public:
  StrengthField() = default;
  /// @param weights one a point, finite and at least 0. @param voxel_edge [m] > 0. Takes about a microsecond a point.
  StrengthField(const ErosionPoints& points, std::span<const double> weights, double voxel_edge);

  [[nodiscard]] double voxel_edge() const noexcept { return voxel_edge_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return table_.size() * sizeof(std::int32_t); }
  /// Fills `field`, placed round the tool inside the erodible box. Same bits at every SIMD level.
  void look_up(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field) const;

 private:
  Vec3 origin_{0.0};      // [m] of the first node
  double spacing_ = 1.0;  // [m]
  Vec3i size_{0};         // nodes; the outermost are 0
  double unit_ = 1.0;
  double voxel_edge_ = 0.0;
  std::vector<std::int32_t> table_;
};

}  // namespace burrhole
