/// core/contact/contact_constraint.h: a plane that an effect adds to contact, such as the stop of a sleeve or a virtual fixture.
///   Frame  as named.   Units  SI.   Trivially copyable.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/geometry.h"

namespace burrhole {

/// Constrains one point of the tool to the half-space that the normal points into: force = stiffness * max(0, depth) along the normal.
struct ContactConstraint {
  Vec3 point{0.0};             ///< [m] tool frame
  Vec3 plane_point{0.0};       ///< [m] world
  Vec3 normal{0.0, 0.0, 1.0};  ///< [-] world, unit, away from the forbidden side
  double stiffness = 1e6;      ///< [N/m] > 0
};
static_assert(std::is_trivially_copyable_v<ContactConstraint>);

inline constexpr std::size_t kMaxConstraints = 8;              ///< further ones are ignored
inline constexpr std::uint32_t kConstraintPoint = 0xfffffe00;  ///< planes of constraints are numbered from here, above all shell points

}  // namespace burrhole
