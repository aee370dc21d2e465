/// app/lab/frontier_search.h: the largest stiffness at which the shipped loop is stable, found by running it.
///   Units SI.   Thread any; a loop is only read.
///   Pressed   on a plate under a thrust of K times kPreloadDepth, so that contact never opens while a perturbation of a twentieth of it
///             does not grow twentyfold: the loop is linear, and the sign of its envelope's log growth decides.
///   Let go    over bone under a light thrust, with friction, steps and limits as the device has them: whether it comes to rest.
#pragma once

#include "app/lab/frontier_loop.h"

namespace burrhole {

inline constexpr double kPreloadDepth = 1e-3;  // [m]
inline constexpr double kLargestTried = 1e6;   // [N/m]: a scene's own bound on the coupling

/// Log growth of the envelope of a grip pressed on the plate, its last sixth against its second; 1 once contact opened, -1 once the swing
/// is gone.
[[nodiscard]] Result<double> pressed_growth(const FrontierLoop& loop, double stiffness, int ticks);

/// [N/m] by bisection to 0.5 %; infinite if stable at kLargestTried, 0 if not even at 1 N/m. `hint` saves runs only: both ends of the
/// bracket are run, and moved out until one is stable and one is not.
/// @param ticks of a run. At 1 % beyond a limit a factor 10 takes up to 9.2e4: within 8000 the envelope still changes by 13 %.
[[nodiscard]] Result<double> pressed_limit(const FrontierLoop& loop, double hint, int ticks = 8000);

/// How a grip let go over bone ends.
struct Settling {
  double swing = 0.0;  ///< [m] of the grip's height in the last third, about the straight line that it follows
  double aside = 0.0;  ///< [m] largest way off the axis
};
struct LetGo {
  double height = 0.5e-3;  ///< [m] over bone
  bool pressed = false;    ///< or half as deep in it as the thrust brings it
  double thrust = 2.0;     ///< [N]
  double duration = 4.0;   ///< [s]
};
[[nodiscard]] Result<Settling> let_go(const FrontierLoop& loop, double stiffness, const LetGo& start);
/// Whether that is a rest: contact does not open and close, and what is left of the swing is a few of the device's steps.
[[nodiscard]] bool at_rest(const Settling& settling, double quantum) noexcept;

/// [N/m] Going up from `from` in steps of a tenth of a decade, the first at which it does not come to rest, then bisected to 2 %. 0: not
/// even there. Not a bound: there may be rest again beyond it.
[[nodiscard]] Result<double> let_go_limit(const FrontierLoop& loop, const LetGo& start, double from);

}  // namespace burrhole
