/// app/run/lockstep.h: runs the steps in a fixed order in one thread, with the mailboxes of a live run. Results are reproducible bit for
///   bit. A tick  reads the hand; evaluates contact if due; delivers contact results to the servo after the scene's latency; sends the
///           servo's force to the hand; runs the simulation step if due.
#pragma once

#include <vector>

#include "app/stage/stage.h"
#include "core/base/step_timer.h"

namespace burrhole {

class Lockstep {
 public:
  /// `parts` must outlive it.
  explicit Lockstep(Stage& parts);
  /// Runs one servo tick. @returns the servo's output.
  const ServoOutput& tick();
  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_; }
  [[nodiscard]] bool ran_contact() const noexcept { return ran_contact_; }       ///< whether contact was due in the last tick
  [[nodiscard]] bool ran_bone() const noexcept { return ran_bone_; }             ///< whether the simulation step was due in the last tick
  [[nodiscard]] std::uint64_t ran_audio() const noexcept { return ran_audio_; }  ///< blocks of sound in the last tick
  [[nodiscard]] const StepTimer& servo_timer() const noexcept { return servo_timer_; }

 private:
  void run_audio();

  Stage* parts_;
  std::vector<ContactState> in_flight_;  // contact results not delivered yet: ring of latency + 1
  std::uint64_t tick_ = 0;
  bool ran_contact_ = false, ran_bone_ = false;
  bool has_audio_;                                 // a scene without sound has no step on the audio clock
  std::uint64_t audio_ticks_ = 0, ran_audio_ = 0;  // blocks so far; in the last tick
  StepTimer servo_timer_;
  ServoOutput servo_;
};

}  // namespace burrhole
