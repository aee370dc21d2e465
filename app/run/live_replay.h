/// app/run/live_replay.h: replays a recorded run, live or lockstep, in one thread: the steps run in the recorded order and compute the same
/// voxels and forces.
///   Frame  world.   Units  SI.   Errors  bad_input.   Thread  one.
#pragma once

#include <atomic>
#include <functional>

#include "app/run/inputs.h"
#include "app/session/recorded_hand.h"
#include "app/session/session.h"
#include "app/stage/stage.h"
#include "core/base/hash.h"

namespace burrhole {

/// Callbacks of a replay; each may be empty.
struct ReplayHooks {
  const std::atomic<bool>* stop = nullptr;            ///< if set, the replay ends early
  std::function<Status(double time)> tick;            ///< called before each servo tick with its recorded time [s]
  std::function<Status(const Input&)> apply;          ///< applies an input for which all clocks were stopped
  std::function<Status(const SessionStill&)> redraw;  ///< draws a picture; the bone is at the picture's step
};

struct LiveReplayed {
  Hash64 sent;  ///< hash of all forces sent to the hand
  std::uint64_t ticks = 0;
  bool cut_short = false;  ///< the recorded process was killed: the last rows refer to steps that were not saved
};

/// @returns whether the session records the order of its steps. A lockstep session of schema 1 does not; it is replayed in lockstep.
[[nodiscard]] bool has_order(const SessionReader& session) noexcept;

/// Kind of the event that a live run records once rows of its steps were lost, since the log was full.
inline constexpr const char* kUnrecordedEvent = "unrecorded";
/// @returns whether rows of steps were lost while the session was recorded: its steps cannot be repeated.
[[nodiscard]] bool lacks_rows(const SessionReader& session) noexcept;

/// @param parts must be created with `hand`, from the same session. bad_input: the rows are inconsistent (some are missing or changed), or
/// lacks_rows(). A session of a killed run has no hashes; its consistent rows are replayed.
[[nodiscard]] Result<LiveReplayed> replay_live(Stage& parts, RecordedHand& hand, const SessionReader& session, const ReplayHooks& hooks);

}  // namespace burrhole
