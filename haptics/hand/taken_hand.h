/// haptics/hand/taken_hand.h: a script's hand that a user can take over, once: from then on it is the user's.
///   Frame  world.   Units  SI.   Errors  those of GoalHand.   Thread  servo; the mailbox's writer is one other thread.
#pragma once

#include "haptics/hand/goal_hand.h"
#include "haptics/hand/simulated_hand.h"

namespace burrhole {

class TakenHand final : public HandSource {
 public:
  /// @param goals must outlive the hand. UserGoal::takes_over takes the script over.
  [[nodiscard]] static Result<TakenHand> create(const SimulatedHand& script, const GoalHandConfig& user, const Pose& world_from_approach,
                                                double period, GoalMailbox& goals);

  [[nodiscard]] const HandState& read() noexcept BH_REALTIME override { return taken_ ? user_.read() : script_.read(); }
  /// Before it advances, the user's hand starts where the script's is, with its speed, thrust and spin.
  void apply(const Wrench& on_hand) noexcept BH_REALTIME override;
  void drive_changed() noexcept BH_REALTIME override;
  void drill_stopped() noexcept BH_REALTIME override;
  void scene_changed(double softest) noexcept override;
  void bone_ahead(bool left) noexcept BH_REALTIME override;
  void drill_at(const Vec3& drill) noexcept BH_REALTIME override;
  void watch_drill() noexcept override { script_.watch_drill(); }
  void added_force(const Vec3& force) noexcept BH_REALTIME override;

 private:
  TakenHand(const SimulatedHand& script, const GoalHand& user, GoalMailbox& goals) : script_(script), user_(user), goals_(&goals) {}
  SimulatedHand script_;
  GoalHand user_;
  GoalMailbox* goals_;
  bool taken_ = false;
};

}  // namespace burrhole
