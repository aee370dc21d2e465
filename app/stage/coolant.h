/// app/stage/coolant.h: the liquid that reaches bone round the tip, from [irrigation].
///   Units  SI; degrees Celsius.
#pragma once

#include "app/stage/step_graph.h"

namespace burrhole {

struct Coolant {
  double flow = 0.0;     ///< [m^3/s] 0: none arrives now
  double celsius = 0.0;  ///< [C] where it arrives
  double film = 0.0;     ///< [W/(m^2 K)] heat transfer coefficient on wet bone
  double reach = 0.0;    ///< [m] from the tip, up to which bone is wet
};

/// [J/(m^3 K)] density x specific heat capacity of water at 30 C.
inline constexpr double kWaterCapacity = 995.7 * 4180.0;

namespace slots {
inline const SlotKey<Coolant> kCoolant{"coolant"};  ///< simulation clock; owned by [irrigation]
}  // namespace slots

}  // namespace burrhole
