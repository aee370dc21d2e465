#include "core/voxel/saved_remaining.h"

#include <algorithm>

namespace burrhole {

Result<BlockStore> saved_remaining(const FloatVdb& grid, const VoxelBox& bone, const std::string& path) {
  constexpr int kFarthest = 512;  // [voxels] a window of the largest edge may reach so far outside the bone
  if (grid.background() != 1.0f) return bad_input("was saved from another bone: the dimensions differ", path);
  if (!bone.grown(kFarthest).contains(grid.active_bounds())) return bad_input("holds a remaining far outside its bone", path);
  bool sound = true;
  grid.for_each_sorted([&](const Vec3i&, float value) { sound = sound && value >= 0.0f && value <= 1.0f; });
  if (!sound) return bad_input("holds a remaining outside 0..1 or not finite", path);
  BlockStore out;
  BlockValues values;
  // Leaf by leaf; voxels of value 1 make no block.
  for_each_voxel(blocks_of(grid.active_bounds()), [&](const Vec3i& block) {
    grid.read_box(box_of_block(block), values);
    if (!std::ranges::all_of(values, [](float value) { return value == 1.0f; })) out.put(block, values);
  });
  return out;
}

}  // namespace burrhole
