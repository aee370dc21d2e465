/// core/debris/wash.h: what flows away: chips that saline rinses off, and chips that the flutes of a bit hold.
///   Units  SI; volumes of solid bone.   Errors  none.   Thread  any.   Source  own derivation.
#pragma once

namespace burrhole {

/// dW/dt = -min(W / tau, q), solved exactly: saline takes wet chips W in the time tau, but carries no more than q.
struct WashRate {
  double time = 1.0;  ///< [s] > 0: tau
  double most = 0.0;  ///< [m^3/s] >= 0: q
};
/// @param wet [m^3] W before. @param dt [s]. @returns the volume [m^3] that left in dt, 0 to `wet`.
[[nodiscard]] double washed(double wet, const WashRate& rate, double dt) noexcept;

/// dC/dt = V / dt - k C, solved exactly: a volume V comes evenly over a step, and the bit releases the share k dt of what it holds.
/// @param held [m^3] C before. @param arriving [m^3] V. @param decay [-] k dt >= 0. @returns C after the step.
[[nodiscard]] double held_after(double held, double arriving, double decay) noexcept;

}  // namespace burrhole
