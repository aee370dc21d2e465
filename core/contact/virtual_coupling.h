/// core/contact/virtual_coupling.h: a virtual tool with mass and inertia. Springs and dampers in six degrees of freedom couple it to the
///   device, and a contact model exerts forces on it. The hand receives the force of the coupling only.
///   Frame   world; poses are of the tool frame, the tool's centre of mass is its origin.   Units  SI.   Thread  contact.
///   Source  the scheme is [McNeely99]'s as named in [AcostaLiu07] section 1 ("virtual coupling"); laws and proof are own derivations.
///
///   Laws. Force on the tool: K (h - x) + B (h' - v). Torque: 2 K_r sin(a/2) about the axis of the rotation by a from tool to hand. It is
///   K_r a for small angles, has the potential 4 K_r (1 - cos(a/2)) and no singular angle. Damper B_r on the difference of angular
///   velocity.
///
///   Step. Let z be the pose, u = (v, w), M the masses, K, B the coupling, f the wrench of coupling springs and bone at the old pose, and C
///   >= 0 the contact stiffness of ContactResult: the trace of -force_gradient, divided among the penetrated planes, each as J J^T with J =
///   (N, arm x N). For sums and averages its translation part is -force_gradient itself. The step is
///       (M + dt B + dt^2 (K + C)) u+ = M u + dt (f + B u_hand),   x+ = x + dt v+,   q+ = exp(dt w+) q.
///   The matrix is symmetric and positive definite for every dt > 0, so u+ always exists.
///
///   Bound. Assume that the hand rests. Let E = 1/2 u M u + coupling potential + U, where U is a potential of bone's force whose second
///   derivative along the step d = dt u+ is at most L (without lower bound). Multiply the step by u+ and use u+ M (u+ - u) = 1/2 u+ M u+ -
///   1/2 u M u + 1/2 |u+ - u|_M^2, U(z + d) <= U - f.d + 1/2 d L d for bone, and likewise (L = K) for both springs, whose second
///   derivatives never exceed K and K_r:
///       E+ - E <= -1/2 |u+ - u|_M^2 - 1/2 d K d - d B d / dt + 1/2 d L d - d C d  <= 0   whenever   L <= K + 2 B / dt + 2 C.
///   So the energy never grows, at any rate and stiffness, while the reported stiffness C is at least half of the model's actual one. Where
///   contact begins within a step (C still 0), it never grows if the contact stiffness is at most K + 2 B/dt: unforeseen_stiffness().
///   Beyond that, a tool that meets a plane of stiffness L at depth y <= dt v has v+ = (m v - dt L y)/(m + dt^2 L), so |v+| <= v: it never
///   leaves faster than it arrived.
///   The bound does not cover models without a potential: discontinuities of a staircase and of an average do work, which the dampers
///   dissipate.
#pragma once

#include "core/base/result.h"
#include "core/contact/contact_additions.h"
#include "core/contact/hand_motion.h"
#include "core/contact/local_contact.h"
#include "core/contact/penalty_model.h"
#include "core/contact/tangential_spring.h"

namespace burrhole {

struct VirtualCouplingConfig {
  double mass = 0.05;              ///< [kg] in [1e-6, 100]
  double inertia = 2e-5;           ///< [kg m^2] in [1e-12, 10], equal about all axes: the mass at 2 cm
  double stiffness = 5000.0;       ///< [N/m] in [1, 1e6]
  double damping = 30.0;           ///< [N s/m] in [0, 1e4]; near critical: 2 sqrt(K m) = 31.6
  double angular_stiffness = 5.0;  ///< [N m/rad] in [1e-6, 1e4]
  double angular_damping = 0.02;   ///< [N m s/rad] in [0, 100]; critical: 2 sqrt(K_r I) = 0.02
};

struct VirtualCouplingState {
  Pose world_from_tool;
  Vec3 velocity{0.0};          ///< [m/s]
  Vec3 angular_velocity{0.0};  ///< [rad/s] world frame
  Wrench on_hand;              ///< [N], [N m] of the coupling on the hand at this pose, about the tool origin
  Wrench tangential;           ///< [N], [N m] of a tangential law on the tool there
  Vec3 spin{0.0};              ///< [rad/s] of the tool's surface, world frame
  Wrench on_tool;              ///< [N], [N m] of bone on the tool at the pose before the step
  double deepest = 0.0;        ///< [m] by the model's own law, at the pose before the step
  std::uint32_t contacts = 0;  ///< number of colliding points at the pose before the step
  std::uint32_t flags = 0;     ///< ContactFlag
};

/// Largest contact stiffness [N/m] that may begin within a step of dt [s] without generating energy: K + 2 B/dt.
[[nodiscard]] double unforeseen_stiffness(const VirtualCouplingConfig& config, double dt) noexcept;

class VirtualCoupling {
 public:
  /// Errors: out_of_range when a key is outside its range or the model is missing.
  [[nodiscard]] static Result<VirtualCoupling> create(const VirtualCouplingConfig& config, std::unique_ptr<PenaltyModel> model);

  /// Places the tool at rest without a query of bone. A pose that is not finite is ignored.
  void place(const Pose& world_from_tool) noexcept;
  /// One contact period of dt [s] > 0: one evaluation of the model, one 6 x 6 solve. Never allocates. Where hand, dt or result are not
  /// finite, the force is zero, the tool stays at rest, and kContactNotFinite is set. Without hand.angular_velocity it uses the hand's
  /// rotation since the last step. A tangential law acts through a spring of the model's stiffness, at most unforeseen_stiffness(), at the
  /// pose before the step, so the bound above holds with it. @param world_from_bone is used for a tangential law only.
  const VirtualCouplingState& step(const ContactView& bone, const HandMotion& hand, double dt, const ToolSpin& spin = {},
                                   const ContactAdditions& added = {}, const Pose& world_from_bone = {}) noexcept BH_REALTIME;
  /// Instead of a step, where bone near the tool has not been read: the tool rests, and spring and damper act on the hand.
  void hold(const HandMotion& hand) noexcept BH_REALTIME;
  /// After a step: describes the contact as planes with the compliance of the model's points, and the coupling's springs. It omits the
  /// tool's mass: between two steps the tool is at the equilibrium of springs and planes.
  void describe(LocalContact& out) const noexcept BH_REALTIME;
  [[nodiscard]] const VirtualCouplingState& state() const noexcept { return state_; }
  [[nodiscard]] const VirtualCouplingConfig& config() const noexcept { return config_; }
  [[nodiscard]] const PenaltyModel& model() const noexcept { return *model_; }

 private:
  VirtualCoupling(const VirtualCouplingConfig& config, std::unique_ptr<PenaltyModel> model);
  void stay(std::uint32_t flags) noexcept;

  /// [rad/s] world frame: as measured, or the mean since the last step.
  [[nodiscard]] Vec3 turning_of(const HandMotion& hand, double dt) noexcept;

  /// The load of the tangential law on the tool at a pose, world frame.
  [[nodiscard]] Wrench rub(TangentialLaw& law, const Pose& world_from_tool, const Pose& world_from_bone, const Vec3& spin,
                           double dt) noexcept;

  TangentialSpring spring_;
  PressedPoints pressed_;
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  Vec3 looked_from_{0.0};  // [m] position of the tool when contacts_ was computed
  VirtualCouplingConfig config_;
  std::unique_ptr<PenaltyModel> model_;
  double lever2_;  // [m^2]
  ContactResult contacts_;
  VirtualCouplingState state_;
};

}  // namespace burrhole
