#include "app/run/live_run.h"

#include <chrono>
#include <new>
#include <thread>

#include "app/run/live_rows.h"
#include "core/base/hash.h"
#include "core/base/spsc_queue.h"
#include "haptics/servo/realtime.h"
#include "haptics/servo/zero_force_on_exit.h"

namespace burrhole {
namespace {

constexpr float kRest = 0.25f;          // of what a step of bone took it then rests: at FIFO it never has more than four fifths of one core
constexpr double kContactOffset = 0.3;  // [servo periods] contact starts once the servo has told the hand's motion
constexpr std::uint64_t kMostCatchUp = 4;       // steps of bone made up for at once; what is more stays lost, and is told
constexpr std::uint64_t kMostHandCatchUp = 50;  // ticks for which a simulated hand is moved on at once, likewise
constexpr double kStopGrace = 0.1;              // [s] beyond the soft stop after which a servo that does not end is told to
constexpr std::size_t kPrefetchAtOnce = 64;     // blocks between two looks at whether the run goes on
constexpr auto kPrefetchEvery = std::chrono::milliseconds(1);
constexpr std::size_t kBlocksRoom = 2048;  // of 8^3 voxels, 2 KiB each, that differ from as-loaded: 28 cm^3 at 0.3 mm
constexpr auto kLookEvery = std::chrono::milliseconds(5);

}  // namespace

bool ParcelDesk::fetch(bool all) {
  if (closed()) return false;
  all_ = all;
  state_.store(kAsked, std::memory_order_release);
  while (state_.load(std::memory_order_acquire) != kFilled) {
    if (closed()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  state_.store(kIdle, std::memory_order_relaxed);
  return true;
}

namespace {

/// The threads of one live run. Constructed at rest; the destructor stops and joins whatever runs.
class Loops {
 public:
  Loops(Stage& parts, RunLog& log, const LiveOptions& options, ParcelDesk& desk, LiveReport& report)
      : parts_(&parts),
        log_(&log),
        options_(options),
        desk_(&desk),
        report_(&report),
        prefetch_(parts.voxmap->bone(), needs_labels(parts.bone->publisher().fields())) {}
  ~Loops() { halt(); }

  Status run();

 private:
  void start();
  void halt() noexcept;
  void servo_loop() noexcept;
  void contact_loop() noexcept;
  void bone_loop() noexcept;
  void cut_on();
  void prefetch_loop();
  bool granted() const noexcept { return waiting_.load(std::memory_order_acquire) == 0; }
  void prepare(int priority) noexcept;
  Status tell_refusals(const std::string& memory);
  Status drain();
  /// Rests all clocks, has the inputs applied that need it, and goes on.
  Status park();
  /// Blocks of sound that are due; on the caller's thread.
  void play_audio();
  Status tell_faults(const ServoRow& row);
  Status drain_servo();
  Status drain_contact();
  Status drain_bone();

  Stage* parts_;
  RunLog* log_;
  LiveOptions options_;
  ParcelDesk* desk_;
  LiveReport* report_;

  timespec start_{};
  std::atomic<bool> stop_{false}, hand_told_{false}, servo_ended_{false};
  std::atomic<std::uint64_t> servo_ticks_{0};  // skipped ones included
  std::atomic<int> waiting_{2};                // real-time threads that have not asked yet
  std::atomic<int> refused_{0};                // errno of a priority that was not granted
  std::atomic<std::uint64_t> unrecorded_{0};
  std::atomic<bool> broken_{false};  // the simulation thread met an exception, `why_` tells which
  std::string why_;
  std::uint32_t told_faults_ = 0;  // latched ones that were warned of
  SpscQueue<ServoRow, 1 << 14> servo_rows_;
  SpscQueue<ContactRow, 1 << 14> contact_rows_;
  SpscQueue<BoneRow, 1 << 12> bone_rows_;
  Hash64 sent_;  // servo thread
  std::vector<double> row_;
  DrillProgress progress_;
  double told_ = 0.0;  // [s] of the last progress
  std::uint64_t audio_ticks_ = 0;
  bool ended_ = false;  // the servo came to the end of script, time or stop; read once it ended
  BonePrefetch prefetch_;
  std::thread servo_, contact_, bone_, prefetch_thread_;
};

void Loops::prepare(int priority) noexcept {
  if (const int fault = ask_for_fifo(priority); fault != 0) refused_.store(fault, std::memory_order_relaxed);
  waiting_.fetch_sub(1, std::memory_order_acq_rel);
}

void Loops::servo_loop() noexcept {
  prepare(kServoAbove);
  const ZeroForceOnExit zero_at_the_end(*parts_->hand);
  TickClock clock(start_, parts_->period, 0.0);
  const auto last = static_cast<std::uint64_t>(parts_->config.duration * parts_->config.servo_hz + 0.5);
  Vec3 held(0.0);
  std::uint64_t ticks = servo_ticks_.load(std::memory_order_relaxed);
  while (!stop_.load(std::memory_order_relaxed) && ticks < last) {
    const TickClock::Wake wake = clock.wait();
    const timespec begin = now_monotonic();
    // In ticks that were slept through the hand moved on under the force that it had.
    for (std::uint64_t n = 1; n < std::min(wake.ticks, kMostHandCatchUp); ++n) parts_->hand->apply({held, Vec3(0.0)});
    // Here and not by the thread that draws: a picture may take seconds.
    if (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed)) parts_->servo->request_stop();
    parts_->servo->sense();
    hand_told_.store(true, std::memory_order_release);
    const ServoOutput& out = parts_->act();
    held = out.force;
    ticks += wake.ticks;
    servo_ticks_.store(ticks, std::memory_order_relaxed);
    sent_.add(out.force);
    report_->last = out;
    ServoRow row = servo_row(*parts_, out);
    row.skipped = static_cast<std::uint32_t>(wake.ticks - 1);
    row.late_us = wake.late_us;
    row.compute_us = microseconds(begin, now_monotonic());
    if (!servo_rows_.push(row)) unrecorded_.fetch_add(1, std::memory_order_relaxed);
    if (out.hand.phase == HandPhase::done || ((out.faults & kServoStopped) != 0 && out.gain == 0.0)) break;
  }
  report_->ticks = ticks;
  report_->force_hash = sent_.value();
  ended_ = !stop_.load(std::memory_order_relaxed);
  servo_ended_.store(true, std::memory_order_release);
}

void Loops::contact_loop() noexcept {
  prepare(kContactAbove);
  TickClock clock(start_, parts_->contact_period, kContactOffset * parts_->period);
  ContactTick& contact = *parts_->contact;
  while (!stop_.load(std::memory_order_relaxed)) {
    const TickClock::Wake wake = clock.wait();
    if (!hand_told_.load(std::memory_order_acquire)) continue;  // no pose yet: a default one would send the tool to the origin
    const timespec begin = now_monotonic();
    const ContactState& state = contact(parts_->hand_mailbox.latest());
    parts_->force_mailbox.publish(state);
    parts_->tool_mailbox.publish(state);
    ContactRow row = contact_row(*parts_, contact.window());
    row.skipped = static_cast<std::uint32_t>(wake.ticks - 1);
    row.late_us = wake.late_us;
    row.compute_us = microseconds(begin, now_monotonic());
    if (!contact_rows_.push(row)) unrecorded_.fetch_add(1, std::memory_order_relaxed);
  }
}

void Loops::bone_loop() noexcept {
  struct CloseDesk {
    ParcelDesk* desk;
    ~CloseDesk() { desk->close(); }
  } const closes{desk_};
  try {
    cut_on();
  } catch (const std::exception& fault) {
    why_ = fault.what();
    broken_.store(true, std::memory_order_release);
  } catch (...) {
    why_ = "of no known kind";
    broken_.store(true, std::memory_order_release);
  }
}

void Loops::cut_on() {
  // At leisure it slept through most of its steps on a busy machine. A refusal is told by servo and contact, who ask for more.
  const bool before_others = ask_for_fifo(kBoneAbove) == 0;
  TickClock clock(start_, parts_->bone_period, 0.5 * parts_->period);
  while (!stop_.load(std::memory_order_relaxed)) {
    const TickClock::Wake wake = clock.wait();
    const timespec woke = now_monotonic();
    for (std::uint64_t n = 0; n < std::min(wake.ticks, kMostCatchUp); ++n) {
      const ContactState& found = parts_->tool_mailbox.latest();
      if (found.number == 0) break;  // contact has not looked yet
      const timespec begin = now_monotonic();
      parts_->cut(found);
      BoneRow row = bone_row(*parts_, found.number);
      row.skipped = n == 0 && wake.ticks > kMostCatchUp ? static_cast<std::uint32_t>(wake.ticks - kMostCatchUp) : 0;
      row.compute_us = microseconds(begin, now_monotonic());
      if (!bone_rows_.push(row)) unrecorded_.fetch_add(1, std::memory_order_relaxed);
    }
    desk_->serve([&](bool all) { parts_->gather(all); });
    if (before_others) std::this_thread::sleep_for(std::chrono::duration<float, std::micro>(kRest * microseconds(woke, now_monotonic())));
  }
}

/// Of normal priority: reads bone round the window from OpenVDB, so that the simulation's thread need not.
void Loops::prefetch_loop() {
  try {
    while (!stop_.load(std::memory_order_relaxed))
      if (prefetch_.fill(kPrefetchAtOnce) == 0) std::this_thread::sleep_for(kPrefetchEvery);
  } catch (const std::bad_alloc&) {
    return;  // without memory for more, slides read what is missing themselves, and count it
  }
}

void Loops::start() {
  Voxmap& voxmap = *parts_->voxmap;
  // Up to these, slides and write-backs do not make arrays grow.
  const std::size_t window_voxels = voxmap.window().box.count() * 3 / 2;
  voxmap.reserve(window_voxels, kBlocksRoom);
  parts_->bone->publisher().reserve(window_voxels);
  voxmap.set_prefetch(&prefetch_);
  while (prefetch_.fill(kPrefetchAtOnce) > 0) continue;
  start_ = now_monotonic();
  desk_->open();
  servo_ = std::thread([this] { servo_loop(); });
  contact_ = std::thread([this] { contact_loop(); });
  bone_ = std::thread([this] { bone_loop(); });
  prefetch_thread_ = std::thread([this] { prefetch_loop(); });
}

void Loops::halt() noexcept {
  if (servo_.joinable() && !servo_ended_.load(std::memory_order_acquire)) {
    // The servo ends by itself once the force has faded; contact and bone go on until then.
    parts_->servo->request_stop();
    const auto latest = std::chrono::steady_clock::now() + std::chrono::duration<double>(parts_->config.servo.soft_stop + kStopGrace);
    while (!servo_ended_.load(std::memory_order_acquire) && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(kLookEvery);
  }
  stop_.store(true, std::memory_order_relaxed);
  for (std::thread* thread : {&servo_, &contact_, &bone_, &prefetch_thread_})
    if (thread->joinable()) thread->join();
  parts_->voxmap->set_prefetch(nullptr);
}

Status Loops::tell_refusals(const std::string& memory) {
  const std::string text = refusal_text(refused_.load(std::memory_order_relaxed), memory);
  if (text.empty()) return {};
  if (options_.require_realtime) return Error{ErrorCode::unavailable, text, {}};
  if (options_.warn) options_.warn(text + ": forces may be late");
  return {};
}

Status Loops::tell_faults(const ServoRow& row) {
  for (std::uint32_t fresh = row.faults & kServoLatched & ~told_faults_; fresh != 0; fresh &= fresh - 1) {
    const std::string name = name_of(static_cast<ServoFault>(fresh & ~(fresh - 1)));
    if (options_.warn) options_.warn("servo: " + name + ": the hand is without force from here on");
    if (Status noted = log_->record_event(static_cast<double>(row.hand.tick) * parts_->period, "fault", name); !noted) return noted;
  }
  told_faults_ |= row.faults & kServoLatched;
  return {};
}

Status Loops::drain_servo() {
  ServoRow row;
  while (servo_rows_.pop(row)) {
    report_->servo.add(row.compute_us);
    report_->servo_late.add(row.late_us);
    report_->servo_skipped += row.skipped;
    report_->faults |= row.faults;
    if (Status told = tell_faults(row); !told) return told;
    if (Status noted = log_->record_hand(row.hand); !noted) return noted;
    if (log_->session() == nullptr) continue;
    put(row, *parts_, row_);
    if (Status written = log_->session()->append(kServoRows, row_); !written) return written;
  }
  return {};
}

Status Loops::drain_contact() {
  ContactRow row;
  while (contact_rows_.pop(row)) {
    report_->contact.add(row.compute_us);
    report_->contact_step.add(row.step_us);
    report_->contact_late.add(row.late_us);
    report_->contact_skipped += row.skipped;
    progress_ = row.progress;
    if (log_->session() != nullptr) {
      put(row, *parts_, row_);
      if (Status written = log_->session()->append(kContactRows, row_); !written) return written;
    }
    if (Status seen =
            log_->record_contact({row.time, glm::length(row.on_hand.force), row.progress.depth}, row.progress, row.world_from_tool);
        !seen)
      return seen;
    if (options_.progress && row.time - told_ >= kProgressEvery) {
      told_ = row.time;
      options_.progress(row.time, row.progress);
    }
  }
  return {};
}

Status Loops::drain_bone() {
  BoneRow row;
  while (bone_rows_.pop(row)) {
    report_->bone.add(row.compute_us);
    report_->bone_skipped += row.skipped;
    if (log_->session() == nullptr) continue;
    put(row, *parts_, row_);
    if (Status written = log_->session()->append(kBoneRows, row_); !written) return written;
  }
  return {};
}

Status Loops::drain() {
  if (Status done = drain_servo(); !done) return done;
  if (Status done = drain_contact(); !done) return done;
  return drain_bone();
}

Status Loops::park() {
  stop_.store(true, std::memory_order_relaxed);
  for (std::thread* thread : {&servo_, &contact_, &bone_, &prefetch_thread_})
    if (thread->joinable()) thread->join();
  parts_->voxmap->set_prefetch(nullptr);
  if (Status drained = drain(); !drained) return drained;
  if (ended_ || broken_.load(std::memory_order_acquire)) return {};
  Status applied;
  if (options_.inputs(servo_ticks_.load(std::memory_order_relaxed), true, applied) == LiveInput::failed) return applied;
  stop_.store(false, std::memory_order_relaxed);
  servo_ended_.store(false, std::memory_order_relaxed);
  start();
  return {};
}

void Loops::play_audio() {
  if (parts_->graph.empty(Clock::audio)) return;
  const double now = microseconds(start_, now_monotonic()) * 1e-6;
  for (; static_cast<double>(audio_ticks_ + 1) * kAudioPeriod <= now; ++audio_ticks_)
    parts_->graph.run(Clock::audio, {audio_ticks_, kAudioPeriod});
}

Status Loops::run() {
  const LockedMemory locked;
  start();
  while (!granted()) std::this_thread::sleep_for(kLookEvery);
  if (Status granted = tell_refusals(locked.refusal()); !granted) return granted;
  while (!servo_ended_.load(std::memory_order_acquire)) {
    if (broken_.load(std::memory_order_acquire)) break;
    if (Status drained = drain(); !drained) return drained;
    std::this_thread::sleep_for(kLookEvery);
    play_audio();
    if (!options_.inputs) continue;
    Status applied;
    const LiveInput input = options_.inputs(servo_ticks_.load(std::memory_order_relaxed), false, applied);
    if (input == LiveInput::failed) return applied;
    if (input == LiveInput::park)
      if (Status parked = park(); !parked) return parked;
  }
  halt();
  report_->unrecorded = unrecorded_.load();
  report_->prefetched_blocks = prefetch_.hits();
  report_->prefetch_misses = prefetch_.misses();
  report_->done = report_->last.hand.phase == HandPhase::done;
  report_->stopped = !report_->done && options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
  if (Status drained = drain(); !drained) return drained;
  if (broken_.load(std::memory_order_acquire)) return Error{ErrorCode::internal, "the simulation ended on an exception: " + why_, {}};
  if (report_->unrecorded > 0 && options_.warn)
    options_.warn(std::to_string(report_->unrecorded) + " rows found the record too far behind: this session cannot be replayed");
  return {};
}

}  // namespace

Status run_live(Stage& parts, RunLog& log, const LiveOptions& options, ParcelDesk& desk, LiveReport& report) {
  return Loops(parts, log, options, desk, report).run();
}

}  // namespace burrhole
