#include "app/engine/recorded_hand.h"

#include <algorithm>
#include <array>

namespace burrhole {

Result<RecordedHand> RecordedHand::create(const SessionReader& session) {
  static constexpr std::array<const char*, 13> kNeeded{"hand_x",  "hand_y",  "hand_z",  "hand_vx", "hand_vy", "hand_vz",  "hand_qw",
                                                       "hand_qx", "hand_qy", "hand_qz", "thrust",  "phase",   "hand_tick"};
  std::array<std::size_t, kNeeded.size()> at{};
  for (std::size_t n = 0; n < kNeeded.size(); ++n) {
    const auto found =
        std::find_if(session.columns().begin(), session.columns().end(), [&](const SessionColumn& c) { return c.name == kNeeded[n]; });
    if (found == session.columns().end()) return bad_input(std::string("the session has no column ") + kNeeded[n]);
    at[n] = static_cast<std::size_t>(found - session.columns().begin());
  }
  // Sessions of before do not tell what was wrong with a hand.
  const auto flags =
      std::find_if(session.columns().begin(), session.columns().end(), [](const SessionColumn& c) { return c.name == "hand_flags"; });
  const auto rows = session.rows(0, session.row_count());
  if (!rows) return rows.error();
  const std::size_t width = session.columns().size();
  if (rows->empty()) return bad_input("the session holds no tick");
  std::vector<HandState> states;
  states.reserve(rows->size() / width);
  for (std::size_t start = 0; start + width <= rows->size(); start += width) {
    const auto value = [&](std::size_t n) { return (*rows)[start + at[n]]; };
    const double phase = value(11);
    if (!(phase >= 0.0 && phase <= static_cast<double>(HandPhase::done)))
      return bad_input("the session holds an unknown phase of the hand");
    HandState state;
    state.world_from_hand = {Quat(value(6), value(7), value(8), value(9)), {value(0), value(1), value(2)}};
    state.velocity = {value(3), value(4), value(5)};
    state.thrust = value(10);
    state.phase = static_cast<HandPhase>(static_cast<std::uint32_t>(phase));
    state.tick = static_cast<std::uint64_t>(std::max(0.0, value(12)));
    if (flags != session.columns().end()) {
      const double told = (*rows)[start + static_cast<std::size_t>(flags - session.columns().begin())];
      if (!(told >= 0.0 && told <= 1e9)) return bad_input("the session holds unknown flags of the hand");
      state.flags = static_cast<std::uint32_t>(told);
    }
    states.push_back(state);
  }
  return RecordedHand(std::move(states));
}

const HandState& RecordedHand::read() noexcept { return states_[std::min(next_, states_.size() - 1)]; }

const HandState* RecordedHand::at(std::uint64_t tick) const noexcept {
  const auto found = std::ranges::lower_bound(states_, tick, {}, &HandState::tick);
  return found != states_.end() && found->tick == tick ? &*found : nullptr;
}

void RecordedHand::apply(const Wrench&) noexcept { ++next_; }

}  // namespace burrhole
