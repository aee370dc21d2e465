#include "app/view/surface_nets.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Lattice {
 public:
  Lattice(const FieldAt& field, const Bounds& box, double pitch) : lo_(box.lo), pitch_(pitch) {
    size_ = glm::max(Vec3i(glm::ceil((box.hi - box.lo) / pitch)) + 1, Vec3i(2));
    value_.resize(points().count());
    for_each_number(size_.z, [&](int k) {
      for_each_voxel({{0, 0, k}, {size_.x, size_.y, k + 1}},
                     [&](const Vec3i& v) { value_[points().offset_of(v)] = static_cast<float>(field(lo_ + pitch_ * Vec3(v))); });
    });
  }

  [[nodiscard]] const Vec3i& size() const noexcept { return size_; }
  [[nodiscard]] VoxelBox points() const noexcept { return {Vec3i(0), size_}; }
  [[nodiscard]] float value(const Vec3i& v) const noexcept { return value_[points().offset_of(v)]; }
  [[nodiscard]] Vec3 place(const Vec3& v) const noexcept { return lo_ + pitch_ * v; }

  /// Interpolated; at points of the lattice's coordinates.
  [[nodiscard]] double at(const Vec3& v) const noexcept {
    const Vec3 inside = glm::clamp(v, Vec3(0.0), Vec3(size_ - 1) - 1e-9);
    return trilinear(points(), value_.data(), inside);
  }
  /// By differences over two cells, which are smooth from cell to cell. [1/cell]
  [[nodiscard]] Vec3 gradient(const Vec3& v) const noexcept {
    Vec3 out(0.0);
    for (glm::length_t a = 0; a < 3; ++a) {
      Vec3 step(0.0);
      step[a] = 1.0;
      out[a] = 0.5 * (at(v + step) - at(v - step));
    }
    return out;
  }

  /// @returns the mean of the crossings of a cell's edges, moved onto the surface; nothing without a crossing.
  [[nodiscard]] std::optional<Vec3> crossing(const Vec3i& cell) const noexcept {
    const std::size_t first = points().offset_of(cell), row = static_cast<std::size_t>(size_.x),
                      slab = row * static_cast<std::size_t>(size_.y);
    std::array<double, 8> corner{};
    unsigned negative = 0;  // corners, as bits
    for (unsigned n = 0; n < 8; ++n) {
      corner[n] = static_cast<double>(value_[first + corner_offset(n, row, slab)]);
      if (!std::isfinite(corner[n])) return std::nullopt;
      negative |= (corner[n] < 0.0 ? 1u : 0u) << n;
    }
    if (negative == 0 || negative == 255) return std::nullopt;
    Vec3 sum(0.0);
    int count = 0;
    for (unsigned n = 0; n < 8; ++n)
      for (unsigned bit : {1u, 2u, 4u}) {
        if ((n & bit) != 0) continue;
        const double a = corner[n], b = corner[n | bit];
        if ((a < 0.0) == (b < 0.0)) continue;
        sum += Vec3(cell + cell_corner(n)) + a / (a - b) * Vec3(cell_corner(n | bit) - cell_corner(n));
        ++count;
      }
    Vec3 p = sum / static_cast<double>(count);
    for (int step = 0; step < 2; ++step) {
      const Vec3 g = gradient(p);
      const double square = glm::dot(g, g), f = at(p);
      if (!(square > 0.0) || !std::isfinite(square * f)) break;
      p = glm::clamp(p - g * (f / square), Vec3(cell) - 0.25, Vec3(cell) + 1.25);
    }
    return p;
  }

 private:
  Vec3 lo_;
  double pitch_;
  Vec3i size_{0};
  std::vector<float> value_;
};

/// Adds the quadrangle round each edge of the lattice that starts at a point and crosses the surface, split along its shorter diagonal.
void add_quads(const Lattice& lattice, const Vec3i& v, const std::vector<std::uint32_t>& ids, TriangleMesh& out) {
  const VoxelBox cells{Vec3i(0), lattice.size() - 1};
  const float here = lattice.value(v);
  for (glm::length_t a = 0; a < 3; ++a) {
    Vec3i along(0), b(0), c(0);
    along[a] = b[(a + 1) % 3] = c[(a + 2) % 3] = 1;
    if ((v + along)[a] >= lattice.size()[a]) continue;
    const float there = lattice.value(v + along);
    if (!std::isfinite(here) || !std::isfinite(there) || (here < 0.0f) == (there < 0.0f)) continue;
    std::array<std::uint32_t, 4> corner{};
    bool whole = true;
    const std::array<Vec3i, 4> round{v - b - c, v - c, v, v - b};  // counter-clockwise about `along`
    for (std::size_t n = 0; n < 4; ++n) {
      corner[n] = cells.contains({round[n], round[n] + 1}) ? ids[cells.offset_of(round[n])] : kNone;
      whole = whole && corner[n] != kNone;
    }
    if (!whole) continue;
    if (here >= 0.0f) std::swap(corner[1], corner[3]);
    const auto apart = [&](std::size_t m, std::size_t n) { return glm::length(out.positions[corner[m]] - out.positions[corner[n]]); };
    const std::size_t first = apart(0, 2) <= apart(1, 3) ? 0 : 1;
    for (const std::size_t n : {0, 1, 2, 0, 2, 3}) out.indices.push_back(corner[(first + n) % 4]);
  }
}

}  // namespace

TriangleMesh make_surface_mesh(const FieldAt& field, const Bounds& box, double pitch) {
  const Lattice lattice(field, box, pitch);
  const VoxelBox cells{Vec3i(0), lattice.size() - 1};
  std::vector<std::uint32_t> ids(cells.count(), kNone);
  TriangleMesh out;
  for_each_voxel(cells, [&](const Vec3i& cell) {
    const auto at = lattice.crossing(cell);
    if (!at) return;
    const Vec3 g = lattice.gradient(*at);
    const double length = glm::length(g);
    ids[cells.offset_of(cell)] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.emplace_back(lattice.place(*at));
    out.normals.emplace_back(length > 0.0 && std::isfinite(length) ? g / length : Vec3(0.0, 0.0, 1.0));
  });
  for_each_voxel(lattice.points(), [&](const Vec3i& v) { add_quads(lattice, v, ids, out); });
  return out;
}

}  // namespace burrhole
