#include "voxmap_twin.h"

#include <cmath>

namespace burrhole::contact_test {
namespace {

using Long = long double;
using Wide = std::array<Long, 3>;

Long dot(const Wide& a, const Wide& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Index coordinates by Gauss elimination with row exchange.
Wide solve(const Rows& m, const Triple& b) {
  std::array<std::array<Long, 4>, 3> a{};
  for (int r = 0; r < 3; ++r) a[r] = {Long(m[r][0]), Long(m[r][1]), Long(m[r][2]), Long(b[r])};
  for (int c = 0; c < 3; ++c) {
    int best = c;
    for (int r = c + 1; r < 3; ++r)
      if (std::fabs(a[r][c]) > std::fabs(a[best][c])) best = r;
    std::swap(a[c], a[best]);
    for (int r = 0; r < 3; ++r) {
      if (r == c) continue;
      const Long share = a[r][c] / a[c][c];
      for (int k = c; k < 4; ++k) a[r][k] -= share * a[c][k];
    }
  }
  return {a[0][3] / a[0][0], a[1][3] / a[1][1], a[2][3] / a[2][2]};
}

Cell nearest(const Wide& p) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis) cell[axis] = int(std::floor(p[axis] + 0.5L));
  return cell;
}

struct Push {
  Wide arm, vector;  // vector: depth along the tool vector
};

/// What the vectors amount to: one factor that each of them is multiplied by.
Long factor(TwinStack stack, const std::vector<Push>& pushes) {
  const Long n = Long(pushes.size());
  if (stack == TwinStack::added) return 1.0L;
  if (stack == TwinStack::tenth_limited) return n <= 10.0L ? 1.0L : 1.0L / (n / 10.0L);
  if (stack == TwinStack::mean) return 1.0L / n;
  // "Instead we are searching for the longest projection of the vector f_i on the vector f_D", f_D along the sum.
  Wide sum{};
  for (const Push& push : pushes)
    for (int axis = 0; axis < 3; ++axis) sum[axis] += push.vector[axis];
  const Long square = dot(sum, sum);
  Long longest = 0.0L;
  for (const Push& push : pushes) longest = std::fmax(longest, dot(push.vector, sum));
  return square > 0.0L ? longest / square : 0.0L;
}

}  // namespace

VoxmapTwinAnswer voxmap_twin_force(const TwinBone& bone, const VoxmapTwinLaw& law, const std::vector<TwinPoint>& points,
                                   const Triple& origin) {
  const auto filled = [&](const Cell& c) {
    const auto found = bone.density.find(c);
    if (found == bone.density.end()) return false;
    return law.any_density_collides ? found->second > 0.0 : found->second >= 0.5;
  };
  VoxmapTwinAnswer answer;
  std::vector<Push> pushes;
  for (const TwinPoint& point : points) {
    Triple from_zero{};
    for (int axis = 0; axis < 3; ++axis) from_zero[axis] = point.position[axis] - bone.offset[axis];
    Wide at = solve(bone.linear, from_zero);
    Cell cell = nearest(at);
    if (!filled(cell)) continue;
    if (law.walk_to_surface) {
      Wide way = solve(bone.linear, point.tool_vector);
      const Long length = std::sqrt(dot(way, way));
      bool out = false;
      for (int step = 0; step < law.longest_march && !out; ++step) {
        for (int axis = 0; axis < 3; ++axis) at[axis] += way[axis] / length;
        out = !filled(nearest(at));
        if (!out) cell = nearest(at);
      }
      if (!out) {
        ++answer.lost;
        continue;
      }
    }
    // Depth: how far the plane's point lies beyond the shell point along the tool vector.
    Long depth = 0.0L, edge = 0.0L;
    for (int axis = 0; axis < 3; ++axis) {
      Long centre = bone.offset[axis];
      for (int c = 0; c < 3; ++c) centre += Long(bone.linear[axis][c]) * cell[c];
      depth += (centre - point.position[axis]) * point.tool_vector[axis];
      edge += Long(bone.linear[axis][0]) * bone.linear[axis][0];
    }
    depth = std::fmax(0.0L, depth + law.plane_offset * std::sqrt(edge));
    answer.depths.push_back(double(depth));
    Push push;
    for (int axis = 0; axis < 3; ++axis) {
      push.arm[axis] = point.position[axis] - origin[axis];
      push.vector[axis] = depth * point.tool_vector[axis];
    }
    pushes.push_back(push);
  }
  if (pushes.empty()) return answer;
  const Long scale = factor(law.stack, pushes) * law.stiffness;
  for (auto push = pushes.rbegin(); push != pushes.rend(); ++push)
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      answer.force[axis] += double(scale * push->vector[axis]);
      answer.torque[axis] += double(scale * (push->arm[next] * push->vector[last] - push->arm[last] * push->vector[next]));
    }
  return answer;
}

}  // namespace burrhole::contact_test
