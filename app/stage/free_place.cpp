#include "app/stage/free_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/bounds.h"
#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

constexpr double kOverlap = 0.75;  // [voxel edges] clearance of a cutting point across the push (constrained_tool.h)

/// The tool's shell, moved inwards by the overlap, in the bone's grid.
class ShellInBone {
 public:
  ShellInBone(const Voxmap& bone, const Affine& index_from_tool, const Tool& tool) : bone_(&bone), grid_{Vec3i(0), bone.bone().dims()} {
    const double overlap = kOverlap * bone.bone().bone_from_index().mean_edge();
    for (std::size_t n = 0; n < tool.shell.size(); ++n)
      points_.push_back(index_from_tool * (tool.shell.positions[n] + overlap * tool.shell.inward_normals[n]));
    for (const Vec3& point : points_) {
      lo_ = glm::min(lo_, point);
      hi_ = glm::max(hi_, point);
    }
  }
  /// @returns the multiple of `along` by which the tool is moved until it is outside the grid.
  [[nodiscard]] double way_out(const Vec3& along) const noexcept {
    double out = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      if (along[a] > 0.0) out = std::min(out, (grid_.hi[a] - lo_[a]) / along[a]);
      if (along[a] < 0.0) out = std::min(out, (grid_.lo[a] - 1.0 - hi_[a]) / along[a]);
    }
    return std::max(0.0, out);
  }
  /// @param by [voxels] displacement of the tool. @returns whether a point is in bone.
  [[nodiscard]] bool touches(const Vec3& by) {
    const VoxelBox box = VoxelBox{floor_int(lo_ + by), floor_int(hi_ + by) + 2}.intersect(grid_.grown(1));
    if (box.empty()) return false;
    density_.resize(box.count());
    bone_->read_density(box, density_);
    return std::ranges::any_of(points_, [&](const Vec3& point) { return density_at(box, point + by) >= kSurfaceLevel; });
  }

 private:
  /// @returns the density, trilinear between voxels; 0 outside the box.
  [[nodiscard]] double density_at(const VoxelBox& box, const Vec3& at) const noexcept {
    const Vec3i cell = floor_int(at);
    if (!box.contains(cell) || !box.contains(cell + 1)) return 0.0;
    const Vec3 part = at - Vec3(cell);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i step(corner & 1, corner >> 1 & 1, corner >> 2);
      const Vec3 weight = glm::mix(1.0 - part, part, Vec3(step));
      sum += weight.x * weight.y * weight.z * static_cast<double>(density_[box.offset_of(cell + step)]);
    }
    return sum;
  }

  const Voxmap* bone_;
  VoxelBox grid_;
  std::vector<Vec3> points_;  // [voxels]
  Vec3 lo_{std::numeric_limits<double>::infinity()}, hi_{-std::numeric_limits<double>::infinity()};
  std::vector<float> density_;
};

}  // namespace

Pose place_free_of_bone(const Voxmap& bone, const Pose& world_from_bone, const Tool& tool, const Pose& world_from_tool, double from) {
  const double step = bone.bone().bone_from_index().mean_edge();
  const Affine index_from_world = (Affine::from_pose(world_from_bone) * bone.bone().bone_from_index()).inverse();
  const Vec3 back = world_from_tool.rotate(Vec3(0.0, 0.0, step)), along = index_from_world.linear * back;
  ShellInBone shell(bone, index_from_world * Affine::from_pose(world_from_tool), tool);
  const double out = std::ceil(shell.way_out(along));  // [steps] outside the grid
  double left = std::min(out, std::ceil(std::max(0.0, from) / step));
  if (left > 0.0 && shell.touches(left * along)) left = out;
  while (left > 0.0 && !shell.touches((left - 1.0) * along)) left -= 1.0;
  return {world_from_tool.rotation, world_from_tool.translation + left * back};
}

}  // namespace burrhole
