#include "core/voxel/dirty_boxes.h"

#include <utility>

namespace burrhole {

void DirtyBoxes::add(const VoxelBox& box) {
  if (box.empty()) return;
  for (VoxelBox& known : boxes_) {
    if (known.contains(box)) return;
    // Merging is free when the union holds no voxel that neither box has.
    const VoxelBox both = known.unite(box);
    if (both.count() <= known.count() + box.count() - known.intersect(box).count()) {
      known = both;
      return;
    }
  }
  boxes_.push_back(box);
  if (boxes_.size() <= kMax) return;

  std::size_t best_a = 0, best_b = 1, best_waste = SIZE_MAX;
  for (std::size_t a = 0; a < boxes_.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes_.size(); ++b) {
      const std::size_t joined = boxes_[a].unite(boxes_[b]).count();
      const std::size_t apart = boxes_[a].count() + boxes_[b].count();
      const std::size_t waste = joined > apart ? joined - apart : 0;
      if (waste < best_waste) {
        best_waste = waste;
        best_a = a;
        best_b = b;
      }
    }
  }
  boxes_[best_a] = boxes_[best_a].unite(boxes_[best_b]);
  boxes_.erase(boxes_.begin() + static_cast<std::ptrdiff_t>(best_b));
}

std::vector<VoxelBox> DirtyBoxes::take() { return std::exchange(boxes_, {}); }

}  // namespace burrhole
