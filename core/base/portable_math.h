/// core/base/portable_math.h: exp, sin, cos and atan2 with the same bits on every x86-64 CPU.
/// glibc picks FMA and non-FMA variants of these at run time, whose last bits differ; a replay must not depend on the CPU.
/// Only +, -, *, / and exact scaling are used; built with -ffp-contract=off. Error at most 2 ulp where not said otherwise (tested against
/// long double).
#pragma once

namespace burrhole {

/// e^x; 0 below -745, +inf above 709.78. NaN in, NaN out.
[[nodiscard]] double portable_exp(double x) noexcept;
/// ln x, x > 0 and normal; within 1e-15 + 1e-15 |ln x|. For tables, not for loops: it takes a few exponentials.
[[nodiscard]] double portable_log(double x) noexcept;
/// Angle of the point (x, y) from the x axis [rad], in [-pi, pi]; 0 at the origin. Within 5 ulp where x^2 + y^2 neither over- nor
/// underflows.
[[nodiscard]] double portable_atan2(double y, double x) noexcept;
/// Sine of x [rad], |x| <= 1e6 (larger arguments lose accuracy, not determinism).
[[nodiscard]] double portable_sin(double x) noexcept;
[[nodiscard]] double portable_cos(double x) noexcept;

}  // namespace burrhole
