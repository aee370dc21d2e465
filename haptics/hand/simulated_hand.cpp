#include "haptics/hand/simulated_hand.h"

namespace burrhole {

SimulatedHand::SimulatedHand(const HandConfig& config, const Pose& world_from_approach, const HandScript& script,
                             const MassSpringDamper& body)
    : feels_(config.feels), stiffness_(config.dynamics.stiffness), world_from_approach_(world_from_approach), script_(script), body_(body) {
  position_ = Vec3(0.0, 0.0, config.standoff);
  state_.world_from_hand = {world_from_approach.rotation, world_from_approach * position_};
}

Result<SimulatedHand> SimulatedHand::create(const HandConfig& config, const Pose& world_from_approach, double period) {
  auto script = HandScript::create(config, config.dynamics.mass, period);
  if (!script) return script.error();
  auto body = MassSpringDamper::create(config.dynamics, period);
  if (!body) return body.error();
  return SimulatedHand(config, world_from_approach, *script, *body);
}

void SimulatedHand::apply(const Wrench& on_hand) noexcept {
  const Vec3 felt = feels_ ? glm::conjugate(world_from_approach_.rotation) * on_hand.force : Vec3(0.0);
  const HandGoal& goal = script_.advance(felt.z, position_.z, velocity_.z);
  body_.step(position_, velocity_, felt + Vec3(0.0, 0.0, -goal.thrust) + goal.rest * stiffness_);
  state_.tick = script_.tick();
  state_.phase = script_.phase();
  state_.thrust = goal.thrust;
  state_.world_from_hand.translation = world_from_approach_ * position_;
  state_.velocity = world_from_approach_.rotate(velocity_);
}

}  // namespace burrhole
