/// app/engine/live_replay.h: the steps of a live run again, without threads or clocks, in the order that its record shows: same voxels,
/// same forces.
#pragma once

#include <atomic>
#include <functional>

#include "app/engine/drill_parts.h"
#include "app/engine/recorded_hand.h"
#include "app/engine/session.h"
#include "core/base/hash.h"

namespace burrhole {

struct LiveReplayed {
  Hash64 sent;  ///< of all forces sent to the hand
  std::uint64_t ticks = 0;
  bool cut_short = false;  ///< the run was killed: its last rows name steps that were not saved any more
};

/// Whether the session was recorded live.
[[nodiscard]] bool is_live(const SessionReader& session) noexcept;

/// `parts` were made with `hand`, from the same session. bad_input when its rows do not follow from one another (some were lost or
/// changed); of a session without hashes, which a killed run leaves, what follows is replayed.
/// `stop` ends it early; `progress` gets the recorded time [s].
[[nodiscard]] Result<LiveReplayed> replay_live(DrillParts& parts, RecordedHand& hand, const SessionReader& session,
                                               const std::atomic<bool>* stop, const std::function<void(double time)>& progress);

}  // namespace burrhole
