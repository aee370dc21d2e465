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
  const HandState& step(const Vec3& force_on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] std::size_t ticks() const noexcept { return states_.size(); }

 private:
  explicit RecordedHand(std::vector<HandState> states) : states_(std::move(states)) {}
  std::vector<HandState> states_;
  std::size_t next_ = 0;
};

}  // namespace burrhole
