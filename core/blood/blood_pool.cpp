#include "core/blood/blood_pool.h"

#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr int kHalvings = 60;  // of the interval in which the flow of a step lies

/// @returns (1 - exp(-x)) / x, x >= 0.
double mean_decay(double x) noexcept { return x < 1e-4 ? 1.0 - x * (0.5 - x / 6.0) : (1.0 - portable_exp(-x)) / x; }

}  // namespace

void BloodPool::step(BloodSite& site, double saline, double dt) noexcept {
  // A hole that shrank loses of the mixture.
  fill(site.capacity(), 0.0, 0.0);
  const double rate = 1.0 / config_.film_time + (saline > 0.0 ? 1.0 / config_.wash_time : 0.0);  // [1/s]
  const double kept = mean_decay(rate * dt);                                                     // of what bleeds in the step
  const double drains = volumes_.film * (1.0 - portable_exp(-rate * dt));
  const double bled = bleed(site, drains, kept, dt);
  const double arrives = std::min(drains + bled * (1.0 - kept), volumes_.film + bled);
  volumes_.bled += bled;
  volumes_.film += bled - arrives;
  flow_ = bled / dt;
  fill(site.capacity(), arrives, saline * dt);
  suck(dt);
  level_ = site.level_of(volumes_.in_hole());
}

double BloodPool::bleed(BloodSite& site, double drains, double kept, double dt) noexcept {
  const double seconds = dt * mean_decay(dt / config_.coagulation);  // at the conductance of the step's start
  const auto volume_at = [&](double level) { return config_.conductance * seconds * site.drive(config_.pressure, level, config_.weight); };
  const auto level_after = [&](double bled) { return site.level_of(volumes_.in_hole() + drains + bled * (1.0 - kept)); };
  double high = volume_at(site.floor());
  const auto lowest = site.lowest_source();
  double bled = high;
  if (lowest && level_after(high) > *lowest) {  // bled - volume_at(level_after(bled)) grows with bled
    double low = 0.0;
    for (int n = 0; n < kHalvings; ++n) {
      bled = 0.5 * (low + high);
      (bled < volume_at(level_after(bled)) ? low : high) = bled;
    }
  }
  site.decay(portable_exp(-dt / config_.coagulation));
  return bled;
}

void BloodPool::fill(double capacity, double blood, double saline) noexcept {
  const double had = volumes_.hole, inflow = blood + saline;
  double& leaves = saline > 0.0 ? volumes_.rinsed : volumes_.overflowed;
  const double excess = volumes_.in_hole() - capacity;
  if (excess > 0.0) {  // more than it holds before anything arrives
    const double share = capacity / volumes_.in_hole();
    const double lost = had * (1.0 - share);
    volumes_.hole -= lost;
    volumes_.saline *= share;
    leaves += lost;
  }
  if (!(inflow > 0.0)) return;
  const double filling = std::clamp((capacity - volumes_.in_hole()) / inflow, 0.0, 1.0);  // of the step
  volumes_.hole += blood * filling;
  volumes_.saline += saline * filling;
  if (filling >= 1.0) return;
  const double before = volumes_.hole, more = 1.0 - filling;
  const double steady = capacity * (blood / inflow);
  const double turned = capacity > 0.0 ? portable_exp(-inflow * more / capacity) : 0.0;
  volumes_.hole = std::clamp(steady + (before - steady) * turned, 0.0, std::min(capacity, before + blood * more));
  volumes_.saline = std::max(0.0, capacity - volumes_.hole);
  leaves += before + blood * more - volumes_.hole;
}

void BloodPool::suck(double dt) noexcept {
  const double all = volumes_.in_hole();
  if (!(config_.suction > 0.0) || !(all > 0.0)) return;
  const double left = std::max(0.0, 1.0 - config_.suction * dt / all);
  const double taken = volumes_.hole * (1.0 - left);
  volumes_.hole -= taken;
  volumes_.saline *= left;
  volumes_.sucked += taken;
}

double BloodPool::blood_depth(const BloodSite& site) const noexcept {
  const double area = site.area_at(level_);
  return area > 0.0 ? volumes_.hole / area : 0.0;
}

}  // namespace burrhole
