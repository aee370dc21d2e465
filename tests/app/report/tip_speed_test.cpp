#include "app/report/tip_speed.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace burrhole {
namespace {

TEST_CASE("tip speed: of a steady feed it is that feed, at the ends too") {
  std::vector<double> time, depth;
  for (int n = 0; n < 50; ++n) time.push_back(0.25 * n), depth.push_back(3.0 - 0.5 * n);
  for (const std::size_t span : {std::size_t{2}, std::size_t{3}, std::size_t{10}, std::size_t{1000}})
    for (const double speed : tip_speed(time, depth, span)) CHECK(speed == -2.0);  // powers of two: no rounding
}

TEST_CASE("tip speed: a live run that missed most of its ticks has samples at one time; none of them gets an infinite speed") {
  // Ten evaluations at each time, between which the tool that is constrained to the surface still moves.
  std::vector<double> time, depth;
  for (int n = 0; n < 60; ++n) time.push_back(0.05 * (n / 10)), depth.push_back(0.001 * n);
  const std::vector<double> fast = tip_speed(time, depth, 4);
  REQUIRE(fast.size() == time.size());
  int unknown = 0;
  for (std::size_t n = 0; n < fast.size(); ++n) {
    CHECK_FALSE(std::isinf(fast[n]));
    const std::size_t a = n < 2 ? 0 : n - 2, b = std::min(time.size() - 1, n + 2);
    CHECK(std::isnan(fast[n]) == (time[a] == time[b]));
    unknown += std::isnan(fast[n]) ? 1 : 0;
  }
  CHECK(unknown > 20);
  for (const double speed : tip_speed(time, depth, 20)) CHECK(std::isfinite(speed));  // a span that is longer than any pause
}

TEST_CASE("tip speed: what is not finite or overflows is no speed, and no samples give none") {
  CHECK(tip_speed({}, {}, 4).empty());
  CHECK(std::isnan(tip_speed(std::vector{0.0}, std::vector{1.0}, 4).front()));
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  for (const double depth : {none, endless, -endless, 1e308})
    for (const double speed : tip_speed(std::vector{0.0, 1e-3}, std::vector{0.0, depth}, 2)) CHECK(std::isnan(speed));
  for (const double time : {none, -1.0, 0.0}) CHECK(std::isnan(tip_speed(std::vector{0.0, time}, std::vector{0.0, 1.0}, 2).front()));
}

}  // namespace
}  // namespace burrhole
