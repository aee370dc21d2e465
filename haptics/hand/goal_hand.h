/// haptics/hand/goal_hand.h: a hand whose goal a user moves with mouse, keyboard or game pad: one mass on a spring and a damper.
///   The goal is smoothed and limited in speed; then it is the rest point of the spring. Bone pushes the mass back, so the thrust on the
///   drill is the stiffness times the distance by which the goal lies beyond the drill, up to the largest force of the arm.
///   Frame  UserGoal: approach frame, origin at the entry point, +z up the shaft, away from bone. read() and apply(): world.
///   Units SI.   Thread servo; the mailbox's writer is one other thread.
///   Source own work; all values are assumed. With this stiffness a thrust of 28 N that bone ceases to carry plunges by 5.6 mm.
#pragma once

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/base/triple_buffer.h"
#include "haptics/hand/hand_source.h"
#include "haptics/hand/mass_spring_damper.h"

namespace burrhole {

/// What a user wants of the hand now.
struct UserGoal {
  Vec3 place{0.0, 0.0, 0.0};                 ///< [m] of the tip
  double tilt_right = 0.0, tilt_away = 0.0;  ///< [rad] of the shaft about the tip: towards +x, towards +y of the approach frame
  bool spins = false;                        ///< the drive is switched on
  bool ends = false;                         ///< the run is to end
  bool takes_over = false;                   ///< the user takes the hand of a script over (taken_hand.h)
};
using GoalMailbox = TripleBuffer<UserGoal>;

struct GoalHandConfig {
  MassSpringDamperConfig dynamics{.mass = 0.6, .damping = 80.0, .stiffness = 5000.0};
  double push = 80.0;         ///< [N] > 0 largest force of the arm
  double smoothing = 0.03;    ///< [s] > 0 time constant with which the hand's goal follows the user's
  double speed = 0.25;        ///< [m/s] > 0 largest speed of the hand's goal
  double turn_speed = 2.0;    ///< [rad/s] > 0 largest speed of each tilt
  double largest_tilt = 0.6;  ///< [rad] > 0, below pi / 2
  double run_up = 0.4;        ///< [s] >= 0 of the drive, from rest to full spin and back
  double standoff = 0.003;    ///< [m] > 0 height above the entry at the start
};

/// Phases: approach, then done when the user ends the run.
class GoalHand final : public HandSource {
 public:
  /// The hand starts at rest, at the standoff, with the drive off. @param goals must outlive the hand; before its first value the goal is
  /// the start. Errors: out_of_range when a value is outside its range or not finite, or when period [s] is not above 0.
  [[nodiscard]] static Result<GoalHand> create(const GoalHandConfig& config, const Pose& world_from_approach, double period,
                                               GoalMailbox& goals);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return state_; }
  /// Advances one tick under a wrench in the world frame. It uses the force [N] and ignores the torque. A goal that is not finite is
  /// ignored.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  /// Starts again from another hand's state: its place, speed, thrust, spin and tick; upright.
  void start_from(const HandState& other) noexcept BH_REALTIME;

 private:
  GoalHand(const GoalHandConfig& config, const Pose& world_from_approach, double period, GoalMailbox& goals, const MassSpringDamper& body);
  void follow(const UserGoal& wanted) noexcept;
  void drive(bool spins) noexcept;

  GoalHandConfig config_;
  Pose world_from_approach_;
  double period_;
  GoalMailbox* goals_;
  MassSpringDamper body_;
  double share_;                               // [-] of the way to the user's goal that is made in a tick
  Vec3 goal_{0.0};                             // [m] smoothed
  double tilt_right_ = 0.0, tilt_away_ = 0.0;  // [rad] smoothed
  Vec3 position_{0.0}, velocity_{0.0};         // approach frame
  HandState state_;
};

}  // namespace burrhole
