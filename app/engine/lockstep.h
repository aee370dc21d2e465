/// app/engine/lockstep.h: the steps of a run in a fixed order, over the same mailboxes as on threads: the same bits whenever it runs.
///   A tick  the hand is read; contact answers it where it is due; results due after the scene's latency reach the servo; the servo's force
///           goes to the hand; bone is cut where it is due.
#pragma once

#include <vector>

#include "app/engine/drill_parts.h"
#include "app/engine/step_timer.h"

namespace burrhole {

struct LockstepTimers {
  StepTimer servo, contact;
};

class Lockstep {
 public:
  /// `parts` must outlive it.
  explicit Lockstep(DrillParts& parts) : parts_(&parts), in_flight_(parts.latency + 1) {}
  /// @returns what the servo did.
  const ServoOutput& tick();
  [[nodiscard]] std::uint64_t ticks() const noexcept { return tick_; }
  [[nodiscard]] bool looked() const noexcept { return looked_; }  ///< whether contact was due in the last tick
  [[nodiscard]] LockstepTimers& timers() noexcept { return timers_; }

 private:
  DrillParts* parts_;
  std::vector<ContactState> in_flight_;  // contact results on their way: ring of latency + 1
  std::uint64_t tick_ = 0;
  bool looked_ = false;
  LockstepTimers timers_;
  ServoOutput servo_;
};

}  // namespace burrhole
