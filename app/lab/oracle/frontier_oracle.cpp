#include "app/lab/oracle/frontier_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr double kTop = 1e7;  // [N/m] upper end of the search

/// exp of [0 1 0; -k/m -b/m 1/m; 0 0 0] T: position and velocity after a tick from those before and a constant force. Taylor after halving.
struct Flow {
  std::array<std::array<double, 3>, 3> a{};
};

Flow product(const Flow& l, const Flow& r) {
  Flow out;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) out.a[i][j] += l.a[i][k] * r.a[k][j];
  return out;
}

Flow flow_of(const SampledWall& wall) {
  constexpr int kHalvings = 10, kTerms = 14;  // |A T| < 1 after 2^-10 for all bodies used: the rest of the series is below 1e-20
  const double t = wall.period / (1 << kHalvings);
  const Flow rate{{{{0.0, t, 0.0}, {-wall.hand_stiffness / wall.mass * t, -wall.damping / wall.mass * t, t / wall.mass}, {0.0, 0.0, 0.0}}}};
  Flow sum{{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}}, term = sum;
  for (int n = 1; n <= kTerms; ++n) {
    term = product(term, rate);
    for (auto& row : term.a)
      for (double& value : row) value /= n;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) sum.a[i][j] += term.a[i][j];
  }
  for (int n = 0; n < kHalvings; ++n) sum = product(sum, sum);
  return sum;
}

/// The state of the sampled system and its ticks; linear, so unit vectors give the matrix.
class Ticks {
 public:
  Ticks(const SampledWall& wall, double stiffness)
      : wall_(wall),
        flow_(flow_of(wall)),
        stiffness_(stiffness),
        filter_(wall.period / (wall.period + wall.velocity_time)),
        reported_(static_cast<std::size_t>(wall.delay) + 1),
        asked_(static_cast<std::size_t>((wall.latency_ticks + wall.contact_ticks - 1) / wall.contact_ticks) + 1) {}

  [[nodiscard]] std::size_t size() const { return 2 + 2 * reported_ + 2 * asked_ + 2; }

  void contact_period(std::vector<double>& s) const {
    for (int n = 0; n < wall_.contact_ticks; ++n) tick(s, n);
  }

 private:
  // Layout: x, v; reported positions and velocities, newest first; requested forces and their samples, newest first; line from, force.
  [[nodiscard]] std::size_t reported_x(std::size_t n) const { return 2 + n; }
  [[nodiscard]] std::size_t reported_v(std::size_t n) const { return 2 + reported_ + n; }
  [[nodiscard]] std::size_t force(std::size_t n) const { return 2 + 2 * reported_ + n; }
  [[nodiscard]] std::size_t sample(std::size_t n) const { return 2 + 2 * reported_ + asked_ + n; }
  [[nodiscard]] std::size_t from() const { return size() - 2; }
  [[nodiscard]] std::size_t shown() const { return size() - 1; }

  void push(std::vector<double>& s, std::size_t first, std::size_t count, double value) const {
    for (std::size_t n = count - 1; n > 0; --n) s[first + n] = s[first + n - 1];
    s[first] = value;
  }

  void tick(std::vector<double>& s, int n) const {
    const double x = s[reported_x(reported_ - 1)], v = s[reported_v(reported_ - 1)];
    if (n == 0) {
      push(s, force(0), asked_, -stiffness_ * x - wall_.wall_damping * v);
      push(s, sample(0), asked_, x);
    }
    // The evaluation that has arrived: floor((n - latency) / N) periods before this one.
    const int behind = wall_.latency_ticks > n ? (wall_.latency_ticks - n + wall_.contact_ticks - 1) / wall_.contact_ticks : 0;
    const auto due = static_cast<std::size_t>(behind);
    const bool fresh = (n - wall_.latency_ticks) % wall_.contact_ticks == 0;
    show(s, due, fresh, n, x, v);
    const double f = s[shown()], x0 = s[0], v0 = s[1];
    s[0] = flow_.a[0][0] * x0 + flow_.a[0][1] * v0 + flow_.a[0][2] * f;
    s[1] = flow_.a[1][0] * x0 + flow_.a[1][1] * v0 + flow_.a[1][2] * f;
    const double speed = s[reported_v(0)] + ((s[0] - s[reported_x(0)]) / wall_.period - s[reported_v(0)]) * filter_;
    push(s, reported_x(0), reported_, s[0]);
    push(s, reported_v(0), reported_, wall_.true_velocity ? s[1] : speed);
  }

  void show(std::vector<double>& s, std::size_t due, bool fresh, int n, double x, double v) const {
    if (wall_.scheme != MultiRateScheme::linear) s[from()] = 0.0;  // otherwise it would be an irrelevant eigenvalue of 1
    switch (wall_.scheme) {
      case MultiRateScheme::hold:
        s[shown()] = s[force(due)];
        break;
      case MultiRateScheme::linear: {
        if (fresh) s[from()] = s[shown()];
        const int since = ((n - wall_.latency_ticks) % wall_.contact_ticks + wall_.contact_ticks) % wall_.contact_ticks + 1;
        s[shown()] = s[from()] + (s[force(due)] - s[from()]) * since / wall_.contact_ticks;
        break;
      }
      case MultiRateScheme::gradient:
        s[shown()] = s[force(due)] - stiffness_ * (x - s[sample(due)]);
        break;
      case MultiRateScheme::planes:
        s[shown()] = -stiffness_ * x - wall_.wall_damping * v;
        break;
    }
  }

  SampledWall wall_;
  Flow flow_;
  double stiffness_, filter_;
  std::size_t reported_, asked_;
};

/// Scales to a largest entry of 1. @returns the logarithm of the divisor.
double normalise(SquareMatrix& matrix) {
  double largest = 0.0;
  for (const double value : matrix.entries) largest = std::max(largest, std::abs(value));
  if (largest == 0.0) return -std::numeric_limits<double>::infinity();
  for (double& value : matrix.entries) value /= largest;
  return std::log(largest);
}

}  // namespace

double log_spectral_radius(SquareMatrix matrix) {
  constexpr int kSquarings = 40;  // ||A^n||^(1/n) with n = 1e12: a defective matrix adds at most log n / n to the logarithm
  double sum = normalise(matrix);
  const std::size_t size = matrix.size;
  SquareMatrix next = matrix;
  for (int n = 1; n <= kSquarings && std::isfinite(sum); ++n) {
    std::fill(next.entries.begin(), next.entries.end(), 0.0);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t k = 0; k < size; ++k)
        for (std::size_t j = 0; j < size; ++j) next.entries[i * size + j] += matrix.entries[i * size + k] * matrix.entries[k * size + j];
    std::swap(matrix, next);
    sum += normalise(matrix) / std::exp2(n);
  }
  return sum;
}

SquareMatrix contact_period_matrix(const SampledWall& wall, double stiffness) {
  BH_ASSERT(wall.delay >= 0 && wall.contact_ticks >= 1 && wall.latency_ticks >= 0);
  const Ticks ticks(wall, stiffness);
  SquareMatrix out{ticks.size(), std::vector<double>(ticks.size() * ticks.size())};
  for (std::size_t j = 0; j < out.size; ++j) {
    std::vector<double> state(out.size, 0.0);
    state[j] = 1.0;
    ticks.contact_period(state);
    for (std::size_t i = 0; i < out.size; ++i) out.entries[i * out.size + j] = state[i];
  }
  return out;
}

double exact_stability_limit(const SampledWall& wall) {
  const auto stable = [&](double stiffness) { return log_spectral_radius(contact_period_matrix(wall, stiffness)) < 0.0; };
  double low = 1.0;
  if (!stable(low)) return 0.0;
  double high = low;
  do {
    low = high;
    high *= 1.1;
    if (high > kTop) return std::numeric_limits<double>::infinity();
  } while (stable(high));
  while (high / low > 1.0 + 1e-6) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

double passive_limit(const SampledWall& wall, double device_damping) {
  constexpr int kFrequencies = 4000;
  const double half = 0.5 * wall.period, decay = wall.velocity_time / (wall.period + wall.velocity_time);
  double limit = std::numeric_limits<double>::infinity(), least = 0.0;
  for (int n = 1; n <= kFrequencies; ++n) {
    const double w = std::numbers::pi * n / kFrequencies, one_less = 1.0 - std::cos(w);
    const double d = wall.delay + wall.latency_ticks;
    // (1 - z^-1) z^-d K, and (1 - z^-1) z^-d B (1 - decay)(1 - z^-1) / (T (1 - decay z^-1)).
    const double spring = half * (std::cos(d * w) - std::cos((d + 1.0) * w)) / one_less;
    const double re = (std::cos(d * w) - 2.0 * std::cos((d + 1.0) * w) + std::cos((d + 2.0) * w)) * (1.0 - decay) / wall.period;
    const double im = (-std::sin(d * w) + 2.0 * std::sin((d + 1.0) * w) - std::sin((d + 2.0) * w)) * (1.0 - decay) / wall.period;
    const double den_re = 1.0 - decay * std::cos(w), den_im = decay * std::sin(w);
    const double damper = half * (re * den_re + im * den_im) / (den_re * den_re + den_im * den_im) / one_less;
    const double left = device_damping - wall.wall_damping * damper;
    // At frequencies where a delayed spring dissipates energy it may compensate a damper that generates energy: a lower bound.
    if (spring > 0.0) limit = std::min(limit, left / spring);
    if (spring < 0.0) least = std::max(least, left / spring);
  }
  return limit >= least ? limit : 0.0;
}

std::optional<double> quantised_passive_limit(double device_damping, double friction, double quantum, double period) {
  if (!(quantum > 0.0)) return std::nullopt;
  return std::min(2.0 * device_damping / period, 2.0 * friction / quantum);
}

double delayed_linear_limit(const SampledWall& wall) {
  return (wall.damping + wall.wall_damping) / (0.5 * wall.period + wall.period * (wall.delay + wall.latency_ticks));
}

}  // namespace burrhole
