/// app/stage/bleeding_state.h: whether a hole bleeds and whether its floor is seen, from [bleeding].
///   Units  SI.
#pragma once

#include "app/stage/step_graph.h"

namespace burrhole {

/// Of a bone step.
struct BleedingState {
  double level = 0.0;   ///< [-] kBleedingNone, kBleedingStarted or kBleedingWaxed
  double hidden = 0.0;  ///< [-] 1: blood hides the floor of the hole
};

inline constexpr double kBleedingNone = 0.0, kBleedingStarted = 1.0, kBleedingWaxed = 2.0;

namespace slots {
inline const SlotKey<BleedingState> kBleeding{"bleeding"};  ///< simulation clock; owned by [bleeding]
}  // namespace slots

}  // namespace burrhole
