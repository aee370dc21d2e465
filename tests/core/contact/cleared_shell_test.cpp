// Points drawn in by vectors against cleared() of each.
#include "core/contact/cleared_shell.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"
#include "every_level.h"

using namespace burrhole;

namespace {

PointShell shell_of(std::size_t count) {
  PointShell shell;
  const auto vector = [](std::uint64_t n) { return Vec3(uniform11(3, 3 * n), uniform11(3, 3 * n + 1), uniform11(3, 3 * n + 2)); };
  for (std::uint64_t n = 0; n < count; ++n) {
    shell.positions.push_back(4e-3 * vector(2 * n) + Vec3(0.0, 0.0, 0.08));
    shell.inward_normals.push_back(glm::normalize(vector(2 * n + 1)));
    shell.cutting.push_back(n % 4 != 0);
  }
  return shell;
}

/// How many coordinates of the part are not those of its points, drawn in one by one.
int wrong(const PointShell& shell, const ContactShellPart& part, const Vec3& middle, const Vec3& push, double clearance) {
  int out = 0;
  for (std::size_t n = 0; n < part.x.size(); ++n) {
    const std::size_t point = part.point[std::min(n, part.size() - 1)];
    const Vec3 p = cleared(shell.positions[point], shell.inward_normals[point], push, clearance) - middle;
    out += part.x[n] != static_cast<float>(p.x);
    out += part.y[n] != static_cast<float>(p.y);
    out += part.z[n] != static_cast<float>(p.z);
  }
  return out;
}

}  // namespace

TEST_CASE("cleared shell: every place is cleared() of its point, padding too, at every SIMD level") {
  const Vec3 middle(1e-4, -2e-4, 0.08), push = glm::normalize(Vec3(0.3, -0.4, 0.8));
  for (const std::size_t count : {1, 5, 40, 333}) {
    const PointShell shell = shell_of(count);
    ContactShellPart part = make_contact_shell(shell, 0.25e-3).cutting;
    const ClearedShell drawn(shell, part, middle);
    at_all_levels([&] {
      for (const double clearance : {0.0, 1e-5, 0.19e-3}) {
        drawn.draw(push, clearance, part);
        CHECK(wrong(shell, part, middle, push, clearance) == 0);
        if (count == 333) CHECK(wrong(shell, part, middle, push, clearance + 1e-6) > 100);  // sabotage: another clearance shows
      }
    });
  }
}

TEST_CASE("cleared shell: nothing moves along the push") {
  const Vec3 push = glm::normalize(Vec3(0.3, -0.4, 0.8));
  const PointShell shell = shell_of(200);
  for (std::size_t n = 0; n < shell.size(); ++n) {
    const Vec3 way = cleared(shell.positions[n], shell.inward_normals[n], push, 1e-3) - shell.positions[n];
    // Rounding of a place of 0.08 m.
    CHECK(std::abs(glm::dot(way, push)) < 1e-16);
  }
}

TEST_CASE("cleared shell: faces towards the push are not moved, flanks by the full clearance") {
  const Vec3 push(0.0, 0.0, 1.0);
  const auto way_at = [&](double degrees) {
    const double angle = degrees / 180.0 * 3.14159265358979323846;
    return glm::length(cleared(Vec3(0.0), {std::sin(angle), 0.0, std::cos(angle)}, push, 1e-3));
  };
  for (const double degrees : {0.0, 10.0, 22.0, 158.0, 180.0}) CHECK(way_at(degrees) == 0.0);
  for (const double degrees : {52.0, 70.0, 90.0, 128.0})
    CHECK(way_at(degrees) == doctest::Approx(1e-3 * std::sin(degrees / 180.0 * 3.14159265358979323846)));
  // No jump between, which would be one of the force.
  for (double degrees = 0.0; degrees < 90.0; degrees += 0.5) CHECK(std::abs(way_at(degrees + 0.5) - way_at(degrees)) < 0.03e-3);
}

TEST_CASE("cleared shell: a shell without cutting points is drawn as nothing") {
  PointShell shell = shell_of(7);
  std::ranges::fill(shell.cutting, std::uint8_t{0});
  ContactShellPart part = make_contact_shell(shell, 0.25e-3).cutting;
  ClearedShell(shell, part, Vec3(0.0)).draw(Vec3(0.0, 0.0, 1.0), 1e-4, part);
  CHECK(part.x.empty());
}
