/// core/drill/clutch.h: the clutch of a cranial perforator: drives the drill while bone supports the tip of its inner drill, and stops it when
///   the tip loses its support.
///   Units  SI.   Errors  out_of_range from create().   Thread  simulation.
///   Source  mechanism: patents US4362161 and US20090024129: a spring holds the inner drill forward, thrust on its tip pushes it back until its
///           teeth engage, and without that thrust the spring, and the cams of the teeth, part them. Equations: own derivation. All numbers are
///           assumptions: forces and travels of clutches are not published.
///   Motion  x is the way [m] by which the inner drill is pushed back, 0 forward to `travel`. R is the reaction of bone on the tip [N]. The
///           spring pushes with P + k x, P = engage_force - k travel, against a damper c, without mass:
///             c dx/dt = R - P - k x,   x(t) = x_R + (x(0) - x_R) exp(-k t / c),   x_R = (R - P) / k,   0 <= x <= travel,
///           exact for a constant R and any step. c = 0: x follows R at once.
///   States  The teeth engage when x reaches the travel, so when R has been at least engage_force; to reach it in a finite time, 1/1000 of the
///           travel less is enough. They part when x falls below travel - teeth: R below release_force() = engage_force - k teeth. A tip that
///           loses all its support therefore stops the drill after c/k ln(engage_force / release_force()).
///   Worn spring  P and k are multiplied by 1 - wear: both forces fall by it, and the time above grows by 1 / (1 - wear).
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/result.h"

namespace burrhole {

struct ClutchConfig {
  double engage_force = 12.0;  ///< [N] > 0: least reaction of the tip that engages
  double stiffness = 3000.0;   ///< [N/m] > 0: k of the spring
  double travel = 1.5e-3;      ///< [m] > 0 of the inner drill; k travel <= engage_force, so that the spring always pushes forward
  double teeth = 1.0e-3;       ///< [m] in (0, travel): depth to which teeth engage
  double damping = 100.0;      ///< [N s/m] >= 0: c
  double inner_stop = 0.0;     ///< [s] >= 0 in which the inner drill runs down, at a constant rate, once it is released
  double outer_stop = 0.0;     ///< [s] >= 0 the same of the outer drill
  double release_delay = 0.0;  ///< [s] >= 0, failure: the teeth hold for so long after they should have parted
  double least_spin = 0.0;     ///< [rev/s] >= 0, failure: below this speed of the drive the state does not change
  double wear = 0.0;           ///< [-] in [0, 1], failure: lost share of the force of the spring
};

enum class ClutchState : std::uint8_t { released, engaged, holding };  ///< holding: engaged, while release_delay runs

/// Speeds over a step, as shares of that of the drive [-], means of the step.
struct ClutchDrive {
  double inner = 0.0, outer = 0.0;  ///< [-] of the drills
  double coupled = 0.0;             ///< [-] share of the step in which the drive turns the drills: torque reaches the drive then only
};

class Clutch {
 public:
  /// The clutch starts released, its inner drill forward. out_of_range: a number outside of its range.
  [[nodiscard]] static Result<Clutch> create(const ClutchConfig& config);

  /// Advances by `dt` [s] > 0 under a constant reaction [N] >= 0 of the tip at a speed [rev/s] of the drive. A reaction that is negative or not
  /// finite counts as 0. A step contains at most one release and one engagement.
  ClutchDrive step(double reaction, double spin, double dt) noexcept;
  /// As at the start; counts stay. For a drill that was placed elsewhere.
  void reset() noexcept;

  [[nodiscard]] ClutchState state() const noexcept { return state_; }
  [[nodiscard]] bool engaged() const noexcept { return state_ != ClutchState::released; }
  [[nodiscard]] bool turns() const noexcept {
    return engaged() || inner_ > 0.0 || outer_ > 0.0;
  }                                                                 ///< of either drill, while the drive turns
  [[nodiscard]] double pushed_back() const noexcept { return x_; }  ///< [m] x
  [[nodiscard]] double release_force() const noexcept;              ///< [N] with the wear of the spring
  [[nodiscard]] double engage_force() const noexcept;               ///< [N] the same
  [[nodiscard]] std::uint64_t engagements() const noexcept { return engagements_; }
  [[nodiscard]] std::uint64_t releases() const noexcept { return releases_; }
  [[nodiscard]] double time() const noexcept { return time_; }                               ///< [s] sum of all steps
  [[nodiscard]] std::optional<double> engaged_at() const noexcept { return engaged_at_; }    ///< [s] of the first engagement
  [[nodiscard]] std::optional<double> released_at() const noexcept { return released_at_; }  ///< [s] of the last release
  /// [s] for the last release, from the last time at which the reaction fell below release_force(), to the step, to it; 0 before one.
  [[nodiscard]] double release_took() const noexcept { return took_; }

 private:
  explicit Clutch(const ClutchConfig& config) : config_(config) {}
  [[nodiscard]] double move(double reaction, double dt, double target) noexcept;
  [[nodiscard]] double way_at(double reaction, double x, double t) const noexcept;
  double let_go(double crossed, double dt) noexcept;
  struct Part {
    double from, to;  // [s] of a step
  };
  void run_down(const Part& part, double dt, ClutchDrive& out) noexcept;
  void engage(double from, double dt, ClutchDrive& out) noexcept;

  ClutchConfig config_;
  ClutchState state_ = ClutchState::released;
  double x_ = 0.0;                     // [m]
  double inner_ = 0.0, outer_ = 0.0;   // [-] speeds at the end of the last step
  double held_ = 0.0;                  // [s] for which the teeth should have parted
  double time_ = 0.0;                  // [s]
  double lost_at_ = 0.0, took_ = 0.0;  // [s]
  bool supported_ = false;             // the reaction was release_force() or more in the last step
  std::uint64_t engagements_ = 0, releases_ = 0;
  std::optional<double> engaged_at_, released_at_;
};

}  // namespace burrhole
