/// app/engine/realtime.h: what a live loop asks of the system: its processor before all others, memory that stays, ticks that do not drift.
///   A refusal is told, never fatal here: the caller warns, or ends where the user asked for it.
#pragma once

#include <time.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/assert.h"

namespace burrhole {

/// Denormals become zero in this thread, and in threads that it starts, until the guard ends: they are a hundred times slower than other
/// numbers. Live and lockstep both tick under it, so that they compute the same bits. Does nothing where the processor has no such mode.
class FlushToZero {
 public:
  FlushToZero() noexcept;
  ~FlushToZero();
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_ = 0;
};

/// Keeps all memory of the process, now and later, in place until it ends.
class LockedMemory {
 public:
  LockedMemory() noexcept;
  ~LockedMemory();
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;
  /// Why the system refused; empty: it did not.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

 private:
  std::string refusal_;
};

inline constexpr int kServoAbove = 60, kContactAbove = 50,
                     kBoneAbove = 10;  ///< FIFO priorities of the live threads, over the lowest there is

/// Asks for SCHED_FIFO for this thread, at `above` of the lowest such priority. @returns why not; 0: it was granted (an errno).
[[nodiscard]] int ask_for_fifo(int above) noexcept;

/// Both refusals in a line; empty: there is none. @param priority_fault of ask_for_fifo().
[[nodiscard]] std::string refusal_text(int priority_fault, const std::string& memory);
/// What of both the system would refuse a live run, and why; empty: nothing. Takes neither.
[[nodiscard]] std::string realtime_refusal();

/// Which tick comes next, by the clock's time alone. A tick whose moment is past is taken at once, the newest of them; never twice in a
/// row: a loop that cannot keep its period would run free and starve all below its priority, so it gives ticks up and waits for a coming
/// one.
class TickPlan {
 public:
  /// @param first [ns] moment of the first tick. @param period [ns] > 0.
  TickPlan(std::int64_t first, std::int64_t period) noexcept : next_(first), period_(period) {}
  struct Tick {
    std::uint64_t ticks = 1;  ///< since the last one; above 1: so many less one were given up
    std::int64_t due = 0;     ///< [ns]
  };
  [[nodiscard]] Tick next(std::int64_t now) noexcept BH_REALTIME;

 private:
  std::int64_t next_, period_;
  bool hurried_ = false;  // the last tick was past when it was taken
};

/// Ticks at fixed moments of the monotonic clock, slept for as TickPlan has it.
class TickClock {
 public:
  /// @param period [s] > 0. @param offset [s] of the first tick after `start`.
  TickClock(const timespec& start, double period, double offset) noexcept;
  struct Wake {
    std::uint64_t ticks = 1;  ///< since the last one; above 1: so many less one were slept through
    float late_us = 0.0f;     ///< after the newest of them was due
  };
  Wake wait() noexcept BH_REALTIME;

 private:
  TickPlan plan_;
};

[[nodiscard]] timespec now_monotonic() noexcept;
/// [us] from one moment to a later one.
[[nodiscard]] float microseconds(const timespec& from, const timespec& to) noexcept;

}  // namespace burrhole
