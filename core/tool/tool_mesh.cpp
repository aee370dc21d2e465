#include "core/tool/tool_mesh.h"

#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

/// Vertices of one ring: a pole is a ring whose vertices coincide, so that each has the normal of its own triangle.
void append_ring(TriangleMesh& mesh, const Meridian& at, const Meridian& outward, int slices) {
  for (int i = 0; i < slices; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / slices;
    const double x = portable_cos(angle), y = portable_sin(angle);
    mesh.positions.emplace_back(at.x * x, at.x * y, at.y);
    mesh.normals.emplace_back(outward.x * x, outward.x * y, outward.y);
  }
}

/// Triangles between the ring that starts at vertex `lower` and the next one; none where an edge has shrunk to the axis.
void append_band(TriangleMesh& mesh, std::uint32_t lower, bool lower_is_pole, bool upper_is_pole, int slices) {
  const auto n = static_cast<std::uint32_t>(slices);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = lower + i, b = lower + (i + 1) % n, c = a + n, d = b + n;
    if (!lower_is_pole) mesh.indices.insert(mesh.indices.end(), {a, b, d});
    if (!upper_is_pole) mesh.indices.insert(mesh.indices.end(), {a, d, c});
  }
}

}  // namespace

TriangleMesh make_tool_mesh(const ToolSpec& spec, int slices, int arc_steps) {
  TriangleMesh mesh;
  for (const OutlinePiece& piece : spec.outline) {
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
  return mesh;
}

}  // namespace burrhole
