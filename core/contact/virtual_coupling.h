/// core/contact/virtual_coupling.h: a virtual tool with mass and inertia, tied to the device by springs and dampers in six degrees of
/// freedom and pushed by any contact model; the hand feels the coupling, never the model.
///   Frame   world; poses are of the tool frame, the tool's mass is centred at its origin.   Units  SI.   Thread  contact.
///   Source  the scheme is [McNeely99]'s as [AcostaLiu07] section 1 names it ("virtual coupling"); laws and proof are own derivations.
///
///   Laws. Force on the tool K (h - x) + B (h' - v). Torque 2 K_r sin(a/2) about the axis of the turn by a from tool to hand, which is
///   K_r a for small turns, has the potential 4 K_r (1 - cos(a/2)) and no singular angle; damper B_r on the difference of angular velocity.
///
///   Step. With z the pose, u = (v, w), M the masses, K, B the coupling, f the wrench of coupling springs and bone at the old pose, and
///   C >= 0 the contact stiffness that ContactResult tells (trace of -force_gradient, shared by the planes at depth, each as J J^T with
///   J = (N, arm x N); for sums and averages its translation part is -force_gradient itself):
///       (M + dt B + dt^2 (K + C)) u+ = M u + dt (f + B u_hand),   x+ = x + dt v+,   q+ = exp(dt w+) q.
///   The matrix is symmetric and positive definite for every dt > 0, so u+ always exists.
///
///   Bound. Let the hand rest, E = 1/2 u M u + coupling potential + U, and let bone's force have a potential U whose second derivative
///   along the step d = dt u+ is at most L (it may be anything below). Multiply the step by u+, use u+ M (u+ - u) = 1/2 u+ M u+ -
///   1/2 u M u + 1/2 |u+ - u|_M^2, U(z + d) <= U - f.d + 1/2 d L d for bone, and likewise (L = K) for both springs, whose second
///   derivatives never exceed K and K_r:
///       E+ - E <= -1/2 |u+ - u|_M^2 - 1/2 d K d - d B d / dt + 1/2 d L d - d C d  <= 0   whenever   L <= K + 2 B / dt + 2 C.
///   So energy never grows while the model's own stiffness is told to within a factor of two, at any rate and any stiffness; and where
///   contact begins within a step (C still 0) if it is no stiffer than K + 2 B/dt: unforeseen_stiffness(). Beyond that, a tool that meets
///   a plane of stiffness L at depth y <= dt v has v+ = (m v - dt L y)/(m + dt^2 L), so |v+| <= v: it never leaves faster than it came.
///   What no step can mend is a model without a potential: the jumps of a staircase and of an average do work, which the dampers take.
#pragma once

#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/local_contact.h"

namespace burrhole {

struct VirtualCouplingConfig {
  double mass = 0.05;              ///< [kg] in [1e-6, 100]
  double inertia = 2e-5;           ///< [kg m^2] in [1e-12, 10], the same about every axis: the mass at 2 cm
  double stiffness = 5000.0;       ///< [N/m] in [1, 1e6]
  double damping = 30.0;           ///< [N s/m] in [0, 1e4]; about critical: 2 sqrt(K m) = 31.6
  double angular_stiffness = 5.0;  ///< [N m/rad] in [1e-6, 1e4]
  double angular_damping = 0.02;   ///< [N m s/rad] in [0, 100]; critical: 2 sqrt(K_r I) = 0.02
};

/// What one step needs to know of the device, at the end of the step.
struct CoupledHand {
  Pose world_from_hand;        ///< where the hand would have the tool
  Vec3 velocity{0.0};          ///< [m/s]
  Vec3 angular_velocity{0.0};  ///< [rad/s] world frame
};

struct VirtualCouplingState {
  Pose world_from_tool;
  Vec3 velocity{0.0};          ///< [m/s]
  Vec3 angular_velocity{0.0};  ///< [rad/s] world frame
  Wrench on_hand;              ///< what the coupling exerts on the hand at this pose: [N], [N m] about the tool origin
  Wrench on_tool;              ///< what bone exerted on the tool at the pose before the step
  double deepest = 0.0;        ///< [m] by the model's own law, at the pose before the step
  std::uint32_t contacts = 0;  ///< colliding points, there
  std::uint32_t flags = 0;     ///< ContactFlag
};

/// Largest contact stiffness [N/m] that may begin within a step of dt [s] and still add no energy: K + 2 B/dt.
[[nodiscard]] double unforeseen_stiffness(const VirtualCouplingConfig& config, double dt) noexcept;

class VirtualCoupling {
 public:
  /// out_of_range when a key is outside its range or the model is missing.
  [[nodiscard]] static Result<VirtualCoupling> create(const VirtualCouplingConfig& config, std::unique_ptr<ContactModel> model);

  /// Places the tool at rest without looking at bone. A pose that is not finite is ignored.
  void place(const Pose& world_from_tool) noexcept;
  /// One contact period of dt [s] > 0: one evaluation of the model, one 6 x 6 solve. Never allocates. Where hand, dt or result are not
  /// finite: no force, the tool stays, at rest, and kContactNotFinite is set.
  const VirtualCouplingState& step(const ContactView& bone, const CoupledHand& hand, double dt) noexcept BH_REALTIME;
  /// After a step: what bone does to the tool there, as planes that yield as the model's points do, and the coupling's springs. The tool's
  /// mass is not in it: between two steps the tool is where springs and planes balance.
  void describe(LocalContact& out) const noexcept BH_REALTIME;
  [[nodiscard]] const VirtualCouplingState& state() const noexcept { return state_; }
  [[nodiscard]] const ContactModel& model() const noexcept { return *model_; }

 private:
  VirtualCoupling(const VirtualCouplingConfig& config, std::unique_ptr<ContactModel> model);
  void stay(std::uint32_t flags) noexcept;

  Vec3 looked_from_{0.0};  // [m] where the tool was when contacts_ was found
  VirtualCouplingConfig config_;
  std::unique_ptr<ContactModel> model_;
  ContactResult contacts_;
  VirtualCouplingState state_;
};

}  // namespace burrhole
