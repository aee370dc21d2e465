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

/// One copy of bone, as its readers want it: voxels for the penalty models and the monitor, the surface for the constrained tool.
struct BoneView {
  ContactView voxels;
  std::optional<SurfaceView> surface;  ///< where the copy carries records
};

/// Where the step reads bone: the published window, or the paper's grids.
struct ContactBone {
  SnapshotBuffer<ContactWindow>* window = nullptr;
  const VdbContactGrids* grids = nullptr;
  Affine bone_from_index;
  Pose world_from_bone;

  /// The newest copy; valid until the next call.
  [[nodiscard]] BoneView view() const;
};

class ContactStep {
 public:
  /// Errors of the model's create() pass through. `voxel_edge` [m].
  [[nodiscard]] static Result<ContactStep> create(const ContactScene& scene, const PointShell& shell, double voxel_edge, bool spinning);
  /// `dt` [s] is the contact period. @returns the state for the mailboxes.
  const ContactState& operator()(const BoneView& bone, const HandState& hand, double dt) noexcept BH_REALTIME;
  void place(const Pose& world_from_tool) noexcept;
  [[nodiscard]] std::size_t points() const noexcept { return shell_points_; }

 private:
  ContactStep() = default;
  void hold(const SurfaceView& bone, const HandState& hand, double dt) noexcept;
  void push(const ContactView& bone, const HandState& hand) noexcept;
  void couple(const ContactView& bone, const HandState& hand, double dt) noexcept;

  bool spinning_ = false;  // when asked to: a bit that stalled stays engaged in what it was cutting, by F / K_cut and no further
  std::size_t shell_points_ = 0;
  std::optional<ConstrainedTool> tool_;     // model `surface`: the tool held back
  std::unique_ptr<ContactModel> model_;     // or a penalty model of the papers, device pose = tool pose
  std::optional<VirtualCoupling> coupled_;  // or the same on a virtual coupling, which then owns the model
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  ContactResult result_;
  ContactState state_;
};

}  // namespace burrhole
