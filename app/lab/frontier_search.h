/// app/lab/frontier_search.h: measures the largest stiffness at which the shipped loop is stable, by running it.
///   Units SI.   Errors  those of a run.   Thread any; a loop is only read.
///   Pressed   on a plate under a thrust of K times kPreloadDepth: contact stays closed while a perturbation of a twentieth of the depth
///   grows
///             less than twentyfold. The loop is then linear, and the sign of the logarithmic growth of the envelope decides.
///   Released  above bone under a light thrust, with friction, quantisation and limits of the device: whether it comes to rest.
#pragma once

#include "app/lab/frontier_loop.h"

namespace burrhole {

inline constexpr double kPreloadDepth = 1e-3;  // [m]
inline constexpr double kLargestTried = 1e6;   // [N/m] the upper limit of the coupling in a scene

/// @returns the logarithmic growth of the envelope of a grip pressed on the plate, from the second to the last sixth of the run; 1 if
/// contact opened, -1 if the oscillation decayed to nothing.
[[nodiscard]] Result<double> pressed_growth(const FrontierLoop& loop, double stiffness, int ticks);

/// @returns the limit [N/m] by bisection to 0.5 %; infinite if stable at kLargestTried, 0 if unstable at 1 N/m. `hint` only saves runs:
/// both ends of the bracket are tested and extended until one is stable and one is not.
/// @param ticks of a run. 1 % beyond a limit the envelope takes up to 9.2e4 ticks for a factor 10: within 8000 ticks it changes by 13 %.
[[nodiscard]] Result<double> pressed_limit(const FrontierLoop& loop, double hint, int ticks = 8000);

/// Final motion of a grip released above bone.
struct Settling {
  double swing = 0.0;  ///< [m] amplitude of the grip's height in the last third, about its linear trend
  double aside = 0.0;  ///< [m] largest distance from the axis
};
struct Release {
  double height = 0.5e-3;  ///< [m] above bone
  bool pressed = false;    ///< starts half as deep in bone as the thrust brings it
  double thrust = 2.0;     ///< [N]
  double duration = 4.0;   ///< [s]
};
[[nodiscard]] Result<Settling> release(const FrontierLoop& loop, double stiffness, const Release& start);
/// @returns whether the grip is at rest: contact does not open and close, and the amplitude is at most a few quanta of the device.
[[nodiscard]] bool at_rest(const Settling& settling, double quantum) noexcept;

/// @returns the first stiffness [N/m] at which the grip does not come to rest, searched upwards from `from` in steps of a tenth of a
/// decade, then bisected to 2 %; 0 if it does not at `from`. Not a bound: it may come to rest again at a larger stiffness.
[[nodiscard]] Result<double> release_limit(const FrontierLoop& loop, const Release& start, double from);

}  // namespace burrhole
