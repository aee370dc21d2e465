// Sums over engaged points against a plain loop: the same bits.
#include "core/contact/flank_sums.h"

#include <doctest/doctest.h>

#include "core/base/random.h"
#include "every_level.h"

using namespace burrhole;

namespace {

constexpr double kLeast = -0.05;

struct Felt {
  PointShell shell;
  ProbeHits hits;
};

/// Every third point of a shell is a hit, half of them under the surface.
Felt felt_of(std::size_t count) {
  Felt out;
  const auto vector = [](std::uint64_t n) { return Vec3(uniform11(9, 3 * n), uniform11(9, 3 * n + 1), uniform11(9, 3 * n + 2)); };
  for (std::uint64_t n = 0; n < 3 * count; ++n) {
    out.shell.positions.push_back(4e-3 * vector(2 * n));
    out.shell.inward_normals.push_back(glm::normalize(vector(2 * n + 1)));
    out.shell.cutting.push_back(1);
  }
  out.hits.count = count;
  for (std::uint64_t n = 0; n < count; ++n) {
    out.hits.point.push_back(static_cast<std::uint32_t>(3 * n + 1));
    out.hits.distance.push_back(static_cast<float>(uniform11(10, n)));
  }
  return out;
}

FlankSums sum_plainly(const Felt& felt, const FlankAxes& axes, double least) {
  FlankSums out;
  for (std::size_t n = 0; n < felt.hits.count; ++n) {
    const Vec3& normal = felt.shell.inward_normals[felt.hits.point[n]];
    const Vec3& at = felt.shell.positions[felt.hits.point[n]];
    const double facing = glm::dot(normal, axes.push);
    if (felt.hits.distance[n] >= 0.0f || facing < least) continue;
    const double load = facing * facing, nu = glm::dot(normal, axes.u), nv = glm::dot(normal, axes.v), height = glm::dot(at, axes.push);
    out.along += load;
    out.middle += load * at;
    out.spread += load * (glm::dot(at, at) - height * height);
    out.uu += nu * nu;
    out.uv += nu * nv;
    out.vv += nv * nv;
  }
  return out;
}

bool same(const FlankSums& a, const FlankSums& b) {
  return a.along == b.along && a.middle == b.middle && a.spread == b.spread && a.uu == b.uu && a.uv == b.uv && a.vv == b.vv;
}

}  // namespace

TEST_CASE("flank friction sums: the bits of a plain loop, at every SIMD level") {
  const Quat turn = glm::normalize(Quat(0.8, 0.3, -0.4, 0.2));
  const FlankAxes axes{turn * Vec3(0.0, 0.0, 1.0), turn * Vec3(1.0, 0.0, 0.0), turn * Vec3(0.0, 1.0, 0.0)};
  for (const std::size_t count : {0, 1, 7, 8, 63, 64, 65, 130, 1000}) {
    CAPTURE(count);
    Felt felt = felt_of(count);
    const FlankSums plain = sum_plainly(felt, axes, kLeast);
    if (count == 1000) CHECK(plain.along > 20.0);
    at_all_levels([&] {
      CHECK(same(sum_flanks(felt.hits, felt.shell, axes, kLeast), plain));
      if (count == 1000) CHECK_FALSE(same(sum_flanks(felt.hits, felt.shell, axes, 2.0 * kLeast), plain));  // sabotage: another bound shows
    });
    if (count < 1000) continue;
    std::swap(felt.hits.distance[3], felt.hits.distance[4]);
    const bool alike = (felt.hits.distance[3] < 0.0f) == (felt.hits.distance[4] < 0.0f);
    CHECK(same(sum_flanks(felt.hits, felt.shell, axes, kLeast), plain) == alike);
    for (float& distance : felt.hits.distance) distance = 0.0f;  // at the surface is not under it
    CHECK(sum_flanks(felt.hits, felt.shell, axes, kLeast).along == 0.0);
  }
}
