/// core/base/lane_orders.h: table of the orders of lanes that put those of a mask first (compact_lanes-inl.h).
///   Frame  none.   Units  [lanes].   Errors  none.   Thread  any.
#pragma once

#include <array>
#include <cstddef>

namespace burrhole {

/// Entry `lanes` x mask + n: the lane that comes n-th. Lanes outside of the mask come last, in their order.
template <class Order, std::size_t lanes>
inline constexpr std::array<Order, lanes*(std::size_t{1} << lanes)> kLaneOrders = [] {
  std::array<Order, lanes*(std::size_t{1} << lanes)> out{};
  for (std::size_t mask = 0; mask < std::size_t{1} << lanes; ++mask) {
    std::size_t to = lanes * mask;
    for (const bool in : {true, false})
      for (std::size_t lane = 0; lane < lanes; ++lane)
        if (((mask >> lane & 1) != 0) == in) out[to++] = static_cast<Order>(lane);
  }
  return out;
}();

}  // namespace burrhole
