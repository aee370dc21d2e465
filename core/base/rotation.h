/// core/base/rotation.h: turns as vectors along their axis, with the same bits on every x86-64 CPU.
///   Units  rad.
#pragma once

#include "core/base/geometry.h"

namespace burrhole {

/// Rotation vector of a unit quaternion: axis times angle, the shorter way round, so at most pi long.
[[nodiscard]] Vec3 rotation_vector(const Quat& q) noexcept;
/// Unit quaternion of a rotation vector of at most 1e6 rad; a longer one is taken as that long, as its direction has lost its meaning.
[[nodiscard]] Quat rotation_of(const Vec3& vector) noexcept;

}  // namespace burrhole
