/// app/view/texel_queue.h: boxes of changed voxels whose texels were not yet sent to the display, returned within a budget.
///   Frame index.  Units voxels, one texel each.  Errors  none.   Thread one, the owner of the bone.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/box_list.h"

namespace burrhole {

/// Disjoint boxes, in the order of their first change. It stores boxes, not texels: texels are made when a box is taken, so a box that
/// changed several times is sent once, in its latest state.
class TexelQueue {
 public:
  static constexpr std::size_t kMostBoxes = 64;  ///< if exceeded, the bounding box of all boxes replaces them

  void add(const VoxelBox& box) { boxes_.add_disjoint(box); }
  /// @returns the next boxes, with at most `most` texels in total. A box is split along its slabs and rows; at least one row is returned.
  [[nodiscard]] std::vector<VoxelBox> take(std::size_t most);
  [[nodiscard]] bool empty() const noexcept { return boxes_.empty(); }
  [[nodiscard]] std::size_t texels() const noexcept { return boxes_.count(); }

 private:
  BoxList<VoxelBox, kMostBoxes> boxes_;
};

}  // namespace burrhole
