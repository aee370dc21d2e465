/// app/run/live_run.h: runs the steps of a scene on separate threads, each at its own rate; they communicate through the stage's mailboxes.
///   servo        SCHED_FIFO, highest priority: reads the hand, computes the force from the latest contact result, sends it to the hand
///   contact      SCHED_FIFO, second: evaluates contact of the latest hand state with the newest copy of bone
///   simulation   SCHED_FIFO, lowest: cuts and publishes bone; after each step it pauses for a quarter of the step's time, so that other
///                threads get the core
///   the caller   pictures and record, at normal priority
///   The last command to the hand is a force of zero, however the run ends: script, duration, a signal, an exception in a picture or in the
///   record. After a signal or an exception the force first falls to zero over the servo's soft stop; at the end of script or duration it
///   is set to zero immediately. A latched servo fault does not end the run: the force stays zero, and a warning is reported.
///   Frame  world.   Units  SI.   Errors  see run_live().
#pragma once

#include <atomic>
#include <functional>
#include <type_traits>

#include "app/run/live_user.h"
#include "app/run/run_log.h"
#include "core/base/step_timer.h"

namespace burrhole {

/// Result of applying the inputs that are due.
enum class LiveInput {
  none,   ///< done
  park,   ///< the next one needs all clocks stopped
  failed  ///< with an error in `status`
};

struct LiveOptions {
  bool require_realtime = false;                                    ///< refused priority or locked memory is an error
  const std::atomic<bool>* stop = nullptr;                          ///< set from a signal handler: ends the run cleanly
  std::function<void(double time, const DrillProgress&)> progress;  ///< receives the simulated time [s]; may be empty
  std::function<void(const std::string&)> warn;                     ///< receives one line per warning; may be empty
  /// Applies the inputs that are due before a servo tick, in order, up to the first that needs all clocks stopped. With `parked` all clocks
  /// are stopped, and every due input is applied. May be empty.
  std::function<LiveInput(std::uint64_t tick, bool parked, Status& status)> inputs{};
  std::function<void(const LiveState&)> see{};  ///< receives the state about every 5 ms; may be empty
  /// Called about as often when the batch of changed texels is filled, to send it to the display; empty: none is filled before a picture.
  std::function<Status()> send{};
  double untimed = 0.0;                            ///< [s] at the start that the timers of the report leave out
  const std::atomic<bool>* read_failed = nullptr;  ///< a paged bone cannot be read: ends the run like `stop`; may be null
};

/// @returns whether a flag is there and set.
[[nodiscard]] inline bool is_set(const std::atomic<bool>* flag) noexcept {
  return flag != nullptr && flag->load(std::memory_order_relaxed);
}

/// Timing and counters of a live run.
struct LiveReport {
  StepTimer servo, contact_step, contact, bone;                            ///< time of computation, after LiveOptions::untimed
  StepTimer servo_late, contact_late;                                      ///< lateness of the thread's wake-up, after that
  std::uint64_t servo_skipped = 0, contact_skipped = 0, bone_skipped = 0;  ///< missed ticks
  std::uint64_t unrecorded = 0;                                            ///< rows dropped because the log was full
  std::uint64_t ticks = 0;                                                 ///< of the servo, including missed ticks
  std::uint64_t prefetched_blocks = 0;                                     ///< blocks of 8^3 voxels that slides of the window used
  std::uint64_t prefetch_misses = 0;                                       ///< blocks that the simulation thread read itself
  std::uint32_t faults = 0;                                                ///< bits of ServoFault that occurred
  ServoOutput last;
  std::uint64_t force_hash = 0;  ///< of all forces sent to the hand
  bool stopped = false;          ///< by LiveOptions::stop
  bool done = false;             ///< the script ended
};

static_assert(std::is_trivially_copyable_v<LiveReport>, "a report of fixed size: a run may last for hours");

/// Hand-off of the display's batch of changed texels: on request, the simulation thread fills it between two steps.
class BatchHandOff {
 public:
  /// Frame side: requests the batch and waits until it is filled. @returns false if no simulation runs; the caller then fills it.
  /// @param all ignores the display's budget.
  [[nodiscard]] bool fetch(bool all);
  /// Frame side: requests the batch and does not wait. @returns whether a batch is filled; it is taken then.
  [[nodiscard]] bool poll(bool all) noexcept;
  /// Simulation side, between two steps.
  template <class Gather>
  void serve(Gather&& gather) {
    if (state_.load(std::memory_order_acquire) != kRequested) return;
    gather(all_);
    state_.store(kFilled, std::memory_order_release);
  }
  /// Simulation side: open before the first access to bone, close after the last.
  void open() noexcept { closed_.store(false, std::memory_order_release); }
  void close() noexcept { closed_.store(true, std::memory_order_release); }
  [[nodiscard]] bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }

 private:
  enum : int { kIdle, kRequested, kFilled };
  bool all_ = false;  // written before state_ becomes kRequested
  std::atomic<int> state_{kIdle};
  std::atomic<bool> closed_{true};
};

/// Runs to the end of the script or of the scene's duration, or until stopped. `hand_off` is the one that `log` uses. Errors: unavailable
/// if real-time priority is refused under require_realtime; those of session and pictures, after the threads have ended; internal if the
/// simulation thread met an exception.
[[nodiscard]] Status run_live(Stage& parts, RunLog& log, const LiveOptions& options, BatchHandOff& hand_off, LiveReport& report);

}  // namespace burrhole
