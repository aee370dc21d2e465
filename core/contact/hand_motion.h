/// core/contact/hand_motion.h: the motion of the hand or device, as input of every contact model.
///   Frame  world.   Units  SI.   Trivially copyable.
#pragma once

#include <optional>
#include <type_traits>

#include "core/base/geometry.h"

namespace burrhole {

struct HandMotion {
  Pose world_from_hand;  ///< pose of the tool if nothing resists
  Vec3 velocity{0.0};    ///< [m/s]
  /// [rad/s] if measured by the source; empty: models use the turn of the last period
  std::optional<Vec3> angular_velocity = std::nullopt;
};
static_assert(std::is_trivially_copyable_v<HandMotion>);

}  // namespace burrhole
