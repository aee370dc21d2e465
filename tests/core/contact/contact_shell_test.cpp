#include "core/contact/contact_shell.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/random.h"

using namespace burrhole;

namespace {

PointShell random_shell(std::size_t count, std::uint64_t seed) {
  PointShell shell;
  for (std::uint64_t n = 0; n < count; ++n) {
    shell.positions.push_back(5e-3 * Vec3(uniform11(seed, 3 * n), uniform11(seed, 3 * n + 1), uniform11(seed, 3 * n + 2)));
    shell.cutting.push_back(uniform01(seed + 1, n) < 0.6);
  }
  shell.inward_normals.assign(count, Vec3(0.0, 0.0, 1.0));
  return shell;
}

/// The place of a cell on the curve, written in base two, highest bits of z, y, x first: another way to interleave.
std::string curve_place(const Vec3& p, const Vec3& lo, double cell) {
  std::string out;
  for (int bit = 20; bit >= 0; --bit)
    for (const std::size_t axis : {std::size_t{2}, std::size_t{1}, std::size_t{0}})
      out += std::fmod(std::floor(std::floor((p[axis] - lo[axis]) / cell) / std::exp2(bit)), 2.0) != 0.0 ? '1' : '0';
  return out;
}

void check_part(const ContactShellPart& part, const PointShell& shell, const Vec3& lo, double cell, bool cutting) {
  const std::size_t padded = (part.size() + kShellPad - 1) / kShellPad * kShellPad;
  CHECK(part.x.size() == padded);
  CHECK(part.y.size() == padded);
  CHECK(part.z.size() == padded);
  for (std::size_t n = 0; n < padded; ++n) {
    const Vec3& p = shell.positions[part.point[std::min(n, part.size() - 1)]];
    CHECK(part.x[n] == static_cast<float>(p.x));
    CHECK(part.y[n] == static_cast<float>(p.y));
    CHECK(part.z[n] == static_cast<float>(p.z));
  }
  for (std::size_t n = 0; n < part.size(); ++n) {
    CHECK((shell.cutting[part.point[n]] != 0) == cutting);
    if (n == 0) continue;
    const std::string before = curve_place(shell.positions[part.point[n - 1]], lo, cell);
    const std::string here = curve_place(shell.positions[part.point[n]], lo, cell);
    CHECK(before <= here);
    if (before == here) CHECK(part.point[n - 1] < part.point[n]);  // equal cells keep the shell's order
  }
}

}  // namespace

TEST_CASE("contact shell: each point once, in its part, along the curve, padded by the last") {
  const double cell = 0.5e-3;
  for (const std::size_t count : {1u, 15u, 16u, 17u, 33u, 3000u}) {
    CAPTURE(count);
    const PointShell shell = random_shell(count, count);
    const ContactShell made = make_contact_shell(shell, cell);
    Vec3 lo(1.0);
    double reach = 0.0;
    for (const Vec3& p : shell.positions) {
      lo = glm::min(lo, p);
      reach = std::max(reach, glm::length(p));
    }
    check_part(made.cutting, shell, lo, cell, true);
    check_part(made.passive, shell, lo, cell, false);
    CHECK(made.reach == reach);
    std::vector<std::uint32_t> all = made.cutting.point;
    all.insert(all.end(), made.passive.point.begin(), made.passive.point.end());
    std::ranges::sort(all);
    REQUIRE(all.size() == count);
    for (std::size_t n = 0; n < count; ++n) CHECK(all[n] == n);
  }
}

TEST_CASE("contact shell: the curve keeps neighbours together") {
  const PointShell shell = random_shell(3000, 8);
  const ContactShell made = make_contact_shell(shell, 0.5e-3);
  const auto way = [&](const std::vector<std::uint32_t>& order) {
    double sum = 0.0;
    for (std::size_t n = 1; n < order.size(); ++n) sum += glm::length(shell.positions[order[n]] - shell.positions[order[n - 1]]);
    return sum;
  };
  std::vector<std::uint32_t> unsorted = made.cutting.point;
  std::ranges::sort(unsorted);
  CHECK(5.0 * way(made.cutting.point) < way(unsorted));
}

TEST_CASE("contact shell: a part without points is empty, and so is all of an empty shell") {
  PointShell shell = random_shell(20, 3);
  shell.cutting.assign(20, 1);
  const ContactShell made = make_contact_shell(shell, 0.5e-3);
  CHECK(made.cutting.size() == 20);
  CHECK(made.passive.size() == 0);
  CHECK(made.passive.x.empty());
  const ContactShell none = make_contact_shell({}, 0.5e-3);
  CHECK(none.cutting.size() == 0);
  CHECK(none.reach == 0.0);
}

TEST_CASE("contact shell: a cell far too small for the tool keeps all points") {
  // More cells than 21 bits count: the furthest share the last one; the order is then only less good.
  const PointShell shell = random_shell(50, 4);
  for (const double cell : {1e-9, 1e-12, 1e-15}) {
    const ContactShell made = make_contact_shell(shell, cell);
    CHECK(made.cutting.size() + made.passive.size() == 50);
  }
}
