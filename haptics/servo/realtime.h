/// haptics/servo/realtime.h: real-time services of the system for a live loop: scheduling priority, locked memory, ticks at fixed times.
///   A refused request is returned and is not fatal here: the caller warns, or ends where the user requested it.
#pragma once

#include <time.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/assert.h"

namespace burrhole {

/// Sets denormals to zero in this thread, and in threads that it starts, until the guard ends: arithmetic on denormals is about a hundred
/// times slower. Live and lockstep runs both tick under it, for the same bits. Does nothing where the processor has no such mode.
class FlushToZero {
 public:
  FlushToZero() noexcept;
  ~FlushToZero();
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_ = 0;
};

/// Locks all current and future memory of the process in RAM until it ends.
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

inline constexpr int kServoAbove = 60, kContactAbove = 50,
                     kBoneAbove = 10;  ///< FIFO priorities of the live threads, above the lowest FIFO priority

/// Requests SCHED_FIFO for this thread, at `above` over the lowest FIFO priority. @returns 0 when granted, else the errno.
[[nodiscard]] int ask_for_fifo(int above) noexcept;

/// Both refusals as one line; empty: no refusal. @param priority_fault result of ask_for_fifo().
[[nodiscard]] std::string refusal_text(int priority_fault, const std::string& memory);
/// The refusals that a live run would get, with reasons; empty: none. Changes neither priority nor memory.
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
  bool hurried_ = false;  // the last tick was overdue when it ran
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
/// [us] from one time to a later one.
[[nodiscard]] float microseconds(const timespec& from, const timespec& to) noexcept;

}  // namespace burrhole
