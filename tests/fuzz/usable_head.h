/// tests/fuzz/usable_head.h: what every header that a reader accepts must promise.
#pragma once

#include <cstdlib>

#include "volumes/read/image_file.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {

inline void demand_usable(const ImageHead& head) {
  const Vec3 dims(head.dims);
  if (head.dims.x < 1 || head.dims.y < 1 || head.dims.z < 1 || dims.x * dims.y * dims.z > kMaxScanVoxels) std::abort();
  if (affine_error(head.bone_from_index)) std::abort();
}

}  // namespace burrhole
