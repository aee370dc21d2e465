#include "app/lab/pareto.h"

#include <algorithm>
#include <numeric>

namespace burrhole {

std::vector<std::size_t> pareto_front(std::span<const PricedPoint> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    if (points[a].cost != points[b].cost) return points[a].cost < points[b].cost;
    return points[a].quality > points[b].quality;
  });
  std::vector<std::size_t> front;
  for (const std::size_t n : order)
    if (front.empty() || points[n].quality > points[front.back()].quality) front.push_back(n);
  return front;
}

}  // namespace burrhole
