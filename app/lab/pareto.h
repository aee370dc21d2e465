/// app/lab/pareto.h: what is worth its cost: points that no other point beats in both cost and quality.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace burrhole {

struct PricedPoint {
  double cost = 0.0;     ///< less is better
  double quality = 0.0;  ///< more is better
};

/// Indices of the front, costs rising; so do qualities. Of equal points the first one. Values are finite (ours to see to).
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const PricedPoint> points);

}  // namespace burrhole
