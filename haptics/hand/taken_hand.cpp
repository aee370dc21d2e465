#include "haptics/hand/taken_hand.h"

namespace burrhole {

Result<TakenHand> TakenHand::create(const SimulatedHand& script, const GoalHandConfig& user, const Pose& world_from_approach, double period,
                                    GoalMailbox& goals) {
  auto hand = GoalHand::create(user, world_from_approach, period, goals);
  if (!hand) return hand.error();
  return TakenHand(script, *hand, goals);
}

void TakenHand::apply(const Wrench& on_hand) noexcept {
  if (!taken_ && goals_->latest().takes_over) {
    user_.start_from(script_.read());
    taken_ = true;
  }
  if (taken_)
    user_.apply(on_hand);
  else
    script_.apply(on_hand);
}

void TakenHand::drive_changed() noexcept {
  if (!taken_) script_.drive_changed();
}

void TakenHand::drill_stopped() noexcept {
  if (!taken_) script_.drill_stopped();
}

void TakenHand::scene_changed(double softest) noexcept {
  if (!taken_) script_.scene_changed(softest);
}

void TakenHand::bone_ahead(bool left) noexcept {
  if (!taken_) script_.bone_ahead(left);
}

void TakenHand::drill_at(const Vec3& drill) noexcept {
  if (!taken_) script_.drill_at(drill);
}

void TakenHand::added_force(const Vec3& force) noexcept {
  if (!taken_) script_.added_force(force);
}

}  // namespace burrhole
