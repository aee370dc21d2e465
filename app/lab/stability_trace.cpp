#include "app/lab/stability_trace.h"

#include <algorithm>
#include <cmath>

#include "haptics/servo/energy_observer.h"

namespace burrhole {
namespace {

constexpr double kWeak = 0.5;  // [N] a tenth of less is imperceptible

template <class F>
void for_each_in(const StabilityTrace& trace, const TimeSpan& span, F&& f) {
  for (const StabilitySample& sample : trace.samples)
    if (span.holds(sample.time)) f(sample);
}

template <class F>
double largest_in(const StabilityTrace& trace, const TimeSpan& span, F&& of) {
  double out = 0.0;
  for_each_in(trace, span, [&](const StabilitySample& sample) {
    const double value = of(sample);
    if (std::isnan(value) || value > out) out = value;  // NaN exceeds any bound and stays: no value is greater than it
  });
  return out;
}

Vec3 along_surface(const StabilitySample& sample, const Vec3& v) noexcept { return v - sample.normal * glm::dot(v, sample.normal); }

double sign(double value) noexcept { return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0; }

}  // namespace

double ticks_not_finite(const StabilityTrace& trace) noexcept {
  double out = 0.0;
  for (const StabilitySample& s : trace.samples)
    out += is_finite(s.force) && is_finite(s.shown) && is_finite(s.grip) && is_finite(s.grip_velocity) && is_finite(s.tool) ? 0.0 : 1.0;
  return out;
}

double largest_force(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return glm::length(s.force); });
}

double largest_force_step(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  double out = 0.0;
  const StabilitySample* before = nullptr;
  for_each_in(trace, span, [&](const StabilitySample& sample) {
    if (before != nullptr) out = std::max(out, glm::length(sample.force - before->force));
    before = &sample;
  });
  return out;
}

double largest_attractive_force(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return s.attractive_force; });
}

double longest_force_without_bone(const StabilityTrace& trace, double felt) noexcept {
  std::size_t longest = 0, now = 0;
  for (const StabilitySample& s : trace.samples) {
    now = !s.bone_between && glm::length(s.force) > felt ? now + 1 : 0;
    longest = std::max(longest, now);
  }
  return static_cast<double>(longest) * trace.period;
}

double passivity_deficit(const StabilityTrace& trace, const Dissipation& dissipation) noexcept {
  EnergyObserver observer({.damping = dissipation.damping}, trace.period);
  double out = 0.0;
  for (std::size_t n = 0; n < trace.samples.size(); ++n) {
    const StabilitySample& s = trace.samples[n];
    Vec3 held(0.0);
    if (n > 0) {
      const StabilitySample& before = trace.samples[n - 1];
      held = before.shown;
      // Friction counts while the wall exerts force: without force there is no wall, and the observer receives exactly zero.
      const Vec3 moved = s.grip - before.grip;
      if (held != Vec3(0.0)) held -= dissipation.friction * Vec3(sign(moved.x), sign(moved.y), sign(moved.z));
    }
    observer(s.grip - s.carried, s.grip_velocity, held);
    out = std::max(out, -observer.energy());
  }
  return out;
}

double cycle_size(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  Vec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for_each_in(trace, span, [&](const StabilitySample& s) {
    lo = glm::min(lo, s.grip);
    hi = glm::max(hi, s.grip);
  });
  return std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, 0.0});
}

double force_ripple(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  Vec3 sum(0.0);
  double count = 0.0;
  for_each_in(trace, span, [&](const StabilitySample& s) {
    sum += s.force;
    count += 1.0;
  });
  if (count == 0.0) return 0.0;
  const Vec3 mean = sum / count;
  const double off = largest_in(trace, span, [&](const StabilitySample& s) { return glm::length(s.force - mean); });
  return 2.0 * off / std::max(glm::length(mean), kWeak);
}

double deepest(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return s.depth; });
}

double furthest_beyond(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return s.beyond; });
}

double largest_speed(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return glm::length(s.grip_velocity); });
}

double drag_along(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  double work = 0.0, way = 0.0;
  const StabilitySample* before = nullptr;
  for_each_in(trace, span, [&](const StabilitySample& sample) {
    if (before != nullptr) {
      const Vec3 moved = along_surface(sample, sample.tool - before->tool);
      work -= glm::dot(before->force, moved);
      way += glm::length(moved);
    }
    before = &sample;
  });
  return way > 0.0 ? std::abs(work) / way : 0.0;
}

double largest_lateral_force(const StabilityTrace& trace, const TimeSpan& span) noexcept {
  return largest_in(trace, span, [](const StabilitySample& s) { return glm::length(along_surface(s, s.force)); });
}

double largest_force_with(const StabilityTrace& trace, std::uint32_t faults) noexcept {
  return largest_in(trace, {}, [&](const StabilitySample& s) { return (s.faults & faults) != 0 ? glm::length(s.force) : 0.0; });
}

double share_with(const StabilityTrace& trace, const TimeSpan& span, std::uint32_t faults) noexcept {
  double with = 0.0, all = 0.0;
  for_each_in(trace, span, [&](const StabilitySample& s) {
    with += (s.faults & faults) != 0 ? 1.0 : 0.0;
    all += 1.0;
  });
  return all > 0.0 ? with / all : 0.0;
}

}  // namespace burrhole
