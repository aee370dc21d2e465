/// core/drill/removal_pass.h: one pass over a box that turns the exposure of each voxel into a loss of bone.
///   Units  exposure as in ExposureField; removed mass in voxels.   Thread  simulation.
#pragma once

#include <cstdint>

#include "core/drill/exposure.h"
#include "core/voxel/box_set.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// remaining *= exp(-(exposure x scale) x dt / h), h = max(hardness, least_hardness), or 1 without hardness.
struct RemovalLaw {
  double scale = 1.0;
  double dt = 1.0;
  bool by_hardness = true;
  float least_hardness = 0.1f;
  float minimum_density = 0.05f;  ///< occupancy x remaining below becomes 0
};

/// What the SIMD kernel is given. Offsets count voxels of the window.
struct RemovalArgs {
  RemovalLaw law;
  Vec3i corner, size;            // of the exposure, from the window's corner
  std::size_t row, slab, start;  // of the window; first voxel
  double unit;
  std::int64_t* sums;
  const float *occupancy, *hardness;
  float* remaining;
  double* mass;  // eight sums
};

struct Removal {
  double mass = 0.0;  ///< [voxels] sum of occupancy x loss of remaining
  std::uint32_t voxels = 0;
};

/// Applies the law where exposure is above 0, and puts the exposure back to zero. Same bits at every SIMD level; the exponential is
/// portable_exp's, the mass is summed in eight lanes by x.
Removal apply_removal(Voxmap& voxmap, const RemovalLaw& law, ExposureField& exposure, TileMarks& marks);

}  // namespace burrhole
