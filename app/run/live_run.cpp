#include "app/run/live_run.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <new>
#include <thread>

#include "app/run/effect_events.h"
#include "app/run/live_replay.h"
#include "app/run/live_rows.h"
#include "app/stage/drill_clutch.h"
#include "core/base/caught_error.h"
#include "core/base/hash.h"
#include "core/base/spsc_queue.h"
#include "haptics/servo/realtime.h"
#include "haptics/servo/zero_force_on_exit.h"

namespace burrhole {
namespace {

constexpr float kPause = 0.125f;  // pause after a simulation step over the step's time: the step uses at most eight ninths of one core
constexpr double kContactOffset = 0.3;          // [servo periods] contact starts after the servo has published the hand state
constexpr std::uint64_t kMostCatchUp = 4;       // most missed simulation steps that are made up at once; the others are counted as skipped
constexpr std::uint64_t kMostHandCatchUp = 50;  // most missed ticks by which a simulated hand is advanced at once
constexpr double kStopGrace = 0.1;              // [s] beyond the soft stop, after which a servo that is still running is stopped
constexpr std::size_t kPrefetchAtOnce = 64;     // blocks between two checks for the end of the run
constexpr auto kPrefetchEvery = std::chrono::milliseconds(1);
constexpr double kPricesEvery = 0.5;  // [s] between two tables of what the steps cost
constexpr auto kPollEvery = std::chrono::milliseconds(5);

}  // namespace

bool BatchHandOff::fetch(bool all) {
  if (closed()) return false;
  all_ = all;
  state_.store(kRequested, std::memory_order_release);
  while (state_.load(std::memory_order_acquire) != kFilled) {
    if (closed()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  state_.store(kIdle, std::memory_order_relaxed);
  return true;
}

bool BatchHandOff::poll(bool all) noexcept {
  if (closed()) return false;
  const bool filled = state_.load(std::memory_order_acquire) == kFilled;
  if (state_.load(std::memory_order_relaxed) == kIdle) {
    all_ = all;
    state_.store(kRequested, std::memory_order_release);
  }
  if (filled) state_.store(kIdle, std::memory_order_relaxed);
  return filled;
}

namespace {

/// The threads of one live run. The constructor starts none; the destructor stops and joins those that run.
class Loops {
 public:
  Loops(Stage& parts, RunLog& log, const LiveOptions& options, BatchHandOff& hand_off, LiveReport& report)
      : parts_(&parts),
        log_(&log),
        options_(options),
        hand_off_(&hand_off),
        report_(&report),
        events_(parts.graph),
        zone_columns_(parts.graph),
        prefetch_(parts.voxmap->bone(), parts.needs.reads_window && needs_labels(parts.needs.fields)) {}
  ~Loops() { halt(); }

  Status run();

 private:
  void start();
  void halt() noexcept;
  void servo_loop() noexcept;
  void contact_loop() noexcept;
  [[nodiscard]] Error error_of_simulation() const;
  void bone_loop() noexcept;
  void run_bone_steps();
  void prefetch_loop();
  bool priorities_requested() const noexcept { return waiting_.load(std::memory_order_acquire) == 0; }
  void prepare(int priority) noexcept;
  Status report_refusals(const std::string& memory);
  Status drain();
  /// Stops all clocks, applies the inputs that need this, and starts the clocks again.
  Status park();
  /// Reports the state to the user, and sends the display what has changed.
  Status show();
  [[nodiscard]] std::shared_ptr<const std::vector<StepPrice>> prices() const;
  /// Computes the blocks of sound that are due, on the caller's thread. Their clock is that of the servo: it stops with it.
  Status run_audio();
  Status drain_servo();
  Status drain_contact();
  /// @returns the magnitude [N] of the force on the hand in a servo tick, or in the latest one that was reported. Call it with ticks in order.
  double force_at(std::uint64_t tick);
  Status drain_bone();
  /// Records, once, that rows were lost: a session that lacks rows must say so even if the process is killed later.
  Status record_losses();

  Stage* parts_;
  RunLog* log_;
  LiveOptions options_;
  BatchHandOff* hand_off_;
  LiveReport* report_;

  timespec start_{};
  std::atomic<bool> stop_{false}, hand_published_{false}, servo_ended_{false};
  std::atomic<std::uint64_t> servo_ticks_{0};  // including skipped ones
  std::atomic<int> waiting_{2};                // real-time threads that have not requested their priority yet
  std::atomic<int> refused_{0};                // errno of a refused priority
  std::atomic<std::uint64_t> unrecorded_{0};
  std::atomic<bool> broken_{false};  // the simulation thread met an exception; why_ says which
  std::exception_ptr why_;           // no text: that may need the memory that was refused
  SpscQueue<ServoRow, 1 << 14> servo_rows_;
  SpscQueue<ContactRow, 1 << 14> contact_rows_;
  SpscQueue<BoneRow, 1 << 12> bone_rows_;
  Hash64 sent_;                                               // servo thread
  std::deque<std::pair<std::uint64_t, double>> sent_forces_;  // tick and magnitude [N], from the tick of the latest contact row on
  std::vector<double> row_;
  DrillProgress progress_;
  EffectEvents events_;
  ZoneColumns zone_columns_;
  LiveState state_;
  std::size_t clutch_column_ = EffectValues::kMax;  // of [clutch] in the rows of bone
  bool recorded_losses_ = false;
  double priced_ = 0.0;            // [s] of the latest prices
  double progress_time_ = 0.0;     // [s] simulated time of the last progress report
  std::uint64_t audio_ticks_ = 0;  // blocks of sound so far
  bool ended_ = false;             // the servo ended by script, duration or stop, not by park(); read after its thread has ended
  BonePrefetch prefetch_;
  std::thread servo_, contact_, bone_, prefetch_thread_;
};

void Loops::prepare(int priority) noexcept {
  if (const int error = ask_for_fifo(priority); error != 0) refused_.store(error, std::memory_order_relaxed);
  waiting_.fetch_sub(1, std::memory_order_acq_rel);
}

void Loops::servo_loop() noexcept {
  prepare(kServoAbove);
  const ZeroForceOnExit zero_at_end(*parts_->hand);
  TickClock clock(start_, parts_->period, 0.0);
  const auto last = static_cast<std::uint64_t>(parts_->config.duration * parts_->config.servo_hz + 0.5);
  Vec3 held(0.0);
  std::uint64_t ticks = servo_ticks_.load(std::memory_order_relaxed);
  while (!stop_.load(std::memory_order_relaxed) && ticks < last) {
    const TickClock::Wake wake = clock.wait();
    const timespec begin = now_monotonic();
    // During missed ticks the hand moved under the last force.
    for (std::uint64_t n = 1; n < std::min(wake.ticks, kMostHandCatchUp); ++n) parts_->hand->apply({held, Vec3(0.0)});
    // The servo checks the stop flag itself: the drawing thread may take seconds for one picture.
    if (is_set(options_.stop) || is_set(options_.read_failed)) parts_->servo->request_stop();
    parts_->servo->sense();
    hand_published_.store(true, std::memory_order_release);
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
    if (!hand_published_.load(std::memory_order_acquire)) continue;  // no pose yet; the default one would move the tool to the origin
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
  struct CloseAtEnd {
    BatchHandOff* hand_off;
    ~CloseAtEnd() { hand_off->close(); }
  } const closes{hand_off_};
  try {
    run_bone_steps();
  } catch (...) {
    why_ = std::current_exception();
    broken_.store(true, std::memory_order_release);
  }
}

void Loops::run_bone_steps() {
  // At normal priority it missed most of its steps on a busy machine. A refusal is not reported here: servo and contact request a higher
  // priority and report theirs.
  const bool has_fifo = ask_for_fifo(kBoneAbove) == 0;
  TickClock clock(start_, parts_->bone_period, 0.5 * parts_->period);
  while (!stop_.load(std::memory_order_relaxed)) {
    const TickClock::Wake wake = clock.wait();
    const timespec woke = now_monotonic();
    for (std::uint64_t n = 0; n < std::min(wake.ticks, kMostCatchUp); ++n) {
      const ContactState& found = parts_->tool_mailbox.latest();
      if (found.number == 0) break;  // no contact result yet
      const timespec begin = now_monotonic();
      parts_->cut(found);
      BoneRow row = bone_row(*parts_, found.number);
      row.skipped = n == 0 && wake.ticks > kMostCatchUp ? static_cast<std::uint32_t>(wake.ticks - kMostCatchUp) : 0;
      row.compute_us = microseconds(begin, now_monotonic());
      if (!bone_rows_.push(row)) unrecorded_.fetch_add(1, std::memory_order_relaxed);
    }
    hand_off_->serve([&](bool all) { parts_->gather(all); });
    if (has_fifo) std::this_thread::sleep_for(std::chrono::duration<float, std::micro>(kPause * microseconds(woke, now_monotonic())));
  }
}

/// At normal priority: reads bone round the window from OpenVDB in advance, for the simulation thread.
void Loops::prefetch_loop() {
  try {
    while (!stop_.load(std::memory_order_relaxed))
      if (prefetch_.fill(kPrefetchAtOnce) == 0) std::this_thread::sleep_for(kPrefetchEvery);
  } catch (const std::bad_alloc&) {
    return;  // out of memory: slides then read missing blocks themselves and count them
  }
}

void Loops::start() {
  Voxmap& voxmap = *parts_->voxmap;
  // Within these reserves slides and write-backs do not allocate.
  const std::size_t window_voxels = most_window_voxels(voxmap.window().box.count());
  voxmap.reserve(window_voxels, kReservedBlocks);
  if (parts_->bone->publisher() != nullptr) parts_->bone->publisher()->reserve(window_voxels);
  voxmap.set_prefetch(&prefetch_);
  while (prefetch_.fill(kPrefetchAtOnce) > 0) continue;
  const std::vector<StepColumn>& columns = parts_->graph.columns(Clock::simulation);
  const auto clutch = std::ranges::find(columns, kEngagedColumn, &StepColumn::name);
  clutch_column_ = clutch == columns.end() ? EffectValues::kMax : static_cast<std::size_t>(clutch - columns.begin());
  start_ = now_monotonic();
  hand_off_->open();
  servo_ = std::thread([this] { servo_loop(); });
  contact_ = std::thread([this] { contact_loop(); });
  bone_ = std::thread([this] { bone_loop(); });
  prefetch_thread_ = std::thread([this] { prefetch_loop(); });
}

void Loops::halt() noexcept {
  if (servo_.joinable() && !servo_ended_.load(std::memory_order_acquire)) {
    // The servo ends by itself once the force has fallen to zero; contact and bone run until then.
    parts_->servo->request_stop();
    const auto latest = std::chrono::steady_clock::now() + std::chrono::duration<double>(parts_->config.servo.soft_stop + kStopGrace);
    while (!servo_ended_.load(std::memory_order_acquire) && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(kPollEvery);
  }
  stop_.store(true, std::memory_order_relaxed);
  for (std::thread* thread : {&servo_, &contact_, &bone_, &prefetch_thread_})
    if (thread->joinable()) thread->join();
  parts_->voxmap->set_prefetch(nullptr);
  report_->unrecorded = unrecorded_.load();
}

Status Loops::report_refusals(const std::string& memory) {
  const std::string text = refusal_text(refused_.load(std::memory_order_relaxed), memory);
  if (text.empty()) return {};
  if (options_.require_realtime) return Error{ErrorCode::unavailable, text, {}};
  if (options_.warn) options_.warn(text + ": forces may be late");
  return {};
}

Status Loops::drain_servo() {
  ServoRow row;
  while (servo_rows_.pop(row)) {
    if (const double time = static_cast<double>(row.hand.tick) * parts_->period; time >= options_.untimed) {
      report_->servo.add(row.compute_us);
      report_->servo_late.add(row.late_us);
    }
    report_->servo_skipped += row.skipped;
    report_->faults |= row.faults;
    state_.hand = row.hand;
    state_.force = row.force;
    state_.faults = row.faults;
    sent_forces_.emplace_back(row.hand.tick, glm::length(row.force));
    state_.servo_us = row.compute_us;
    state_.servo_late_us = row.late_us;
    if (Status noted = log_->record_faults(row.faults, static_cast<double>(row.hand.tick) * parts_->period, options_.warn); !noted)
      return noted;
    if (Status noted = log_->record_hand(row.hand); !noted) return noted;
    if (log_->session() == nullptr) continue;
    put(row, *parts_, row_);
    if (Status written = log_->session()->append(kServoRows, row_); !written) return written;
  }
  return {};
}

double Loops::force_at(std::uint64_t tick) {
  while (sent_forces_.size() > 1 && sent_forces_.front().first < tick) sent_forces_.pop_front();
  return sent_forces_.empty() ? 0.0 : sent_forces_.front().second;
}

Status Loops::drain_contact() {
  ContactRow row;
  while (contact_rows_.pop(row)) {
    if (row.time >= options_.untimed) {
      report_->contact.add(row.compute_us);
      report_->contact_step.add(row.step_us);
      report_->contact_late.add(row.late_us);
    }
    report_->contact_skipped += row.skipped;
    progress_ = row.progress;
    state_.progress = row.progress;
    state_.world_from_tool = row.world_from_tool;
    state_.world_from_rest = row.world_from_rest;
    state_.contact_us = row.compute_us;
    if (log_->session() != nullptr) {
      put(row, *parts_, row_);
      if (Status written = log_->session()->append(kContactRows, row_); !written) return written;
    }
    const RunSample sample{row.time, force_at(row.hand_tick), row.progress.depth};
    if (Status seen = log_->record_contact(sample, row.progress, row.world_from_tool); !seen) return seen;
    const std::span values = std::span(row.effects.values).first(row.effects.count);
    if (Status noted = events_.look(values, row.time, *log_); !noted) return noted;
    state_.zone = zone_columns_.read(values);
    if (options_.progress && row.time - progress_time_ >= kProgressEvery) {
      progress_time_ = row.time;
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
    state_.bone_us = row.compute_us;
    state_.removed = row.removed;
    if (clutch_column_ < row.effects.count) state_.driven = row.effects.values[clutch_column_] > 0.0;
    ++state_.steps;
    if (log_->session() == nullptr) continue;
    put(row, *parts_, row_);
    if (Status written = log_->session()->append(kBoneRows, row_); !written) return written;
  }
  return {};
}

Status Loops::drain() {
  if (Status done = drain_servo(); !done) return done;
  if (Status done = drain_contact(); !done) return done;
  if (Status done = drain_bone(); !done) return done;
  return record_losses();
}

Status Loops::record_losses() {
  if (recorded_losses_ || unrecorded_.load(std::memory_order_relaxed) == 0) return {};
  recorded_losses_ = true;
  const double time = static_cast<double>(servo_ticks_.load(std::memory_order_relaxed)) * parts_->period;
  return log_->record_event(time, kUnrecordedEvent, "rows of steps before this were lost, since the log was full");
}

Status Loops::park() {
  stop_.store(true, std::memory_order_relaxed);
  for (std::thread* thread : {&servo_, &contact_, &bone_, &prefetch_thread_})
    if (thread->joinable()) thread->join();
  parts_->voxmap->set_prefetch(nullptr);
  if (Status drained = drain(); !drained) return drained;
  if (Status sounded = run_audio(); !sounded) return sounded;
  if (ended_ || broken_.load(std::memory_order_acquire)) return {};
  servo_ticks_.fetch_add(1, std::memory_order_relaxed);  // of the hand under the zero force that ended the servo's thread
  Status applied;
  if (options_.inputs(servo_ticks_.load(std::memory_order_relaxed), true, applied) == LiveInput::failed) return applied;
  stop_.store(false, std::memory_order_relaxed);
  servo_ended_.store(false, std::memory_order_relaxed);
  start();
  return {};
}

std::shared_ptr<const std::vector<StepPrice>> Loops::prices() const {
  const auto period = [&](Clock clock) {
    return clock == Clock::servo        ? parts_->period
           : clock == Clock::contact    ? parts_->contact_period
           : clock == Clock::simulation ? parts_->bone_period
                                        : kAudioPeriod;
  };
  auto out = std::make_shared<std::vector<StepPrice>>();
  for (const StepGraph::StepInfo& step : parts_->graph.steps()) {
    if (step.clock == Clock::frame) continue;  // runs at events alone
    const float us = step.mean_us->load(std::memory_order_relaxed);
    out->push_back({step.effect, step.name, us, static_cast<double>(us) * 1e-6 / period(step.clock)});
  }
  return out;
}

Status Loops::show() {
  if (options_.see) {
    state_.time = static_cast<double>(servo_ticks_.load(std::memory_order_relaxed)) * parts_->period;
    state_.missed = report_->servo_skipped + report_->contact_skipped;
    if (state_.time - priced_ >= kPricesEvery || state_.prices == nullptr) {
      state_.prices = prices();
      priced_ = state_.time;
    }
    options_.see(state_);
  }
  return options_.send && hand_off_->poll(false) ? options_.send() : Status();
}

Status Loops::run_audio() {
  if (parts_->graph.empty(Clock::audio)) return {};
  const bool records = log_->session() != nullptr && records_audio(*parts_);
  const std::uint64_t due = parts_->audio_blocks(servo_ticks_.load(std::memory_order_relaxed));
  for (; audio_ticks_ < due; ++audio_ticks_) {
    parts_->graph.run(Clock::audio, {audio_ticks_, kAudioPeriod});
    if (!records) continue;
    put_audio(*parts_, row_);
    if (Status written = log_->session()->append(kAudioRows, row_); !written) return written;
  }
  return {};
}

Error Loops::error_of_simulation() const {
  const Error why = error_of(why_);
  return {why.code, "the simulation thread ended: " + why.text(), {}};
}

Status Loops::run() {
  const LockedMemory locked;
  start();
  while (!priorities_requested()) std::this_thread::sleep_for(kPollEvery);
  if (Status reported = report_refusals(locked.refusal()); !reported) return reported;
  while (!servo_ended_.load(std::memory_order_acquire)) {
    if (broken_.load(std::memory_order_acquire)) break;
    if (Status drained = drain(); !drained) return drained;
    if (Status shown = show(); !shown) return shown;
    std::this_thread::sleep_for(kPollEvery);
    if (Status sounded = run_audio(); !sounded) return sounded;
    if (!options_.inputs) continue;
    Status applied;
    const LiveInput input = options_.inputs(servo_ticks_.load(std::memory_order_relaxed), false, applied);
    if (input == LiveInput::failed) return applied;
    if (input == LiveInput::park)
      if (Status parked = park(); !parked) return parked;
  }
  halt();
  report_->prefetched_blocks = prefetch_.hits();
  report_->prefetch_misses = prefetch_.misses();
  report_->done = report_->last.hand.phase == HandPhase::done;
  report_->stopped = !report_->done && is_set(options_.stop);
  if (Status drained = drain(); !drained) return drained;
  if (Status sounded = run_audio(); !sounded) return sounded;
  if (broken_.load(std::memory_order_acquire)) return error_of_simulation();
  return {};
}

}  // namespace

Status run_live(Stage& parts, RunLog& log, const LiveOptions& options, BatchHandOff& hand_off, LiveReport& report) {
  return Loops(parts, log, options, hand_off, report).run();
}

}  // namespace burrhole
