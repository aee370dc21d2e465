#include "app/engine/texel_queue.h"

#include <algorithm>
#include <iterator>

#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

/// The first part of the box that holds at most `most` texels: whole slabs, else rows of one slab, else, if there must be one, a row.
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

void TexelQueue::add(const VoxelBox& box) {
  if (box.empty()) return;
  std::vector<VoxelBox> fresh{box};
  for (const VoxelBox& waiting : boxes_) {
    std::vector<VoxelBox> outside;
    for (const VoxelBox& part : fresh) std::ranges::copy(box_without(part, waiting), std::back_inserter(outside));
    fresh = std::move(outside);
  }
  boxes_.insert(boxes_.end(), fresh.begin(), fresh.end());
  if (boxes_.size() <= kMostBoxes) return;
  VoxelBox all;
  for (const VoxelBox& one : boxes_) all = all.unite(one);
  boxes_.assign(1, all);
}

std::vector<VoxelBox> TexelQueue::take(std::size_t most) {
  std::vector<VoxelBox> out;
  std::size_t left = most;
  while (!boxes_.empty()) {
    const VoxelBox part = first_part(boxes_.front(), left, out.empty());
    if (part.empty()) break;
    out.push_back(part);
    left -= std::min(left, part.count());
    // What is left of the box stays in front: the rows of a slab that was parted, then the slabs behind it.
    const std::vector<VoxelBox> rest = box_without(boxes_.front(), part);
    boxes_.erase(boxes_.begin());
    boxes_.insert(boxes_.begin(), rest.rbegin(), rest.rend());
  }
  return out;
}

std::size_t TexelQueue::texels() const noexcept {
  std::size_t sum = 0;
  for (const VoxelBox& box : boxes_) sum += box.count();
  return sum;
}

}  // namespace burrhole
