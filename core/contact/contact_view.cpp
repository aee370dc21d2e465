#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

/// Cell of eight voxels round a point, and the point's place in it.
struct Cell {
  Vec3i base;
  Vec3 t;
  explicit Cell(const Vec3& p) : base(floor_int(p)), t(p - Vec3(base)) {}
};

template <class T, class Fetch>
T interpolate(const Cell& cell, Fetch&& fetch) {
  const auto mix = [](const T& a, const T& b, double t) { return a + (b - a) * t; };
  const auto row = [&](int y, int z) { return mix(fetch(Vec3i(0, y, z)), fetch(Vec3i(1, y, z)), cell.t.x); };
  return mix(mix(row(0, 0), row(1, 0), cell.t.y), mix(row(0, 1), row(1, 1), cell.t.y), cell.t.z);
}

}  // namespace

ContactView::ContactView(const ContactWindow& window, const Affine& bone_from_index, const Pose& world_from_bone)
    : box_(window.box),
      valid_(window.box.grown(-1)),
      density_(window.density.data()),
      gradient_(window.gradient.data()),
      words_(window.words.empty() ? nullptr : window.words.data()) {
  set_frames(bone_from_index, world_from_bone);
}

ContactView::ContactView(const VdbContactGrids& grids, const Affine& bone_from_index, const Pose& world_from_bone) : grids_(&grids) {
  set_frames(bone_from_index, world_from_bone);
}

void ContactView::set_frames(const Affine& bone_from_index, const Pose& world_from_bone) {
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
  if (grids_ == nullptr && valid_.contains(cell.base) && valid_.contains(cell.base + 1)) {
    const Vec3i size = box_.size();
    const float* d = density_ + box_.offset_of(cell.base);
    const std::ptrdiff_t row = size.x, slab = row * size.y;
    return interpolate<double>(cell, [&](const Vec3i& o) { return static_cast<double>(d[o.x + o.y * row + o.z * slab]); });
  }
  return interpolate<double>(cell, [&](const Vec3i& o) { return static_cast<double>(density(cell.base + o)); });
}

Vec3 ContactView::sample_gradient(const Vec3& index) const noexcept {
  const Cell cell(index);
  return interpolate<Vec3>(cell, [&](const Vec3i& o) { return Vec3(gradient(cell.base + o)); });
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
    // False position, bounded to the bracket; the field is trilinear, so three steps are enough for a thousandth of a voxel.
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
    if (normal == Vec3(0.0)) normal = direction;  // dead zone or the ridge of a thin wall: the way out stands in
    return SurfacePoint{world_of(crossing), normal};
  }
  return std::nullopt;
}

}  // namespace burrhole
