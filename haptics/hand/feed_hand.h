/// haptics/hand/feed_hand.h: the feed of a test bench: a carriage that advances the drill at a fixed speed, or with a fixed thrust, to a
///   depth stop, and withdraws. It never reacts to breakthrough.
///   Frame  approach frame, as hand_script.h; depth = -z.   Units SI.   Thread servo.
///   Source own work. With a fixed thrust F: m x'' + b x' = F - force of the drill, as a weight moves a carriage.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct FeedHandConfig {
  double feed = 0.0005;             ///< [m/s] > 0 of the advance, with a thrust only until contact; the withdrawal is twice as fast
  std::optional<double> push = {};  ///< [N] > 0 thrust from contact to the stop; nothing: the feed is fixed whatever the force
  double stop = 0.003;              ///< [m] >= 0 depth of the tip below the entry at which the advance ends
  double ramp = 1.0;                ///< [s] >= 0 from contact to full thrust
  double contact_force = 1.0;       ///< [N] > 0 force on the carriage that counts as contact
  double standoff = 0.003;          ///< [m] > 0 height above the entry at start and end
  double mass = 0.6;                ///< [kg] > 0 of carriage and drill, with a thrust
  double damping = 10.0;            ///< [N s/m] >= 0 of the carriage, likewise
  double compliance = 0.0;          ///< [m/N] >= 0 between carriage and tool: under a force F the tip is F times this behind the carriage
};

/// Phases: approach until contact, lean until the stop, withdraw, done.
class FeedHand final : public HandSource {
 public:
  /// Errors: out_of_range when a value is outside its range or not finite, or when period [s] is not above 0.
  [[nodiscard]] static Result<FeedHand> create(const FeedHandConfig& config, const Pose& world_from_approach, double period);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return state_; }
  /// Advances one tick. The carriage uses the force along its axis and ignores the others. Its stop is `stop` plus the
  /// compression of the coupling, F * compliance. F is the largest force of the last 5 to 10 ms, because the damper of the coupling lowers the
  /// force for milliseconds after the bit has advanced; it is the present force if that is below contact_force. Where the drill leaves bone it
  /// advances by F * compliance at once, which no carriage can prevent.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;

 private:
  FeedHand(const FeedHandConfig& config, const Pose& world_from_approach, double period, const MassSpringDamper& carriage);
  void advance(double felt) noexcept;
  void withdraw() noexcept;
  [[nodiscard]] double thrust() const noexcept;

  FeedHandConfig config_;
  Pose world_from_approach_;
  double period_;
  MassSpringDamper carriage_;
  std::uint64_t damped_ticks_;
  double height_;                                // [m]
  double climb_ = 0.0;                           // [m/s]
  double contact_thrust_ = 0.0;                  // [N] that the carriage exerted at contact
  double largest_ = 0.0, largest_before_ = 0.0;  // [N] felt in this and in the last block of damped_ticks_
  std::uint64_t lean_tick_ = 0;
  HandState state_;
};

}  // namespace burrhole
