/// tests/support/local_states.h: contact states with planes, made by hand.
#pragma once

#include <initializer_list>

#include "core/base/random.h"
#include "core/contact/contact_state.h"

namespace burrhole::test {

inline HoldPlane make_plane(const Vec3& normal, double gap, double yield, std::uint32_t point) {
  HoldPlane plane;
  plane.normal = normal;
  plane.gap = gap;
  plane.yield = yield;
  plane.point = point;
  return plane;
}

/// The sum of what the planes of a penalty model exert, written plainly.
inline Vec3 penalty_force(const LocalContact& local, const Vec3& moved) {
  Vec3 out(0.0);
  for (const HoldPlane& plane : local.list()) {
    const double gap = plane.gap + glm::dot(plane.normal, moved);
    if (gap < 0.0) out -= plane.normal * (gap / plane.yield);
  }
  return out;
}

inline ContactState penalty_state(std::initializer_list<HoldPlane> planes) {
  ContactState state;
  state.number = 1;
  state.local.kind = LocalKind::penalty;
  for (const HoldPlane& plane : planes) state.local.planes[state.local.count++] = plane;
  state.on_hand.force = penalty_force(state.local, Vec3(0.0));
  for (const HoldPlane& plane : planes)
    if (plane.gap < 0.0) state.force_gradient -= glm::outerProduct(plane.normal, plane.normal) / plane.yield;
  return state;
}

inline ContactState coupled_state(std::initializer_list<HoldPlane> planes, double stiffness = 5000.0, double damping = 0.0) {
  ContactState state;
  state.number = 1;
  state.local.kind = LocalKind::coupled;
  for (const HoldPlane& plane : planes) {
    state.local.planes[state.local.count++] = plane;
    state.on_hand.force += plane.normal * plane.force;
    state.on_hand.torque += glm::cross(plane.arm, plane.normal * plane.force);
  }
  state.local.coupling_stiffness = stiffness;
  state.local.coupling_damping = damping;
  state.local.turn_stiffness = 20.0;
  state.local.cutting_stiffness = 1e5;
  return state;
}

inline Vec3 random_vector(std::uint64_t seed, std::uint64_t counter) {
  return {uniform11(seed, 3 * counter), uniform11(seed, 3 * counter + 1), uniform11(seed, 3 * counter + 2)};
}
inline Vec3 random_unit(std::uint64_t seed, std::uint64_t counter) {
  const Vec3 v = random_vector(seed, counter);
  return glm::length(v) > 0.1 ? glm::normalize(v) : Vec3(0.0, 0.0, 1.0);
}

}  // namespace burrhole::test
