/// haptics/hand/hand_source.h: the source of the hand's motion as the servo reads it: a simulated hand, a device, or a replayed recording.
///   Frame  world.   Units  SI.   Thread  servo.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/contact/hand_motion.h"

namespace burrhole {

/// Phases of a script (hand_script.h) or a bench (feed_hand.h, without give_felt and release). A real device is always in `approach`.
enum class HandPhase : std::uint32_t {
  approach,   ///< moves towards bone, until the force on the hand counts as contact
  lean,       ///< presses the drill onto bone
  give_felt,  ///< breakthrough was detected; the thrust goes on for the reaction time
  release,    ///< the thrust falls to zero; lean comes again if bone is left ahead of the tip
  withdraw,   ///< moves back, out of the hole
  done        ///< at its start again; the run ends
};

/// What is to be known of a reading. The servo outputs no force for a reading with one of the first two.
enum HandFlag : std::uint32_t {
  kHandLost = 1u << 0,       ///< set by the source: the device does not answer; the motion is the last one that it reported
  kHandNotFinite = 1u << 1,  ///< set by the servo: the motion read was not finite; the last finite motion replaces it
  kHandUnopposed = 1u << 2,  ///< set by the servo: a stop or a latched fault takes its force off the hand, so contact's force is not felt
};

/// State of the hand at this tick. A TripleBuffer carries it to contact. Contact models read its HandMotion.
struct HandState : HandMotion {
  double thrust = 0.0;  ///< [N] along the axis into bone
  double spin = 1.0;    ///< [-] spin command: 0 off, 1 the full spin of the scene
  HandPhase phase = HandPhase::approach;
  std::uint64_t tick = 0;      ///< increases by one each tick
  std::uint32_t flags = 0;     ///< HandFlag
  std::uint32_t switches = 0;  ///< bits of pedals and buttons
};
static_assert(std::is_trivially_copyable_v<HandState>);

/// Source of the goal pose of the tool. The servo calls read() once and then apply() once per tick.
class HandSource {
 public:
  virtual ~HandSource() = default;
  /// Current state of the hand; the reference stays valid until apply().
  [[nodiscard]] virtual const HandState& read() noexcept BH_REALTIME = 0;
  /// Sets the wrench of the drill on the hand, held from now to the next tick: [N], [N m] about the hand's position, world frame. A
  /// simulated hand advances by one tick under it.
  virtual void apply(const Wrench& on_hand) noexcept BH_REALTIME = 0;
  /// Called between read() and apply() when the commanded spin has changed. The bit is about to engage or disengage, and a script must not
  /// take this for a breakthrough.
  virtual void drive_changed() noexcept BH_REALTIME {}
  /// Called in the tick in which the clutch of the drill has released: the bit stops under the thrust, and its torque is gone. A hand feels it.
  virtual void drill_stopped() noexcept BH_REALTIME {}
  /// Called while no clock runs, when another tool is held or bone has come back, as by an undo: the bit engages anew, and a script must not
  /// take this for a breakthrough. @param softest HandScriptConfig::softest of the present tool.
  virtual void scene_changed(double softest) noexcept { static_cast<void>(softest); }
  /// Called once per tick before apply(). @param left whether bone is left on the planned axis ahead of the tip: what a surgeon sees, or feels
  /// with a probe, in the hole.
  virtual void bone_ahead(bool left) noexcept BH_REALTIME { static_cast<void>(left); }
  /// Called once per tick before apply(). @param drill [m] place of the drill in the newest contact result, in the world in which the bone is at
  /// rest: what a surgeon sees and holds. The coupling between hand and drill may become softer or harder, and then the two do not move alike.
  virtual void drill_at(const Vec3& drill) noexcept BH_REALTIME { static_cast<void>(drill); }
  /// Called before the first tick of a run in which effects push the hand, such as a guidance (added_force()), or in which bone moves.
  virtual void watch_drill() noexcept {}
  /// Called before apply() in each tick in which effects push the hand. @param force [N] world: their part of the force that apply() gives. The
  /// rest is the drill's, which lies in the hand the deeper the harder bone presses it there, whatever else pushes the hand.
  virtual void added_force(const Vec3& force) noexcept BH_REALTIME { static_cast<void>(force); }
};

}  // namespace burrhole
