#include "core/contact/shell_regions.h"

#include <algorithm>

namespace burrhole {
namespace {

/// Dissimilarity of two points of a shell: opposite directions count as much as opposite ends of the tool.
double unlike(const PointShell& shell, std::size_t a, std::size_t b, double reach) noexcept {
  const Vec3 apart = (shell.positions[a] - shell.positions[b]) / reach;
  const Vec3 turned = shell.inward_normals[a] - shell.inward_normals[b];
  return glm::dot(apart, apart) + glm::dot(turned, turned);
}

double reach_of(const PointShell& shell) noexcept {
  Vec3 lo = shell.positions.front(), hi = lo;
  for (const Vec3& p : shell.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  return std::max(0.5 * glm::length(hi - lo), 1e-9);
}

}  // namespace

ShellRegions::ShellRegions(const PointShell& shell) : region_of_(shell.size(), 0) {
  const double reach = reach_of(shell);
  std::vector<double> nearest(shell.size());
  for (std::size_t n = 0; n < shell.size(); ++n) nearest[n] = unlike(shell, n, 0, reach);
  for (std::size_t region = 1; region < kMaxRegions; ++region) {
    const auto farthest = std::max_element(nearest.begin(), nearest.end());
    if (*farthest <= 0.0) break;
    const auto seed = static_cast<std::size_t>(farthest - nearest.begin());
    for (std::size_t n = 0; n < shell.size(); ++n)
      if (const double here = unlike(shell, n, seed, reach); here < nearest[n]) {
        nearest[n] = here;
        region_of_[n] = static_cast<std::uint8_t>(region);
      }
  }
}

void ShellRegions::pick(const ProbeHits& hits, std::array<std::uint32_t, kMaxRegions>& out) const noexcept {
  out.fill(kNoHit);
  for (std::size_t n = 0; n < hits.count; ++n) {
    std::uint32_t& best = out[region_of_[hits.point[n]]];
    if (best == kNoHit || hits.distance[n] < hits.distance[best]) best = static_cast<std::uint32_t>(n);
  }
}

}  // namespace burrhole
