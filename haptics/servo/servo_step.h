/// haptics/servo/servo_step.h: one tick of the servo: reads the hand, computes a force from the latest contact state, limits it, applies
///   it.
///   Frame  world.   Units SI.   Thread servo: no lock, allocation, log, file or exception. request_stop() and request_reset() from any
///          thread.
///   Order in act()  faults -> multi-rate force -> finite? -> passivity controller -> cap on magnitude -> slew -> soft gain.
///   A latched fault sets the force to zero from that tick on, until reset() succeeds. The force then returns through the soft start, as it
///   does at the start, after stale contact and after a jump. While the force is zero the gain returns to 1 at once, so that the next
///   contact has its full force. Torque is neither limited nor output: no supported device renders torque.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/base/result.h"
#include "core/base/step_timer.h"
#include "core/base/triple_buffer.h"
#include "core/contact/contact_state.h"
#include "haptics/hand/hand_source.h"
#include "haptics/servo/energy_observer.h"
#include "haptics/servo/force_limits.h"
#include "haptics/servo/multi_rate.h"
#include "haptics/servo/swing_detector.h"

namespace burrhole {

enum ServoFault : std::uint32_t {
  kServoForceNotFinite = 1u << 0,  ///< latched
  kServoForceCapped = 1u << 1,     ///< the magnitude was limited in this tick
  kServoSlewLimited = 1u << 2,     ///< the change was limited in this tick
  kServoHandNotFinite = 1u << 3,   ///< latched
  kServoHandLost = 1u << 4,        ///< latched: reported by the source, or the source repeated one tick for too long
  kServoContactStale = 1u << 5,    ///< contact is too old: the force fades out, and returns when contact does
  kServoEnergy = 1u << 6,          ///< latched: the loop generated more energy than device and hand dissipate
  kServoStopped = 1u << 7,         ///< a stop was requested: the force fades out; until reset()
  kServoDamped = 1u << 8,          ///< the passivity controller added a force in this tick
  kServoHandJumped = 1u << 9,      ///< the hand's change of position in this tick is not a motion: the force returns through the soft start
  kServoSwinging = 1u << 10,       ///< the force is in a limit cycle
};
inline constexpr std::uint32_t kServoLatched = kServoForceNotFinite | kServoHandNotFinite | kServoHandLost | kServoEnergy;
[[nodiscard]] const char* name_of(ServoFault fault) noexcept;

struct ServoConfig {
  double period = 1e-3;  ///< [s] > 0
  MultiRateConfig multi_rate{};
  double largest_force = 200.0;       ///< [N] > 0: of the output to the hand; the limit of a device
  double largest_slew = 0.0;          ///< [N/s] >= 0; 0 or infinite: off
  double soft_start = 0.0;            ///< [s] >= 0: from zero to the full force, at the start, after a fault and a jump; 0: at once
  double soft_stop = 0.0;             ///< [s] >= 0: from the full force to zero, for a stop and for stale contact
  std::uint64_t max_contact_age = 0;  ///< [ticks] above which contact is stale; 0: never. contact_age_limit() is the usual value
  std::uint64_t max_hand_age = 0;     ///< [ticks] for which a source may repeat the same tick; 0: no limit
  double jump_speed = 0.0;            ///< [m/s] >= 0 above which a change of the hand's position is a jump and not a motion; 0: never
  EnergyObserverConfig energy{};
  SwingConfig swing{};
};
/// Errors: out_of_range, with the name of the value, when a value is outside the range of its comment.
[[nodiscard]] Status check(const ServoConfig& config);

struct ServoOutput {
  Vec3 force{0.0};   ///< [N] on the hand this tick
  Vec3 wanted{0.0};  ///< [N] before all limits; zero when it was not finite
  HandState hand;    ///< as read in this tick; the last finite one where this one is not finite
  std::uint32_t faults = 0;
  double gain = 0.0;                 ///< [-] of the soft start and stop, 0..1
  std::uint64_t contact_number = 0;  ///< number of the evaluation that was used
  std::uint64_t contact_age = 0;     ///< [ticks] since the motion that the contact result belongs to; 0 before the first
};

/// Numbers of ticks with each event, since construction.
struct ServoCounts {
  std::uint64_t ticks = 0, stale = 0, capped = 0, slewed = 0, damped = 0, jumped = 0, swinging = 0;
  std::uint64_t latched = 0;  ///< number of times that a fault latched
};

class ServoStep {
 public:
  ServoStep(const ServoConfig& config, HandSource& hand, TripleBuffer<ContactState>& contact_in,
            TripleBuffer<HandState>& hand_out) noexcept;

  /// First half of a tick: reads the hand and publishes its state to contact.
  const HandState& sense() noexcept BH_REALTIME;
  /// Second half: computes the force from the latest contact state, limits it and applies it to the hand. A contact result for this tick's
  /// motion is used already.
  const ServoOutput& act() noexcept BH_REALTIME { return act(Vec3(0.0)); }
  /// @param added [N] on the hand in addition to the force of contact; the same limits apply.
  const ServoOutput& act(const Vec3& added) noexcept BH_REALTIME;
  const ServoOutput& operator()() noexcept BH_REALTIME {
    sense();
    return act();
  }

  /// Any thread or signal handler: the force fades out over soft_stop and stays zero until reset(). A stop and a reset in one tick: the
  /// stop wins.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }
  /// Any thread: calls reset() at the next tick, once.
  void request_reset() noexcept { reset_requested_.store(true, std::memory_order_relaxed); }
  /// Servo thread: clears latched faults and a stop. @returns false, without a change, while a cause persists.
  bool reset() noexcept BH_REALTIME;

  /// Any thread: sets the spin command [-] 0..1 from the next sense() on; it is multiplied with that of the hand's source.
  void set_spin(double command) noexcept { spin_.store(command, std::memory_order_relaxed); }
  /// Any thread: sets bits of pedals and buttons, combined with those of the hand's source.
  void set_switches(std::uint32_t bits) noexcept { switches_.store(bits, std::memory_order_relaxed); }
  /// Restarts the soft start; the force of the last tick fades out meanwhile, so that the hand, which leans on it, meets no gap. Call it while
  /// no clock runs, when the scene may have changed abruptly.
  void restart() noexcept;
  [[nodiscard]] const HandState& hand() const noexcept { return output_.hand; }  ///< of the last sense()
  [[nodiscard]] const ServoOutput& output() const noexcept { return output_; }   ///< of the last act()
  /// As MultiRate::use_tangential_law(). Call it while the servo is parked.
  void use_tangential_law(TangentialLaw* law) { multi_rate_.use_tangential_law(law); }
  [[nodiscard]] std::uint32_t faults() const noexcept { return faults_; }
  [[nodiscard]] const ServoCounts& counts() const noexcept { return counts_; }
  /// [N] Largest magnitude of ServoOutput::force since construction.
  [[nodiscard]] double largest_output() const noexcept { return largest_output_; }
  /// Durations of the part of a tick that computes the force from the latest contact result: by its local planes, or another scheme.
  [[nodiscard]] const StepTimer& multi_rate_timer() const noexcept { return multi_rate_timer_; }
  [[nodiscard]] const Swing& swing() const noexcept { return swings_.largest(); }  ///< largest limit cycle since construction

 private:
  void read_hand() noexcept;
  void latch(std::uint32_t fault) noexcept;
  void apply_requests() noexcept;
  /// Starts the soft start, unless contact finds no force for a hand of this tick or later.
  void restart_softly() noexcept;
  /// Sets the faults of this tick except those of the force, and the age of contact.
  void watch(const ContactState& contact) noexcept;
  /// @param added [N] the part of the force that effects add.
  [[nodiscard]] Vec3 limited(Vec3 force, Vec3 added) noexcept;
  /// @returns what is left of the force that was shown at restart(), one tick on.
  [[nodiscard]] Vec3 fading() noexcept;

  ServoConfig config_;
  HandSource* hand_;
  TripleBuffer<ContactState>* contact_in_;
  TripleBuffer<HandState>* hand_out_;
  std::atomic<bool> stop_requested_{false}, reset_requested_{false};
  MultiRate multi_rate_;
  StepTimer multi_rate_timer_;
  EnergyObserver energy_;
  SwingDetector swings_;
  SlewLimit slew_;
  SoftGain gain_;
  Vec3 slewed_added_{0.0};          // [N] part of what slew_ shows that effects added
  Vec3 added_{0.0};                 // [N] part of the output that effects added
  Vec3 kept_{0.0};                  // [N] shown when restart() was called
  Vec3 kept_added_{0.0};            // [N] part of it that effects added
  double kept_share_ = 0.0;         // [-] of kept_ that is still shown
  std::uint64_t hand_age_ = 0;      // [ticks] for which the hand's tick has been the same
  std::uint64_t soft_since_ = 0;    // tick of the hand at the last abrupt removal of the force
  std::uint64_t contact_tick_ = 0;  // of the motion that the latest contact state belongs to
  std::atomic<double> spin_{1.0};   // [-]
  double spin_before_ = 1.0;        // [-] of the last sense()
  std::atomic<std::uint32_t> switches_{0};
  bool jumped_ = false;            // in the last reading
  std::uint32_t hand_faults_ = 0;  // of the last reading
  std::uint32_t faults_ = 0;
  double largest_output_ = 0.0;  // [N]
  ServoCounts counts_;
  ServoOutput output_;
};

}  // namespace burrhole
