/// core/drill/removal_pass.h: one pass over a box that converts the exposure of each voxel into a loss of bone.
///   Frame  index coordinates of the bone.   Units  exposure as in ExposureField; removed mass in voxels.   Errors  none.
///   Thread  simulation.
#pragma once

#include <cstdint>

#include "core/drill/exposure.h"
#include "core/voxel/tile_marks.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// remaining *= exp(-(exposure x scale) x dt / h), h = max(hardness, least_hardness), or 1 without hardness.
struct RemovalLaw {
  double scale = 1.0;  ///< [-] factor on exposure
  double dt = 1.0;     ///< [s]
  bool by_hardness = true;
  float least_hardness = 0.1f;    ///< [-]
  float minimum_density = 0.05f;  ///< [-] occupancy x remaining below this becomes 0
};

/// Arguments of the SIMD kernel. Offsets count voxels of the window.
struct RemovalArgs {
  RemovalLaw law;
  Vec3i corner, size;            // [voxels] of the exposure, relative to the window's corner
  std::size_t row, slab, start;  // of the window; offset of the first voxel
  double unit;                   // [-] exposure = sum x unit
  std::int64_t* sums;
  const float *occupancy, *hardness;  // [-]
  float* remaining;                   // [-]
  double* mass;                       // [voxels] eight partial sums
};

struct Removal {
  double mass = 0.0;         ///< [voxels] sum of occupancy x loss of remaining
  std::uint32_t voxels = 0;  ///< voxels that lost bone
};

/// Applies the law where the exposure is > 0 and resets the exposure to zero. The bits are the same at every SIMD level: the exponential is
/// portable_exp, and the mass is summed in eight lanes by x.
Removal apply_removal(Voxmap& voxmap, const RemovalLaw& law, ExposureField& exposure, TileMarks& marks);

}  // namespace burrhole
