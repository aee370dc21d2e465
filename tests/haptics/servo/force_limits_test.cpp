#include "haptics/servo/force_limits.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/local_states.h"

using namespace burrhole;

namespace {

/// [TellesONeill10] eq. (2) as printed: from the force asked for before. For comparison.
class PrintedFilter {
 public:
  explicit PrintedFilter(double delta) : delta_(delta) {}
  Vec3 operator()(const Vec3& wanted) {
    const Vec3 change = wanted - before_, from = before_;
    before_ = wanted;
    return glm::length(change) > delta_ ? from + delta_ * change / glm::length(change) : wanted;
  }

 private:
  double delta_;
  Vec3 before_{0.0};
};

template <class Filter>
std::vector<Vec3> filtered(Filter filter, const std::vector<Vec3>& wanted) {
  std::vector<Vec3> out;
  for (const Vec3& force : wanted) out.push_back(filter(force));
  return out;
}

double largest_step(const std::vector<Vec3>& forces) {
  Vec3 before(0.0);
  double out = 0.0;
  for (const Vec3& force : forces) {
    out = std::max(out, glm::length(force - before));
    before = force;
  }
  return out;
}

/// Walks, jumps and ringing of up to 300 N.
std::vector<Vec3> rough_forces(std::uint64_t seed, int ticks) {
  std::vector<Vec3> out;
  Vec3 force(0.0);
  for (int n = 0; n < ticks; ++n) {
    const auto counter = static_cast<std::uint64_t>(n);
    const double kind = uniform01(seed, counter);
    if (kind < 0.1)
      force = 300.0 * test::random_vector(seed + 1, counter);
    else if (kind < 0.3)
      force = -force;
    else
      force += 0.5 * test::random_vector(seed + 2, counter);
    out.push_back(force);
  }
  return out;
}

constexpr double kRounding = 1.0 + 1e-12;  // of forces of 300 N against steps of 2 N

}  // namespace

TEST_CASE(
    "SlewLimit: no change is larger than the bound over random force sequences, capped after it or not, where the printed filter jumps") {
  constexpr double kStep = 2.0;  // [N]
  for (std::uint64_t seed = 10; seed < 40; ++seed) {
    CAPTURE(seed);
    const auto wanted = rough_forces(seed, 500);
    const auto shown = filtered(SlewLimit(kStep), wanted);
    CHECK(largest_step(shown) <= kStep * kRounding);
    auto capped = shown;
    for (Vec3& force : capped) force = shortened(force, 20.0);
    CHECK(largest_step(capped) <= kStep * kRounding);
    CHECK(largest_step(filtered(PrintedFilter(kStep), wanted)) > 20.0 * kStep);
    CHECK(largest_step(filtered(SlewLimit(0.0), wanted)) > 20.0 * kStep);  // off
  }
}

TEST_CASE("SlewLimit: a jump is reached in as many ticks as it has bounds, straight and without overshoot, where printed it passes whole") {
  const std::vector<Vec3> jump(20, Vec3(6.0, 8.0, 0.0));  // 10 N from the first tick on
  const auto shown = filtered(SlewLimit(1.0), jump), printed = filtered(PrintedFilter(1.0), jump);
  for (std::size_t n = 0; n < shown.size(); ++n) {
    const double length = std::min(10.0, static_cast<double>(n + 1));
    CHECK(glm::length(shown[n] - length * Vec3(0.6, 0.8, 0.0)) < 1e-12);
  }
  CHECK(glm::length(printed[1] - printed[0]) > 8.999);  // 1 N, then the rest of it at once
}

TEST_CASE("SlewLimit: of a force that rings faster than the bound a small swing is left, where printed it passes whole and a tick late") {
  std::vector<Vec3> ringing;
  for (int n = 0; n < 100; ++n) ringing.emplace_back(0.0, 0.0, n % 2 == 0 ? 50.0 : -50.0);
  double shown_swing = 0.0, printed_swing = 0.0, in_step = -1e9;
  const auto shown = filtered(SlewLimit(1.0), ringing), printed = filtered(PrintedFilter(1.0), ringing);
  for (std::size_t n = 10; n < ringing.size(); ++n) {
    shown_swing = std::max(shown_swing, std::abs(shown[n].z));
    printed_swing = std::max(printed_swing, std::abs(printed[n].z));
    in_step = std::max(in_step, printed[n].z * ringing[n].z);
  }
  CHECK(shown_swing <= 1.0);
  CHECK(printed_swing == 49.0);
  CHECK(in_step < 0.0);  // always against what is asked for
}

TEST_CASE("SlewLimit: a force within the bound passes to the bit, and off it is not there") {
  SlewLimit slew(5.0), zero(0.0), infinite(std::numeric_limits<double>::infinity());
  Vec3 force(0.0);
  for (std::uint64_t n = 0; n < 100; ++n) {
    force += 2.5 * test::random_vector(77, n);  // at most 4.4 N
    CHECK(slew(force) == force);
    CHECK_FALSE(slew.limited());
    const Vec3 any = 1e6 * test::random_vector(78, n);
    CHECK(zero(any) == any);
    CHECK(infinite(any) == any);
  }
}

TEST_CASE("shortened: keeps direction, never lengthens, and holds where the square of the length overflows") {
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 v = test::random_vector(5, n) * std::exp(100.0 * uniform11(6, n));
    const Vec3 out = shortened(v, 3.0);
    CHECK(glm::length(out) <= 3.0 * (1.0 + 1e-15));
    if (glm::length(v) <= 3.0)
      CHECK(out == v);
    else
      CHECK(glm::length(out - 3.0 * glm::normalize(v)) < 1e-14);
  }
  const Vec3 huge = shortened(Vec3(3e200, 0.0, -4e200), 5.0);
  CHECK(glm::length(huge - Vec3(3.0, 0.0, -4.0)) < 1e-14);
}

TEST_CASE("SoftGain: rises and falls in straight lines of the configured durations, at once for none, and from wherever it is") {
  SoftGain gain(0.1, 0.05, 1e-3);
  for (int n = 1; n <= 100; ++n) CHECK(std::abs(gain(true) - n / 100.0) < 1e-12);
  CHECK(gain(true) == 1.0);
  for (int n = 1; n <= 25; ++n) CHECK(std::abs(gain(false) - (1.0 - n / 50.0)) < 1e-12);
  CHECK(std::abs(gain(true) - 0.51) < 1e-12);
  gain.cut();
  CHECK(gain.gain() == 0.0);
  CHECK(std::abs(gain(true) - 0.01) < 1e-15);
  SoftGain at_once(0.0, 0.0, 1e-3);
  CHECK(at_once(true) == 1.0);
  CHECK(at_once(false) == 0.0);
}
