/// haptics/hand/simulated_hand.h: a surgeon's two hands on a drill: a mass on a spring-damper that follows a script and feels the bone.
///   Frame  approach frame: origin at the entry point, +z up the shaft, away from bone; depth = -z.   Units SI.   Thread servo.
///   Source mass, damping and stiffness: firm grip of the project's facts (assumed figures); the script is our own.
#pragma once

#include <cstdint>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

struct HandConfig {
  MassSpringDamperConfig dynamics;
  double feed = 0.005;              ///< [m/s] approach and withdrawal
  double push = 28.0;               ///< [N] thrust while leaning on the drill, real newtons: no device limits them
  double ramp = 1.0;                ///< [s] from first contact to full thrust
  double reaction = 0.150;          ///< [s] from feeling the give to letting go (assumed)
  double release = 0.3;             ///< [s] over which the thrust then falls to nothing
  double contact_force = 1.0;       ///< [N] felt force that counts as contact
  double give_speed = 0.008;        ///< [m/s] advance of the hand that feels like breaking through
  double follow_time = 0.25;        ///< [s] how fast the rest position of the arm follows the drill while leaning
  double standoff = 0.003;          ///< [m] height above the entry where the script starts and ends
  double tremor_amplitude = 40e-6;  ///< [m] lateral, peak, of the rest position
  double tremor_frequency = 9.0;    ///< [Hz]
  std::uint64_t seed = 1;
  bool feels = true;  ///< false: the force feedback is cut (for comparison)
};

class SimulatedHand final : public HandSource {
 public:
  /// out_of_range as MassSpringDamper, or when a script value is not finite or negative.
  [[nodiscard]] static Result<SimulatedHand> create(const HandConfig& config, const Pose& world_from_approach, double period);

  /// Advances one tick under the force that the tool exerts on the hand [N, world frame], held over the tick.
  const HandState& step(const Vec3& force_on_hand) noexcept BH_REALTIME override;
  [[nodiscard]] const HandState& state() const noexcept { return state_; }

 private:
  SimulatedHand(const HandConfig& config, const Pose& world_from_approach, double period, const MassSpringDamper& body);
  void follow_script(double felt) noexcept;
  [[nodiscard]] Vec3 tremor() const noexcept;

  HandConfig config_;
  Pose world_from_approach_;
  double period_;
  MassSpringDamper body_;
  Vec3 position_{0.0}, velocity_{0.0};  // approach frame
  double goal_height_ = 0.0;            // [m] rest position of the arm along the axis
  double advance_ = 0.0;                // [m/s] low-passed speed into bone
  std::uint64_t lean_tick_ = 0, give_tick_ = 0, release_tick_ = 0;
  double release_thrust_ = 0.0;  // [N] when letting go began
  HandState state_;
};

}  // namespace burrhole
