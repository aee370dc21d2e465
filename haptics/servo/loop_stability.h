/// haptics/servo/loop_stability.h: stability of the force loop: a hand, the device that it holds if there is one, and the coupling to a tool
///   that rigid bone stops.
///   Model  One degree of freedom, preloaded, so that contact never opens. Without friction, quantum and force limits. The loop is linear and
///          periodic in the contact period of N servo ticks. With s the state at the times of the motions that contact samples, A the flow of
///          a tick, b the effect of a force held over it, and e = -(K x + B v) the force that contact computes from a sample, tick j of a
///          period has the force f_j = sum_k l_jk e z^-k, where the scheme, the reading delay and the latency give l_jk. The characteristic
///          function is  F(z) = z^M det(z I - A^N - sum_j A^(N-1-j) b f_j(z) c^T),  with c e = e: a polynomial of degree M + size of s.
///          The loop is stable if all zeros are inside the unit circle. They are counted by the argument principle, so the latency does not
///          enlarge a matrix.
///   Units  SI, at the grip: with a device the stiffness of the coupling is multiplied by `gain`, the product of its scales.   Errors  none.
///   Thread any; pure functions. Not for the servo: a call takes up to some milliseconds.
///   Source own derivation. app/lab/oracle/frontier_oracle.h is a separate derivation of the same limits.
#pragma once

#include "haptics/hand/mass_spring_damper.h"
#include "haptics/servo/multi_rate.h"

namespace burrhole {

struct ForceLoop {
  MassSpringDamperConfig body{};  ///< of device and hand
  double period = 1e-3;           ///< [s] of the servo
  int reading_delay = 0;          ///< [ticks] of the device's readings
  bool true_velocity = false;     ///< the velocity read is that of the body; otherwise filtered differences of positions
  double velocity_time = 0.0;     ///< [s] time constant of that filter
  int contact_ticks = 1;          ///< [ticks] N, of the servo per contact evaluation
  int latency_ticks = 0;          ///< [ticks] from a reading to the force of its contact evaluation
  MultiRateScheme scheme = MultiRateScheme::planes;
  double stiffness = 0.0;  ///< [N/m] of the coupling
  double damping = 0.0;    ///< [N s/m] of the coupling
  double gain = 1.0;       ///< [-] position scale times force scale
};

/// @returns whether all motions of the loop decay; false at the limit, and for a loop whose zeros cannot be separated from the circle.
[[nodiscard]] bool is_stable(const ForceLoop& loop);
/// @returns the natural logarithm of the spectral radius over one contact period, to 1e-9 (`planes`: per tick); never below
/// -600 / (degree of F).
[[nodiscard]] double log_growth(const ForceLoop& loop);
/// A quantity of the loop that may be reduced: the coupling's stiffness or damping, or the gain.
using LoopQuantity = double ForceLoop::*;
/// @returns the limit of a quantity below its present value: just below it the loop is stable, above it it is not. Searched downwards in steps
/// of 5 % to a thousandth of the present value, then bisected to 1e-6; 0 if no such value is stable. @pre the loop is unstable.
[[nodiscard]] double limit_below(const ForceLoop& loop, LoopQuantity quantity);
/// @returns the undamped natural angular frequency [rad/s] of body and coupling.
[[nodiscard]] double natural_frequency(const ForceLoop& loop) noexcept;

}  // namespace burrhole
