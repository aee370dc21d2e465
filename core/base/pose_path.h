/// core/base/pose_path.h: a rigid displacement over time, through keyframes.
///   Frame  that of the keyframes.   Units  SI.   Errors  out_of_range from create().   Thread  any: const after create().
#pragma once

#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct PoseKey {
  double time = 0.0;         ///< [s]
  Vec3 translation{0.0};     ///< [m]
  Vec3 axis{0.0, 0.0, 1.0};  ///< [-] of the rotation; any length above 0
  double angle = 0.0;        ///< [rad]; may exceed a full turn
};

/// A displacement at one time: a rotation about a point that moves by `translation`.
struct Displacement {
  Vec3 translation{0.0};              ///< [m]
  Quat rotation{1.0, 0.0, 0.0, 0.0};  ///< [-]
  Vec3 velocity{0.0};                 ///< [m/s] of the translation
  Vec3 angular_velocity{0.0};         ///< [rad/s]
};

/// Between two keyframes both velocities are constant. Two keyframes with one axis are connected by the difference of their angles, so a
/// bone can turn several times between them; other pairs by the shortest rotation. Outside the keyframes the displacement is that of the
/// nearest.
class PosePath {
 public:
  PosePath() = default;  ///< at rest
  /// out_of_range: a number is not finite, an axis has no length, or times do not increase.
  [[nodiscard]] static Result<PosePath> create(std::vector<PoseKey> keys);
  [[nodiscard]] Displacement at(double time) const noexcept;

 private:
  std::vector<PoseKey> keys_;  // axes of length 1
};

}  // namespace burrhole
