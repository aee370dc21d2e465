/// app/run/live_run.h: runs the steps of a scene on separate threads, each at its own rate; they communicate through the stage's mailboxes.
///   servo        SCHED_FIFO, highest: reads the hand, makes its force from the latest contact, sends it
///   contact      SCHED_FIFO, next: the latest motion against the newest copy of bone
///   simulation   SCHED_FIFO, lowest: cuts, publishes; rests a quarter of the time that it took, so that it cannot hold a core for itself
///   the caller   pictures and record, at leisure
///   Whatever ends the run (script, time, a signal, an exception in a picture or the record), the last thing that the hand gets is a force
///   of zero. A signal or an exception lets it fade over the servo's soft stop first; where script or time are over it is zero at once.
///   A latched fault of the servo ends nothing: the hand is without force, and the run says so.
#pragma once

#include <atomic>
#include <functional>

#include "app/run/run_log.h"
#include "core/base/step_timer.h"

namespace burrhole {

/// What the inputs that are due ask of a live run.
enum class LiveInput { none, park, failed };

struct LiveOptions {
  bool require_realtime = false;            ///< a refusal of priority or of locked memory is an error
  const std::atomic<bool>* stop = nullptr;  ///< set from a signal handler: end cleanly
  std::function<void(double time, const DrillProgress&)> progress;
  std::function<void(const std::string&)> warn;
  /// Inputs that are due before a servo tick: applies those that need no rest. With `parked` all clocks rest, and the others are applied
  /// too.
  std::function<LiveInput(std::uint64_t tick, bool parked, Status& status)> inputs{};
};

/// Figures of a live run beside those of the steps.
struct LiveReport {
  SampleTimer servo, contact_step, contact, bone;                          ///< computing
  SampleTimer servo_late, contact_late;                                    ///< lateness of the thread's wake-up
  std::uint64_t servo_skipped = 0, contact_skipped = 0, bone_skipped = 0;  ///< missed ticks
  std::uint64_t unrecorded = 0;                                            ///< rows dropped because the log was full
  std::uint64_t ticks = 0;                                                 ///< of the servo, including missed ticks
  std::uint64_t prefetched_blocks = 0;                                     ///< of 8^3 voxels, taken by slides of the window
  std::uint64_t prefetch_misses = 0;                                       ///< blocks that the simulation's thread read itself
  std::uint32_t faults = 0;                                                ///< of the servo, all seen
  ServoOutput last;
  std::uint64_t force_hash = 0;  ///< of all forces sent
  bool stopped = false, done = false;
};

/// Hand-off of the display's batch: on request, the simulation thread fills it between two steps.
class ParcelDesk {
 public:
  /// Frame side: requests the batch and waits until it is filled. @returns false if no simulation runs; the caller then fills it.
  /// @param all ignores the display's budget.
  [[nodiscard]] bool fetch(bool all);
  /// Simulation side, between two steps.
  template <class Gather>
  void serve(Gather&& gather) {
    if (state_.load(std::memory_order_acquire) != kAsked) return;
    gather(all_);
    state_.store(kFilled, std::memory_order_release);
  }
  /// Simulation side: open before the first access to bone, close after the last.
  void open() noexcept { closed_.store(false, std::memory_order_release); }
  void close() noexcept { closed_.store(true, std::memory_order_release); }
  [[nodiscard]] bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }

 private:
  enum : int { kIdle, kAsked, kFilled };
  bool all_ = false;  // written before kAsked is
  std::atomic<int> state_{kIdle};
  std::atomic<bool> closed_{true};
};

/// Runs to the end of the script or of the scene's duration, or until stopped. `desk` is the hand-off that `log` uses. Errors: unavailable
/// if real-time priority is refused under require_realtime; those of session and pictures, after an orderly end of the run.
[[nodiscard]] Status run_live(Stage& parts, RunLog& log, const LiveOptions& options, ParcelDesk& desk, LiveReport& report);

}  // namespace burrhole
