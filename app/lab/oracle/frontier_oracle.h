/// app/lab/oracle/frontier_oracle.h: computed stability limits of a virtual wall (stiffness K, damping B) that a hand presses through a force
///   device. Shares no code with the simulated loop that it checks.
///   Units SI.   Errors  none.   Thread any; pure functions.
///   exact_stability_limit() takes the state-transition matrix of the sampled system over one contact period; the system is stable while the
///           spectral radius is below 1. The motion of the mass between ticks is a matrix exponential by Taylor series; the device model of
///           the simulated loop uses a closed form.
///   passive_limit(), quantised_passive_limit() and delayed_linear_limit() are published formulas.
///   Source  exact_stability_limit(): own derivation. The formulas: Colgate & Schenkel 1997, Abbott & Okamura 2005, Gil et al. 2009.
#pragma once

#include <optional>
#include <vector>

#include "haptics/servo/multi_rate.h"

namespace burrhole {

/// One degree of freedom; preloaded, so that contact never opens.
struct SampledWall {
  double mass = 0.1;            ///< [kg] of device and hand
  double damping = 0.5;         ///< [N s/m] of device and hand
  double hand_stiffness = 0.0;  ///< [N/m] of the hand, from the grip to a fixed point
  double period = 1e-3;         ///< [s] of the servo
  int delay = 0;                ///< [ticks] delay of the device's readings
  int contact_ticks = 1;        ///< [ticks] of the servo per contact evaluation
  int latency_ticks = 0;        ///< [ticks] of the servo from a motion of the hand to its force, >= 0
  MultiRateScheme scheme = MultiRateScheme::hold;
  double wall_damping = 0.0;   ///< [N s/m] B
  double velocity_time = 0.0;  ///< [s] time constant of the device's velocity filter
  bool true_velocity = false;  ///< the velocity read is that of the mass, without differences and filter
};

/// Square matrix, row-major.
struct SquareMatrix {
  std::size_t size = 0;
  std::vector<double> entries;  ///< [units of the state] size x size
};
/// @returns the natural logarithm of the spectral radius, -infinity for a nilpotent matrix. Gelfand's formula with repeated squaring, correct
/// for complex eigenvalues too.
[[nodiscard]] double log_spectral_radius(SquareMatrix matrix);

/// @returns the state-transition matrix over one contact period at wall stiffness K [N/m]. State: position [m] and velocity [m/s]; reported
/// positions and velocities, newest first; computed forces [N] and the positions at which they were computed, newest first; the force at the
/// start of the interpolation, and the force on the hand.
[[nodiscard]] SquareMatrix contact_period_matrix(const SampledWall& wall, double stiffness);
/// @returns the smallest K [N/m] found at which the spectral radius reaches 1: 0 if it does at 1 N/m, infinity if it does not below 1e7.
/// Searched upwards in steps of 10 %, then bisected to 1e-6.
[[nodiscard]] double exact_stability_limit(const SampledWall& wall);

/// @returns the largest K [N/m] for which the device without a hand is passive (Colgate & Schenkel), 0 if there is none. Condition, at 4000
/// frequencies w up to pi/T: b > T/2 Re((1 - z^-1) H(z)) / (1 - cos wT) with z = e^(iwT), H(z) = z^-d (K + B F(z)), b = device_damping
/// [N s/m], T = period, d = delay + latency_ticks, and F the filtered backward difference divided by T.
/// For d = 0 without filter it reads b > K T/2 + B, for B = 0 it reads b > K (T/2 + d T).
[[nodiscard]] double passive_limit(const SampledWall& wall, double device_damping);
/// @returns the largest passive K [N/m] with quantised positions, without delay and for B = 0 (Abbott & Okamura): min(2 b/T, 2 f_c/quantum);
/// nothing if `quantum` is 0. @param device_damping [N s/m] b. @param friction [N] f_c. @param quantum [m]. @param period [s] T.
[[nodiscard]] std::optional<double> quantised_passive_limit(double device_damping, double friction, double quantum, double period);
/// @returns the largest stable K [N/m] with delay (Gil et al.): (b + B)/(T/2 + t_d), b = damping of device and hand, t_d = delay of the
/// readings plus latency of the force.
[[nodiscard]] double delayed_linear_limit(const SampledWall& wall);

}  // namespace burrhole
