#include "core/voxel/box_parts.h"

#include "core/base/box_list.h"

namespace burrhole {

std::vector<VoxelBox> box_without(const VoxelBox& box, const VoxelBox& hole) {
  std::vector<VoxelBox> out;
  append_outside(box, hole, out);
  return out;
}

VoxelBox kept_by_slide(const VoxelBox& from, const VoxelBox& to, const Vec3i& margin) {
  VoxelBox kept;
  for (const std::size_t axis : {0, 1, 2}) {
    kept.lo[axis] = from.lo[axis] == to.lo[axis] ? to.lo[axis] : std::max(from.lo[axis], to.lo[axis]) + margin[axis];
    kept.hi[axis] = from.hi[axis] == to.hi[axis] ? to.hi[axis] : std::min(from.hi[axis], to.hi[axis]) - margin[axis];
  }
  return kept;
}

}  // namespace burrhole
