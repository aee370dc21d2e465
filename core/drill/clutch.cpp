#include "core/drill/clutch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kSeat = 1e-3;  // [-] of the travel: this near to its end the teeth are engaged
constexpr double kNever = std::numeric_limits<double>::infinity();

/// @returns the mean over `dt` of a speed that falls from `from` at a rate of 1 / stop, and its end.
struct RunDown {
  double mean, end;
};
RunDown run_down_of(double from, double stop, double dt) noexcept {
  if (!(stop > 0.0)) return {0.0, 0.0};
  const double lasts = std::min(dt, from * stop);
  const double end = std::max(0.0, from - dt / stop);
  return {dt > 0.0 ? 0.5 * (from + (from - lasts / stop)) * lasts / dt : 0.0, end};
}

}  // namespace

Result<Clutch> Clutch::create(const ClutchConfig& c) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  for (const double value : {c.engage_force, c.stiffness, c.travel, c.teeth})
    if (!(value > 0.0 && std::isfinite(value))) return refuse("force, stiffness, travel and teeth of a clutch must be numbers above 0");
  for (const double value : {c.damping, c.inner_stop, c.outer_stop, c.release_delay, c.least_spin})
    if (!(value >= 0.0 && std::isfinite(value))) return refuse("damping, times and least spin of a clutch must be numbers, 0 or more");
  if (!(c.wear >= 0.0 && c.wear <= 1.0)) return refuse("the wear of a clutch must be from 0 to 1");
  if (c.teeth >= c.travel) return refuse("the teeth of a clutch must be shorter than its travel");
  if (c.stiffness * c.travel > c.engage_force) return refuse("stiffness x travel of a clutch must be at most its force");
  return Clutch(c);
}

double Clutch::release_force() const noexcept { return (1.0 - config_.wear) * (config_.engage_force - config_.stiffness * config_.teeth); }

double Clutch::engage_force() const noexcept { return (1.0 - config_.wear) * config_.engage_force; }

void Clutch::reset() noexcept {
  state_ = ClutchState::released;
  x_ = inner_ = outer_ = held_ = 0.0;
  supported_ = false;
}

/// @returns x at `t` [s] after `x` under a reaction, not limited to the travel.
double Clutch::way_at(double reaction, double x, double t) const noexcept {
  const double k = (1.0 - config_.wear) * config_.stiffness, force = reaction - engage_force() + k * config_.travel;
  if (config_.damping == 0.0) {
    if (k > 0.0) return force / k;
    return reaction > 0.0 ? config_.travel : x;  // no spring: nothing brings the inner drill forward
  }
  if (k == 0.0) return x + force / config_.damping * t;
  const double rest = force / k;
  return rest + (x - rest) * portable_exp(-k * t / config_.damping);
}

/// Moves the inner drill. @returns the time [s] in the step at which it passes `target` [m]; infinite if it does not.
double Clutch::move(double reaction, double dt, double target) noexcept {
  const double before = x_, free = way_at(reaction, before, dt);
  x_ = std::clamp(free, 0.0, config_.travel);
  const bool rises = before < target && free >= target, falls = before >= target && free < target;
  if (!rises && !falls) return kNever;
  const double k = (1.0 - config_.wear) * config_.stiffness, force = reaction - engage_force() + k * config_.travel;
  if (config_.damping == 0.0) return 0.0;
  if (k == 0.0) return std::clamp((target - before) * config_.damping / force, 0.0, dt);
  const double rest = force / k;
  return std::clamp(config_.damping / k * portable_log((before - rest) / (target - rest)), 0.0, dt);
}

/// The teeth should have parted since `crossed` [s] in this step, 0: before it. @returns when [s] they do; infinite: not in this step.
double Clutch::let_go(double crossed, double dt) noexcept {
  const double at = crossed + config_.release_delay - held_;
  if (at > dt) {
    held_ += dt - crossed;
    state_ = ClutchState::holding;
    return kNever;
  }
  const double when = std::max(0.0, at);
  state_ = ClutchState::released;
  held_ = 0.0;
  ++releases_;
  released_at_ = time_ + when;
  took_ = *released_at_ - lost_at_;
  return when;
}

/// Adds the turns of the drills in the part of a step in which nothing drives them.
void Clutch::run_down(const Part& part, double dt, ClutchDrive& out) noexcept {
  const double lasts = part.to - part.from;
  const RunDown inner = run_down_of(inner_, config_.inner_stop, lasts), outer = run_down_of(outer_, config_.outer_stop, lasts);
  out.inner += inner.mean * lasts / dt;
  out.outer += outer.mean * lasts / dt;
  inner_ = inner.end;
  outer_ = outer.end;
}

void Clutch::engage(double from, double dt, ClutchDrive& out) noexcept {
  state_ = ClutchState::engaged;
  ++engagements_;
  held_ = 0.0;
  if (!engaged_at_) engaged_at_ = time_ + from;
  out.coupled = 1.0 - from / dt;
  out.inner += out.coupled;
  out.outer += out.coupled;
  inner_ = outer_ = 1.0;
}

ClutchDrive Clutch::step(double reaction, double spin, double dt) noexcept {
  ClutchDrive out;
  if (!(dt > 0.0)) return out;
  if (!(reaction > 0.0 && std::isfinite(reaction))) reaction = 0.0;
  const bool may_change = spin >= config_.least_spin;
  if (reaction >= release_force())
    supported_ = true;
  else if (supported_) {
    lost_at_ = time_;
    supported_ = false;
  }
  const double part = config_.travel - config_.teeth, seat = (1.0 - kSeat) * config_.travel;
  if (engaged()) {
    const double crossed = move(reaction, dt, part);
    double gone = kNever;
    if (x_ >= part) {
      held_ = 0.0;
      state_ = ClutchState::engaged;
    } else if (may_change) {
      gone = let_go(crossed < kNever ? crossed : 0.0, dt);
    }
    out.coupled = std::min(gone, dt) / dt;
    out.inner = out.outer = out.coupled;
    inner_ = outer_ = 1.0;
    if (gone < kNever) run_down({gone, dt}, dt, out);
  } else {
    const bool was_seated = x_ >= seat;
    const double crossed = move(reaction, dt, seat);
    const bool engages = may_change && x_ >= seat;
    const double from = !engages ? dt : was_seated ? 0.0 : std::min(crossed, dt);
    run_down({0.0, from}, dt, out);
    if (engages) engage(from, dt, out);
  }
  time_ += dt;
  return out;
}

}  // namespace burrhole
