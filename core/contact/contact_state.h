/// core/contact/contact_state.h: the result that contact publishes to the servo through a TripleBuffer: plain values only.
///   Frame  world.   Units  SI.   Trivially copyable.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/geometry.h"
#include "core/contact/local_contact.h"

namespace burrhole {

struct ContactState {
  Pose world_from_tool;        ///< pose of the constrained tool
  Pose world_from_hand;        ///< hand motion that this result belongs to
  Wrench on_hand;              ///< [N], [N m] about the tool origin, world frame
  Mat3 force_gradient{0.0};    ///< [N/m] d on_hand.force / d position of the hand (for [AcostaLiu07] eq. 3)
  LocalContact local;          ///< the same contact as planes, from which the servo extrapolates until the next state
  double engagement = 0.0;     ///< [m] engaged depth
  double cutting_force = 0.0;  ///< [N] force of the tool on the bone that it cuts
  double cutting_sum = 0.0;    ///< [N] sum of cutting_force over all evaluations; the difference of two states gives the mean between them
  double spin = 1.0;           ///< [-] spin command of that motion, 0..1 of the scene's spin
  std::uint64_t tick = 0;      ///< servo tick of that hand motion
  std::uint64_t number = 0;    ///< number of the evaluation, from 1; 0: none yet
  std::uint32_t flags = 0;     ///< ContactFlag
};
static_assert(std::is_trivially_copyable_v<ContactState>);

}  // namespace burrhole
