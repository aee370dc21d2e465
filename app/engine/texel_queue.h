/// app/engine/texel_queue.h: boxes of voxels that changed and whose texels the display has not got yet, handed out under a budget.
///   Frame index.  Units voxels, a texel each.  Thread one, the owner of the bone.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// Disjoint boxes, in the order in which they changed first. Holds places, not texels: these are made when a box is taken, so that what
/// waited is sent once and as it is then.
class TexelQueue {
 public:
  static constexpr std::size_t kMostBoxes = 64;  ///< beyond it the box round all of them waits in their place

  void add(const VoxelBox& box);
  /// The next boxes, of at most `most` texels together; a box is parted along its slabs and rows, and a row of one slab is always handed out.
  [[nodiscard]] std::vector<VoxelBox> take(std::size_t most);
  [[nodiscard]] bool empty() const noexcept { return boxes_.empty(); }
  [[nodiscard]] std::size_t texels() const noexcept;

 private:
  std::vector<VoxelBox> boxes_;
};

}  // namespace burrhole
