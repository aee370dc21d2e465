#include "core/heat/bone_cells.h"

namespace burrhole {

void BoneCells::mean(const VoxelBox& cells, std::span<const float> density, std::span<float> share) const noexcept {
  const VoxelBox voxels = voxels_of(cells);
  const auto row = static_cast<std::size_t>(voxels.size().x), plane = row * static_cast<std::size_t>(voxels.size().y);
  const auto edge = static_cast<std::size_t>(edge_);
  const float one = 1.0f / static_cast<float>(edge * edge * edge);
  std::size_t at = 0;
  for_each_voxel(cells, [&](const Vec3i& cell) {
    const std::size_t first = voxels.offset_of(cell * edge_);
    float sum = 0.0f;
    for (std::size_t k = 0; k < edge; ++k)
      for (std::size_t j = 0; j < edge; ++j)
        for (std::size_t i = 0; i < edge; ++i) sum += density[first + k * plane + j * row + i];
    share[at++] = sum * one;
  });
}

}  // namespace burrhole
