/// haptics/servo/realtime.h: real-time services of the system for a live loop: scheduling priority, locked memory, ticks at fixed times.
///   Units  as noted.   Errors  none: a refused request is returned as errno or text, and the caller warns or ends the run.
///   Thread  the loop's own.
#pragma once

#include <time.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/assert.h"

namespace burrhole {

/// Flushes denormals to zero in this thread, and in threads that it starts, until the guard ends: arithmetic on denormals is about a
/// hundred times slower. Live and lockstep runs both use it, so that results are bit-identical. No effect on processors without such a
/// mode.
class FlushToZero {
 public:
  FlushToZero() noexcept;
  ~FlushToZero();
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_ = 0;
};

/// Locks all current and future memory of the process in RAM until it ends. Limits the heaps of the process to two from then on.
class LockedMemory {
 public:
  LockedMemory() noexcept;
  ~LockedMemory();
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;
  /// Reason of the system's refusal; empty: granted.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

 private:
  std::string refusal_;
};

/// @returns whether the user's limit lets LockedMemory lock the program's memory; the system may refuse it even so.
[[nodiscard]] bool may_lock_memory() noexcept;

inline constexpr int kServoAbove = 60, kContactAbove = 50,
                     kBoneAbove = 10;  ///< FIFO priorities of the live threads, above the lowest FIFO priority

/// Requests SCHED_FIFO for this thread, at `above` over the lowest FIFO priority. @returns 0 when granted, else the errno.
[[nodiscard]] int ask_for_fifo(int above) noexcept;

/// @returns both refusals as one line; empty if there is none. @param priority_error result of ask_for_fifo().
[[nodiscard]] std::string refusal_text(int priority_error, const std::string& memory);
/// @returns the refusals that a live run would receive, with reasons; empty if there are none. Changes neither priority nor memory.
[[nodiscard]] std::string realtime_refusal();

/// Selects the next tick from the clock's time alone. If ticks are overdue, the newest of them runs at once, but never twice in a row: a
/// loop that cannot keep its period would run without pause and starve all threads of lower priority. It then drops the overdue ticks and
/// waits for a future one.
class TickPlan {
 public:
  /// @param first [ns] time of the first tick. @param period [ns] > 0.
  TickPlan(std::int64_t first, std::int64_t period) noexcept : next_(first), period_(period) {}
  struct Tick {
    std::uint64_t ticks = 1;  ///< since the last one; ticks - 1 of them were dropped
    std::int64_t due = 0;     ///< [ns]
  };
  [[nodiscard]] Tick next(std::int64_t now) noexcept BH_REALTIME;

 private:
  std::int64_t next_, period_;
  bool overdue_ = false;  // the last tick was overdue when it ran
};

/// Ticks at fixed times of the monotonic clock; the thread sleeps until the tick that TickPlan selects.
class TickClock {
 public:
  /// @param period [s] > 0. @param offset [s] from `start` to the first tick.
  TickClock(const timespec& start, double period, double offset) noexcept;
  struct Wake {
    std::uint64_t ticks = 1;  ///< since the last one; ticks - 1 of them were missed
    float late_us = 0.0f;     ///< [us] after the newest of them was due
  };
  Wake wait() noexcept BH_REALTIME;

 private:
  TickPlan plan_;
};

[[nodiscard]] timespec now_monotonic() noexcept;
/// @returns the time from `from` to `to` [us].
[[nodiscard]] float microseconds(const timespec& from, const timespec& to) noexcept;

}  // namespace burrhole
