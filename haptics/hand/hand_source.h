/// haptics/hand/hand_source.h: whoever holds the drill, as the servo sees it: a simulated hand, or a recorded one in a replay.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

enum class HandPhase : std::uint32_t { approach, lean, give_felt, release, withdraw, done };

/// What the hand does now; goes to contact through a TripleBuffer.
struct HandState {
  Pose world_from_hand;  ///< where the hand would have the tool
  Vec3 velocity{0.0};    ///< [m/s]
  double thrust = 0.0;   ///< [N] along the axis into bone
  HandPhase phase = HandPhase::approach;
  std::uint64_t tick = 0;
};
static_assert(std::is_trivially_copyable_v<HandState>);

class HandSource {
 public:
  virtual ~HandSource() = default;
  /// Advances one servo tick under the force that the drill exerts on the hand [N, world frame], held over the tick.
  virtual const HandState& step(const Vec3& force_on_hand) noexcept BH_REALTIME = 0;
};

}  // namespace burrhole
