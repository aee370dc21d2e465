/// app/lab/frontier_oracle.h: what theory says about a wall of stiffness K and damping B that a held device presses on, computed without a
///   line of the loop that is measured.
///   Units SI.   Thread any; pure functions.
///   Exact   the sampled system, one vector of numbers mapped from one contact period to the next; stable while its spectral radius is
///           below 1. Between ticks the body moves by exp of its own matrix (a Taylor series, not the closed form that the plant uses).
///   Lines   the passive wall, the quantised passive wall, linear stability with delay: facts of the literature, as printed or evaluated.
///   Source  exact system: own derivation. Colgate & Schenkel 1997, Abbott & Okamura 2005, Gil et al. 2009: formulas as the project's facts
///   have them.
#pragma once

#include <optional>
#include <vector>

#include "haptics/servo/multi_rate.h"

namespace burrhole {

/// One degree of freedom, pressed on so that contact never opens; the tool lies still on bone.
struct SampledWall {
  double mass = 0.1, damping = 0.5, spring = 0.0;  ///< [kg], [N s/m], [N/m] totals of device and hand; the spring is the hand's
  double period = 1e-3;                            ///< [s] of the servo
  int delay = 0;                                   ///< [ticks] of the device's readings
  int contact_ticks = 1, latency_ticks = 0;        ///< as in FrontierLoopConfig, the latency at least 0
  MultiRateScheme scheme = MultiRateScheme::hold;
  double wall_damping = 0.0;   ///< [N s/m] B
  double velocity_time = 0.0;  ///< [s] of the filter of the device's velocity
};

/// Square matrix, rows first.
struct SquareMatrix {
  std::size_t size = 0;
  std::vector<double> at;
};
/// log of the spectral radius: Gelfand's formula by repeated squaring, so that complex pairs need no care.
[[nodiscard]] double log_spectral_radius(SquareMatrix matrix);

/// One contact period of the sampled system at wall stiffness K [N/m].
[[nodiscard]] SquareMatrix contact_period_map(const SampledWall& wall, double stiffness);
/// [N/m] Where the spectral radius first passes 1, going up from 1 N/m; infinite if not below 1e7.
[[nodiscard]] double exact_limit(const SampledWall& wall);

/// [N/m] Colgate & Schenkel's condition on the device alone (no hand), b > T/2 Re((1 - z^-1) H(z)) / (1 - cos wT) at every frequency,
/// evaluated for H = z^-delay (K + B filtered difference): K T/2 + B without delay and filter, K (T/2 + d T) for B = 0. 0 where B alone
/// breaks it.
[[nodiscard]] double passive_limit(const SampledWall& wall, double device_damping);
/// [N/m] Abbott & Okamura: min(2 b/T, 2 f_c/step); nothing where the device has no step.
[[nodiscard]] std::optional<double> quantised_passive_limit(double device_damping, double friction, double quantum, double period);
/// [N/m] Gil et al.: (b + B)/(T/2 + t_d), t_d the reading's delay and the force's latency.
[[nodiscard]] double linear_limit(const SampledWall& wall);

}  // namespace burrhole
