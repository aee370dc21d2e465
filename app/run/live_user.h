/// app/run/live_user.h: a person at a live run, behind a window; or a test in a person's place.
///   Frame  world.   Units  SI.   Errors  none.
///   Thread  functions are called by the thread of run_live(), except hear(); the servo reads `goals`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/run/inputs.h"
#include "core/measure/drill_monitor.h"
#include "haptics/hand/goal_hand.h"

namespace burrhole {

/// What a step of an effect costs now.
struct StepPrice {
  std::string effect, step;
  float us = 0.0f;     ///< [us] of a call, mean of the latest
  double share = 0.0;  ///< [-] of a core: that time over the period of its clock
};

/// How near the tip is to the zones of [zones].
struct ZoneReading {
  double distance = 0.0;  ///< [m] negative inside
  double level = 0.0;     ///< [-] kZoneClear, kZoneNear or kZoneInside of zone_state.h
};

/// What a person can see and feel of a live run.
struct LiveState {
  HandState hand;        ///< of the latest servo tick that was reported
  Pose world_from_tool;  ///< of the latest contact result
  Pose world_from_rest;  ///< of the bone in that result (BoneMotion)
  Vec3 force{0.0};       ///< [N] of the drill on the hand, before the force scale
  DrillProgress progress;
  std::optional<bool> driven;  ///< [clutch]: whether it is engaged, so that the drive turns the drill; without [clutch] nothing
  double removed = 0.0;        ///< [m^3] of bone that was cut so far, undone drilling included
  double time = 0.0;           ///< [s] simulated, of the servo
  std::uint64_t steps = 0;     ///< of bone
  float servo_us = 0.0f, contact_us = 0.0f, bone_us = 0.0f;  ///< [us] computation of the latest steps
  float servo_late_us = 0.0f;                                ///< [us] lateness of the latest servo tick
  std::uint64_t missed = 0;                                  ///< ticks of servo and contact that were missed so far
  std::uint32_t faults = 0;                                  ///< ServoFault of the latest tick
  std::optional<ZoneReading> zone{};                         ///< in a scene with [zones]
  std::shared_ptr<const std::vector<StepPrice>> prices{};    ///< of the steps in their order, twice a second; null before the first
};

class LiveUser {
 public:
  virtual ~LiveUser() = default;
  [[nodiscard]] virtual GoalMailbox& goals() noexcept = 0;
  /// @returns the next input, if there is one; its tick is set when it is applied.
  [[nodiscard]] virtual std::optional<Input> next_input() = 0;
  /// Receives the state about every 5 ms.
  virtual void see(const LiveState& state) = 0;
  /// Receives what became of an input, one line. Any thread. @param warning whether it was not done.
  virtual void hear(const std::string& line, bool warning) = 0;
  /// @returns whether the person has taken a script's hand over.
  [[nodiscard]] virtual bool took_over() { return false; }
  /// Called when the clocks have stopped for good; pictures and report follow.
  virtual void ended() {}
  /// Called when an input `pause` has stopped all clocks. @returns an input to apply while they stand (is_query()); nothing when the run is
  /// to go on or to end.
  [[nodiscard]] virtual std::optional<Input> wait_until_resumed() = 0;
};

}  // namespace burrhole
