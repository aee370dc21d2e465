/// haptics/hand/hand_source.h: whoever holds the drill, as the servo sees it: a simulated hand, a device, or a recorded one in a replay.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

enum class HandPhase : std::uint32_t { approach, lean, give_felt, release, withdraw, done };

/// What is wrong with a reading; the servo gives no force on it.
enum HandFlag : std::uint32_t {
  kHandLost = 1u << 0,       ///< set by the source: the device does not answer; the motion is that of its last report
  kHandNotFinite = 1u << 1,  ///< set by the servo: the motion told was not finite and is replaced by the last that was
};

/// What the hand does now; goes to contact through a TripleBuffer.
struct HandState {
  Pose world_from_hand;  ///< where the hand would have the tool
  Vec3 velocity{0.0};    ///< [m/s]
  double thrust = 0.0;   ///< [N] along the axis into bone
  HandPhase phase = HandPhase::approach;
  std::uint64_t tick = 0;   ///< rises by one each tick
  std::uint32_t flags = 0;  ///< HandFlag
};
static_assert(std::is_trivially_copyable_v<HandState>);

/// Read once and pushed once a servo tick, in this order.
class HandSource {
 public:
  virtual ~HandSource() = default;
  /// Where the hand is now; the reference stays good until apply().
  [[nodiscard]] virtual const HandState& read() noexcept BH_REALTIME = 0;
  /// What the drill exerts on the hand from now to the next tick, held: [N], [N m] about the hand's position, world frame. A simulated hand
  /// moves on under it by one tick.
  virtual void apply(const Wrench& on_hand) noexcept BH_REALTIME = 0;
};

}  // namespace burrhole
