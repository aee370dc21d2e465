/// app/lab/oracle/frontier_oracle.h: theoretical limits of a wall of stiffness K and damping B pressed by a device in a hand. Shares no
/// code
///   with the measured loop.
///   Units SI.   Errors  none.   Thread any; pure functions.
///   Exact   the sampled system as a linear map of its state from one contact period to the next; stable while the spectral radius is below
///   1.
///           Between ticks the body moves by the matrix exponential (a Taylor series; the plant uses a closed form).
///   Limits  the passive wall, the quantised passive wall, linear stability with delay: formulas of the literature.
///   Source  exact system: own derivation. Colgate & Schenkel 1997, Abbott & Okamura 2005, Gil et al. 2009: formulas as in the project's
///           facts.
#pragma once

#include <optional>
#include <vector>

#include "haptics/servo/multi_rate.h"

namespace burrhole {

/// One degree of freedom, preloaded so that contact never opens; the tool rests on bone.
struct SampledWall {
  double mass = 0.1, damping = 0.5, spring = 0.0;  ///< [kg], [N s/m], [N/m] sums of device and hand; the spring is that of the hand
  double period = 1e-3;                            ///< [s] of the servo
  int delay = 0;                                   ///< [ticks] delay of the device's readings
  int contact_ticks = 1, latency_ticks = 0;        ///< [ticks] as in FrontierLoopConfig, the latency >= 0
  MultiRateScheme scheme = MultiRateScheme::hold;
  double wall_damping = 0.0;   ///< [N s/m] B
  double velocity_time = 0.0;  ///< [s] time constant of the device's velocity filter
};

/// Square matrix, row-major.
struct SquareMatrix {
  std::size_t size = 0;
  std::vector<double> at;  ///< [-] size x size entries
};
/// @returns the logarithm of the spectral radius, by Gelfand's formula with repeated squaring, which also covers complex pairs.
[[nodiscard]] double log_spectral_radius(SquareMatrix matrix);

/// @returns the map of one contact period of the sampled system at wall stiffness K [N/m].
[[nodiscard]] SquareMatrix contact_period_map(const SampledWall& wall, double stiffness);
/// @returns the stiffness [N/m] at which the spectral radius first exceeds 1, searched upwards from 1 N/m; infinite if it does not below
/// 1e7.
[[nodiscard]] double exact_limit(const SampledWall& wall);

/// @returns the limit [N/m] of Colgate & Schenkel's condition for the device alone (no hand), b > T/2 Re((1 - z^-1) H(z)) / (1 - cos wT) at
/// every frequency, for H = z^-delay (K + B filtered difference): K T/2 + B without delay and filter, K (T/2 + d T) for B = 0. 0 if B alone
/// violates it.
[[nodiscard]] double passive_limit(const SampledWall& wall, double device_damping);
/// @returns the limit [N/m] of Abbott & Okamura: min(2 b/T, 2 f_c/quantum); nothing if the device has no quantum.
[[nodiscard]] std::optional<double> quantised_passive_limit(double device_damping, double friction, double quantum, double period);
/// @returns the limit [N/m] of Gil et al.: (b + B)/(T/2 + t_d), t_d the delay of the reading plus the latency of the force.
[[nodiscard]] double linear_limit(const SampledWall& wall);

}  // namespace burrhole
