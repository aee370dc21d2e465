/// app/effect/gravity_key.h: the key `down` of effects in which something falls, and the direction that it stands for.
///   Frame  as each function states.   Units  [-].   Errors  pushed to the table's Issues.   Thread  any.
#pragma once

#include <optional>

#include "app/stage/stage.h"
#include "core/config/toml.h"

namespace burrhole {

/// @returns a unit vector, world frame; nothing without the key.
[[nodiscard]] std::optional<Vec3> read_down(TableReader& table);
/// @returns the unit direction of gravity, bone frame. @param down as read_down(); nothing: along the approach axis, into the bone.
[[nodiscard]] Vec3 down_in_bone(const Stage& stage, const std::optional<Vec3>& down);

}  // namespace burrhole
