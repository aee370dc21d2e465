#include "core/mesh/mesh_gaps.h"

#include <algorithm>
#include <cmath>

#include "core/contact/nearest_triangle.h"

namespace burrhole {
namespace {

/// [voxel edges] A vertex is moved along the gradient of the density (docs/mesh.md), so removal beside it may move it outwards by less.
constexpr double kMargin = 0.25;
/// [voxel edges] Nearer to the surface the way to its nearest place has no direction: the normals there have.
constexpr double kOnSurface = 0.02;

}  // namespace

MeshGaps::MeshGaps(std::size_t points, double edge) : edge_(edge), known_(points), near_(points), slot_(points, 0) {}

void MeshGaps::forget() noexcept { std::ranges::fill(known_, Known{}); }

void MeshGaps::begin(const ContactView& bone, double reach) noexcept {
  bone_ = &bone;
  index_from_bone_ = bone.index_from_world() * Affine::from_pose(bone.world_from_bone());
  if (bone.triangles()->layout != layout_) forget();
  layout_ = bone.triangles()->layout;
  reach_ = std::min(reach, kSearch * edge_);
  nearest_ = kSearch * edge_;
  outside_ = false;
  count_ = 0;
}

void MeshGaps::add(const MeshGap& gap) noexcept {
  slot_[gap.point] = static_cast<std::uint32_t>(count_);
  near_[count_++] = gap;
  nearest_ = std::min(nearest_, std::max(0.0, gap.gap));
}

void MeshGaps::probe(std::uint32_t point, const Vec3& place) noexcept {
  Known& known = known_[point];
  if (const double left = known.distance - kMargin * edge_ - glm::length(place - known.place); left > reach_) {
    nearest_ = std::min(nearest_, left);
    return;
  }
  known = {place, 0.0};
  const Vec3 index = index_from_bone_ * place;
  if (!holds_index(index) || !bone_->knows(voxel_of(index))) {
    outside_ = true;
    return;
  }
  const TrianglePatch& patch = *bone_->triangles();
  if (!patch.blocks[patch.block_box().offset_of(patch.block_of(voxel_of(index)))].near_bone) {
    known.distance = edge_ * (TrianglePatch::kNear - 0.5);  // no solid voxel is nearer than kNear
    nearest_ = std::min(nearest_, known.distance);
    return;
  }
  const double search = kSearch * edge_;
  const NearestTriangle found = find_nearest(patch, place - patch.origin, search * search);
  if (found.triangle == nullptr) {
    if (bone_->sample(index) >= kSurfaceLevel) return add({point, -search, Vec3(0.0)});
    known.distance = search;
    return;
  }
  const double distance = std::sqrt(found.distance2);
  // As in mesh_contact.cpp: farther off than a voxel the density decides.
  const bool inside = distance > edge_ ? bone_->sample(index) >= kSurfaceLevel : found.inside;
  if (!inside) known.distance = distance;
  if (!inside && distance > reach_) {
    nearest_ = std::min(nearest_, distance);
    return;
  }
  Vec3 normal(found.triangle->normal);
  if (distance > kOnSurface * edge_)
    normal = found.from_place / (inside ? -distance : distance);
  else if (const double length = glm::length(found.normals); length > 0.0)
    normal = found.normals / length;
  add({point, inside ? -distance : distance, normal});
}

}  // namespace burrhole
