#include "app/window/desk.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kLineStays = 6.0;         // [s]
constexpr std::size_t kMostLines = 4;      // shown at once
constexpr std::size_t kMostEvents = 4096;  // kept for a panel that does not draw

}  // namespace

void Desk::begin(const DeskPlan& plan, const PilotSetup& setup, const OrbitCamera& camera, const std::string& tool) {
  const std::scoped_lock lock(mutex_);
  plan_ = plan;
  pilot_ = std::make_unique<Pilot>(setup, camera);
  pilot_->set_picture_size(width_, height_);
  tool_ = tool;
}

DeskStage Desk::stage() {
  const std::scoped_lock lock(mutex_);
  return stage_;
}

void Desk::finish(const Result<RunSummary>& summary) {
  const std::scoped_lock lock(mutex_);
  stage_ = DeskStage::ended;
  if (summary)
    summary_ = *summary;
  else
    failure_ = summary.error().text();
  if (closing_) closed_ = true;
}

std::optional<Input> Desk::next_input() {
  const std::scoped_lock lock(mutex_);
  auto next = pilot_ ? pilot_->take_input() : std::nullopt;
  if (next && next->kind == InputKind::tool) tool_ = next->text;
  return next;
}

void Desk::see(const LiveState& state) {
  const std::scoped_lock lock(mutex_);
  live_ = state;
  if (stage_ == DeskStage::loading) stage_ = DeskStage::drilling;
}

void Desk::wait_until_resumed() {
  std::unique_lock lock(mutex_);
  resumed_.wait(lock, [this] { return ending_ || closed() || !pilot_ || !pilot_->paused(); });
}

void Desk::handle(const WindowEvent& event) {
  const std::scoped_lock lock(mutex_);
  if (events_.size() < kMostEvents) events_.push_back(event);
  if (!waits_since_) waits_since_ = std::chrono::steady_clock::now();
  if (!pilot_) {
    if (event.kind == WindowEvent::Kind::close) closed_ = true;
    return;
  }
  if (event.kind == WindowEvent::Kind::close) {
    closing_ = true;
    if (stage_ == DeskStage::ended) closed_ = true;
  }
  pilot_->handle(event, mouse_taken_.load(std::memory_order_relaxed));
  resumed_.notify_all();
}

void Desk::step(double dt, const PadState& pad) {
  const std::scoped_lock lock(mutex_);
  time_ += dt;
  if (!pilot_) return;
  if (pad_ && !pad.present) lines_.push_back({time_, "The game pad is gone: the drive is off", true});
  pad_ = pad.present;
  pilot_->step(dt, live_, pad);
  goals_.publish(pilot_->goal());
  turned_ += pilot_->paused() ? 0.0 : dt * live_.hand.spin * plan_.spin_rpm * kRevPerMinute;
  turned_ -= std::floor(turned_);
  std::erase_if(lines_, [this](const DeskLine& line) { return time_ - line.time > kLineStays; });
  resumed_.notify_all();
}

void Desk::stop_waiting() {
  const std::scoped_lock lock(mutex_);
  ending_ = true;
  resumed_.notify_all();
}

DeskView Desk::view() {
  const std::scoped_lock lock(mutex_);
  DeskView out;
  shown_soon_ = waits_since_.has_value();
  out.stage = stage_ == DeskStage::drilling && pilot_ && pilot_->goal().ends ? DeskStage::writing : stage_;
  out.live = live_;
  out.tool = tool_;
  out.turned = turned_;
  out.time = time_;
  out.pad = pad_;
  out.lines = lines_;
  if (!pilot_) return out;
  out.camera = pilot_->camera().camera();
  out.mode = pilot_->camera().mode();
  out.goal = pilot_->goal();
  out.paused = pilot_->paused();
  out.fine = pilot_->fine();
  out.locked_on = pilot_->locked_on();
  out.wishes = pilot_->wishes();
  return out;
}

DeskPlan Desk::plan() {
  const std::scoped_lock lock(mutex_);
  return plan_;
}

void Desk::with_pilot(const std::function<void(Pilot&)>& f) {
  const std::scoped_lock lock(mutex_);
  if (pilot_) f(*pilot_);
  resumed_.notify_all();
}

void Desk::set_picture_size(int width, int height) {
  const std::scoped_lock lock(mutex_);
  width_ = width;
  height_ = height;
  if (pilot_) pilot_->set_picture_size(width, height);
}

std::vector<WindowEvent> Desk::take_events() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(events_, {});
}

std::optional<RunSummary> Desk::summary() {
  const std::scoped_lock lock(mutex_);
  return summary_;
}

std::string Desk::failure() {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

void Desk::fail(const Error& error) {
  const std::scoped_lock lock(mutex_);
  error_ = error;
  closed_ = true;
}

std::optional<Error> Desk::error() {
  const std::scoped_lock lock(mutex_);
  return error_;
}

std::optional<double> Desk::take_latency() {
  const std::scoped_lock lock(mutex_);
  if (!shown_soon_ || !waits_since_) return std::nullopt;
  const auto waited = std::chrono::steady_clock::now() - *waits_since_;
  waits_since_.reset();
  shown_soon_ = false;
  return std::chrono::duration<double>(waited).count();
}

void Desk::say(const std::string& line, bool warning) {
  const std::scoped_lock lock(mutex_);
  lines_.push_back({time_, line, warning});
  if (lines_.size() > kMostLines) lines_.erase(lines_.begin());
}

}  // namespace burrhole
