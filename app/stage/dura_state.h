/// app/stage/dura_state.h: what the dura under the hole does to the tool, from [dura].
///   Frame  as named.   Units  SI.
#pragma once

#include "app/stage/step_graph.h"
#include "core/base/geometry.h"

namespace burrhole {

/// Of a bone step.
struct DuraState {
  double force = 0.0;      ///< [N] on the tool, away from the dura
  double stiffness = 0.0;  ///< [N/m] growth of the force as the tool goes on
  double depth = 0.0;      ///< [m] of the tool's tip below the inner surface of the bone, along the approach axis, in that step
  double level = 0.0;      ///< [-] kDuraClear, kDuraPressed or kDuraTorn
};

inline constexpr double kDuraClear = 0.0, kDuraPressed = 1.0, kDuraTorn = 2.0;

namespace slots {
inline const SlotKey<DuraState> kDura{"dura"};      ///< simulation clock; owned by [dura]
inline const SlotKey<Vec3> kDuraPush{"dura_push"};  ///< [N] contact clock, world frame; owned by [dura]
}  // namespace slots

}  // namespace burrhole
