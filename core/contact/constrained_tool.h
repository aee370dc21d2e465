/// core/contact/constrained_tool.h: the tool as a body of its own, tied to the hand by a spring-damper and held back by bone.
///   Frame   world; poses are of the tool frame.   Units SI.   Thread contact.
///   What bone resists: a tool at rest cannot enter the 0.5 surface; a spinning one engages by F / K_cut where it cuts, and nowhere else.
///   First form: translation is held, orientation follows the hand; torque is reported, not yielded to. Massless: the coupling force and
///   the contact forces balance at every step. Source: own derivation (see hold_solver.h); design of proxies after the field's custom.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/hold_solver.h"

namespace burrhole {

struct ConstrainedToolConfig {
  double coupling_stiffness = 5000.0;  ///< [N/m] hand to tool
  double coupling_damping = 10.0;      ///< [N s/m]
  double cutting_stiffness = 100e3;    ///< [N/m] K_cut: thrust over engaged depth of a spinning tool
  int max_moves = 32;                  ///< moves of at most `margin` each in one step: bounds cost and speed, never safety
};

/// Planes handed on for the servo loop and for the record.
inline constexpr std::size_t kMaxHoldPlanes = 32;

/// What one step needs to know of the hand.
struct HandMotion {
  Pose world_from_hand;  ///< where the hand would have the tool
  Vec3 velocity{0.0};    ///< [m/s]
  bool spinning = false;
};

struct ConstrainedToolState {
  Pose world_from_tool;
  Wrench on_hand;           ///< what the tool exerts on the hand: force [N], torque [N m] about the tool origin
  double engagement = 0.0;  ///< [m] shared depth of the cutting points
  double deepest = 0.0;     ///< [m] greatest depth of a shell point under the 0.5 surface at the pose, planes linearised
  std::uint32_t planes = 0;
  std::uint32_t moves = 0;
  std::uint32_t flags = 0;  ///< ContactFlag
};

class ConstrainedTool {
 public:
  /// `make_model` builds the scene's contact model on a given shell: the tool detects with a shell grown by half a voxel, so that every
  /// plane within one move is known before it is met. Errors of the model's create() pass through.
  using ModelFactory = Result<std::unique_ptr<ContactModel>> (*)(const void* context, PointShell shell);
  [[nodiscard]] static Result<ConstrainedTool> create(const ConstrainedToolConfig& config, const PointShell& shell, double voxel_edge,
                                                      const void* context, ModelFactory make_model);

  /// Places the tool without looking at bone (start of a run, after a teleport of the scene).
  void place(const Pose& world_from_tool) noexcept;
  /// One contact period. Never allocates.
  const ConstrainedToolState& step(const ContactView& bone, const HandMotion& hand, double dt) noexcept BH_REALTIME;
  [[nodiscard]] const ConstrainedToolState& state() const noexcept { return state_; }

 private:
  ConstrainedTool(const ConstrainedToolConfig& config, const PointShell& shell, double margin, std::unique_ptr<ContactModel> detector);
  /// A spinning tool reaches through the last layer of a table before that layer is cut: bone inside the tool, behind a point that has
  /// left it on the far side, still holds. Without this the tool would pop through what its engaged depth is allowed to overlap.
  void add_bone_behind(const ContactView& bone, const Pose& pose) noexcept;
  void find_planes(const ContactView& bone, const Pose& pose, bool spinning) noexcept;
  void add_plane(const HoldPlane& plane, const Vec3& arm) noexcept;

  ConstrainedToolConfig config_;
  PointShell shell_;
  double margin_ = 0.0;
  std::unique_ptr<ContactModel> detector_;
  ContactResult contacts_;
  static constexpr std::uint8_t kFree = 0, kHeld = 1, kTouching = 2;
  std::vector<std::uint8_t> held_;  // per shell point: was it held at the last look
  std::array<HoldPlane, kMaxHoldPlanes> planes_{};
  std::array<Vec3, kMaxHoldPlanes> arms_{};
  std::size_t plane_count_ = 0;
  double deepest_ = 0.0;
  ConstrainedToolState state_;
};

}  // namespace burrhole
