#include "core/base/portable_math.h"

#include <cmath>
#include <limits>

namespace burrhole {
namespace {

// ln 2 and pi/2 are split so that k * high part is exact for every k that occurs (Cody and Waite argument reduction).
constexpr double kLn2High = 6.93147180369123816490e-01;
constexpr double kLn2Low = 1.90821492927058770002e-10;
constexpr double kInvLn2 = 1.44269504088896338700e+00;
constexpr double kPiHalf1 = 1.57079632673412561417e+00;
constexpr double kPiHalf2 = 6.07710050630396597660e-11;
constexpr double kPiHalf3 = 2.02226624879595063154e-21;
constexpr double kTwoOverPi = 6.36619772367581382433e-01;

/// An argument reduced to |r| <= pi/4. The angle is r + tail; the tail is the part below the precision of r.
struct Reduced {
  double r;
  double tail;
  int quadrant;
};

// Taylor series on |r| <= pi/4. The first omitted term is below 2^-55 of the result; the tail enters to first order.
double sin_series(double r, double tail) noexcept {
  const double r2 = r * r;
  double sum = 0.0;
  for (int n = 17; n >= 3; n -= 2) sum = (1.0 + sum) * (-r2 / static_cast<double>(n * (n - 1)));
  return r + (r * sum + tail * (1.0 - 0.5 * r2));
}

double cos_series(double r, double tail) noexcept {
  const double r2 = r * r;
  double sum = 0.0;
  for (int n = 18; n >= 2; n -= 2) sum = (1.0 + sum) * (-r2 / static_cast<double>(n * (n - 1)));
  return 1.0 + (sum - tail * r);
}

/// a - b and its rounding error (Knuth's two-sum, exact for operands in any order).
struct Difference {
  double value;
  double lost;
};

Difference exact_difference(double a, double b) noexcept {
  const double value = a - b;
  const double part = value - a;
  return {value, (a - (value - part)) - (b + part)};
}

Reduced reduce(double x) noexcept {
  const double k = std::nearbyint(x * kTwoOverPi);
  const auto [w, lost] =
      exact_difference(x - k * kPiHalf1, k * kPiHalf2);  // both products and the first difference are exact for |x| <= 1e6
  const double low = lost - k * kPiHalf3;
  const double r = w + low;
  return {r, (w - r) + low, static_cast<int>(static_cast<long long>(k) & 3)};
}

}  // namespace

double portable_exp(double x) noexcept {
  if (std::isnan(x)) return x;
  if (x < -745.2) return 0.0;
  if (x > 709.79) return std::numeric_limits<double>::infinity();
  const double k = std::nearbyint(x * kInvLn2);
  const double r = (x - k * kLn2High) - k * kLn2Low;  // |r| <= ln2/2
  // e^r by Horner's scheme on 1/n!. The first omitted term (n = 14) is below 2^-57 of the result.
  static constexpr double kInverseFactorial[] = {1.0 / 6227020800.0, 1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0,
                                                 1.0 / 362880.0,     1.0 / 40320.0,     1.0 / 5040.0,     1.0 / 720.0,
                                                 1.0 / 120.0,        1.0 / 24.0,        1.0 / 6.0,        0.5};
  double sum = 0.0;
  for (const double c : kInverseFactorial) sum = sum * r + c;
  const double fraction = 1.0 + (r + r * r * sum);
  return std::ldexp(fraction, static_cast<int>(k));
}

double portable_log(double x) noexcept {
  int power = 0;
  const double m = std::frexp(x, &power) * 1.4142135623730951;  // in [0.707, 1.414)
  const double q = static_cast<double>(power) - 0.5;            // x = m 2^q
  // Halley's iteration for e^y = m. The error of the first guess is below 0.06 and goes to its cube over 12 each time: 2e-5, 7e-16,
  // rounding.
  double y = m - 1.0 - 0.5 * (m - 1.0) * (m - 1.0);
  for (int n = 0; n < 3; ++n) {
    const double e = portable_exp(y);
    y += 2.0 * (m - e) / (m + e);
  }
  return q * (kLn2High + kLn2Low) + y;
}

double portable_sin(double x) noexcept {
  const auto [r, tail, quadrant] = reduce(x);
  const double value = (quadrant & 1) != 0 ? cos_series(r, tail) : sin_series(r, tail);
  return (quadrant & 2) != 0 ? -value : value;
}

double portable_cos(double x) noexcept {
  const auto [r, tail, quadrant] = reduce(x);
  const double value = (quadrant & 1) != 0 ? sin_series(r, tail) : cos_series(r, tail);
  return (quadrant == 1 || quadrant == 2) ? -value : value;
}

double portable_atan2(double y, double x) noexcept {
  if (x == 0.0 && y == 0.0) return 0.0;
  // tan(a / 2) = sin a / (1 + cos a). An angle of at most pi/2 is halved until its tangent is at most 0.199; the series is then short.
  const double across = std::abs(y), along = std::abs(x);
  double t = across / (along + std::sqrt(along * along + across * across));
  constexpr int kHalvings = 3;
  for (int n = 1; n < kHalvings; ++n) t = t / (1.0 + std::sqrt(1.0 + t * t));
  // The first omitted term, t^22 / 23, is below 2^-55.
  const double t2 = t * t;
  double sum = 0.0;
  for (int n = 21; n >= 3; n -= 2) sum = t2 * ((n / 2 % 2 == 1 ? -1.0 : 1.0) / static_cast<double>(n) + sum);
  const double angle = static_cast<double>(1 << kHalvings) * (t + t * sum);
  constexpr double kPi = 3.14159265358979323846;
  return std::copysign(x < 0.0 ? kPi - angle : angle, y);
}

}  // namespace burrhole
