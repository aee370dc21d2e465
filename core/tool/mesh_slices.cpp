#include "core/tool/mesh_slices.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

// A plane z = Z cuts a closed mesh in closed polygons. Each triangle contributes one segment, from the point where an edge crosses the
// plane downwards to the point where an edge crosses it upwards. A vertex counts as below if z <= Z, so an edge either crosses or does not.
// The crossing is computed from the lower end to the upper end: both triangles get the same bits. The same rule applies one dimension down:
// a row y = Y crosses a segment if exactly one end has y <= Y. Seen from outside a triangle runs counter-clockwise, so a face with a normal
// towards -x has its rising edge at smaller y than its falling edge: a crossing along +x is an entry. (Check: (0,0,0), (0,0,1), (0,1,0) has
// the normal -x, rises at y = 0 and falls at y > 0.)

namespace burrhole {
namespace {

struct SlicePoint {
  double x, y;
};

struct Segment {
  SlicePoint rising, falling;
};

double between(double a, double b, double t) noexcept {
  // Clamped: rounding must not move the crossing outside the edge.
  return std::clamp(a + t * (b - a), std::min(a, b), std::max(a, b));
}

SlicePoint edge_point(const Vec3& below, const Vec3& above, double z) noexcept {
  const double t = (z - below.z) / (above.z - below.z);
  return {between(below.x, above.x, t), between(below.y, above.y, t)};
}

std::optional<Segment> cut(const SurfaceMesh& mesh, std::size_t triangle, double z) noexcept {
  const Vec3* corner[3];
  for (std::size_t n = 0; n < 3; ++n) corner[n] = &mesh.positions[mesh.indices[3 * triangle + n]];
  Segment s{};
  bool met = false;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 &from = *corner[n], &to = *corner[(n + 1) % 3];
    if (from.z <= z && to.z > z) {
      s.rising = edge_point(from, to, z);
      met = true;
    } else if (to.z <= z && from.z > z) {
      s.falling = edge_point(to, from, z);
    }
  }
  return met ? std::optional<Segment>(s) : std::nullopt;
}

/// +1 if the row enters the solid through the segment, -1 if it leaves, 0 if they do not cross.
int crossing(const Segment& s, double y) noexcept { return (s.rising.y <= y ? 1 : 0) - (s.falling.y <= y ? 1 : 0); }

double crossing_x(const Segment& s, double y) noexcept {
  const bool rising_first = s.rising.y < s.falling.y;
  const SlicePoint &low = rising_first ? s.rising : s.falling, &high = rising_first ? s.falling : s.rising;
  return between(low.x, high.x, (y - low.y) / (high.y - low.y));
}

struct IntRange {
  int lo, hi;  ///< half-open
};

/// Lattice steps that may lie within [a, b], with one extra on either side for rounding; clamped to 0 .. count.
IntRange steps_within(double a, double b, double origin, double pitch, int count) noexcept {
  const double limit = count;
  const double lo = std::floor((a - origin) / pitch) - 1.0, hi = std::ceil((b - origin) / pitch) + 2.0;
  return {static_cast<int>(std::clamp(lo, 0.0, limit)), static_cast<int>(std::clamp(hi, 0.0, limit))};
}

/// Adds the change of the winding number by a segment at the first lattice point of each row at or after the crossing.
void add_segment(const Segment& s, const PointLattice& lattice, std::vector<int>& change) {
  const IntRange rows =
      steps_within(std::min(s.rising.y, s.falling.y), std::max(s.rising.y, s.falling.y), lattice.origin.y, lattice.pitch, lattice.dims.y);
  for (int j = rows.lo; j < rows.hi; ++j) {
    const double y = lattice.origin.y + j * lattice.pitch;
    const int sign = crossing(s, y);
    if (sign == 0) continue;
    const double i = std::max(0.0, std::ceil((crossing_x(s, y) - lattice.origin.x) / lattice.pitch));
    if (i < lattice.dims.x)
      change[static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice.dims.x) + static_cast<std::size_t>(i)] += sign;
  }
}

/// Accumulates along the rows; leaves `change` zero for the next slice.
void sum_rows(std::vector<int>& change, int width, std::vector<std::uint8_t>& inside) {
  for (std::size_t at = 0; at < change.size();) {
    int winding = 0;
    for (int i = 0; i < width; ++i, ++at) {
      winding += change[at];
      change[at] = 0;
      inside[at] = winding > 0 ? 1 : 0;
    }
  }
}

}  // namespace

void for_each_slice(const SurfaceMesh& mesh, const PointLattice& lattice,
                    const std::function<bool(int, std::span<const std::uint8_t>)>& use) {
  const std::size_t triangles = mesh.indices.size() / 3;
  std::vector<IntRange> slices(triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto z = [&](std::size_t n) { return mesh.positions[mesh.indices[3 * t + n]].z; };
    slices[t] = steps_within(std::min({z(0), z(1), z(2)}), std::max({z(0), z(1), z(2)}), lattice.origin.z, lattice.pitch, lattice.dims.z);
  }
  std::vector<std::uint32_t> waiting(triangles), active;
  std::iota(waiting.begin(), waiting.end(), 0u);
  std::sort(waiting.begin(), waiting.end(),
            [&](auto a, auto b) { return slices[a].lo != slices[b].lo ? slices[a].lo < slices[b].lo : a < b; });
  const std::size_t area = static_cast<std::size_t>(lattice.dims.x) * static_cast<std::size_t>(lattice.dims.y);
  std::vector<int> change(area, 0);
  std::vector<std::uint8_t> inside(area, 0);
  std::size_t next = 0;
  for (int k = 0; k < lattice.dims.z; ++k) {
    std::erase_if(active, [&](std::uint32_t t) { return slices[t].hi <= k; });
    for (; next < waiting.size() && slices[waiting[next]].lo <= k; ++next)
      if (slices[waiting[next]].hi > k) active.push_back(waiting[next]);
    const double z = lattice.origin.z + k * lattice.pitch;
    for (const std::uint32_t t : active)
      if (const auto segment = cut(mesh, t, z)) add_segment(*segment, lattice, change);
    sum_rows(change, lattice.dims.x, inside);
    if (!use(k, inside)) return;
  }
}

std::vector<int> windings_left_of(const SurfaceMesh& mesh, std::span<const Vec3> points) {
  std::vector<std::size_t> by_height(points.size());
  std::iota(by_height.begin(), by_height.end(), std::size_t{0});
  std::sort(by_height.begin(), by_height.end(), [&](std::size_t a, std::size_t b) { return points[a].z < points[b].z; });
  std::vector<int> winding(points.size(), 0);
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const auto z = [&](std::size_t n) { return mesh.positions[mesh.indices[3 * t + n]].z; };
    const double low = std::min({z(0), z(1), z(2)}), high = std::max({z(0), z(1), z(2)});
    auto at = std::lower_bound(by_height.begin(), by_height.end(), low, [&](std::size_t n, double height) { return points[n].z < height; });
    for (; at != by_height.end() && points[*at].z < high; ++at) {
      const Vec3& p = points[*at];
      const auto segment = cut(mesh, t, p.z);
      if (!segment) continue;
      const int sign = crossing(*segment, p.y);
      if (sign != 0 && crossing_x(*segment, p.y) < p.x) winding[*at] += sign;
    }
  }
  return winding;
}

}  // namespace burrhole
