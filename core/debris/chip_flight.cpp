#include "core/debris/chip_flight.h"

#include <cmath>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kNewtonDrag = 0.44;  // [-] drag coefficient of a sphere at large Re

/// @returns the velocity after `dt` at a constant rate.
Vec3 decayed(const Vec3& velocity, const Vec3& gravity, double rate, double dt) noexcept {
  const Vec3 end = gravity / rate;
  return end + (velocity - end) * portable_exp(-rate * dt);
}

}  // namespace

ChipDrag chip_drag(const ChipAir& air, double diameter) noexcept {
  return {18.0 * air.viscosity / (air.chip_density * diameter * diameter),
          0.75 * kNewtonDrag * air.air_density / (air.chip_density * diameter)};
}

double terminal_speed(const ChipDrag& drag, double gravity) noexcept {
  // The root of a v + b v^2 = g, in the form that keeps its digits when b v is small.
  return 2.0 * gravity / (drag.linear + std::sqrt(drag.linear * drag.linear + 4.0 * drag.quadratic * gravity));
}

Vec3 advance_chip(const ChipDrag& drag, const Vec3& gravity, double dt, Vec3& velocity) noexcept {
  const Vec3 middle = decayed(velocity, gravity, drag.rate(velocity), 0.5 * dt);
  const double rate = drag.rate(middle);
  const Vec3 end = gravity / rate, before = velocity;
  velocity = decayed(before, gravity, rate, dt);
  return end * dt + (before - velocity) / rate;
}

}  // namespace burrhole
