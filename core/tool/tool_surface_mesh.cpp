// The surface of a mesh tool: a tree of boxes round its triangles, halved along the longest axis.
#include <algorithm>
#include <array>
#include <limits>

#include "core/tool/mesh_spec.h"
#include "core/tool/tool_surface.h"

namespace burrhole {
namespace {

constexpr double kCellRadius = 0.75;  // [-] over the pitch: make_mesh_shell() has every place within pitch / sqrt(2)
constexpr std::uint32_t kLeaf = 4;    // [triangles] not divided further
constexpr int kDeepest = 28;          // levels of the tree

double to_box2(const Bounds& box, const Vec3& p) noexcept {
  const Vec3 off = p - glm::clamp(p, box.lo, box.hi);
  return glm::dot(off, off);
}

/// Place of a triangle nearest to p: its plane's foot where that is inside, else of the nearest edge.
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  const auto left_of = [&](const Vec3& u, const Vec3& v) { return glm::dot(glm::cross(v - u, p - u), normal) >= 0.0; };
  if (area2 > 0.0 && left_of(a, b) && left_of(b, c) && left_of(c, a)) return p - normal * (glm::dot(p - a, normal) / area2);
  Vec3 best = a;
  double least = std::numeric_limits<double>::infinity();
  const std::array<const Vec3*, 4> ring{&a, &b, &c, &a};
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 way = *ring[n + 1] - *ring[n];
    const double length2 = glm::dot(way, way);
    const Vec3 at = *ring[n] + way * (length2 > 0.0 ? std::clamp(glm::dot(p - *ring[n], way) / length2, 0.0, 1.0) : 0.0);
    if (const double distance2 = glm::dot(p - at, p - at); distance2 < least) {
      least = distance2;
      best = at;
    }
  }
  return best;
}

}  // namespace

ToolSurface::ToolSurface(const MeshToolSpec& spec, const SurfaceMesh& mesh) : mesh_cell_radius_(kCellRadius * spec.pitch) {
  if (spec.erosion_factor > 0.0) cut_from_ = spec.cut_from, cut_to_ = spec.cut_to;
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3)
    triangles_.push_back({mesh.positions[mesh.indices[n]], mesh.positions[mesh.indices[n + 1]], mesh.positions[mesh.indices[n + 2]]});
  if (triangles_.empty()) return;
  nodes_.push_back({{}, 0, static_cast<std::uint32_t>(triangles_.size()), 0});
  divide(0, 0);
}

void ToolSurface::divide(std::size_t node, int depth) {
  const std::uint32_t first = nodes_[node].first, last = nodes_[node].last;
  Bounds box{triangles_[first].a, triangles_[first].a};
  for (std::uint32_t n = first; n < last; ++n)
    for (const Vec3* p : {&triangles_[n].a, &triangles_[n].b, &triangles_[n].c}) box.include(*p);
  nodes_[node].box = box;
  if (last - first <= kLeaf || depth + 1 >= kDeepest) return;
  const Vec3 size = box.hi - box.lo;
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  const auto from = triangles_.begin();
  std::stable_sort(from + first, from + last, [axis](const Triangle& s, const Triangle& t) {
    return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
  });
  const std::size_t left = nodes_.size();
  nodes_[node].left = static_cast<std::uint32_t>(left);
  nodes_.push_back({{}, first, middle, 0});
  nodes_.push_back({{}, middle, last, 0});
  divide(left, depth + 1);
  divide(left + 1, depth + 1);
}

std::optional<Vec3> ToolSurface::nearest_of_mesh(const Vec3& p) const noexcept {
  std::array<std::uint32_t, 2 * kDeepest> open;
  std::size_t count = 0;
  open[count++] = 0;
  Vec3 best(0.0), outward(0.0);
  double least = std::numeric_limits<double>::infinity();
  while (count > 0) {
    const Node& node = nodes_[open[--count]];
    if (to_box2(node.box, p) >= least) continue;
    if (node.left != 0) {
      const bool first = to_box2(nodes_[node.left].box, p) < to_box2(nodes_[node.left + 1].box, p);
      open[count++] = first ? node.left + 1 : node.left;  // the nearer half is taken first
      open[count++] = first ? node.left : node.left + 1;
      continue;
    }
    for (std::uint32_t n = node.first; n < node.last; ++n) {
      const Triangle& t = triangles_[n];
      const Vec3 at = nearest_on_triangle(p, t.a, t.b, t.c), off = p - at;
      const double distance2 = glm::dot(off, off);
      if (distance2 >= least) continue;
      outward = glm::cross(t.b - t.a, t.c - t.a);
      least = distance2;
      best = at;
    }
  }
  return glm::dot(p - best, outward) > 0.0 ? std::optional(best) : std::nullopt;
}

}  // namespace burrhole
