#include "app/window/window_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/caught_error.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kLineStays = 6.0;         // [s]
constexpr std::size_t kMostLines = 4;      // shown at once
constexpr std::size_t kMostEvents = 4096;  // kept for a panel that does not draw

}  // namespace

void WindowState::begin(const WindowPlan& plan, const ControlsSetup& setup, const OrbitCamera& camera, const std::string& tool) {
  const std::scoped_lock lock(mutex_);
  plan_ = plan;
  controls_ = std::make_unique<Controls>(setup, camera);
  controls_->set_picture_size(width_, height_);
  tool_ = tool;
}

RunStage WindowState::stage() {
  const std::scoped_lock lock(mutex_);
  return stage_;
}

void WindowState::finish(const Result<RunSummary>& summary) {
  const std::scoped_lock lock(mutex_);
  stage_ = RunStage::ended;
  if (summary)
    summary_ = *summary;
  else
    failure_ = summary.error().text();
  if (closing_) closed_ = true;
}

std::optional<Input> WindowState::next_input() {
  const std::scoped_lock lock(mutex_);
  auto next = controls_ ? controls_->take_input() : std::nullopt;
  if (next && next->kind == InputKind::tool) tool_ = next->text;
  return next;
}

void WindowState::see(const LiveState& state) {
  const std::scoped_lock lock(mutex_);
  live_ = state;
  if (stage_ == RunStage::loading) stage_ = RunStage::drilling;
}

void WindowState::ended() {
  const std::scoped_lock lock(mutex_);
  if (stage_ != RunStage::ended) stage_ = RunStage::writing;
  live_.hand.spin = 0.0;
}

bool WindowState::took_over() {
  const std::scoped_lock lock(mutex_);
  return controls_ && controls_->goal().takes_over;
}

std::optional<Input> WindowState::wait_until_resumed() {
  std::unique_lock lock(mutex_);
  const auto goes_on = [this] { return ending_ || closed() || !controls_ || !controls_->paused(); };
  resumed_.wait(lock, [&] { return goes_on() || controls_->has_query(); });
  return goes_on() ? std::nullopt : controls_->take_query();
}

std::optional<Transport> WindowState::watch(double time) {
  const std::scoped_lock lock(mutex_);
  Transport* const transport = controls_ ? controls_->transport() : nullptr;
  if (transport == nullptr || ending_ || closed() || controls_->goal().ends) return std::nullopt;
  transport->arrive(time);
  return *transport;
}

void WindowState::end_watching_at(double time) {
  const std::scoped_lock lock(mutex_);
  if (controls_ && controls_->transport() != nullptr) controls_->transport()->end_at(time);
}

void WindowState::wait_for_head() {
  std::unique_lock lock(mutex_);
  resumed_.wait_for(lock, std::chrono::milliseconds(20));
}

void WindowState::handle(const WindowEvent& event) {
  const std::scoped_lock lock(mutex_);
  if (events_.size() < kMostEvents) events_.push_back(event);
  if (!waits_since_) waits_since_ = std::chrono::steady_clock::now();
  if (!controls_) {
    if (event.kind == WindowEvent::Kind::close) closed_ = true;
    return;
  }
  if (event.kind == WindowEvent::Kind::close) {
    closing_ = true;
    if (stage_ == RunStage::ended) closed_ = true;
  }
  const bool leaves = event.code == static_cast<int>(Key::escape) || event.code == static_cast<int>(Key::enter);
  if (stage_ == RunStage::ended && event.kind == WindowEvent::Kind::key && event.down && leaves) closed_ = true;
  controls_->handle(event, mouse_taken_.load(std::memory_order_relaxed));
  resumed_.notify_all();
}

void WindowState::step(double dt, const PadState& pad) {
  const std::scoped_lock lock(mutex_);
  time_ += dt;
  if (!controls_) return;
  if (pad_ && !pad.present) {
    controls_->lock_drive(false);
    lines_.push_back({time_, "The game pad is gone", true});
  }
  pad_ = pad.present;
  controls_->step(dt, live_, pad);
  goals_.publish(controls_->goal());
  const Transport* const transport = controls_->transport();
  const double pace = transport == nullptr ? (controls_->paused() ? 0.0 : 1.0) : transport->runs() ? transport->speed() : 0.0;
  if (live_.driven.value_or(true)) turned_ += pace * dt * live_.hand.spin * plan_.spin_rpm * kRevPerMinute;
  turned_ -= std::floor(turned_);
  if (std::string answer = controls_->take_answer(); !answer.empty()) lines_.push_back({time_, std::move(answer), true});
  std::erase_if(lines_, [this](const MessageLine& line) { return time_ - line.time > kLineStays; });
  resumed_.notify_all();
}

void WindowState::stop_waiting() {
  const std::scoped_lock lock(mutex_);
  ending_ = true;
  resumed_.notify_all();
}

WindowView WindowState::view_of_controls() {
  const std::scoped_lock lock(mutex_);
  WindowView out;
  out.stage = stage_;
  if (!controls_) return out;
  out.goal = controls_->goal();
  out.requests = controls_->requests();
  return out;
}

WindowView WindowState::view() {
  const std::scoped_lock lock(mutex_);
  WindowView out;
  shown_soon_ = waits_since_.has_value();
  out.stage = stage_ == RunStage::drilling && controls_ && controls_->goal().ends ? RunStage::writing : stage_;
  out.live = live_;
  out.tool = tool_;
  out.turned = turned_;
  out.time = time_;
  out.pad = pad_;
  out.lines = lines_;
  if (!controls_) return out;
  out.camera = controls_->camera().camera();
  out.mode = controls_->camera().mode();
  out.cut = controls_->cut();
  out.goal = controls_->goal();
  out.paused = controls_->paused();
  out.fine = controls_->fine();
  out.locked_on = controls_->locked_on();
  out.held_push = controls_->held_push();
  out.instruments_on = controls_->instruments_on();
  out.requests = controls_->requests();
  if (const Transport* const transport = controls_->transport()) out.transport = *transport;
  return out;
}

WindowPlan WindowState::plan() {
  const std::scoped_lock lock(mutex_);
  WindowPlan out = plan_;
  if (controls_ && controls_->goal().takes_over) out.largest_push = plan_.users_push;
  return out;
}

void WindowState::with_controls(const std::function<void(Controls&)>& f) {
  const std::scoped_lock lock(mutex_);
  if (controls_) f(*controls_);
  resumed_.notify_all();
}

void WindowState::set_picture_size(int width, int height) {
  const std::scoped_lock lock(mutex_);
  width_ = width;
  height_ = height;
  if (controls_) controls_->set_picture_size(width, height);
}

bool WindowState::has_events() {
  const std::scoped_lock lock(mutex_);
  return !events_.empty();
}

std::vector<WindowEvent> WindowState::take_events() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(events_, {});
}

std::optional<RunSummary> WindowState::summary() {
  const std::scoped_lock lock(mutex_);
  return summary_;
}

std::string WindowState::failure() {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

void WindowState::fail(const Error& error) {
  const std::scoped_lock lock(mutex_);
  error_ = error;
  closed_ = true;
}

void WindowState::fail(std::exception_ptr thrown) noexcept {
  const std::scoped_lock lock(mutex_);
  thrown_ = std::move(thrown);
  closed_ = true;
}

std::optional<Error> WindowState::error() {
  const std::scoped_lock lock(mutex_);
  if (thrown_) return error_of(thrown_);
  return error_;
}

std::optional<double> WindowState::take_latency() {
  const std::scoped_lock lock(mutex_);
  if (!shown_soon_ || !waits_since_) return std::nullopt;
  const auto waited = std::chrono::steady_clock::now() - *waits_since_;
  waits_since_.reset();
  shown_soon_ = false;
  return std::chrono::duration<double>(waited).count();
}

void WindowState::say(const std::string& line, bool warning) {
  const std::scoped_lock lock(mutex_);
  lines_.push_back({time_, line, warning});
  if (lines_.size() > kMostLines) lines_.erase(lines_.begin());
}

}  // namespace burrhole
