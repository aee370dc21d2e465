/// core/measure/layer_loads.h: time and force of drilling in each layer of bone on the planned axis, and what was removed of each layer.
///   Frame  bone frame; depth along the axis from the entry.   Units  SI.   Errors none.   Thread  one owner.
#pragma once

#include <array>
#include <vector>

#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// The tip in one layer of Approach::layers.
struct LayerLoad {
  VoxelLabel label = VoxelLabel::none;
  double from = 0.0, to = 0.0;  ///< [m] depth
  double time = 0.0;            ///< [s] with the tip in the layer and a force on the hand
  double impulse = 0.0;         ///< [N s] of that force
  double peak = 0.0;            ///< [N]
};

class LayerLoads {
 public:
  static constexpr double kForce = 0.05;  ///< [N] least force that counts
  explicit LayerLoads(const Approach& approach);
  /// @param depth [m] of the tip. @param force [N] on the hand, magnitude. @param time [s] of this call, which ends the interval since the
  /// last; intervals of over 0.1 s, as after a jump of the time, do not count.
  void add(double depth, double force, double time) noexcept;
  [[nodiscard]] const std::vector<LayerLoad>& loads() const noexcept { return loads_; }

 private:
  std::vector<LayerLoad> loads_;
  double last_ = 0.0;  // [s]
};

/// @returns the integral of occupancy x (loss of remaining) [m^3] by VoxelLabel, against the state at the start of the run. The partial voxels
/// at a face, which are labelled as what lies beyond it, count to the bone beside them. The sum is HoleMeasure::removed_mass.
[[nodiscard]] std::array<double, 256> removed_by_label(Voxmap& voxmap);

}  // namespace burrhole
