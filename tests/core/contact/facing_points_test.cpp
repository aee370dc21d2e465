// Points picked by vectors against a plain loop in double precision.
#include "core/contact/facing_points.h"

#include <doctest/doctest.h>

#include "core/base/random.h"
#include "every_level.h"

using namespace burrhole;

namespace {

constexpr double kLeast = -0.05, kRounding = 1e-5;

PointShell shell_of(std::size_t count) {
  PointShell shell;
  const auto vector = [](std::uint64_t n) { return Vec3(uniform11(5, 3 * n), uniform11(5, 3 * n + 1), uniform11(5, 3 * n + 2)); };
  for (std::uint64_t n = 0; n < count; ++n) {
    shell.positions.push_back(4e-3 * vector(2 * n));
    shell.inward_normals.push_back(glm::normalize(vector(2 * n + 1)));
    shell.cutting.push_back(n % 4 != 0);
  }
  return shell;
}

/// How many points are picked wrongly: missing, not facing, out of order, or not where they are.
int wrong(const PointShell& shell, const ContactShellPart& part, const ContactShellPart& picked, const Vec3& push, double least) {
  int out = 0;
  std::size_t at = 0;
  for (std::size_t n = 0; n < part.size(); ++n) {
    const double along = glm::dot(shell.inward_normals[part.point[n]], push);
    if (at < picked.size() && picked.point[at] == part.point[n]) {
      out += along < least - kRounding || picked.x[at] != part.x[n] || picked.y[at] != part.y[n] || picked.z[at] != part.z[n];
      ++at;
    } else {
      out += along >= least;
    }
  }
  return out + static_cast<int>(picked.size() - at);
}

}  // namespace

TEST_CASE("facing points: those of a plain loop, in order and where they are, at every SIMD level") {
  const Vec3 push = glm::normalize(Vec3(0.3, -0.4, 0.8));
  for (const std::size_t count : {1, 5, 22, 40, 333}) {
    const PointShell shell = shell_of(count);
    ContactShellPart part = make_contact_shell(shell, 0.25e-3).cutting;
    FacingPoints facing(shell, part);
    for (float& x : part.x) x += 1e-4f;  // drawn in after it was made
    at_all_levels([&] {
      for (const Vec3& way : {push, -push, Vec3(1.0, 0.0, 0.0)}) {
        const ContactShellPart& picked = facing.pick(part, way, kLeast);
        CHECK(wrong(shell, part, picked, way, kLeast) == 0);
        if (count < 333) continue;
        CHECK(picked.size() > 90);
        CHECK(picked.size() < 160);
        // Sabotage: another bound or the other way shows.
        CHECK(wrong(shell, part, facing.pick(part, way, kLeast + 0.05), way, kLeast) > 0);
        CHECK(wrong(shell, part, facing.pick(part, -way, kLeast), way, kLeast) > 100);
      }
    });
  }
}

TEST_CASE("facing points: a shell without cutting points has none") {
  PointShell shell = shell_of(7);
  std::ranges::fill(shell.cutting, std::uint8_t{0});
  const ContactShellPart part = make_contact_shell(shell, 0.25e-3).cutting;
  FacingPoints facing(shell, part);
  CHECK(facing.pick(part, Vec3(0.0, 0.0, 1.0), kLeast).size() == 0);
}
