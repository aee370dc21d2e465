#include "core/mesh/half_edge_mesh.h"

#include "core/base/assert.h"

namespace burrhole {
namespace {

template <class T>
std::size_t bytes_in(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

}  // namespace

HalfEdgeMesh::Id HalfEdgeMesh::add_vertex(const Vec3i& voxel) {
  if (!free_vertices_.empty()) {
    const Id vertex = free_vertices_.back();
    free_vertices_.pop_back();
    voxel_[vertex] = voxel;
    return vertex;
  }
  voxel_.push_back(voxel);
  first_.push_back(kNone);
  open_.push_back(0);
  return static_cast<Id>(voxel_.size() - 1);
}

void HalfEdgeMesh::free_vertex(Id vertex) {
  BH_ASSERT(first_[vertex] == kNone && open_[vertex] == 0);
  free_vertices_.push_back(vertex);
}

HalfEdgeMesh::Id HalfEdgeMesh::add_triangle(const std::array<Id, 3>& vertices) {
  Id triangle = triangle_slots();
  if (free_triangles_.empty()) {
    origin_.resize(origin_.size() + 3);
    partner_.resize(origin_.size());
    next_at_origin_.resize(origin_.size());
  } else {
    triangle = free_triangles_.back();
    free_triangles_.pop_back();
  }
  for (Id n = 0; n < 3; ++n) {
    const Id h = 3 * triangle + n, vertex = vertices[n];
    origin_[h] = vertex;
    next_at_origin_[h] = first_[vertex];
    first_[vertex] = h;
  }
  for (Id n = 0; n < 3; ++n) open(3 * triangle + n);
  return triangle;
}

void HalfEdgeMesh::remove_triangle(Id triangle) {
  BH_ASSERT(has_triangle(triangle));
  for (Id n = 0; n < 3; ++n) {
    const Id h = 3 * triangle + n, other = partner_[h];
    if (other == kFront || other == kBorder) {
      --(other == kFront ? front_edges_ : border_edges_);
      --open_[origin(h)];
      --open_[target(h)];
    } else {
      open(other);
    }
  }
  for (Id n = 0; n < 3; ++n) unlink(3 * triangle + n);
  for (Id n = 0; n < 3; ++n) origin_[3 * triangle + n] = kNone;
  free_triangles_.push_back(triangle);
}

void HalfEdgeMesh::glue(Id half_edge, Id reverse) {
  BH_ASSERT(partner_[half_edge] == kFront && partner_[reverse] == kFront);
  BH_ASSERT(origin(half_edge) == target(reverse) && target(half_edge) == origin(reverse));
  partner_[half_edge] = reverse;
  partner_[reverse] = half_edge;
  open_[origin(half_edge)] -= 2;
  open_[target(half_edge)] -= 2;
  front_edges_ -= 2;
}

void HalfEdgeMesh::part(Id half_edge) {
  const Id other = partner_[half_edge];
  BH_ASSERT(other != kFront && other != kBorder);
  open(half_edge);
  open(other);
}

void HalfEdgeMesh::leave_open(Id half_edge) {
  BH_ASSERT(partner_[half_edge] == kFront);
  partner_[half_edge] = kBorder;
  --front_edges_;
  ++border_edges_;
}

HalfEdgeMesh::Id HalfEdgeMesh::take_front() {
  while (!front_.empty()) {
    const Id h = front_.back();
    front_.pop_back();
    if (origin_[h] != kNone && partner_[h] == kFront) return h;
  }
  return kNone;
}

void HalfEdgeMesh::clear() {
  for (std::vector<Id>* values : {&origin_, &partner_, &next_at_origin_, &first_, &open_, &free_triangles_, &free_vertices_, &front_})
    values->clear();  // keeps the memory
  voxel_.clear();
  front_edges_ = border_edges_ = 0;
}

void HalfEdgeMesh::open(Id half_edge) {
  partner_[half_edge] = kFront;
  ++open_[origin(half_edge)];
  ++open_[target(half_edge)];
  ++front_edges_;
  front_.push_back(half_edge);
}

void HalfEdgeMesh::unlink(Id half_edge) {
  Id* link = &first_[origin_[half_edge]];
  while (*link != half_edge) link = &next_at_origin_[*link];
  *link = next_at_origin_[half_edge];
}

std::size_t HalfEdgeMesh::bytes() const noexcept {
  return bytes_in(origin_) + bytes_in(partner_) + bytes_in(next_at_origin_) + bytes_in(voxel_) + bytes_in(first_) + bytes_in(open_) +
         bytes_in(free_triangles_) + bytes_in(free_vertices_) + bytes_in(front_);
}

}  // namespace burrhole
