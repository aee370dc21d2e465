/// core/contact/contact_state.h: what contact publishes for the servo: plain values only, through a TripleBuffer.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/geometry.h"
#include "core/contact/local_contact.h"

namespace burrhole {

struct ContactState {
  Pose world_from_tool;        ///< the tool as bone lets it be
  Pose world_from_hand;        ///< the motion it answers: where the hand was
  Wrench on_hand;              ///< [N], [N m] about the tool origin, world frame
  Mat3 force_gradient{0.0};    ///< [N/m] d on_hand.force / d position of the hand (for [AcostaLiu07] eq. 3)
  LocalContact local;          ///< the same contact as planes, for a servo that goes on by itself
  double engagement = 0.0;     ///< [m]
  double cutting_force = 0.0;  ///< [N] with which the tool presses on what it cuts
  double cutting_sum = 0.0;    ///< [N] of that over all evaluations so far: two of them tell the mean between
  std::uint64_t tick = 0;      ///< servo tick of the hand motion it answers
  std::uint64_t number = 0;    ///< of the evaluation, from 1; 0: there was none yet
  std::uint32_t flags = 0;     ///< ContactFlag
};
static_assert(std::is_trivially_copyable_v<ContactState>);

}  // namespace burrhole
