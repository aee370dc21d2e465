#include "core/voxel/gradient.h"

#include "core/base/assert.h"

namespace burrhole {

void update_gradient(const DensityBlock& block, const VoxelBox& target, float dead_zone, const VoxelBox& gradient_box,
                     std::span<Vec3f> gradient) noexcept {
  if (target.empty()) return;
  BH_ASSERT(block.box.contains(target.grown(1)));
  BH_ASSERT(gradient_box.contains(target));
  const std::ptrdiff_t row = block.box.size().x;
  const std::ptrdiff_t slab = row * block.box.size().y;
  const float dead2 = dead_zone * dead_zone;
  for (int k = target.lo.z; k < target.hi.z; ++k) {
    for (int j = target.lo.y; j < target.hi.y; ++j) {
      const float* d = block.density.data() + block.box.offset_of({target.lo.x, j, k});
      Vec3f* g = gradient.data() + gradient_box.offset_of({target.lo.x, j, k});
      for (int i = target.lo.x; i < target.hi.x; ++i, ++d, ++g) {
        const Vec3f v(0.5f * (d[1] - d[-1]), 0.5f * (d[row] - d[-row]), 0.5f * (d[slab] - d[-slab]));
        const float length2 = v.x * v.x + v.y * v.y + v.z * v.z;
        *g = length2 < dead2 ? Vec3f(0.0f) : v;
      }
    }
  }
}

}  // namespace burrhole
