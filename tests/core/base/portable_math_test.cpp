#include "core/base/portable_math.h"

#include "core/base/rotation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "core/base/random.h"

using namespace burrhole;

namespace {

/// |value - exact| in units of the last place of the exact value as a double (the spacing of subnormals below the normal range).
double ulps(double value, long double exact) {
  const double rounded = std::abs(static_cast<double>(exact));
  const double ulp = rounded < std::numeric_limits<double>::min()
                         ? std::numeric_limits<double>::denorm_min()
                         : std::nextafter(rounded, std::numeric_limits<double>::infinity()) - rounded;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / static_cast<long double>(ulp));
}

struct Range {
  double low, high;
};

/// Worst error in ulp over `count` arguments spread over the range by a fixed seed.
template <class F, class G>
double worst(F&& f, G&& exact, Range range, int count) {
  double most = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = range.low + (range.high - range.low) * uniform01(7, static_cast<std::uint64_t>(i));
    most = std::max(most, ulps(f(x), exact(static_cast<long double>(x))));
  }
  return most;
}

long double exact_exp(long double x) { return std::exp(x); }
long double exact_sin(long double x) { return std::sin(x); }
long double exact_cos(long double x) { return std::cos(x); }

}  // namespace

// The promise of the header is 2 ulp. long double carries 11 bits more than double: the reference's own error is below 0.001 ulp.
constexpr double kPromise = 2.0;
static_assert(std::numeric_limits<long double>::digits >= 64, "the reference must be finer than double");

TEST_CASE("portable_exp: within 2 ulp over the whole range, subnormal results included") {
  CHECK(worst(portable_exp, exact_exp, {-1.0, 1.0}, 200000) <= kPromise);
  CHECK(worst(portable_exp, exact_exp, {-1e-6, 1e-6}, 20000) <= kPromise);
  CHECK(worst(portable_exp, exact_exp, {-745.1, 709.78}, 200000) <= kPromise);
  CHECK(worst(portable_exp, exact_exp, {-745.1, -708.0}, 50000) <= kPromise);
}

TEST_CASE("portable_exp: extremes go to 0, 1, infinity and NaN") {
  CHECK(portable_exp(0.0) == 1.0);
  CHECK(portable_exp(-0.0) == 1.0);
  CHECK(portable_exp(-800.0) == 0.0);
  CHECK(portable_exp(-std::numeric_limits<double>::infinity()) == 0.0);
  CHECK(std::isinf(portable_exp(710.0)));
  CHECK(std::isinf(portable_exp(std::numeric_limits<double>::infinity())));
  CHECK(std::isnan(portable_exp(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("portable_log: within its stated error, over all magnitudes and near 1, and undone by portable_exp") {
  double most = 0.0, most_short = 0.0;
  for (std::uint64_t n = 0; n < 200000; ++n) {
    const double x = n % 2 == 0 ? std::pow(10.0, 600.0 * uniform01(3, n) - 300.0) : 1.0 - 0.9 * uniform01(3, n) * uniform01(4, n);
    const long double exact = std::log(static_cast<long double>(x));
    const double allowed = 1e-15 + 1e-15 * static_cast<double>(std::abs(exact));
    most = std::max(most, static_cast<double>(std::abs(static_cast<long double>(portable_log(x)) - exact)) / allowed);
    // Sabotage: the first guess of the iteration, without the iteration.
    int power = 0;
    const double m = std::frexp(x, &power) * 1.4142135623730951;
    const double guess = (power - 0.5) * 0.6931471805599453 + (m - 1.0) - 0.5 * (m - 1.0) * (m - 1.0);
    most_short = std::max(most_short, static_cast<double>(std::abs(static_cast<long double>(guess) - exact)) / allowed);
  }
  CHECK(most <= 1.0);
  CHECK(most_short > 1.0);
  CHECK(std::abs(portable_log(1.0)) <= 1e-15);
  CHECK(std::abs(portable_exp(portable_log(0.3)) - 0.3) < 1e-15);
}

TEST_CASE("portable_sin and portable_cos: within 2 ulp up to 1e6 rad") {
  for (const Range range : {Range{-0.8, 0.8}, Range{-7.0, 7.0}, Range{-1e3, 1e3}, Range{-1e6, 1e6}}) {
    CAPTURE(range.high);
    CHECK(worst(portable_sin, exact_sin, range, 200000) <= kPromise);
    CHECK(worst(portable_cos, exact_cos, range, 200000) <= kPromise);
  }
}

TEST_CASE("portable_sin and portable_cos: within 2 ulp at the doubles nearest to the multiples of pi/2, where the result almost vanishes") {
  double worst_sin = 0.0, worst_cos = 0.0;
  for (int k = 1; k <= 600000; k += k < 2000 ? 1 : 997) {
    const double x = static_cast<double>(k) * 1.57079632679489661923;
    worst_sin = std::max(worst_sin, ulps(portable_sin(x), exact_sin(static_cast<long double>(x))));
    worst_cos = std::max(worst_cos, ulps(portable_cos(x), exact_cos(static_cast<long double>(x))));
  }
  CHECK(worst_sin <= kPromise);
  CHECK(worst_cos <= kPromise);
}

TEST_CASE("portable_sin and portable_cos: exact at 0, odd and even, NaN stays NaN") {
  CHECK(portable_sin(0.0) == 0.0);
  CHECK(portable_cos(0.0) == 1.0);
  for (int i = 0; i < 1000; ++i) {
    const double x = 100.0 * uniform01(11, static_cast<std::uint64_t>(i));
    CHECK(portable_sin(-x) == -portable_sin(x));
    CHECK(portable_cos(-x) == portable_cos(x));
  }
  CHECK(std::isnan(portable_sin(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("portable_atan2: within 5 ulp all round, at any scale, and on the axes") {
  double most = 0.0, most_short = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const auto u = [&](std::uint64_t stream) { return uniform01(stream, static_cast<std::uint64_t>(i)); };
    const double scale = portable_exp(200.0 * (u(23) - 0.5));
    const double x = scale * (2.0 * u(21) - 1.0), y = scale * (2.0 * u(22) - 1.0) * (i % 3 == 0 ? 1e-9 : 1.0);
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    most = std::max(most, ulps(portable_atan2(y, x), exact));
    most_short = std::max(most_short, ulps(portable_atan2(y, x) * (1.0 + 3e-15), exact));
  }
  CHECK(most <= 5.0);
  CHECK(most_short > 5.0);  // sabotage
  constexpr double kHalfPi = 1.57079632679489661923;
  CHECK(portable_atan2(0.0, 0.0) == 0.0);
  CHECK(portable_atan2(0.0, 2.0) == 0.0);
  CHECK(std::abs(portable_atan2(0.0, -2.0) - 2.0 * kHalfPi) < 1e-15);
  CHECK(std::abs(portable_atan2(3.0, 0.0) - kHalfPi) < 5e-16);
  CHECK(std::abs(portable_atan2(-3.0, 0.0) + kHalfPi) < 5e-16);
  CHECK(std::isnan(portable_atan2(std::numeric_limits<double>::quiet_NaN(), 1.0)));
}

TEST_CASE("rotation vector: there and back, also near no turn and near half a turn, and of the shorter way") {
  for (int i = 0; i < 20000; ++i) {
    const auto u = [&](std::uint64_t stream) { return 2.0 * uniform01(stream, static_cast<std::uint64_t>(i)) - 1.0; };
    const Vec3 axis = glm::normalize(Vec3(u(31), u(32), u(33)) + Vec3(1e-3, 0.0, 0.0));
    constexpr double kPi = 3.14159265358979323846;
    const double angle = i % 3 == 0   ? 1e-14 * static_cast<double>(i)
                         : i % 3 == 1 ? kPi - 1e-9 * static_cast<double>(i + 1)
                                      : 1.5 * (1.0 + u(34));
    const Quat q = rotation_of(axis * angle);
    CHECK(std::abs(glm::length(q) - 1.0) < 1e-15);
    // The quaternion has 2^-53 of absolute precision, its angle twice that; a few roundings more.
    CHECK(glm::length(rotation_vector(q) - axis * angle) < 4e-15);
    CHECK(rotation_vector(-q) == rotation_vector(q));
    // Against the turning of a point by Rodrigues' formula with the library's functions.
    const Vec3 p(0.3, -0.7, 0.2);
    const Vec3 turned = p * std::cos(angle) + glm::cross(axis, p) * std::sin(angle) + axis * (glm::dot(axis, p) * (1.0 - std::cos(angle)));
    CHECK(glm::length(q * p - turned) < 4e-15);
  }
}

TEST_CASE("sabotage: the same check refuses a series cut two terms short") {
  const auto short_sin = [](double x) {
    const double x2 = x * x;  // Taylor to x^11; the first term left out is 4e-11 of the result at 0.8
    double sum = 0.0;
    for (int n = 11; n >= 3; n -= 2) sum = (1.0 + sum) * (-x2 / static_cast<double>(n * (n - 1)));
    return x + x * sum;
  };
  CHECK(worst(short_sin, exact_sin, {-0.8, 0.8}, 20000) > kPromise);
}
