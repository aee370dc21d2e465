/// app/engine/recorded_hand.h: the hand of a recorded session, tick by tick, for a replay. It feels nothing: what it felt is in its motion.
#pragma once

#include <vector>

#include "app/engine/session.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

class RecordedHand final : public HandSource {
 public:
  /// bad_input when the session lacks a column of the hand or holds no row.
  [[nodiscard]] static Result<RecordedHand> create(const SessionReader& session);
  /// Past the last row the last motion stays.
  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override;
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  /// The motion of a servo tick by its own count; nothing where it was not recorded.
  [[nodiscard]] const HandState* at(std::uint64_t tick) const noexcept;
  [[nodiscard]] std::size_t ticks() const noexcept { return states_.size(); }

 private:
  explicit RecordedHand(std::vector<HandState> states) : states_(std::move(states)) {}
  std::vector<HandState> states_;
  std::size_t next_ = 0;
};

}  // namespace burrhole
