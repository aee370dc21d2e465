/// haptics/hand/simulated_hand.h: a surgeon's two hands on a drill: a mass on a spring-damper that follows a script and feels the bone.
///   Frame  approach frame, as hand_script.h.   Units SI.   Thread servo.
///   Source mass, damping and stiffness: firm grip of the project's facts (assumed figures).
#pragma once

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/hand_script.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct HandConfig : HandScriptConfig {
  MassSpringDamperConfig dynamics;
  bool feels = true;  ///< false: the force feedback is cut (for comparison)
};

class SimulatedHand final : public HandSource {
 public:
  /// out_of_range as MassSpringDamper and HandScript.
  [[nodiscard]] static Result<SimulatedHand> create(const HandConfig& config, const Pose& world_from_approach, double period);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return state_; }
  /// Advances one tick; of the wrench a hand on a drill feels the force.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;

 private:
  SimulatedHand(const HandConfig& config, const Pose& world_from_approach, const HandScript& script, const MassSpringDamper& body);

  bool feels_;
  double stiffness_;  // [N/m] of the arm
  Pose world_from_approach_;
  HandScript script_;
  MassSpringDamper body_;
  Vec3 position_{0.0}, velocity_{0.0};  // approach frame
  HandState state_;
};

}  // namespace burrhole
