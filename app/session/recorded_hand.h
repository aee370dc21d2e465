/// app/session/recorded_hand.h: the hand of a recorded session, tick by tick, for a replay. Forces do not affect its motion.
///   Frame  world.   Units  SI.   Errors  bad_input.   Thread  servo.
#pragma once

#include <vector>

#include "app/session/session.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

class RecordedHand final : public HandSource {
 public:
  /// bad_input: the session lacks a column of the hand or has no row.
  [[nodiscard]] static Result<RecordedHand> create(const SessionReader& session);
  /// @returns the motion of the next tick; after the last row, the last motion.
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  /// @returns the motion of a servo tick; null if it was not recorded.
  [[nodiscard]] const HandState* at(std::uint64_t tick) const noexcept;
  [[nodiscard]] std::size_t ticks() const noexcept { return states_.size(); }

 private:
  explicit RecordedHand(std::vector<HandState> states) : states_(std::move(states)) {}
  std::vector<HandState> states_;
  std::size_t next_ = 0;
};

}  // namespace burrhole
