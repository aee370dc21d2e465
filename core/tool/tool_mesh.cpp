#include "core/tool/tool_mesh.h"

#include <numbers>
#include <utility>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

/// Vertices of one ring. A pole is a ring of coincident vertices, so that each has the normal of its own triangle.
void append_ring(TriangleMesh& mesh, const Meridian& at, const Meridian& outward, int slices) {
  for (int i = 0; i < slices; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / slices;
    const double x = portable_cos(angle), y = portable_sin(angle);
    mesh.positions.emplace_back(at.x * x, at.x * y, at.y);
    mesh.normals.emplace_back(outward.x * x, outward.x * y, outward.y);
  }
}

/// Triangles between the ring that starts at vertex `lower` and the next one; none where an edge degenerates to the axis.
void append_band(TriangleMesh& mesh, std::uint32_t lower, bool lower_is_pole, bool upper_is_pole, int slices) {
  const auto n = static_cast<std::uint32_t>(slices);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = lower + i, b = lower + (i + 1) % n, c = a + n, d = b + n;
    if (!lower_is_pole) mesh.indices.insert(mesh.indices.end(), {a, b, d});
    if (!upper_is_pole) mesh.indices.insert(mesh.indices.end(), {a, d, c});
  }
}

void append_piece(TriangleMesh& mesh, const OutlinePiece& piece, int slices, int arc_steps) {
  const int steps = piece.curved ? arc_steps : 1;
  for (int i = 0; i <= steps; ++i) {
    const double fraction = static_cast<double>(i) / steps;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Meridian at = piece.point(fraction);
    append_ring(mesh, at, piece.outward(fraction), slices);
    if (i == 0) continue;
    const bool from_pole = i == 1 && piece.start.x <= 0.0, to_pole = at.x <= 0.0;
    append_band(mesh, first - static_cast<std::uint32_t>(slices), from_pole, to_pole, slices);
  }
}

/// Six faces of two triangles each.
void append_box(TriangleMesh& mesh, const Bounds& box) {
  for (const BoxFace& face : box_faces()) {
    const std::size_t u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;  // u x v is the axis: counter-clockwise seen from the plus side
    Vec3f normal(0.0f);
    normal[face.axis] = static_cast<float>(face.sign);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [high_u, high_v] : {std::pair(false, false), {true, false}, {true, true}, {false, true}}) {
      Vec3 p = face.sign < 0.0 ? box.lo : box.hi;
      p[u] = high_u ? box.hi[u] : box.lo[u];
      p[v] = high_v ? box.hi[v] : box.lo[v];
      mesh.positions.emplace_back(p);
      mesh.normals.push_back(normal);
    }
    const std::uint32_t second = face.sign > 0.0 ? 1 : 2, third = face.sign > 0.0 ? 2 : 1;
    mesh.indices.insert(mesh.indices.end(), {first, first + second, first + third});
    mesh.indices.insert(mesh.indices.end(), {first, first + 1 + second, first + 1 + third});
  }
}

}  // namespace

TriangleMesh make_tool_mesh(const ToolSpec& spec, int slices, int arc_steps) {
  TriangleMesh mesh;
  for (const OutlinePiece& piece : spec.outline) append_piece(mesh, piece, slices, arc_steps);
  for (const RegionSpec& region : spec.regions)
    if (!region.solid.revolves()) append_box(mesh, region.solid.bounds());
  return mesh;
}

}  // namespace burrhole
