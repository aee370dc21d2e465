/// tests/support/plain_trilinear.h: the sum of a cell's corners by their weights, the plain twin of core/base/trilinear.h.
#pragma once

#include "core/base/geometry.h"

namespace burrhole::test {

/// @param index place in index coordinates   @param at at(voxel) is the value there
template <class At>
[[nodiscard]] double plain_trilinear(const Vec3& index, At&& at) {
  const Vec3 base = glm::floor(index), t = index - base;
  double sum = 0.0;
  for (const int k : {0, 1})
    for (const int j : {0, 1})
      for (const int i : {0, 1}) {
        const double weight = (i == 1 ? t.x : 1.0 - t.x) * (j == 1 ? t.y : 1.0 - t.y) * (k == 1 ? t.z : 1.0 - t.z);
        sum += weight * static_cast<double>(at(Vec3i(base) + Vec3i(i, j, k)));
      }
  return sum;
}

}  // namespace burrhole::test
