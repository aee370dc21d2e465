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
  /// Which copy that was (ContactWindow::number); 0 of the paper's grids.
  [[nodiscard]] std::uint64_t number() const noexcept;
};

class ContactStep {
 public:
  struct Use {
    double voxel_edge = 0.0;  ///< [m]
    bool spinning = false;
    bool planes = false;     ///< whether the state's `local` is asked for
    double foresight = 0.0;  ///< [s] for how long one has to last: a contact period and the latency
  };
  /// Errors of the model's create() pass through.
  [[nodiscard]] static Result<ContactStep> create(const ContactScene& scene, const PointShell& shell, const Use& use);
  /// `dt` [s] is the contact period. @returns the state for the mailboxes.
  const ContactState& operator()(const BoneView& bone, const HandState& hand, double dt) noexcept BH_REALTIME;
  void place(const Pose& world_from_tool) noexcept;
  [[nodiscard]] std::size_t points() const noexcept { return shell_points_; }

 private:
  ContactStep() = default;
  void hold(const SurfaceView& bone, const HandState& hand, double dt) noexcept;
  void push(const ContactView& bone, const HandState& hand) noexcept;
  void couple(const ContactView& bone, const HandState& hand, double dt) noexcept;

  bool planes_ = false;
  double foresight_ = 0.0;
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
