#include "app/lab/multirate.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "app/lab/frontier_search.h"
#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr std::array<MultiRateScheme, 4> kSchemes{MultiRateScheme::hold, MultiRateScheme::linear, MultiRateScheme::gradient,
                                                  MultiRateScheme::planes};
constexpr double kRadii = 10e-3;                            // [m] of sphere and tool together
constexpr int kServoHz = 1000, kTicks = 3000, kFrom = 500;  // compared after every loop has a contact result; the slowest after 100 ticks
constexpr int kFiner = 4;                                   // factor on all rates in the reference, which has no latency

/// A hand that follows its path independent of the force.
class GuidedHand final : public HandSource {
 public:
  GuidedHand(const Pose& world_from_approach, bool drilling, double period)
      : world_from_approach_(world_from_approach), drilling_(drilling), period_(period) {
    go();
  }
  [[nodiscard]] const HandState& read() noexcept override { return state_; }
  void apply(const Wrench&) noexcept override {
    ++state_.tick;
    go();
  }

 private:
  /// Approach frame. Sliding: 3 mm to and fro over the top of the sphere, half a millimetre deep, at most 19 mm/s. Drilling: feed of 0.5
  /// mm/s with a tremor of 0.1 mm at 3 Hz.
  [[nodiscard]] Vec3 at(double t) const noexcept {
    const double turns = 2.0 * std::numbers::pi * t;
    if (drilling_) return {0.0, 0.0, -0.3e-3 - 0.5e-3 * t + 0.1e-3 * portable_sin(3.0 * turns)};
    const double x = 3e-3 * portable_sin(turns), reach = kRadii - 0.5e-3;
    return {x, 0.0, std::sqrt(reach * reach - x * x) - kRadii};
  }
  void go() noexcept {
    const double t = static_cast<double>(state_.tick) * period_;
    state_.world_from_hand = {world_from_approach_.rotation, world_from_approach_ * at(t)};
    state_.velocity = world_from_approach_.rotate((at(t) - at(t - period_)) / period_);
  }
  Pose world_from_approach_;
  bool drilling_;
  double period_;  // [s]
  HandState state_;
};

FrontierLoopConfig config_of(MultiRateScheme scheme, int contact_ticks, bool drilling) {
  const auto device = find_device("generic");
  const auto hand = find_hand("nominal");
  BH_ASSERT(device.ok() && hand.ok());
  return {.device = make_simulated_config(**device, **hand),
          .servo_hz = kServoHz,
          .contact_ticks = contact_ticks,
          .latency_ticks = -1,
          .scheme = scheme,
          .bone = FrontierBone::sphere,
          .drilling = drilling};
}

struct Trace {
  std::vector<Vec3> force;  ///< [N] requested by the servo, per tick
  StepTiming servo;
};

/// @param every keeps one tick of this many.
Result<Trace> trace_of(const FrontierLoopConfig& config, double stiffness, int every = 1) {
  const auto loop = FrontierLoop::create(config);
  if (!loop) return loop.error();
  GuidedHand hand(loop->world_from_approach(), config.drilling, 1.0 / config.servo_hz);
  const auto parts = loop->parts(stiffness, hand);
  if (!parts) return parts.error();
  Lockstep lockstep(**parts);
  Trace out;
  for (int n = 0; n < kTicks * every; ++n) {
    const Vec3 force = lockstep.tick().force;
    if (n >= kFrom * every && n % every == 0) out.force.push_back(force);
  }
  out.servo = lockstep.servo_timer().timing();
  return out;
}

/// The same hand on the same bone with four times the rates and no latency: no scheme has to extrapolate.
Result<Trace> finer_trace(bool drilling, double stiffness) {
  FrontierLoopConfig config = config_of(MultiRateScheme::hold, 1, drilling);
  config.servo_hz *= kFiner;
  config.latency_ticks = 0;
  return trace_of(config, stiffness, kFiner);
}

/// [%] of the mean force of `reference`: root mean square and largest difference.
std::pair<double, double> off(const std::vector<Vec3>& force, const std::vector<Vec3>& reference) {
  double square = 0.0, worst = 0.0, mean = 0.0;
  for (std::size_t n = 0; n < force.size(); ++n) {
    const double apart = glm::length(force[n] - reference[n]);
    square += apart * apart;
    worst = std::max(worst, apart);
    mean += glm::length(reference[n]);
  }
  const double count = static_cast<double>(force.size());
  mean /= count;
  return {100.0 * std::sqrt(square / count) / mean, 100.0 * worst / mean};
}

class Measurement {
 public:
  explicit Measurement(const MultirateOptions& options)
      : options_(options), own_({}, count_of_trials(options)), study_(options.study != nullptr ? *options.study : own_) {}

  Result<std::vector<CostRow>> operator()() {
    for (const bool drilling : {false, true}) {
      reference_.reset();
      for (const MultiRateScheme scheme : kSchemes) {
        double at_full_rate = 0.0;
        for (const int ticks : options_.contact_ticks) {
          const FrontierLoopConfig config = config_of(scheme, ticks, drilling);
          const auto figures = study_.run(trial_of(config), [&] { return measure(config); });
          if (!figures) return figures.error();
          add_force(config, *figures);
          if (options_.limits) add_limit(config, (*figures)[kForceFigures], at_full_rate);
        }
      }
    }
    return rows_;
  }

 private:
  static constexpr std::size_t kForceFigures = 4;

  [[nodiscard]] StudyTrial trial_of(const FrontierLoopConfig& config) const {
    StudyTrial out{.key = {},
                   .name = fmt::format("{}, {}, contact at {:g} Hz", config.drilling ? "drilling" : "sliding", name_of(config.scheme),
                                       static_cast<double>(config.servo_hz) / config.contact_ticks),
                   .figures = kForceFigures + (options_.limits ? 1 : 0)};
    out.key.add("multirate").add(out.name).add(options_.stiffness);
    return out;
  }
  /// @returns root mean square and largest error of the force [%], median and 99th percentile of a servo step [us]; with limits, the stable
  /// stiffness [N/m].
  Result<Study::Figures> measure(const FrontierLoopConfig& config) {
    if (!reference_) {
      auto finer = finer_trace(config.drilling, options_.stiffness);
      if (!finer) return finer.error();
      reference_ = std::move(finer).value();
    }
    const auto trace = trace_of(config, options_.stiffness);
    if (!trace) return trace.error();
    const auto [rms, worst] = off(trace->force, reference_->force);
    Study::Figures out{rms, worst, trace->servo.p50_us, trace->servo.p99_us};
    if (!options_.limits) return out;
    const auto loop = FrontierLoop::create(config);
    if (!loop) return loop.error();
    const auto limit = release_limit(*loop, {.pressed = true}, 50.0);
    if (!limit) return limit.error();
    out.push_back(*limit);
    return out;
  }
  static CostRow row_of(const FrontierLoopConfig& config) {
    CostRow row;
    row.subject = config.drilling ? "drilling into a sphere" : "sliding over a sphere";
    row.model = name_of(config.scheme);
    row.knob = "contact_rate_hz";
    row.setting = static_cast<double>(config.servo_hz) / config.contact_ticks;
    return row;
  }
  void add_force(const FrontierLoopConfig& config, const Study::Figures& figures) {
    CostRow row = row_of(config);
    row.unit = "% of mean force";
    row.reference = "servo and contact at 4 kHz, nothing late";
    row.median_us = figures[2];
    row.p99_us = figures[3];
    row.error_name = "force_rms_off";
    row.error = figures[0];
    rows_.push_back(row);
    row.error_name = "force_worst_off";
    row.error = figures[1];
    rows_.push_back(row);
  }
  void add_limit(const FrontierLoopConfig& config, double limit, double& at_full_rate) {
    if (config.contact_ticks == 1) at_full_rate = limit;
    CostRow row = row_of(config);
    row.subject = config.drilling ? "drilling into a sphere" : "pressed onto a sphere";
    row.error_name = "stiffness_kept";
    row.error = limit / at_full_rate;
    row.unit = "-";
    row.reference = "the same scheme, contact at 1 kHz";
    rows_.push_back(row);
    row.error_name = "stiffness_limit";
    row.error = limit;
    row.unit = "N/m";
    row.reference = "largest that comes to rest";
    rows_.push_back(row);
  }

  const MultirateOptions& options_;
  Study own_;
  Study& study_;
  std::optional<Trace> reference_;  // of `drilling`; made for the first trial that is measured
  std::vector<CostRow> rows_;
};

}  // namespace

std::size_t count_of_trials(const MultirateOptions& options) { return 2 * kSchemes.size() * options.contact_ticks.size(); }

Result<std::vector<CostRow>> measure_multirate(const MultirateOptions& options) {
  if (options.contact_ticks.empty() || options.contact_ticks.front() != 1)
    return Error{ErrorCode::out_of_range, "the first contact period must be one tick: the others are compared with it", {}};
  return Measurement(options)();
}

}  // namespace burrhole
