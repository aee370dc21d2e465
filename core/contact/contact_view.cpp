#include "core/contact/contact_view.h"

#include "core/base/bounds.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

/// Cell of eight voxels around a point, and the point's position in it.
struct Cell {
  Vec3i base;
  Vec3 t;
  explicit Cell(const Vec3& p) : base(floor_int(p)), t(p - Vec3(base)) {}
};

}  // namespace

ContactView::ContactView(const ContactWindow& window, const Affine& bone_from_index, const Pose& world_from_bone)
    : box_(window.box),
      valid_(window.box.grown(-1)),
      density_(window.density.data()),
      gradient_(window.gradient.data()),
      words_(window.words.empty() ? nullptr : window.words.data()),
      triangles_(window.triangles.blocks.empty() ? nullptr : &window.triangles) {
  set_frames(bone_from_index, world_from_bone);
}

ContactView::ContactView(const VdbContactGrids& grids, const Affine& bone_from_index, const Pose& world_from_bone) : grids_(&grids) {
  set_frames(bone_from_index, world_from_bone);
}

void ContactView::set_frames(const Affine& bone_from_index, const Pose& world_from_bone) {
  world_from_bone_ = world_from_bone;
  world_from_index_ = Affine::from_pose(world_from_bone) * bone_from_index;
  index_from_world_ = world_from_index_.inverse();
  voxel_edge_ = bone_from_index.mean_edge();
}

Vec3 ContactView::outward_normal(const Vec3& index_gradient) const noexcept {
  // index_from_world^T g, written out: glm's v * M is M^T v.
  const Vec3 world = index_gradient * index_from_world_.linear;
  const double length = glm::length(world);
  return length > 0.0 ? -world / length : Vec3(0.0);
}

double ContactView::sample(const Vec3& index) const noexcept {
  const Cell cell(index);
  if (grids_ == nullptr && valid_.contains(cell.base) && valid_.contains(cell.base + 1)) return trilinear(box_, density_, index);
  return trilinear(cell.t, [&](unsigned n) { return static_cast<double>(density(cell.base + cell_corner(n))); });
}

Vec3 ContactView::sample_gradient(const Vec3& index) const noexcept {
  const Cell cell(index);
  return trilinear(cell.t, [&](unsigned n) { return Vec3(gradient(cell.base + cell_corner(n))); });
}

std::optional<SurfacePoint> ContactView::leave_bone(const Vec3& from, const Vec3& direction, double reach) const noexcept {
  const double step = 0.5 * voxel_edge_;
  const int steps = static_cast<int>(std::ceil(reach / step));
  const Vec3 start = index_of(from);
  const Vec3 way = index_direction(direction) * step;
  double inside = 0.0, inside_excess = sample(start) - kSurfaceLevel;
  for (int n = 1; n <= steps; ++n) {
    double outside = static_cast<double>(n), outside_excess = sample(start + way * outside) - kSurfaceLevel;
    if (outside_excess >= 0.0) {
      inside = outside;
      inside_excess = outside_excess;
      continue;
    }
    // False position, bounded to the bracket. The field is trilinear, so three steps reach a thousandth of a voxel.
    double crossing_at = outside;
    for (int refinement = 0; refinement < 3; ++refinement) {
      crossing_at = inside + (outside - inside) * std::max(0.0, inside_excess) / (std::max(0.0, inside_excess) - outside_excess);
      const double excess = sample(start + way * crossing_at) - kSurfaceLevel;
      if (excess >= 0.0) {
        inside = crossing_at;
        inside_excess = excess;
      } else {
        outside = crossing_at;
        outside_excess = excess;
      }
    }
    const Vec3 crossing = start + way * crossing_at;
    Vec3 normal = outward_normal(sample_gradient(crossing));
    if (normal == Vec3(0.0)) normal = direction;  // dead zone or ridge of a thin wall: use the search direction
    return SurfacePoint{world_of(crossing), normal};
  }
  return std::nullopt;
}

}  // namespace burrhole
