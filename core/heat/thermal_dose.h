/// core/heat/thermal_dose.h: thermal dose in cumulative equivalent minutes at 43 C.
///   CEM43 = integral of R^(43 - T) dt, R = 0.5 above 43 C, 0.25 below (Sapareto and Dewey 1984). 47 C for 1 min is 16 min, 50 C for 30 s
///   is 64 min.   Units  degrees Celsius, s, min.   Thread  any.
#pragma once

namespace burrhole {

/// @returns the dose [min] of `seconds` [s] at a temperature [C], which counts as at most kHottestOfDose.
[[nodiscard]] double thermal_dose(double celsius, double seconds) noexcept;

/// [C] Above it the dose does not grow: water boils, and bone is dead at once. Keeps doses in the range of floats.
inline constexpr double kHottestOfDose = 100.0;

}  // namespace burrhole
