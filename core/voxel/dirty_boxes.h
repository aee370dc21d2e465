/// core/voxel/dirty_boxes.h: a bounded list of changed boxes: several tight boxes rather than their union.
#pragma once

#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// At most `kMax` boxes; when one more comes in, the two whose union wastes least are merged. Boxes may overlap.
class DirtyBoxes {
 public:
  static constexpr std::size_t kMax = 16;

  void add(const VoxelBox& box);
  void clear() noexcept { boxes_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return boxes_.empty(); }
  [[nodiscard]] const std::vector<VoxelBox>& boxes() const noexcept { return boxes_; }
  [[nodiscard]] std::vector<VoxelBox> take();

 private:
  std::vector<VoxelBox> boxes_;
};

}  // namespace burrhole
