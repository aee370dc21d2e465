/// app/engine/contact_step.h: one contact period: latest hand motion against the newest window copy, result to servo and simulation.
///   Thread contact; never waits, never allocates after create().
#pragma once

#include <memory>
#include <optional>

#include "app/engine/scene.h"
#include "core/base/triple_buffer.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/contact_state.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

/// Where the step reads bone: the published window, or the paper's grids.
struct ContactBone {
  SnapshotBuffer<ContactWindow>* window = nullptr;
  const VdbContactGrids* grids = nullptr;
  Affine bone_from_index;
  Pose world_from_bone;

  [[nodiscard]] ContactView view() const {
    return grids != nullptr ? ContactView(*grids, bone_from_index, world_from_bone)
                            : ContactView(window->latest(), bone_from_index, world_from_bone);
  }
};

class ContactStep {
 public:
  /// Errors of the model's create() pass through.
  [[nodiscard]] static Result<ContactStep> create(const ContactScene& scene, const PointShell& shell, const ContactBone& bone,
                                                  bool spinning);
  /// `dt` [s] is the contact period. @returns the state for the mailboxes.
  const ContactState& operator()(const ContactView& bone, const HandState& hand, double dt) noexcept BH_REALTIME;
  void place(const Pose& world_from_tool) noexcept;
  [[nodiscard]] std::size_t points() const noexcept { return model_->shell().size(); }

 private:
  ContactStep() = default;
  bool spinning_ = false;
  std::unique_ptr<ContactModel> model_;  // the penalty form, device pose = tool pose
  std::optional<ConstrainedTool> tool_;  // or the tool held back
  ContactResult result_;
  ContactState state_;
};

}  // namespace burrhole
