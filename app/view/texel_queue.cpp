#include "app/view/texel_queue.h"

#include <algorithm>

#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

/// The first part of the box with at most `most` texels: whole slabs, else rows of one slab, and one row at least if required.
VoxelBox first_part(const VoxelBox& box, std::size_t most, bool must) {
  const Vec3i size = box.size();
  const auto row = static_cast<std::size_t>(size.x), slab = row * static_cast<std::size_t>(size.y);
  VoxelBox part = box;
  if (most >= slab) {
    part.hi.z = box.lo.z + static_cast<int>(std::min(most / slab, static_cast<std::size_t>(size.z)));
    return part;
  }
  part.hi.z = box.lo.z + 1;
  part.hi.y = box.lo.y + std::max(static_cast<int>(most / row), must ? 1 : 0);
  return part;
}

}  // namespace

std::vector<VoxelBox> TexelQueue::take(std::size_t most) {
  std::vector<VoxelBox> out;
  std::size_t left = most;
  while (!boxes_.empty()) {
    const VoxelBox front = *boxes_.begin();
    const VoxelBox part = first_part(front, left, out.empty());
    if (part.empty()) break;
    out.push_back(part);
    left -= std::min(left, part.count());
    // The rest of the box stays first in the queue: the remaining rows of a split slab, then the slabs behind it.
    boxes_.erase(0);
    for (const VoxelBox& rest : box_without(front, part)) boxes_.prepend(rest);
  }
  return out;
}

}  // namespace burrhole
