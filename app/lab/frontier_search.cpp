#include "app/lab/frontier_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

constexpr double kPush = 0.05;    // [-] of the preload depth: the perturbation
constexpr double kOpens = 0.95;   // [-] of the preload depth: contact is about to open
constexpr double kGone = 5e-3;    // [-] of the perturbation
constexpr double kRatio = 1.005;  // [-] precision of the bisection
constexpr int kCheckEvery = 500;  // [ticks] between two tests whether the oscillation has decayed

}  // namespace

Result<double> pressed_growth(const FrontierLoop& loop, double stiffness, int ticks) {
  const double thrust = stiffness * kPreloadDepth;
  auto run = loop.begin(
      stiffness, {.height = -(1.0 - kPush) * kPreloadDepth, .rest = -kPreloadDepth, .thrust = thrust, .held = loop.config().first_ticks()});
  if (!run) return run.error();
  const int window = ticks / 6;
  double early = 0.0, late = 0.0, recent = 0.0;
  for (int n = 0; n < loop.config().first_ticks(); ++n) (void)run->tick();
  for (int n = 0; n < ticks; ++n) {
    const FrontierTick tick = run->tick();
    const double size = std::abs(tick.height - tick.tool + kPreloadDepth);
    if (!(size < kOpens * kPreloadDepth)) return 1.0;  // NaN counts as unstable
    // A strong damper on a weak spring opens contact by its force before the amplitude is large. A decaying oscillation has decayed by now.
    if (n >= window && tick.shown.z <= 0.0) return 1.0;
    if (n >= window && n < 2 * window) early = std::max(early, size);
    if (n >= ticks - window) late = std::max(late, size);
    recent = std::max(recent, size);
    if (n % kCheckEvery != kCheckEvery - 1) continue;
    if (recent < kGone * kPush * kPreloadDepth) return -1.0;
    recent = 0.0;
  }
  return std::log(late / early);
}

Result<double> pressed_limit(const FrontierLoop& loop, double hint, int ticks) {
  std::optional<Error> failed;
  const auto stable = [&](double stiffness) {
    const auto growth = pressed_growth(loop, stiffness, ticks);
    if (!growth) failed = growth.error();
    return growth && *growth < 0.0;
  };
  double low = std::clamp(hint / 1.3, 1.0, kLargestTried), high = std::clamp(hint * 1.3, 2.0, kLargestTried);
  while (!failed && !stable(low)) {
    if (low <= 1.0) return 0.0;
    high = low;
    low = std::max(1.0, 0.5 * low);
  }
  while (!failed && stable(high)) {
    if (high >= kLargestTried) return std::numeric_limits<double>::infinity();
    low = high;
    high = std::min(kLargestTried, 2.0 * high);
  }
  while (!failed && high / low > kRatio) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  if (failed) return *failed;
  return std::sqrt(low * high);
}

Result<Settling> release(const FrontierLoop& loop, double stiffness, const Release& start) {
  const double height = start.pressed ? -0.5 * start.thrust / (stiffness + loop.config().device.plant.body.stiffness) : start.height;
  auto run = loop.begin(stiffness, {.height = height, .rest = 0.0, .thrust = start.thrust, .held = loop.config().first_ticks()});
  if (!run) return run.error();
  const int ticks = static_cast<int>(start.duration * loop.config().servo_hz), from = ticks - ticks / 3;
  std::vector<double> heights;
  Settling out;
  for (int n = 0; n < ticks; ++n) {
    const FrontierTick tick = run->tick();
    if (!std::isfinite(tick.height)) return Settling{.swing = 1.0, .aside = 1.0};
    out.aside = std::max(out.aside, tick.aside);
    if (n < from) continue;
    heights.push_back(tick.height);
  }
  const double slope = (heights.back() - heights.front()) / static_cast<double>(heights.size() - 1);
  double low = 0.0, high = 0.0;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    const double off = heights[n] - heights.front() - slope * static_cast<double>(n);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  out.swing = high - low;
  return out;
}

bool at_rest(const Settling& settling, double quantum) noexcept { return settling.swing < 3.0 * quantum + 20e-6 && settling.aside < 1e-3; }

Result<double> release_limit(const FrontierLoop& loop, const Release& start, double from) {
  std::optional<Error> failed;
  const auto rests = [&](double stiffness) {
    const auto settling = release(loop, stiffness, start);
    if (!settling) failed = settling.error();
    return settling && at_rest(*settling, loop.config().device.quantum);
  };
  if (!rests(from)) return failed ? Result<double>(*failed) : Result<double>(0.0);
  double low = from, high = from;
  do {
    low = high;
    high *= std::pow(10.0, 0.1);
    if (high > kLargestTried) return std::numeric_limits<double>::infinity();
  } while (rests(high) && !failed);
  while (!failed && high / low > 1.02) {
    const double middle = std::sqrt(low * high);
    (rests(middle) ? low : high) = middle;
  }
  if (failed) return *failed;
  return std::sqrt(low * high);
}

}  // namespace burrhole
