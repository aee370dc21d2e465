#include "core/mesh/mesh_patch.h"

#include <algorithm>

#include "core/base/portable_math.h"
#include "core/voxel/voxmap.h"

namespace burrhole {
namespace {

constexpr std::uint32_t kNowhere = 0xffffffffu;
constexpr int kMargin = 2;  // [voxels] outermost layers of the window without triangles; an offset reads no further

/// [rad] at a corner.
float angle_between(const Vec3& u, const Vec3& v) noexcept {
  return static_cast<float>(portable_atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)));
}

Vec3i rounded_up(const Vec3i& size, int edge) noexcept { return (size + (edge - 1)) / edge; }

}  // namespace

/// The half-edges of a triangle, that of the lowest voxel first: by k, then j, then i.
struct MeshPatch::Corners {
  std::array<Id, 3> half_edges{};
  std::array<Vec3i, 3> voxels{};
  /// Differs for triangles of one block.
  [[nodiscard]] unsigned key(const Vec3i& block_lo) const noexcept {
    const Vec3i at = voxels[0] - block_lo;
    const auto place = static_cast<unsigned>((at.z * TrianglePatch::kBlock + at.y) * TrianglePatch::kBlock + at.x);
    return (place * 27 + step_code(voxels[1] - voxels[0])) * 27 + step_code(voxels[2] - voxels[0]);
  }
};

MeshPatch::MeshPatch(const Affine& bone_from_index)
    : bone_from_index_(bone_from_index), turns_over_(glm::determinant(bone_from_index.linear) < 0.0) {}

MeshPatch::Corners MeshPatch::corners_of(Id triangle) const noexcept {
  const HalfEdgeMesh& edges = mesh_->half_edges();
  Corners out;
  for (Id n = 0; n < 3; ++n) {
    out.half_edges[n] = 3 * triangle + n;
    out.voxels[n] = edges.voxel(edges.origin(3 * triangle + n));
  }
  const auto comes_before = [](const Vec3i& a, const Vec3i& b) { return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x; };
  const auto lowest = std::ranges::min_element(out.voxels, comes_before) - out.voxels.begin();
  std::ranges::rotate(out.half_edges, out.half_edges.begin() + lowest);
  std::ranges::rotate(out.voxels, out.voxels.begin() + lowest);
  return out;
}

PatchTriangle MeshPatch::shape_of(const Corners& corners) const noexcept {
  PatchTriangle out;
  for (std::size_t n = 0; n < 3; ++n) out.corners[n] = Vec3f(bone_from_index_ * mesh_->position(corners.half_edges[n]) - patch_.origin);
  if (turns_over_) std::swap(out.corners[1], out.corners[2]);
  const std::array<Vec3, 3> p{Vec3(out.corners[0]), Vec3(out.corners[1]), Vec3(out.corners[2])};
  const Vec3 across = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double length = glm::length(across);
  if (length > 0.0) out.normal = Vec3f(across / length);
  for (std::size_t n = 0; n < 3; ++n) out.angles[n] = angle_between(p[(n + 1) % 3] - p[n], p[(n + 2) % 3] - p[n]);
  return out;
}

void MeshPatch::lay_out(const VoxelBox& box) {
  patch_.box = box;
  patch_.blocks_size = rounded_up(box.size(), TrianglePatch::kBlock);
  patch_.groups_size = rounded_up(patch_.blocks_size, TrianglePatch::kGroup);
  patch_.origin = bone_from_index_ * Vec3(box.lo);
  patch_.index_from_patch = glm::inverse(bone_from_index_.linear);
  const Mat3 rows = glm::transpose(patch_.index_from_patch);
  patch_.voxels_per_metre = {glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2])};
  ++patch_.layout;
  ++patch_.stamp;
  const std::size_t count = patch_.block_box().count();
  patch_.blocks.resize(count);
  for (PatchBlock& block : patch_.blocks) {
    block.triangles.clear();
    block.bounds = {};
  }
  patch_.groups.assign(patch_.group_box().count(), {});
  filed_.resize(count);
  for (auto& triangles : filed_) triangles.clear();
  stamps_.assign(count, patch_.stamp);
  is_touched_.assign(count, 0);
  touched_.clear();
  block_of_.clear();
}

void MeshPatch::rebuild(const MasterWindow& window) {
  auto mesh = BallMesh::create(window.box, {.subvoxel = true, .report = true});
  BH_ASSERT(mesh.ok());  // a window is shorter than BallMesh::kLongestBox
  mesh_.emplace(std::move(mesh).value());
  mesh_->fill({window.box, window.density});
  lay_out(window.box);
  changed_.clear();
  mesh_->take_changed(changed_);
  for (const Id triangle : changed_) file(triangle);
  rebuild_touched();
  find_near(window, patch_.block_box());
}

void MeshPatch::update(const MasterWindow& window, const VoxelBox& changed) {
  BH_ASSERT(mesh_ && window.box == patch_.box);
  const VoxelBox part = changed.intersect(window.box);
  if (part.empty()) return;
  mesh_->update({window.box, window.density}, part);
  ++patch_.stamp;
  changed_.clear();
  mesh_->take_changed(changed_);
  for (const Id triangle : changed_) file(triangle);
  rebuild_touched();
  const VoxelBox read = part.grown(TrianglePatch::kNear).intersect(window.box);
  find_near(window, {patch_.block_of(read.lo), patch_.block_of(read.hi - 1) + 1});
}

void MeshPatch::file(Id triangle) {
  if (triangle >= block_of_.size()) block_of_.resize(mesh_->half_edges().triangle_slots(), kNowhere);
  std::uint32_t& at = block_of_[triangle];
  if (at != kNowhere) {
    std::vector<Id>& others = filed_[at];
    *std::ranges::find(others, triangle) = others.back();
    others.pop_back();
    touch(at);
    at = kNowhere;
  }
  if (!mesh_->half_edges().has_triangle(triangle)) return;
  const Corners corners = corners_of(triangle);
  const VoxelBox inner = patch_.box.grown(-kMargin);
  for (const Vec3i& voxel : corners.voxels)
    if (!inner.contains(voxel)) return;
  at = static_cast<std::uint32_t>(patch_.block_box().offset_of(patch_.block_of(corners.voxels[0])));
  filed_[at].push_back(triangle);
  touch(at);
}

void MeshPatch::touch(std::uint32_t block) {
  if (is_touched_[block] != 0) return;
  is_touched_[block] = 1;
  touched_.push_back(block);
}

void MeshPatch::rebuild_touched() {
  const VoxelBox blocks = patch_.block_box();
  std::vector<std::uint32_t> groups;
  for (const std::uint32_t block : touched_) {
    rebuild_block(block);
    is_touched_[block] = 0;
    const int n = static_cast<int>(block);
    const Vec3i at(n % blocks.hi.x, n / blocks.hi.x % blocks.hi.y, n / (blocks.hi.x * blocks.hi.y));
    groups.push_back(static_cast<std::uint32_t>(patch_.group_box().offset_of(at / TrianglePatch::kGroup)));
  }
  touched_.clear();
  std::ranges::sort(groups);
  groups.erase(std::ranges::unique(groups).begin(), groups.end());
  for (const std::uint32_t group : groups) {
    const int n = static_cast<int>(group);
    const Vec3i& size = patch_.groups_size;
    const Vec3i lo = Vec3i(n % size.x, n / size.x % size.y, n / (size.x * size.y)) * TrianglePatch::kGroup;
    PatchBounds& bounds = patch_.groups[group] = {};
    for_each_voxel(VoxelBox{lo, lo + TrianglePatch::kGroup}.intersect(blocks), [&](const Vec3i& at) {
      const PatchBounds& of_block = patch_.blocks[blocks.offset_of(at)].bounds;
      if (of_block.empty()) return;
      bounds.include(of_block.lo);
      bounds.include(of_block.hi);
    });
  }
}

void MeshPatch::rebuild_block(std::uint32_t block) {
  const int n = static_cast<int>(block);
  const Vec3i& size = patch_.blocks_size;
  const Vec3i lo = patch_.box.lo + Vec3i(n % size.x, n / size.x % size.y, n / (size.x * size.y)) * TrianglePatch::kBlock;
  // Their order must not depend on that of the changes.
  std::vector<std::pair<unsigned, Corners>> triangles;
  triangles.reserve(filed_[block].size());
  for (const Id triangle : filed_[block]) {
    const Corners corners = corners_of(triangle);
    triangles.emplace_back(corners.key(lo), corners);
  }
  std::ranges::sort(triangles, {}, &std::pair<unsigned, Corners>::first);
  PatchBlock& out = patch_.blocks[block];
  out.triangles.clear();
  out.bounds = {};
  for (const auto& [key, corners] : triangles) {
    const PatchTriangle shape = shape_of(corners);
    if (shape.normal == Vec3f(0.0f)) continue;  // without area
    out.triangles.push_back(shape);
    for (const Vec3f& corner : shape.corners) out.bounds.include(corner);
  }
  stamps_[block] = patch_.stamp;
}

void MeshPatch::find_near(const MasterWindow& window, const VoxelBox& blocks) {
  for_each_voxel(blocks, [&](const Vec3i& at) {
    const Vec3i lo = window.box.lo + at * TrianglePatch::kBlock;
    const VoxelBox part = VoxelBox{lo, lo + TrianglePatch::kBlock}.grown(TrianglePatch::kNear).intersect(window.box);
    bool solid = false;
    for (int k = part.lo.z; k < part.hi.z && !solid; ++k)
      for (int j = part.lo.y; j < part.hi.y && !solid; ++j) {
        const float* row = window.density.data() + window.box.offset_of({part.lo.x, j, k});
        solid = std::any_of(row, row + part.size().x, [](float density) { return density >= 0.5f; });
      }
    const std::size_t block = patch_.block_box().offset_of(at);
    if (patch_.blocks[block].near_bone == solid) return;
    patch_.blocks[block].near_bone = solid;
    stamps_[block] = patch_.stamp;
  });
}

void MeshPatch::bring_up_to_date(TrianglePatch& copy) const {
  if (copy.layout != patch_.layout) {
    copy = patch_;
    return;
  }
  if (copy.stamp == patch_.stamp) return;
  for (std::size_t block = 0; block < stamps_.size(); ++block)
    if (stamps_[block] > copy.stamp) copy.blocks[block] = patch_.blocks[block];
  copy.groups = patch_.groups;
  copy.stamp = patch_.stamp;
}

std::size_t MeshPatch::bytes() const noexcept {
  std::size_t sum = mesh_ ? mesh_->bytes() : 0;
  for (const auto& triangles : filed_) sum += sizeof(triangles) + triangles.capacity() * sizeof(Id);
  return sum + patch_.bytes() + block_of_.capacity() * sizeof(std::uint32_t) + stamps_.capacity() * (sizeof(std::uint64_t) + 1);
}

std::unique_ptr<TriangleSource> make_mesh_patch(const Affine& bone_from_index) { return std::make_unique<MeshPatch>(bone_from_index); }

std::size_t mesh_patch_bytes(std::size_t window_voxels, std::size_t copies) noexcept {
  // Triangles as in a full box (docs/mesh.md); a block is 64 voxels; a vector may hold twice what it needs.
  constexpr double kTriangles = 12.0, kMeshTriangle = 110.0, kMeshVoxel = 0.75, kVoxelsOfBlock = 64.0;
  const auto voxels = static_cast<double>(window_voxels), holders = static_cast<double>(copies + 1);
  const double triangles = kTriangles * std::cbrt(voxels) * std::cbrt(voxels);
  return static_cast<std::size_t>(triangles * (kMeshTriangle + 4.0 + 1.5 * holders * sizeof(PatchTriangle)) +
                                  voxels * (kMeshVoxel + (holders * sizeof(PatchBlock) + 40.0) / kVoxelsOfBlock));
}

}  // namespace burrhole
