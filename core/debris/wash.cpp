#include "core/debris/wash.h"

#include <algorithm>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kShort = 1e-5;  // [-] of k dt, below which (1 - e^-x) / x is its series: the next term is 2e-11

double decay_of(double wet, double time, double dt) noexcept { return wet * (1.0 - portable_exp(-dt / time)); }

}  // namespace

double washed(double wet, const WashRate& rate, double dt) noexcept {
  if (!(wet > 0.0) || !(rate.most > 0.0)) return 0.0;
  const double knee = rate.most * rate.time;  // at which both rates are equal
  if (wet <= knee) return decay_of(wet, rate.time, dt);
  const double until = (wet - knee) / rate.most;
  if (dt <= until) return std::min(wet, rate.most * dt);
  return wet - knee + decay_of(knee, rate.time, dt - until);
}

double held_after(double held, double arriving, double decay) noexcept {
  const double kept = portable_exp(-decay);
  const double mean = decay < kShort ? 1.0 - 0.5 * decay : (1.0 - kept) / decay;
  return held * kept + arriving * mean;
}

}  // namespace burrhole
