/// core/drill/region_spin.h: two regions of a tool, each with a speed of its own: the erosion factors of a region are multiplied by its share of
///   the speed. All erosion laws depend on the product of factor and spin; law `threshold` does not, and has one speed.
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  simulation; set() may allocate when a share changes.
///   Made only if a scene requires it: otherwise a tool has one speed and one set of factors.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/drill/erosion.h"
#include "core/tool/cutting_field.h"

namespace burrhole {

/// Numbers of two regions of a tool, ToolSurface::find_region().
struct DrillRegions {
  std::size_t inner = 0, outer = 0;
};

class RegionSpins {
 public:
  /// @pre the tool has a surface with these regions. Other regions turn with the outer one.
  RegionSpins(const Tool& tool, const DrillRegions& regions);

  /// A copy of the tool's field for Erosion::create(); set() changes its factors. Null if the tool has none.
  [[nodiscard]] std::shared_ptr<const CuttingField> field() const noexcept { return field_; }
  /// Sets the speeds over that of the load. 1 for both restores every factor bit for bit. `erosion` was made with field().
  void set(double inner, double outer, Erosion& erosion);

 private:
  std::vector<float> points_, nodes_;                   // [1/rev] factors at full speed
  std::vector<std::uint8_t> point_inner_, node_inner_;  // 1: of the inner region
  std::shared_ptr<CuttingField> field_;
  std::vector<float> scaled_;  // scratch
  std::array<double, 2> now_{1.0, 1.0};
};

}  // namespace burrhole
