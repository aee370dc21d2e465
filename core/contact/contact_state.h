/// core/contact/contact_state.h: the result that contact publishes to the servo through a TripleBuffer: plain values only.
///   Frame  world.   Units  SI.   Trivially copyable.
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/geometry.h"
#include "core/contact/bone_motion.h"
#include "core/contact/local_contact.h"

namespace burrhole {

struct ContactState {
  Pose world_from_tool;        ///< pose of the tool; that of the hand in a penalty model without coupling
  Pose world_from_hand;        ///< hand pose from which this result was computed
  Vec3 hand_velocity{0.0};     ///< [m/s] of that pose
  Wrench on_hand;              ///< [N], [N m] on the hand, world frame, before the force scale; moment about the origin of world_from_tool
  Mat3 force_gradient{0.0};    ///< [N/m] d on_hand.force / d position of the hand, rotation not included; [AcostaLiu07] eq. 3
  LocalContact local;          ///< tangent planes of the same contact, from which the servo computes forces until the next state
  double engagement = 0.0;     ///< [m] distance by which the cutting points are pressed into bone; penalty models: largest penetration
  double cutting_force = 0.0;  ///< [N] magnitude of the force between cutting points and bone; penalty models: of all points
  /// [N] sum of cutting_force over all evaluations up to this one. Between two states, (difference of cutting_sum) / (difference of number)
  /// is the mean of cutting_force over the evaluations after the first state.
  double cutting_sum = 0.0;
  /// [m] sum of world_from_tool.translation, as seen from a bone at rest, over all evaluations up to this one. Its differences give mean
  /// positions, exact to a nanometre after ten hours at 1 kHz.
  Vec3 position_sum{0.0};
  BoneMotion bone;           ///< of the bone in this result; at rest without [motion]
  double spin = 1.0;         ///< [-] spin command at `tick`, as a fraction of the scene's spin, 0..1
  std::uint64_t tick = 0;    ///< servo tick of world_from_hand
  std::uint64_t number = 0;  ///< number of the evaluation, from 1; 0: none yet
  std::uint32_t flags = 0;   ///< ContactFlag
};
static_assert(std::is_trivially_copyable_v<ContactState>);

}  // namespace burrhole
