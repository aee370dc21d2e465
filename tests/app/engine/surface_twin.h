/// tests/app/engine/surface_twin.h: what the constrained tool feels, plainly: every near point of the shell in double, distances interpolated
///   from decoded records corner by corner, the hold problem by projected Gauss-Seidel over all of them with many sweeps. Slow; shares with
///   the product only how a record is decoded and what its headers define.
///   Frame  as named.   Units  SI.
#pragma once

#include "core/contact/constrained_tool.h"

namespace burrhole::test {

/// What a contact period starts from.
struct TwinStart {
  Pose bone_from_tool;                   ///< after the period before
  Vec3 engaged{0.0};                     ///< [m] bone frame
  Quat hand_before{1.0, 0.0, 0.0, 0.0};  ///< the hand's rotation then
};

struct TwinForce {
  Vec3 force{0.0};  ///< [N] bone frame
  int points = 0;   ///< of the shell that took part
  int moves = 0;
};

/// One period of a tool whose bone is at rest.
[[nodiscard]] TwinForce feel_plainly(const ConstrainedToolConfig& config, const PointShell& shell, const SurfaceView& bone,
                                     const TwinStart& start, const HandMotion& hand, double dt);

}  // namespace burrhole::test
