/// haptics/servo/servo_step.h: one tick of the servo: the hand in, a force out of what contact told last, limits, the force to the hand.
///   Units SI, world frame.   Thread servo: no lock, allocation, log, file or exception. request_stop() and request_reset() from any
///   thread. Order in act()  faults -> multi-rate force -> finite? -> passivity controller -> cap on magnitude -> slew -> soft gain.
///   A latched fault is zero force from that tick on, until reset() finds its cause gone; the force then comes back through the soft start,
///   and so it does at the start, after stale contact and after a jump. Where nothing is felt it is back at once: bone that is touched next
///   is felt whole. Torque is not limited and so not shown: no device that is served here has one.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/base/result.h"
#include "core/base/triple_buffer.h"
#include "core/contact/contact_state.h"
#include "haptics/hand/hand_source.h"
#include "haptics/servo/energy_observer.h"
#include "haptics/servo/force_limits.h"
#include "haptics/servo/multi_rate.h"

namespace burrhole {

enum ServoFault : std::uint32_t {
  kServoForceNotFinite = 1u << 0,  ///< latched
  kServoForceCapped = 1u << 1,     ///< this tick's magnitude was limited
  kServoSlewLimited = 1u << 2,     ///< this tick's change was limited
  kServoHandNotFinite = 1u << 3,   ///< latched
  kServoHandLost = 1u << 4,        ///< latched: the source said so, or told the same tick for too long
  kServoContactStale = 1u << 5,    ///< contact is too old: the force fades, and comes back with it
  kServoEnergy = 1u << 6,          ///< latched: the loop gave out more energy than device and hand swallow
  kServoStopped = 1u << 7,         ///< a stop was asked for: the force fades; until reset()
  kServoDamped = 1u << 8,          ///< this tick the passivity controller added a force
  kServoHandJumped = 1u << 9,      ///< this tick the hand is where it cannot have moved to: the force comes back softly
};
inline constexpr std::uint32_t kServoLatched = kServoForceNotFinite | kServoHandNotFinite | kServoHandLost | kServoEnergy;
[[nodiscard]] const char* name_of(ServoFault fault) noexcept;

struct ServoConfig {
  double period = 1e-3;  ///< [s] > 0
  MultiRateConfig multi_rate{};
  double largest_force = 200.0;       ///< [N] > 0: of what reaches the hand; a device's own limit
  double largest_slew = 0.0;          ///< [N/s] >= 0; 0 or infinite: off
  double soft_start = 0.0;            ///< [s] >= 0: from nothing to the whole force, at the start, after a fault and a jump; 0: at once
  double soft_stop = 0.0;             ///< [s] >= 0: the way down, for a stop and for stale contact
  std::uint64_t max_contact_age = 0;  ///< [ticks] beyond which contact is stale; 0: never. contact_age_limit() is the usual value
  std::uint64_t max_hand_age = 0;     ///< [ticks] for which a source may tell the same tick; 0: for ever
  double jump_speed = 0.0;            ///< [m/s] >= 0 beyond which the hand did not move but is told elsewhere; 0: never
  EnergyObserverConfig energy{};
};
/// out_of_range, with the name of the value, when one is not what its comment says.
[[nodiscard]] Status check(const ServoConfig& config);

struct ServoOutput {
  Vec3 force{0.0};   ///< [N] on the hand this tick
  Vec3 wanted{0.0};  ///< [N] before all limits; zero when it was not finite
  HandState hand;    ///< as read in this tick; where that was not finite, the last that was
  std::uint32_t faults = 0;
  double gain = 0.0;                 ///< of the soft start and stop, 0..1
  std::uint64_t contact_number = 0;  ///< of the evaluation that was used
  std::uint64_t contact_age = 0;     ///< [ticks] since the motion that it answers; 0 before the first
};

/// Ticks in which each thing happened, since construction.
struct ServoCounts {
  std::uint64_t ticks = 0, stale = 0, capped = 0, slewed = 0, damped = 0, jumped = 0;
  std::uint64_t latched = 0;  ///< times that a fault latched
};

class ServoStep {
 public:
  ServoStep(const ServoConfig& config, HandSource& hand, TripleBuffer<ContactState>& contact_in,
            TripleBuffer<HandState>& hand_out) noexcept;

  /// First half of a tick: where the hand is, told to contact.
  const HandState& sense() noexcept BH_REALTIME;
  /// Second half: the force out of the latest contact, limited, to the hand. What contact found for this tick's motion counts already.
  const ServoOutput& act() noexcept BH_REALTIME;
  const ServoOutput& operator()() noexcept BH_REALTIME {
    sense();
    return act();
  }

  /// Any thread or signal handler: the force fades over soft_stop and stays away until reset(). In one tick a stop outranks a reset.
  void request_stop() noexcept { stop_asked_.store(true, std::memory_order_relaxed); }
  /// Any thread: reset() at the next tick; forgotten if that refuses.
  void request_reset() noexcept { reset_asked_.store(true, std::memory_order_relaxed); }
  /// Servo thread: takes latched faults and a stop back. @returns false, with all as it was, while a cause is still there.
  bool reset() noexcept BH_REALTIME;

  [[nodiscard]] std::uint32_t faults() const noexcept { return faults_; }
  [[nodiscard]] const ServoCounts& counts() const noexcept { return counts_; }

 private:
  void look_at_hand() noexcept;
  void latch(std::uint32_t fault) noexcept;
  void answer_requests() noexcept;
  /// The force comes back softly from here on, unless contact finds nothing for a hand of this tick or later.
  void restart_softly() noexcept;
  /// Faults of this tick but those of the force; the age of contact.
  void watch(const ContactState& contact) noexcept;
  [[nodiscard]] Vec3 limited(Vec3 force) noexcept;

  ServoConfig config_;
  HandSource* hand_;
  TripleBuffer<ContactState>* contact_in_;
  TripleBuffer<HandState>* hand_out_;
  std::atomic<bool> stop_asked_{false}, reset_asked_{false};
  MultiRate multi_rate_;
  EnergyObserver energy_;
  SlewLimit slew_;
  SoftGain gain_;
  std::uint64_t hand_age_ = 0;      // [ticks] for which the hand's tick has been the same
  std::uint64_t soft_since_ = 0;    // tick of the hand at which the force was last taken away at once
  std::uint64_t contact_tick_ = 0;  // of the motion that the latest contact answers
  bool jumped_ = false;             // by the last reading
  std::uint32_t hand_faults_ = 0;   // of the last reading
  std::uint32_t faults_ = 0;
  ServoCounts counts_;
  ServoOutput output_;
};

}  // namespace burrhole
