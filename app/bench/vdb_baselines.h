/// app/bench/vdb_baselines.h: erosion and gradients on OpenVDB grids through value accessors, one point or voxel at a time: the baselines
/// of the dense window. Same laws as core/drill and core/voxel without shared code. OpenVDB types stay in the .cpp.
///   Frame  index, as the window's box.   Units  as noted.   Thread  one.
///   Source  [AcostaLiu07] sections 2 (gradient of density) and 3 (eq. 4); the rate law as in core/drill/erosion.h.
#pragma once

#include <memory>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct VdbErosionStep {
  Affine index_from_tool;
  double spin = 0.0;              ///< [rev/s] for the rate law; s of eq. 4 for the other
  double dt = 0.0;                ///< [s] rate law only
  float minimum_density = 0.05f;  ///< [-] below which a voxel becomes empty
};

/// All leaves of the grids exist from the start, so a write in a timed loop creates no node.
class VdbErosion {
 public:
  /// Copies the window; points keep their order (the tool's lattice, x fastest).
  VdbErosion(const ErosionPoints& points, const MasterWindow& window);
  ~VdbErosion();
  VdbErosion(const VdbErosion&) = delete;
  VdbErosion& operator=(const VdbErosion&) = delete;

  void step_rate(const VdbErosionStep& step);
  void step_per_update(const VdbErosionStep& step);
  /// Restores the state of construction.
  void reset();
  /// @returns `remaining` of the window's box, i fastest [-].
  [[nodiscard]] std::vector<float> remaining() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class VdbGradient {
 public:
  VdbGradient(const MasterWindow& window, float dead_zone);
  ~VdbGradient();
  VdbGradient(const VdbGradient&) = delete;
  VdbGradient& operator=(const VdbGradient&) = delete;

  /// Computes density in the box, and gradient in the box grown by one.
  void commit(const VoxelBox& touched);
  /// @returns values of the window's box, i fastest: density [-], gradient [1/voxel].
  [[nodiscard]] std::vector<float> density() const;
  [[nodiscard]] std::vector<Vec3f> gradient() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
