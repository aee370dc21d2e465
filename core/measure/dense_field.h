/// core/measure/dense_field.h: one scalar of a box of voxels with trilinear sampling between their centres; 0 outside the box.
///   Frame  index.   Units  those of the values.   Errors  none.   Thread  any.
#pragma once

#include <vector>

#include "core/base/bounds.h"
#include "core/base/geometry.h"
#include "core/base/trilinear.h"

namespace burrhole {

struct DenseField {
  VoxelBox box;
  std::vector<float> values;  ///< [-] i fastest

  [[nodiscard]] float at(const Vec3i& v) const { return box.contains(v) ? values[box.offset_of(v)] : 0.0f; }
  [[nodiscard]] double sample(const Vec3& p) const {
    const Vec3i base = floor_int(p);
    if (box.contains(base) && box.contains(base + 1)) return trilinear(box, values.data(), p);
    return trilinear(p - Vec3(base), [&](unsigned n) { return static_cast<double>(at(base + cell_corner(n))); });
  }
};

}  // namespace burrhole
