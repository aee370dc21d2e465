#include "paper_twin.h"

#include <cmath>
#include <optional>

namespace burrhole::contact_test {
namespace {

Triple times(const Rows& m, const Triple& v) {
  Triple out{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out[r] += m[r][c] * v[c];
  return out;
}
Triple times_transposed(const Rows& m, const Triple& v) {
  Triple out{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out[c] += m[r][c] * v[r];
  return out;
}
double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Triple minus(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple cross(const Triple& a, const Triple& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
bool is_zero(const Triple& a) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }
Triple unit(const Triple& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// Cramer's rule.
Rows inverted(const Rows& m) {
  const Triple c0{m[0][0], m[1][0], m[2][0]}, c1{m[0][1], m[1][1], m[2][1]}, c2{m[0][2], m[1][2], m[2][2]};
  const double det = dot(c0, cross(c1, c2));
  Rows out{cross(c1, c2), cross(c2, c0), cross(c0, c1)};
  for (Triple& row : out)
    for (double& x : row) x /= det;
  return out;
}

Cell cell_at(const Triple& p) {
  return {static_cast<int>(std::floor(p[0] + 0.5)), static_cast<int>(std::floor(p[1] + 0.5)), static_cast<int>(std::floor(p[2] + 0.5))};
}
Triple centre(const Cell& c) { return {double(c[0]), double(c[1]), double(c[2])}; }
Cell beside(Cell c, int axis, int step) {
  c[axis] += step;
  return c;
}

class Walk {
 public:
  Walk(const TwinBone& bone, const TwinLaw& law) : bone_(bone), law_(law) {}

  double density(const Cell& c) const {
    const auto found = bone_.density.find(c);
    return found == bone_.density.end() ? 0.0 : found->second;
  }
  /// Stored as float in core, hence rounded to float here.
  Triple gradient(const Cell& c) const {
    Triple g{};
    for (int axis = 0; axis < 3; ++axis) g[axis] = double(float(0.5 * (density(beside(c, axis, 1)) - density(beside(c, axis, -1)))));
    return std::sqrt(dot(g, g)) < bone_.dead_zone ? Triple{} : g;
  }
  bool filled(const Cell& c) const { return law_.any_density_collides ? density(c) > 0.0 : density(c) >= 0.5; }

  Cell low_corner(const Triple& p) const {
    return {static_cast<int>(std::floor(p[0])), static_cast<int>(std::floor(p[1])), static_cast<int>(std::floor(p[2]))};
  }
  bool collides(const Triple& p) const {
    if (law_.any_density_collides) return filled(cell_at(p));
    const Cell low = low_corner(p);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      Cell c = low;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (corner >> axis) % 2 == 1;
        const double t = p[axis] - low[axis];
        weight *= upper ? t : 1.0 - t;
        c[axis] += upper ? 1 : 0;
      }
      sum += weight * density(c);
    }
    return sum >= 0.5;
  }

  /// The surface voxel for a colliding point, or nothing if a limit is met.
  std::optional<Cell> surface_from(Triple p, const Triple& tool_vector) const {
    if (!filled(cell_at(p))) p = centre(densest_corner(p));
    Cell last_filled = cell_at(p);
    // "The tool vector is followed at voxel-sized intervals until a voxel with a non-zero gradient is found."
    int steps = 0;
    while (is_zero(gradient(cell_at(p)))) {
      if (++steps > law_.longest_march) break;
      for (int axis = 0; axis < 3; ++axis) p[axis] += tool_vector[axis];
      if (filled(cell_at(p)))
        last_filled = cell_at(p);
      else
        break;
    }
    // "The gradient is then followed to the surface." Density falls outwards, so against it.
    Triple way = gradient(cell_at(p));
    for (int ascent = 0; filled(cell_at(p)); ++ascent) {
      if (ascent == law_.longest_ascent) return std::nullopt;
      last_filled = cell_at(p);
      if (!is_zero(gradient(last_filled))) way = gradient(last_filled);
      if (is_zero(way)) return std::nullopt;
      p = minus(p, unit(way));
    }
    return last_filled;
  }

  /// Figure 5a.
  Triple plane_point(const Cell& c) const {
    std::vector<Triple> exposed;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1})
        if (!filled(beside(c, axis, side))) {
          exposed.push_back(centre(c));
          exposed.back()[axis] += 0.5 * side;
        }
    return exposed.size() == 1 ? exposed.front() : centre(c);
  }

 private:
  Cell densest_corner(const Triple& p) const {
    const Cell low = low_corner(p);
    Cell best = low;
    for (int corner = 1; corner < 8; ++corner) {
      const Cell c{low[0] + corner % 2, low[1] + corner / 2 % 2, low[2] + corner / 4};
      if (density(c) > density(best)) best = c;
    }
    return best;
  }

  const TwinBone& bone_;
  const TwinLaw& law_;
};

}  // namespace

TwinAnswer twin_force(const TwinBone& bone, const TwinLaw& law, const std::vector<TwinPoint>& points, const Triple& origin) {
  const Walk walk(bone, law);
  const Rows to_index = inverted(bone.linear);
  TwinAnswer answer;
  std::vector<std::array<Triple, 2>> pushes;  // where, force before averaging
  for (const TwinPoint& point : points) {
    const Triple index = times(to_index, minus(point.position, bone.offset));
    if (!walk.collides(index)) continue;
    const std::optional<Cell> surface = walk.surface_from(index, unit(times(to_index, point.tool_vector)));
    if (!surface) {
      ++answer.lost;
      continue;
    }
    Triple plane_point = times(bone.linear, walk.plane_point(*surface));
    for (int axis = 0; axis < 3; ++axis) plane_point[axis] += bone.offset[axis];
    const Triple gradient = walk.gradient(*surface);
    Triple normal = point.tool_vector;
    if (is_zero(gradient)) {
      ++answer.without_gradient;
    } else {
      normal = unit(times_transposed(to_index, gradient));
      for (double& x : normal) x = -x;
    }
    const double depth = std::fmax(0.0, dot(minus(plane_point, point.position), normal));  // eq. 1
    answer.depths.push_back(depth);
    const double push = law.stiffness * depth;  // eq. 2
    pushes.push_back({point.position, {normal[0] * push, normal[1] * push, normal[2] * push}});
  }
  for (const auto& [where, push] : pushes) {
    const Triple turn = cross(minus(where, origin), push);
    for (int axis = 0; axis < 3; ++axis) {
      answer.force[axis] += push[axis] / double(pushes.size());
      answer.torque[axis] += turn[axis] / double(pushes.size());
    }
  }
  return answer;
}

}  // namespace burrhole::contact_test
