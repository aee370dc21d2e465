/// haptics/hand/simulated_hand.h: two hands of a surgeon on a drill: a mass on a spring-damper that follows a script and receives force.
///   Frame  approach frame, as hand_script.h.   Units SI.   Thread servo.
///   Source mass, damping and stiffness are assumed values for a firm grip of the handle.
#pragma once

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/hand_script.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct HandConfig : HandScriptConfig {
  MassSpringDamperConfig dynamics;
  bool feels = true;  ///< false: no force feedback (for comparison)
};

class SimulatedHand final : public HandSource {
 public:
  /// Errors as MassSpringDamper and HandScript.
  [[nodiscard]] static Result<SimulatedHand> create(const HandConfig& config, const Pose& world_from_approach, double period);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return state_; }
  /// Advances one tick. The hand uses the force of the wrench and ignores its torque.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  void drive_changed() noexcept BH_REALTIME override { script_.drive_changed(); }

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
