#include "core/mesh/ball_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/assert.h"
#include "core/base/bounds.h"
#include "core/mesh/pivot_rules.h"
#include "core/mesh/surface_offset.h"

namespace burrhole {

Result<BallMesh> BallMesh::create(const VoxelBox& box, const BallMeshConfig& config) {
  const Vec3i size = box.size();
  if (box.empty() || std::max({size.x, size.y, size.z}) > kLongestBox)
    return Error{ErrorCode::out_of_range,
                 fmt::format("a mesh of {} x {} x {} voxels: mesh a box of 1 to {} per edge", size.x, size.y, size.z, kLongestBox),
                 {}};
  return BallMesh(box, config, TieRule::lowest_corner);
}

Result<BallMesh> make_sabotaged_mesh(const VoxelBox& box, const BallMeshConfig& config, const PivotRules& rules) {
  auto mesh = BallMesh::create(box, config);
  if (!mesh) return mesh;
  BallMesh out(box, config, rules.tie);
  out.missed_glue_ = rules.missed_glue;
  return out;
}

BallMesh::BallMesh(const VoxelBox& box, const BallMeshConfig& config, TieRule tie)
    : config_(config), tables_(std::make_shared<const BallTables>(tie)), solid_(box), vertices_(box) {
  is_marked_.assign(solid_.index_end() / 64, 0);
}

void BallMesh::fill(const DensityBlock& block) {
  BH_ASSERT(block.box.contains(box()));
  for (Id triangle = 0; triangle < mesh_.triangle_slots(); ++triangle) list(triangle);  // those of before
  mesh_.clear();
  vertices_.clear();
  offsets_.clear();
  changed_cells_.clear();
  std::ranges::fill(is_marked_, 0u);
  for (int k = box().lo.z; k < box().hi.z; ++k)
    for (int j = box().lo.y; j < box().hi.y; ++j) {
      const Vec3i start(box().lo.x, j, k);
      const float* density = block.density.data() + block.box.offset_of(start);
      const std::size_t index = solid_.index_of(start);
      for (int i = 0; i < box().size().x; ++i) solid_.set(index + static_cast<std::size_t>(i), density[i] >= 0.5f);
    }
  changed_cells_ = solid_.mixed_cells();
  for (const std::size_t cell : changed_cells_) is_marked_[cell >> 6] |= std::uint64_t{1} << (cell & 63);
  resume();
  if (config_.subvoxel) move_vertices(block, box());
}

void BallMesh::update(const DensityBlock& block, const VoxelBox& changed) {
  BH_ASSERT(block.box.contains(box()));
  const VoxelBox part = changed.intersect(box());
  if (part.empty()) return;
  for (int k = part.lo.z; k < part.hi.z; ++k)
    for (int j = part.lo.y; j < part.hi.y; ++j) {
      const Vec3i start(part.lo.x, j, k);
      const float* density = block.density.data() + block.box.offset_of(start);
      const std::size_t index = solid_.index_of(start);
      for (int i = 0; i < part.size().x; ++i) {
        const bool solid = density[i] >= 0.5f;
        if (solid == solid_.at(index + static_cast<std::size_t>(i))) continue;
        const Vec3i voxel = start + Vec3i(i, 0, 0);
        solid ? add(voxel) : remove(voxel);
      }
    }
  resume();
  // An offset reads the density up to the cell in which it ends.
  if (config_.subvoxel) move_vertices(block, changed.grown(static_cast<int>(std::ceil(kLongestOffset))).intersect(box()));
}

void BallMesh::remove(const Vec3i& voxel) {
  const std::size_t index = solid_.index_of(voxel);
  if (!solid_.at(index)) return;
  solid_.set(index, false);
  mark_cells(index);
  ++work_.voxels_removed;
  const Id vertex = vertices_.find(voxel);
  if (vertex == VertexMap::kNone) return;
  doomed_.clear();
  for (Id h = mesh_.first_at(vertex); h != HalfEdgeMesh::kNone; h = mesh_.next_at_origin(h)) doomed_.push_back(h / 3);
  for (const Id triangle : doomed_) remove_triangle(triangle);
}

void BallMesh::add(const Vec3i& voxel) {
  const std::size_t index = solid_.index_of(voxel);
  if (solid_.at(index)) return;
  solid_.set(index, true);
  mark_cells(index);
  ++work_.voxels_added;
  // A ball that would contain or touch the voxel has its centre in one of the eight cells round it.
  for (unsigned n = 0; n < 8; ++n) {
    const std::size_t cell = index - solid_.corner_step(n);
    const unsigned corners = solid_.corners(cell);
    const CellTriangles &before = tables_->cell(corners & ~(1u << n)), &now = tables_->cell(corners);
    for (unsigned t = 0; t < before.count; ++t) {
      if (now.contains(before.triangles[t])) continue;
      if (const auto half_edge = find_triangle(cell, before.triangles[t])) remove_triangle(*half_edge / 3);
    }
  }
  part_across(voxel);
}

/// Parts the partners between which the ball would now touch the voxel on its way: it lies in the gap between them.
void BallMesh::part_across(const Vec3i& voxel) {
  for (unsigned code = 0; code < 27; ++code) {
    const Vec3i from = voxel + step_of_code(code);
    if (from == voxel || !is_solid(from)) continue;
    const Id vertex = vertices_.find(from);
    if (vertex == VertexMap::kNone) continue;
    for (Id h = mesh_.first_at(vertex); h != HalfEdgeMesh::kNone; h = mesh_.next_at_origin(h)) {
      const Id other = mesh_.partner(h);
      if (other == HalfEdgeMesh::kFront || other == HalfEdgeMesh::kBorder) continue;
      const Vec3i to = mesh_.voxel(mesh_.target(h));
      if (!share_cell(voxel, from, to)) continue;
      const unsigned stop = reached(from, step_code(to - from), step_code(mesh_.voxel(mesh_.opposite(h)) - from));
      if (from + step_of_code(stop) != mesh_.voxel(mesh_.opposite(other))) mesh_.part(h);
    }
  }
}

void BallMesh::resume() {
  do {
    for (Id h = mesh_.take_front(); h != HalfEdgeMesh::kNone; h = mesh_.take_front()) roll(h);
  } while (put_down());
}

void BallMesh::list(Id triangle) {
  if (!config_.report) return;
  const std::size_t word = triangle >> 6;
  if (word >= is_listed_.size()) is_listed_.resize(word + 1);
  const std::uint64_t bit = std::uint64_t{1} << (triangle & 63);
  if ((is_listed_[word] & bit) != 0) return;
  is_listed_[word] |= bit;
  changed_.push_back(triangle);
}

void BallMesh::take_changed(std::vector<Id>& out) {
  std::ranges::sort(changed_);
  for (const Id triangle : changed_) is_listed_[triangle >> 6] &= ~(std::uint64_t{1} << (triangle & 63));
  out.insert(out.end(), changed_.begin(), changed_.end());
  changed_.clear();
}

void BallMesh::list_vertices(const VoxelBox& part) {
  for_each_voxel(part.intersect(box()), [&](const Vec3i& voxel) {
    const Id vertex = vertices_.find(voxel);
    if (vertex == VertexMap::kNone) return;
    for (Id h = mesh_.first_at(vertex); h != HalfEdgeMesh::kNone; h = mesh_.next_at_origin(h)) list(h / 3);
  });
}

void BallMesh::mark_cells(std::size_t index) {
  for (unsigned n = 0; n < 8; ++n) {
    const std::size_t cell = index - solid_.corner_step(n);
    std::uint64_t& word = is_marked_[cell >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (cell & 63);
    if ((word & bit) != 0) continue;
    word |= bit;
    changed_cells_.push_back(cell);
  }
}

unsigned BallMesh::reached(const Vec3i& from, unsigned edge, unsigned opposite) const noexcept {
  const std::size_t index = solid_.index_of(from);
  const PivotPath& path = tables_->path(edge, opposite);
  for (unsigned n = 0; n < path.count; ++n) {
    const PivotStop& stop = path.stops[n];
    const bool hit = solid_.at(index + solid_.step(stop.hit)), tied = solid_.at(index + solid_.step(stop.tied));
    if (hit || tied) return hit && tied ? stop.chosen : hit ? stop.hit : stop.tied;
  }
  BH_ASSERT(false);  // the last stop is the triangle's own third vertex, from the other side
  return opposite;
}

void BallMesh::roll(Id half_edge) {
  ++work_.pivots;
  const Id a = mesh_.origin(half_edge), b = mesh_.target(half_edge);
  const Vec3i from = mesh_.voxel(a);
  const unsigned edge = step_code(mesh_.voxel(b) - from), opposite = step_code(mesh_.voxel(mesh_.opposite(half_edge)) - from);
  const Id c = vertex_at(from + step_of_code(reached(from, edge, opposite)));
  Id reverse = mesh_.find(b, a, c);
  if (reverse == HalfEdgeMesh::kNone) {
    reverse = 3 * add_triangle({b, a, c});
  } else {
    if (++work_.glued == missed_glue_) return mesh_.leave_open(half_edge);
  }
  if (mesh_.partner(reverse) != HalfEdgeMesh::kFront) return mesh_.leave_open(half_edge);
  mesh_.glue(half_edge, reverse);
}

bool BallMesh::put_down() {
  for (; !changed_cells_.empty(); changed_cells_.pop_back()) {
    const std::size_t cell = changed_cells_.back();
    const CellTriangles& triangles = tables_->cell(solid_.corners(cell));
    for (unsigned n = 0; n < triangles.count; ++n) {
      const CellTriangle& corners = triangles.triangles[n];
      if (find_triangle(cell, corners)) continue;
      const Vec3i lowest = solid_.voxel_at(cell);
      const auto vertex = [&](unsigned m) { return vertex_at(lowest + cell_corner(corners[m])); };
      add_triangle({vertex(0), vertex(1), vertex(2)});
      ++work_.seeds;
      return true;  // the cell remains: it may have another
    }
    is_marked_[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
  }
  return false;
}

BallMesh::Id BallMesh::add_triangle(const std::array<Id, 3>& vertices) {
  ++work_.triangles_added;
  const Id triangle = mesh_.add_triangle(vertices);
  list(triangle);
  if (config_.subvoxel) {
    offsets_.resize(3 * static_cast<std::size_t>(mesh_.triangle_slots()));
    for (Id n = 0; n < 3; ++n) offsets_[3 * triangle + n] = Vec3f(0.0f);
  }
  return triangle;
}

void BallMesh::remove_triangle(Id triangle) {
  std::array<Id, 3> corners{};
  for (Id n = 0; n < 3; ++n) corners[n] = mesh_.origin(3 * triangle + n);
  mesh_.remove_triangle(triangle);
  list(triangle);
  ++work_.triangles_removed;
  for (const Id vertex : corners) {
    if (mesh_.state(vertex) != HalfEdgeMesh::VertexState::orphan) continue;
    vertices_.set(mesh_.voxel(vertex), VertexMap::kNone);
    mesh_.free_vertex(vertex);
  }
}

BallMesh::Id BallMesh::vertex_at(const Vec3i& voxel) {
  Id vertex = vertices_.find(voxel);
  if (vertex != VertexMap::kNone) return vertex;
  vertex = mesh_.add_vertex(voxel);
  vertices_.set(voxel, vertex);
  return vertex;
}

std::optional<BallMesh::Id> BallMesh::find_triangle(std::size_t cell, const CellTriangle& corners) const noexcept {
  const Vec3i lowest = solid_.voxel_at(cell);
  std::array<Id, 3> found{};
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3i voxel = lowest + cell_corner(corners[n]);
    found[n] = vertices_.find(voxel);
    if (found[n] == VertexMap::kNone) return std::nullopt;
  }
  const Id half_edge = mesh_.find(found[0], found[1], found[2]);
  if (half_edge == HalfEdgeMesh::kNone) return std::nullopt;
  return half_edge;
}

void BallMesh::move_vertices(const DensityBlock& block, const VoxelBox& part) {
  for_each_voxel(part, [&](const Vec3i& voxel) {
    const Id vertex = vertices_.find(voxel);
    if (vertex != VertexMap::kNone) move_fans(block, vertex);
  });
}

/// Calls f(half-edge) for each half-edge round the origin of one, in its fan.
template <class F>
void BallMesh::for_each_in_fan(Id half_edge, F&& f) const {
  Id h = half_edge;
  do {
    f(h);
    h = mesh_.next_in_fan(h);
  } while (h != half_edge && h != HalfEdgeMesh::kFront && h != HalfEdgeMesh::kBorder);
}

void BallMesh::move_fans(const DensityBlock& block, Id vertex) {
  const Vec3i voxel = mesh_.voxel(vertex);
  std::size_t here = 0, in_first = 0;
  const Id first = mesh_.first_at(vertex);
  for (Id h = first; h != HalfEdgeMesh::kNone; h = mesh_.next_at_origin(h)) ++here;
  for_each_in_fan(first, [&](Id) { ++in_first; });
  if (in_first == here) return move_fan(first, offset_to_surface(block, voxel));
  fans_.clear();
  for (Id start = first; start != HalfEdgeMesh::kNone; start = mesh_.next_at_origin(start)) {
    if (std::ranges::find(fans_, start) != fans_.end()) continue;
    Vec3i normal(0);  // of the triangles on centres: whole numbers, so the sum does not depend on where the fan begins
    for_each_in_fan(start, [&](Id h) {
      const Vec3i u = mesh_.voxel(mesh_.target(h)) - voxel, v = mesh_.voxel(mesh_.opposite(h)) - voxel;
      normal += Vec3i(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
      fans_.push_back(h);
    });
    move_fan(start, offset_along(block, voxel, Vec3(normal)));
  }
}

void BallMesh::move_fan(Id half_edge, const std::optional<Vec3>& offset) {
  const Vec3f way(offset.value_or(Vec3(0.0)));
  for_each_in_fan(half_edge, [&](Id h) {
    if (offsets_[h] == way) return;
    offsets_[h] = way;
    list(h / 3);
  });
  ++work_.vertices_moved;
}

bool BallMesh::is_surface(const Vec3i& voxel) const noexcept {
  if (!is_solid(voxel)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i step(0);
    step[axis] = 1;
    if (!is_solid(voxel + step) || !is_solid(voxel - step)) return true;
  }
  return false;
}

HalfEdgeMesh::VertexState BallMesh::state(const Vec3i& voxel) const noexcept {
  const Id vertex = vertices_.find(voxel);
  return vertex == VertexMap::kNone ? HalfEdgeMesh::VertexState::orphan : mesh_.state(vertex);
}

FrontEdge BallMesh::front_edge(Id half_edge) const noexcept {
  FrontEdge out{.from = mesh_.voxel(mesh_.origin(half_edge)),
                .to = mesh_.voxel(mesh_.target(half_edge)),
                .opposite = mesh_.voxel(mesh_.opposite(half_edge))};
  out.ball = ball_centre({Vec3(out.from), Vec3(out.to), Vec3(out.opposite)}).value_or(Vec3(0.0));
  return out;
}

SurfaceMesh BallMesh::surface() const {
  SurfaceMesh out;
  std::vector<Id> number(3 * static_cast<std::size_t>(mesh_.triangle_slots()), HalfEdgeMesh::kNone);
  for (Id vertex = 0; vertex < mesh_.vertex_slots(); ++vertex) {
    for (Id start = mesh_.first_at(vertex); start != HalfEdgeMesh::kNone; start = mesh_.next_at_origin(start)) {
      if (number[start] != HalfEdgeMesh::kNone) continue;
      if (config_.subvoxel || start == mesh_.first_at(vertex)) out.positions.push_back(position(start));
      for_each_in_fan(start, [&](Id h) { number[h] = static_cast<Id>(out.positions.size() - 1); });
    }
  }
  for (Id triangle = 0; triangle < mesh_.triangle_slots(); ++triangle)
    if (mesh_.has_triangle(triangle))
      for (Id n = 0; n < 3; ++n) out.indices.push_back(number[3 * triangle + n]);
  return out;
}

std::size_t BallMesh::bytes() const noexcept {
  return solid_.bytes() + mesh_.bytes() + vertices_.bytes() + offsets_.capacity() * sizeof(Vec3f) +
         (is_marked_.capacity() + is_listed_.capacity()) * sizeof(std::uint64_t) + changed_.capacity() * sizeof(Id);
}

}  // namespace burrhole
