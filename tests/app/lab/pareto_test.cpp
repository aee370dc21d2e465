#include "app/lab/pareto.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"

using namespace burrhole;

TEST_CASE("pareto: the Pareto front of a few points by hand") {
  const std::vector<PricedPoint> points{{4.0, 40.0}, {1.0, 10.0}, {2.0, 9.0}, {2.0, 30.0}, {3.0, 30.0}, {1.0, 10.0}, {5.0, 40.0}};
  CHECK(pareto_front(points) == std::vector<std::size_t>{1, 3, 0});
  CHECK(pareto_front({}).empty());
}

TEST_CASE("pareto: nothing beats a point of the Pareto front, and each other point is beaten or equalled by one of it") {
  std::vector<PricedPoint> points;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const double cost =
        uniform01(3, 2 * n);  // what costs more is better by tendency, so that the front is long; rounded, so that some are equal
    points.push_back({cost, std::round(20.0 * (0.7 * cost + 0.3 * uniform01(3, 2 * n + 1)))});
  }
  const std::vector<std::size_t> front = pareto_front(points);
  REQUIRE(front.size() > 3);
  const auto beats = [](const PricedPoint& a, const PricedPoint& b) {
    return a.cost <= b.cost && a.quality >= b.quality && (a.cost < b.cost || a.quality > b.quality);
  };
  for (std::size_t n = 0; n < points.size(); ++n) {
    const bool on_front = std::ranges::find(front, n) != front.end();
    const bool beaten = std::ranges::any_of(points, [&](const PricedPoint& other) { return beats(other, points[n]); });
    CHECK(on_front == !beaten);
  }
  for (std::size_t n = 1; n < front.size(); ++n) CHECK(points[front[n]].cost > points[front[n - 1]].cost);
}
