/// app/bench/vdb_baselines.h: erosion and gradients on OpenVDB grids, a point or a voxel at a time through value accessors: what the dense
/// window is measured against. Same laws as core/drill and core/voxel, no code shared with them. OpenVDB types stay in the .cpp.
///   Source  [AcostaLiu07] sections 2 (gradient of density) and 3 (eq. 4); the rate law as in core/drill/erosion.h.
#pragma once

#include <memory>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct VdbErosionStep {
  Affine index_from_tool;
  double spin = 0.0;  ///< [rev/s] for the rate law, s of eq. 4 for the other
  double dt = 0.0;    ///< [s] rate law only
  float minimum_density = 0.05f;
};

/// All grids have their leaves from the start: no write in a timed loop makes a node.
class VdbErosion {
 public:
  /// Takes the window as it is; points keep their order (the tool's lattice, x fastest).
  VdbErosion(const ErosionPoints& points, const MasterWindow& window);
  ~VdbErosion();
  VdbErosion(const VdbErosion&) = delete;
  VdbErosion& operator=(const VdbErosion&) = delete;

  void step_rate(const VdbErosionStep& step);
  void step_per_update(const VdbErosionStep& step);
  /// Back to the window it was made from.
  void reset();
  /// `remaining` of the window's box, i fastest.
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

  /// Density in the box, gradient in the box grown by one.
  void commit(const VoxelBox& touched);
  /// Of the window's box, i fastest.
  [[nodiscard]] std::vector<float> density() const;
  [[nodiscard]] std::vector<Vec3f> gradient() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
