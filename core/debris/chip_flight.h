/// core/debris/chip_flight.h: the flight of a chip in air at rest, under gravity and drag.
///   dv/dt = g - (a + b |v|) v.   a = 18 mu / (rho d^2), b = 0.33 rho_air / (rho d): the sphere of diameter d with the drag coefficient
///   24 / Re + 0.44, Stokes' drag for slow and fine chips and Newton's for fast and coarse ones.
///   Step    the rate a + b |v| of the middle of the step holds throughout it, and the linear equation is solved exactly: stable at any length,
///           exact in Stokes' limit, of second order otherwise, and the terminal speed is that of the closed form.
///   Frame   any that is at rest.   Units   SI.   Errors  none.   Thread  any.   Source  drag of spheres: from memory, not verified; the step is our own derivation.
#pragma once

#include "core/base/geometry.h"

namespace burrhole {

struct ChipAir {
  double chip_density = 1900.0;  ///< [kg/m^3] > 0: solid cortical bone (1810 to 2000)
  double air_density = 1.2;      ///< [kg/m^3] > 0: room air
  double viscosity = 1.8e-5;     ///< [Pa s] > 0: room air
  double gravity = 9.81;         ///< [m/s^2] >= 0
};

struct ChipDrag {
  double linear = 0.0;     ///< [1/s] a
  double quadratic = 0.0;  ///< [1/m] b
  /// @returns a + b |v| [1/s].
  [[nodiscard]] double rate(const Vec3& velocity) const noexcept { return linear + quadratic * glm::length(velocity); }
};
/// @param diameter [m] > 0.
[[nodiscard]] ChipDrag chip_drag(const ChipAir& air, double diameter) noexcept;

/// @returns the speed [m/s] at which drag balances gravity.
[[nodiscard]] double terminal_speed(const ChipDrag& drag, double gravity) noexcept;

/// Changes `velocity` [m/s] by a step of `dt` [s]. @param gravity [m/s^2]. @returns the displacement [m].
[[nodiscard]] Vec3 advance_chip(const ChipDrag& drag, const Vec3& gravity, double dt, Vec3& velocity) noexcept;

}  // namespace burrhole
