/// core/contact/bone_motion.h: the pose of a bone that moves while it is felt and drilled, and how fast it moves.
///   Frame  world; "at rest" is the world in which the bone has its pose of the scene.   Units  SI.   Errors  none.   Trivially copyable.
#pragma once

#include <type_traits>

#include "core/base/geometry.h"

namespace burrhole {

struct BoneMotion {
  Pose world_from_rest;        ///< maps a point of the bone at rest to its place now
  Vec3 velocity{0.0};          ///< [m/s] of the bone's point that is at the world's origin now
  Vec3 angular_velocity{0.0};  ///< [rad/s]

  /// @returns the velocity [m/s] of the bone's point that is at `p` now.
  [[nodiscard]] Vec3 velocity_at(const Vec3& p) const noexcept { return velocity + glm::cross(angular_velocity, p); }
};
static_assert(std::is_trivially_copyable_v<BoneMotion>);

}  // namespace burrhole
