/// app/engine/live_run.h: the steps of a scene on threads of their own, each at its own pace, over the mailboxes of the parts.
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

#include "app/engine/run_log.h"
#include "app/engine/step_timer.h"

namespace burrhole {

struct LiveOptions {
  bool require_realtime = false;            ///< a refusal of priority or of locked memory is an error
  const std::atomic<bool>* stop = nullptr;  ///< set from a signal handler: end cleanly
  std::function<void(double time, const DrillProgress&)> progress;
  std::function<void(const std::string&)> warn;
};

/// Figures of a live run beside those of the steps.
struct LiveReport {
  StepTimer servo, contact_step, contact, bone;                            ///< computing
  StepTimer servo_late, contact_late;                                      ///< waking
  std::uint64_t servo_skipped = 0, contact_skipped = 0, bone_skipped = 0;  ///< ticks slept through
  std::uint64_t unrecorded = 0;                                            ///< rows that found the log too far behind
  std::uint64_t ticks = 0;                                                 ///< of the servo, skipped ones included
  std::uint32_t faults = 0;                                                ///< of the servo, all seen
  ServoOutput last;
  std::uint64_t force_hash = 0;  ///< of all forces sent
  bool stopped = false, done = false;
};

/// Where the display's parcel changes hands: filled by the simulation thread between two steps, when asked.
class ParcelDesk {
 public:
  /// Frame side: asks and waits until the parcel is filled. @returns false when no simulation runs (any more): fill it yourself.
  [[nodiscard]] bool fetch();
  /// Simulation side, between two steps.
  template <class Gather>
  void serve(Gather&& gather) {
    if (state_.load(std::memory_order_acquire) != kAsked) return;
    gather();
    state_.store(kFilled, std::memory_order_release);
  }
  /// Simulation side: the bone is touched no more (closed), or from now on (open).
  void open() noexcept { closed_.store(false, std::memory_order_release); }
  void close() noexcept { closed_.store(true, std::memory_order_release); }
  [[nodiscard]] bool closed() const noexcept { return closed_.load(std::memory_order_acquire); }

 private:
  enum : int { kIdle, kAsked, kFilled };
  std::atomic<int> state_{kIdle};
  std::atomic<bool> closed_{true};
};

/// `desk` is where `log` has its parcels filled. Runs to the end of the script, of the scene's duration, or until stopped. Errors: a
/// refusal under require_realtime (unavailable), a session or picture that failed; the run is ended in order then too.
[[nodiscard]] Status run_live(DrillParts& parts, RunLog& log, const LiveOptions& options, ParcelDesk& desk, LiveReport& report);

/// Why this scene cannot run on threads; nothing: it can.
[[nodiscard]] std::optional<std::string> refusal_of_live(const Scene& scene);

}  // namespace burrhole
