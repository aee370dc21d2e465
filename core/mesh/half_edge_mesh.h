/// core/mesh/half_edge_mesh.h: triangles on voxel centres, and the pivoting front: the edges over which the ball has still to roll.
///   Half-edges   triangle t owns half-edges 3t, 3t + 1 and 3t + 2, counter-clockwise from outside. Each has a partner, the reverse half-edge
///     of the triangle on the other side of the edge, or it is a front edge, or a border edge, over which the ball found no triangle to join.
///   Invariant    front and border edges are loops: as many of them end at a vertex as begin there. Each half-edge is in one state.
///   Why a vertex and an edge may be used more than once   Two parts of bone that touch along an edge have four triangles there, in two pairs,
///     and a wall of one voxel has both its sides on the same vertices. So triangles are looked up by all three vertices, and a partner is
///     the half-edge that the ball reaches, not one with the same ends.
///   Numbers      of triangles and vertices are stable; free ones are used again.
///   Frame  index.   Errors  none.   Thread  one owner.   Source  [TellesONeill10] section 3.2: front loops round removed triangles, glue.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

class HalfEdgeMesh {
 public:
  using Id = std::uint32_t;
  static constexpr Id kNone = 0xffffffffu;
  static constexpr Id kFront = 0xfffffffeu;   ///< in place of a partner
  static constexpr Id kBorder = 0xfffffffdu;  ///< in place of a partner

  enum class VertexState {
    orphan,  ///< no triangle
    front,   ///< on the front or a border
    inner,   ///< all edges have partners
  };

  [[nodiscard]] Id add_vertex(const Vec3i& voxel);
  /// @pre no triangle uses it.
  void free_vertex(Id vertex);
  /// Adds a triangle, counter-clockwise from outside; its edges join the front. @returns its number.
  Id add_triangle(const std::array<Id, 3>& vertices);
  /// Removes a triangle. The partners of its edges join the front.
  void remove_triangle(Id triangle);
  /// Makes partners of two front edges. @pre one is the reverse of the other.
  void glue(Id half_edge, Id reverse);
  /// Makes front edges of two partners.
  void part(Id half_edge);
  /// Makes a border edge of a front edge.
  void leave_open(Id half_edge);
  /// Takes an edge off the list of the front. @returns one that is a front edge still; kNone: the front is empty.
  [[nodiscard]] Id take_front();
  void clear();

  /// @returns the half-edge from a to b of triangle (a, b, c); kNone if there is no such triangle.
  [[nodiscard]] Id find(Id a, Id b, Id c) const noexcept {
    for (Id h = first_[a]; h != kNone; h = next_at_origin_[h])
      if (origin_[next(h)] == b && origin_[previous(h)] == c) return h;
    return kNone;
  }

  [[nodiscard]] static Id next(Id half_edge) noexcept { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
  [[nodiscard]] static Id previous(Id half_edge) noexcept { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
  [[nodiscard]] Id origin(Id half_edge) const noexcept { return origin_[half_edge]; }
  [[nodiscard]] Id target(Id half_edge) const noexcept { return origin_[next(half_edge)]; }
  [[nodiscard]] Id opposite(Id half_edge) const noexcept { return origin_[previous(half_edge)]; }
  /// @returns the half-edge on the other side, kFront or kBorder.
  [[nodiscard]] Id partner(Id half_edge) const noexcept { return partner_[half_edge]; }
  /// @returns the first half-edge that begins at a vertex, kNone if none does; next_at_origin() gives the others, in no order.
  [[nodiscard]] Id first_at(Id vertex) const noexcept { return first_[vertex]; }
  [[nodiscard]] Id next_at_origin(Id half_edge) const noexcept { return next_at_origin_[half_edge]; }

  /// @returns the next half-edge round the origin, in the same fan of triangles; kFront or kBorder where the fan ends.
  [[nodiscard]] Id next_in_fan(Id half_edge) const noexcept { return partner_[previous(half_edge)]; }

  [[nodiscard]] const Vec3i& voxel(Id vertex) const noexcept { return voxel_[vertex]; }
  [[nodiscard]] VertexState state(Id vertex) const noexcept {
    return first_[vertex] == kNone ? VertexState::orphan : open_[vertex] > 0 ? VertexState::front : VertexState::inner;
  }
  /// Numbers below these are in use or free.
  [[nodiscard]] Id vertex_slots() const noexcept { return static_cast<Id>(voxel_.size()); }
  [[nodiscard]] Id triangle_slots() const noexcept { return static_cast<Id>(origin_.size() / 3); }
  [[nodiscard]] bool has_triangle(Id triangle) const noexcept { return origin_[3 * triangle] != kNone; }
  [[nodiscard]] std::size_t triangles() const noexcept { return triangle_slots() - free_triangles_.size(); }
  [[nodiscard]] std::size_t vertices() const noexcept { return voxel_.size() - free_vertices_.size(); }
  [[nodiscard]] std::size_t front_edges() const noexcept { return front_edges_; }
  [[nodiscard]] std::size_t border_edges() const noexcept { return border_edges_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  void open(Id half_edge);
  void unlink(Id half_edge);

  std::vector<Id> origin_, partner_, next_at_origin_;  // per half-edge; origin_ is kNone where the triangle is free
  std::vector<Vec3i> voxel_;                           // per vertex
  std::vector<Id> first_;                              // per vertex
  std::vector<std::uint32_t> open_;                    // per vertex: front and border edges that begin or end at it
  std::vector<Id> free_triangles_, free_vertices_, front_;
  std::size_t front_edges_ = 0, border_edges_ = 0;
};

}  // namespace burrhole
