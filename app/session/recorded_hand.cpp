#include "app/session/recorded_hand.h"

#include <algorithm>
#include <array>

#include "haptics/hand/hand_switches.h"

namespace burrhole {
namespace {

constexpr std::int64_t kRowsAtOnce = 16384;  // limits the memory for the rows of a long session

}  // namespace

Result<RecordedHand> RecordedHand::create(const SessionReader& session) {
  static constexpr std::array<const char*, 13> kNeeded{"hand_x",  "hand_y",  "hand_z",  "hand_vx", "hand_vy", "hand_vz",  "hand_qw",
                                                       "hand_qx", "hand_qy", "hand_qz", "thrust",  "phase",   "hand_tick"};
  if (session.stream(kServoStream) == nullptr) return bad_input(std::string("the session has no stream ") + kServoStream);
  const std::vector<SessionColumn>& columns = session.stream(kServoStream)->columns;
  const auto place_of = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(columns, name, &SessionColumn::name) - columns.begin());
  };
  std::array<std::size_t, kNeeded.size()> at{};
  for (std::size_t n = 0; n < kNeeded.size(); ++n) {
    at[n] = place_of(kNeeded[n]);
    if (at[n] == columns.size()) return bad_input(std::string("the session has no column ") + kNeeded[n]);
  }
  // Sessions of schema 1 have no spin command, the oldest no flags.
  const std::size_t flags = place_of("hand_flags"), spin = place_of("spin_command"), switches = place_of("switches"),
                    width = columns.size();
  const std::int64_t ticks = session.row_count(kServoStream);
  if (ticks == 0) return bad_input("the session holds no tick");
  std::vector<HandState> states;
  states.reserve(static_cast<std::size_t>(ticks));
  for (std::int64_t first = 0; first < ticks; first += kRowsAtOnce) {
    const auto rows = session.rows(kServoStream, first, kRowsAtOnce);
    if (!rows) return rows.error();
    for (std::size_t start = 0; start < rows->size(); start += width) {
      const auto value = [&](std::size_t n) { return (*rows)[start + at[n]]; };
      const double phase = value(11), flag_bits = flags < width ? (*rows)[start + flags] : 0.0;
      if (!(phase >= 0.0 && phase <= static_cast<double>(HandPhase::done)))
        return bad_input("the session holds an unknown phase of the hand");
      if (!(value(12) >= 0.0 && value(12) < 9e15)) return bad_input("the session holds no count in its column hand_tick");
      if (!(flag_bits >= 0.0 && flag_bits <= 1e9)) return bad_input("the session holds unknown flags of the hand");
      HandState state;
      state.world_from_hand = {Quat(value(6), value(7), value(8), value(9)), {value(0), value(1), value(2)}};
      state.velocity = {value(3), value(4), value(5)};
      state.thrust = value(10);
      if (spin < width) state.spin = (*rows)[start + spin];
      const double bits = switches < width ? (*rows)[start + switches] : 0.0;
      if (!(bits >= 0.0 && bits <= static_cast<double>(kAllSwitches))) return bad_input("the session holds unknown switches of the hand");
      state.switches = static_cast<std::uint32_t>(bits);
      if (!(state.spin >= 0.0 && state.spin <= 1.0)) return bad_input("the session holds a spin command that is not between 0 and 1");
      state.phase = static_cast<HandPhase>(static_cast<std::uint32_t>(phase));
      state.tick = static_cast<std::uint64_t>(value(12));
      state.flags = static_cast<std::uint32_t>(flag_bits);
      states.push_back(state);
    }
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
