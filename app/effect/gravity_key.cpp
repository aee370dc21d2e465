#include "app/effect/gravity_key.h"

namespace burrhole {

std::optional<Vec3> read_down(TableReader& table) {
  const auto down = table.optional_numbers("down", 3, {.min = -1e3, .max = 1e3},
                                           "direction of gravity, world frame; absent: along the approach axis, into the bone");
  if (!down) return std::nullopt;
  const Vec3 given((*down)[0], (*down)[1], (*down)[2]);
  if (glm::length(given) > 0.0) return glm::normalize(given);
  table.fault("down", "must not be zero");
  return std::nullopt;
}

Vec3 down_in_bone(const Stage& stage, const std::optional<Vec3>& down) {
  return down ? glm::conjugate(stage.config.volume.world_from_bone.rotation) * *down
              : stage.approach.bone_from_approach.rotate(Vec3(0.0, 0.0, -1.0));
}

}  // namespace burrhole
