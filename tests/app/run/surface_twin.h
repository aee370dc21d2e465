/// tests/app/run/surface_twin.h: what the constrained tool feels, plainly: every near point of the shell in double, distances
///   interpolated from decoded records corner by corner, the hold problem by projected Gauss-Seidel over all of them with many sweeps.
///   Slow. Its own: which points take part, interpolation, the solver, how a move is cut and when it rests, and every constant: the play,
///   the least stiffness, what flanks hold at most. What is engaged is F / K_cut exactly; no plane has a part of that give for itself.
///   Shared with the product, and so not judged here: the records and stiffness that it reads; its configuration; the form of the law
///   (implicit spring and damper, give of bone and of what is cut, play across the push, that bone which is cut pushes little out); and,
///   when it looks at one period alone, the state that the product left before it. A run of its own (`after` as the next start) keeps that
///   state itself.
///   Frame  as named.   Units  SI.
#pragma once

#include "core/contact/constrained_tool.h"

namespace burrhole::test {

/// What a contact period starts from.
struct TwinStart {
  Pose bone_from_tool;                   ///< after the period before
  Vec3 engaged{0.0};                     ///< [m] bone frame
  Vec3 aside{0.0};                       ///< [m] bone frame: ConstrainedToolState::aside
  Quat hand_before{1.0, 0.0, 0.0, 0.0};  ///< the hand's rotation then
  double to_cut = 0.0;                   ///< [m] <= 0: until the surface is lower than ever
};

struct TwinForce {
  Vec3 force{0.0};  ///< [N] bone frame
  int points = 0;   ///< of the shell that took part
  int moves = 0;
  TwinStart after;  ///< what the next period starts from
};

/// One period of a tool whose bone is at rest.
[[nodiscard]] TwinForce feel_plainly(const ConstrainedToolConfig& config, const PointShell& shell, const SurfaceView& bone,
                                     const TwinStart& start, const HandMotion& hand, double dt, bool spinning);

}  // namespace burrhole::test
