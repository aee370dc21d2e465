#include "core/voxel/box_parts.h"

namespace burrhole {

std::vector<VoxelBox> box_without(const VoxelBox& box, const VoxelBox& hole) {
  const VoxelBox inner = box.intersect(hole);
  if (inner.empty()) return {box};
  std::vector<VoxelBox> out;
  VoxelBox rest = box;
  for (const std::size_t axis : {2, 1, 0}) {  // slabs across k first: their rows are the longest
    VoxelBox below = rest, above = rest;
    below.hi[axis] = inner.lo[axis];
    above.lo[axis] = inner.hi[axis];
    for (const VoxelBox& part : {below, above})
      if (!part.empty()) out.push_back(part);
    rest.lo[axis] = inner.lo[axis];
    rest.hi[axis] = inner.hi[axis];
  }
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
