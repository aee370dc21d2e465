#include "core/drill/coverage_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr int kTraceSteps = 32;  // per sub-step; the smallest stride is its length divided by this

Affine nodes_from_index(const CuttingField& field, const Affine& index_from_tool) {
  return Affine::scaling(1.0 / field.pitch, -field.origin / field.pitch) * index_from_tool.inverse();
}

}  // namespace

CoverageSweep::CoverageSweep(const CuttingField& table, const CoverageSamples& samples, const Voxmap& voxmap, const ErosionPath& path)
    : field(table) {
  const Affine from = nodes_from_index(table, path.from), to = nodes_from_index(table, path.to);
  middle = {0.5 * (from.linear + to.linear), 0.5 * (from.offset + to.offset)};
  half = {0.5 * (to.linear - from.linear), 0.5 * (to.offset - from.offset)};
  pitch = table.pitch;
  end = Vec3f(table.dims - 1);
  const Mat3& bone = voxmap.bone().bone_from_index().linear;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Vec3 offset(samples.offset[n]);
    const Vec3f in_nodes(middle.linear * offset);
    x[n] = in_nodes.x;
    y[n] = in_nodes.y;
    z[n] = in_nodes.z;
    extent = glm::max(extent, glm::abs(in_nodes));
    far[n] = static_cast<float>(glm::length(bone * offset));
    reach = std::max(reach, static_cast<double>(far[n]));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) span[axis] = Vec3f(samples.reach * middle.linear[axis]);
  const Bounds first = bounds_under(path.from, table.bounds), last = bounds_under(path.to, table.bounds);
  const double wide = samples.reach + 0.1;  // a turn inside a sub-step bulges by far less
  const Bounds swept{glm::min(first.lo, last.lo) - wide, glm::max(first.hi, last.hi) + wide};
  // Far outside the window numbers need not fit an int.
  const VoxelBox& window = voxmap.window().box;
  const Vec3 low(window.lo - 2), high(window.hi + 2);
  box = {Vec3i(glm::ceil(glm::clamp(swept.lo, low, high))), Vec3i(glm::floor(glm::clamp(swept.hi, low, high))) + 1};
  allowed = box.intersect(voxmap.window().erodible_box());
  for (const Vec3& corner : swept.corners()) half_way = std::max(half_way, pitch * glm::length(half * corner));
  ramp = std::sqrt(3.0 * samples.variance) * voxmap.bone().bone_from_index().mean_edge();
  for (unsigned n = 0; n < 4; ++n)  // the other four corners are opposite to these
    cell = std::max(cell, 0.5 * glm::length(bone * (Bounds{Vec3(-1.0), Vec3(1.0)}.corner(n) * (kCoverageEdge - 1.0))));
}

bool CoverageSweep::met_on_the_way(const Vec3f& q, const Vec3f& half_step) const noexcept {
  const float least = 2.0f / static_cast<float>(kTraceSteps), half_length = static_cast<float>(pitch) * glm::length(half_step);
  float t = -1.0f;
  for (int n = 0; n <= kTraceSteps && t < 1.0f; ++n) {
    const float d = field.distance(q + t * half_step);
    if (d <= 0.0f) return true;
    t += std::max(least, d / half_length);
  }
  return false;
}

double CoverageSweep::way_between(const CuttingField& table, const ErosionPath& path) const noexcept {
  const Affine from = nodes_from_index(table, path.from), to = nodes_from_index(table, path.to);
  const Affine way{to.linear - from.linear, to.offset - from.offset};
  double longest = 0.0;  // affine in the place, so at a corner
  for (const Vec3& corner : Bounds{Vec3(box.lo - kCoverageEdge), Vec3(box.hi + kCoverageEdge)}.corners())
    longest = std::max(longest, glm::length(way * corner));
  return pitch * longest;
}

}  // namespace burrhole
