/// app/lab/pareto.h: the Pareto front of cost and quality: points that no other point beats in both.
///   Units  any.   Errors  none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace burrhole {

struct PricedPoint {
  double cost = 0.0;     ///< [unit of the caller] less is better
  double quality = 0.0;  ///< [unit of the caller] more is better
};

/// @returns the indices of the Pareto front, costs and qualities increasing. Of equal points the first one. @pre values are finite.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const PricedPoint> points);

}  // namespace burrhole
