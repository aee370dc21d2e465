/// core/contact/contact_state.h: what contact publishes for the servo: plain values only, through a TripleBuffer.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/geometry.h"

namespace burrhole {

struct ContactState {
  Pose world_from_tool;        ///< the tool as bone lets it be
  Wrench on_hand;              ///< [N], [N m] about the tool origin, world frame
  double engagement = 0.0;     ///< [m]
  double cutting_force = 0.0;  ///< [N] with which the tool presses on what it cuts
  std::uint64_t tick = 0;      ///< servo tick of the hand motion it answers
  std::uint32_t flags = 0;     ///< ContactFlag
};
static_assert(std::is_trivially_copyable_v<ContactState>);

}  // namespace burrhole
