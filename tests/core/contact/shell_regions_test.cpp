// Spots of a tool's surface: they cover it, and the nearest hit of each is found.
#include "core/contact/shell_regions.h"

#include <doctest/doctest.h>

#include <set>

#include "core/base/random.h"

using namespace burrhole;

namespace {

PointShell ball(std::size_t points) {
  PointShell shell;
  for (std::size_t n = 0; n < points; ++n) {
    const Vec3 out = glm::normalize(Vec3(uniform01(7, 3 * n) - 0.5, uniform01(7, 3 * n + 1) - 0.5, uniform01(7, 3 * n + 2) - 0.5));
    shell.positions.push_back(2e-3 * out);
    shell.inward_normals.push_back(-out);
    shell.cutting.push_back(1);
  }
  return shell;
}

}  // namespace

TEST_CASE("ShellRegions: every way that a ball can be met has a region near it") {
  const PointShell shell = ball(2000);
  const ShellRegions regions(shell);
  // 24 caps cover a sphere at 33 degrees at best (own estimate by area: 4 pi / 24); farthest-first is within twice the best cover.
  std::array<Vec3, kMaxRegions> mean{};
  for (std::size_t n = 0; n < shell.size(); ++n) mean[regions.region_of(n)] -= shell.inward_normals[n];
  for (std::size_t n = 0; n < shell.size(); ++n)
    CHECK(glm::dot(glm::normalize(mean[regions.region_of(n)]), -shell.inward_normals[n]) > std::cos(glm::radians(66.0)));
  std::set<std::size_t> used;
  for (std::size_t n = 0; n < shell.size(); ++n) used.insert(regions.region_of(n));
  CHECK(used.size() == kMaxRegions);
}

TEST_CASE("ShellRegions: a shell of few points, or of one place, has a region for each that differs") {
  const PointShell three = ball(3);
  const ShellRegions regions(three);
  CHECK(std::set<std::size_t>{regions.region_of(0), regions.region_of(1), regions.region_of(2)}.size() == 3);
  PointShell same = ball(1);
  for (int n = 0; n < 4; ++n) {
    same.positions.push_back(same.positions.front());
    same.inward_normals.push_back(same.inward_normals.front());
    same.cutting.push_back(1);
  }
  const ShellRegions one(same);
  for (std::size_t n = 0; n < same.size(); ++n) CHECK(one.region_of(n) == 0);
}

TEST_CASE("ShellRegions: picks the nearest hit of each region, and none where there is none") {
  const PointShell shell = ball(500);
  const ShellRegions regions(shell);
  ProbeHits hits;
  hits.reserve(shell.size());
  std::array<std::uint32_t, kMaxRegions> expected;
  expected.fill(kNoHit);
  for (std::uint32_t n = 0; n < 500; n += 3) {
    if (regions.region_of(n) == 5) continue;
    hits.point[hits.count] = n;
    hits.distance[hits.count] = static_cast<float>(uniform01(11, n));
    std::uint32_t& best = expected[regions.region_of(n)];
    if (best == kNoHit || hits.distance[hits.count] < hits.distance[best]) best = static_cast<std::uint32_t>(hits.count);
    ++hits.count;
  }
  std::array<std::uint32_t, kMaxRegions> found{};
  regions.pick(hits, found);
  CHECK(found == expected);
  CHECK(found[5] == kNoHit);
}
