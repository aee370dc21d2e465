#include "haptics/servo/loop_stability.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

namespace burrhole {
namespace {

using Complex = std::complex<double>;
using Column = std::vector<double>;

/// A square matrix as its columns.
using Columns = std::vector<Column>;

/// Effect of the evaluation k contact periods ago on the state after this period.
struct Term {
  int periods;
  Column effect;
};

class Characteristic {
 public:
  explicit Characteristic(const ForceLoop& loop);
  /// Number of zeros of F.
  [[nodiscard]] int degree() const noexcept { return static_cast<int>(flow_.size()) + most_; }
  /// @returns the number of zeros with |z| < radius; nothing if one is too close to that circle.
  [[nodiscard]] std::optional<int> zeros_within(double radius) const;

 private:
  [[nodiscard]] Column tick(const ForceLoop& loop, const MassSpringDamper& body, const Column& state, double force) const;
  /// F without the factor z^M.
  [[nodiscard]] Complex value(Complex z) const;
  struct Arc {
    double from, to;  // [rad]
    Complex value_from, value_to;
  };
  /// @returns the change of the argument of value() along an arc [rad].
  [[nodiscard]] std::optional<double> turn(double radius, const Arc& arc, int depth) const;

  std::size_t delay_ = 0;    // number of past positions in the state
  Columns flow_;             // A^N
  Column evaluation_;        // c: the force that contact computes from a state
  std::vector<Term> terms_;  // one per number of periods
  int most_ = 0;             // M
  mutable std::vector<Complex> work_;
};

/// State: position, velocity, the velocity as read; for `gradient` also the positions of the last ticks, newest first.
Column Characteristic::tick(const ForceLoop& loop, const MassSpringDamper& body, const Column& state, double force) const {
  Column next = state;
  if (loop.scheme == MultiRateScheme::gradient) force -= loop.gain * loop.stiffness * (delay_ == 0 ? state[0] : state[2 + delay_]);
  body.step(next[0], next[1], force);
  const double difference = (next[0] - state[0]) / loop.period;
  next[2] = loop.true_velocity ? next[1] : state[2] + (difference - state[2]) * (loop.period / (loop.period + loop.velocity_time));
  for (std::size_t n = 0; n < delay_; ++n) next[3 + n] = n == 0 ? state[0] : state[2 + n];
  return next;
}

Characteristic::Characteristic(const ForceLoop& loop) {
  const auto made = MassSpringDamper::create(loop.body, loop.period);
  BH_ASSERT(made.ok() && loop.contact_ticks >= 1 && loop.reading_delay >= 0 && loop.latency_ticks >= 0);
  const bool gradient = loop.scheme == MultiRateScheme::gradient, planes = loop.scheme == MultiRateScheme::planes;
  if (gradient) delay_ = static_cast<std::size_t>(loop.reading_delay);
  const std::size_t size = 3 + delay_;
  // `planes` computes its force in each tick from the reading of that tick.
  const int ticks = planes ? 1 : loop.contact_ticks, late = loop.reading_delay + (planes ? 0 : loop.latency_ticks);

  flow_.assign(size, Column(size, 0.0));
  for (std::size_t j = 0; j < size; ++j) {
    flow_[j][j] = 1.0;
    for (int n = 0; n < ticks; ++n) flow_[j] = tick(loop, *made, flow_[j], 0.0);
  }
  evaluation_.assign(size, 0.0);
  if (!gradient) evaluation_[0] = -loop.gain * loop.stiffness;  // `gradient` evaluates the spring in each tick
  evaluation_[2] = -loop.gain * loop.damping;

  const bool linear = loop.scheme == MultiRateScheme::linear;
  const int oldest = (late + ticks - 1) / ticks;
  most_ = oldest + (linear ? 1 : 0);
  for (int n = 0; n <= most_; ++n) terms_.push_back({n, Column(size, 0.0)});
  for (int j = 0; j < ticks; ++j) {
    Column effect = tick(loop, *made, Column(size, 0.0), 1.0);
    for (int n = j + 1; n < ticks; ++n) effect = tick(loop, *made, effect, 0.0);
    const int periods = j >= late ? 0 : (late - j + ticks - 1) / ticks;
    const int since = j - late + periods * ticks + 1;  // [ticks] 1..N since this evaluation became the latest
    const double part = linear ? static_cast<double>(since) / ticks : 1.0;
    const auto latest = static_cast<std::size_t>(periods);
    for (std::size_t i = 0; i < size; ++i) {
      terms_[latest].effect[i] += part * effect[i];
      if (linear) terms_[latest + 1].effect[i] += (1.0 - part) * effect[i];
    }
  }
  std::erase_if(terms_, [](const Term& term) { return std::ranges::all_of(term.effect, [](double value) { return value == 0.0; }); });
  work_.resize(size * size);
}

/// Determinant by elimination with pivoting.
Complex Characteristic::value(Complex z) const {
  const std::size_t size = flow_.size();
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i) work_[i * size + j] = (i == j ? z : Complex(0.0)) - flow_[j][i];
  for (const Term& term : terms_) {
    const Complex late = std::pow(z, -term.periods);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < size; ++j) work_[i * size + j] -= late * term.effect[i] * evaluation_[j];
  }
  Complex out(1.0);
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i)
      if (std::norm(work_[i * size + k]) > std::norm(work_[pivot * size + k])) pivot = i;
    if (work_[pivot * size + k] == Complex(0.0)) return Complex(0.0);
    if (pivot != k) {
      std::swap_ranges(&work_[k * size], &work_[k * size] + size, &work_[pivot * size]);
      out = -out;
    }
    out *= work_[k * size + k];
    for (std::size_t i = k + 1; i < size; ++i) {
      const Complex factor = work_[i * size + k] / work_[k * size + k];
      for (std::size_t j = k + 1; j < size; ++j) work_[i * size + j] -= factor * work_[k * size + j];
    }
  }
  return out;
}

std::optional<double> Characteristic::turn(double radius, const Arc& arc, int depth) const {
  constexpr double kMost = 0.5;  // [rad] a larger change may hide a whole turn
  constexpr int kDeepest = 40;   // halvings: a zero as close as the rounding of the circle
  if (arc.value_from == Complex(0.0) || arc.value_to == Complex(0.0)) return std::nullopt;
  const double change = std::arg(arc.value_to / arc.value_from);
  if (std::abs(change) <= kMost) return change;
  if (depth == kDeepest) return std::nullopt;
  const double middle = 0.5 * (arc.from + arc.to);
  const Complex at = value(std::polar(radius, middle));
  const auto first = turn(radius, {arc.from, middle, arc.value_from, at}, depth + 1);
  if (!first) return std::nullopt;
  const auto second = turn(radius, {middle, arc.to, at, arc.value_to}, depth + 1);
  if (!second) return std::nullopt;
  return *first + *second;
}

/// F of a conjugate is the conjugate of F: half of the circle is half of the turns.
std::optional<int> Characteristic::zeros_within(double radius) const {
  const int arcs = 8 * (degree() + 4);  // a zero that is not close to the circle turns F by at most an eighth of 2 pi / degree per arc
  double angle = std::numbers::pi * most_;
  Complex from = value(Complex(radius));
  for (int n = 0; n < arcs; ++n) {
    const double start = std::numbers::pi * n / arcs, end = std::numbers::pi * (n + 1) / arcs;
    const Complex to = value(n + 1 == arcs ? Complex(-radius) : std::polar(radius, end));
    const auto change = turn(radius, {start, end, from, to}, 0);
    if (!change) return std::nullopt;
    angle += *change;
    from = to;
  }
  return static_cast<int>(std::lround(angle / std::numbers::pi));
}

bool all_within(const Characteristic& characteristic, double radius) {
  return characteristic.zeros_within(radius) == characteristic.degree();
}

}  // namespace

bool is_stable(const ForceLoop& loop) { return all_within(Characteristic(loop), 1.0); }

double log_growth(const ForceLoop& loop) {
  const Characteristic characteristic(loop);
  const double ticks = loop.scheme == MultiRateScheme::planes ? loop.contact_ticks : 1.0;  // its period is one tick
  const double least = -600.0 / characteristic.degree();                                   // powers of the radius must not overflow
  double high = 1e-3;
  while (!all_within(characteristic, std::exp(high))) high *= 2.0;
  double low = high;
  for (double step = 1e-3; low > least && all_within(characteristic, std::exp(low)); step *= 2.0) low = std::max(least, high - step);
  if (all_within(characteristic, std::exp(low))) return low * ticks;
  while (high - low > 1e-9) {
    const double middle = 0.5 * (low + high);
    (all_within(characteristic, std::exp(middle)) ? high : low) = middle;
  }
  return 0.5 * (low + high) * ticks;
}

double limit_below(const ForceLoop& loop, LoopQuantity quantity) {
  constexpr double kStep = 0.95, kLeast = 1e-3, kWidth = 1e-6;
  const auto stable = [&](double value) {
    ForceLoop changed = loop;
    changed.*quantity = value;
    return is_stable(changed);
  };
  double high = loop.*quantity, low = high;
  const double least = kLeast * high;
  if (!(high > 0.0)) return 0.0;
  do {
    high = low;
    low *= kStep;
    if (low < least) return 0.0;
  } while (!stable(low));
  while (high / low > 1.0 + kWidth) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

double natural_frequency(const ForceLoop& loop) noexcept {
  return std::sqrt((loop.body.stiffness + loop.gain * loop.stiffness) / loop.body.mass);
}

}  // namespace burrhole
