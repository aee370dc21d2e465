/// haptics/hand/simulated_hand.h: a surgeon who holds a drill with both hands: one mass on a spring and a damper. A script moves the rest
///   position of the spring, and bone exerts a force on the mass. The orientation is constant: that of the approach frame.
///   Frame  read() and apply() use the world frame; the script and the mass use the approach frame, as hand_script.h.
///   Units SI.   Thread servo.   Source mass, damping and stiffness are assumed values for a firm grip of the handle.
#pragma once

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/hand_script.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct HandConfig : HandScriptConfig {
  MassSpringDamperConfig dynamics;
  bool feels = true;  ///< false: apply() ignores the force (for comparison)
};

class SimulatedHand final : public HandSource {
 public:
  /// The hand starts at rest, at the standoff above the entry. @param period [s] of the servo. Errors as MassSpringDamper and HandScript.
  [[nodiscard]] static Result<SimulatedHand> create(const HandConfig& config, const Pose& world_from_approach, double period);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return state_; }
  /// Advances one tick under a wrench in the world frame. It uses the force [N] and ignores the torque.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  void drive_changed() noexcept BH_REALTIME override { script_.drive_changed(); }
  void drill_stopped() noexcept BH_REALTIME override { script_.drill_stopped(); }
  void scene_changed(double softest) noexcept override { script_.scene_changed(softest); }
  void bone_ahead(bool left) noexcept BH_REALTIME override { script_.bone_ahead(left); }
  void drill_at(const Vec3& drill) noexcept BH_REALTIME override { script_.drill_at((world_from_approach_.inverse() * drill).z); }
  void watch_drill() noexcept override { script_.watch_drill(); }
  void added_force(const Vec3& force) noexcept BH_REALTIME override {
    if (feels_) script_.added_force((glm::conjugate(world_from_approach_.rotation) * force).z);
  }

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
