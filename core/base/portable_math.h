/// core/base/portable_math.h: exp, log, sin, cos and atan2 that return the same bits on every x86-64 CPU.
///   glibc selects FMA or non-FMA variants at run time, and their last bits differ. A replay must not depend on the CPU.
///   The functions use only +, -, *, / and exact scaling, and are built with -ffp-contract=off. The error is at most 2 ulp unless stated
///   otherwise; a test compares with long double.   Units  angles in rad.   Thread  any.
#pragma once

namespace burrhole {

/// @returns e^x; 0 for x below -745, +inf above 709.78, NaN for NaN.
[[nodiscard]] double portable_exp(double x) noexcept;
/// @returns ln x with an error of at most 1e-15 + 1e-15 |ln x|. It costs several exponentials. @pre x > 0 and normal.
[[nodiscard]] double portable_log(double x) noexcept;
/// @returns the angle [rad] of the point (x, y) from the x axis, in [-pi, pi]; 0 at the origin. The error is at most 5 ulp if x^2 + y^2
/// neither overflows nor underflows.
[[nodiscard]] double portable_atan2(double y, double x) noexcept;
/// Sine and cosine of x [rad]. For |x| > 1e6 they lose accuracy but stay deterministic.
[[nodiscard]] double portable_sin(double x) noexcept;
[[nodiscard]] double portable_cos(double x) noexcept;

}  // namespace burrhole
