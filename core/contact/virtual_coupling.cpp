#include "core/contact/virtual_coupling.h"

#include <array>
#include <cmath>

#include "core/base/rotation.h"
#include "core/base/spd.h"
#include "core/contact/constraint_planes.h"

namespace burrhole {
namespace {

bool is_finite(const Quat& q) noexcept { return std::isfinite(q.w + q.x + q.y + q.z); }
bool is_finite(const Pose& pose) noexcept { return burrhole::is_finite(pose.translation) && is_finite(pose.rotation); }

/// Weight of each touching plane: trace(-G) is the sum of weights, since normals have length 1. Exact for models that combine equal points
/// by sum or average; for any other the trace is kept and its stiffness is divided among the planes.
double weight_of(const ContactResult& contacts, std::size_t touching) noexcept {
  const Mat3& g = contacts.force_gradient;
  const double trace = -(g[0][0] + g[1][1] + g[2][2]);
  return touching > 0 && std::isfinite(trace) ? std::max(0.0, trace) / static_cast<double>(touching) : 0.0;
}

/// Adds w J J^T per touching plane, J = (N, arm x N): positive semidefinite for any model. The rotation of the arms under the force is
/// neglected: force x arm is thousandths of K_r.
void add_contact_stiffness(const ContactResult& contacts, const Vec3& tool_origin, double scale, Matrix6& matrix) noexcept {
  std::size_t touching = 0;
  for (const Contact& contact : contacts.contacts) touching += contact.depth > 0.0 ? 1 : 0;
  const double weight = scale * weight_of(contacts, touching);
  if (weight == 0.0) return;
  for (const Contact& contact : contacts.contacts) {
    if (!(contact.depth > 0.0)) continue;
    const Vec3& n = contact.normal;
    const Vec3 turn = glm::cross(contact.position - tool_origin, n);
    const Vector6 j{n.x, n.y, n.z, turn.x, turn.y, turn.z};
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t c = 0; c <= r; ++c) matrix[r][c] += weight * j[r] * j[c];
  }
}

/// 2 sin(a/2) times the axis of the shorter rotation from tool to hand, world frame.
Vec3 turn_to(const Quat& hand, const Quat& tool) noexcept {
  const Quat turn = hand * glm::conjugate(tool);
  const double sign = turn.w < 0.0 ? -2.0 : 2.0;
  return {sign * turn.x, sign * turn.y, sign * turn.z};
}

}  // namespace

double unforeseen_stiffness(const VirtualCouplingConfig& config, double dt) noexcept {
  return config.stiffness + 2.0 * config.damping / dt;
}

Result<VirtualCoupling> VirtualCoupling::create(const VirtualCouplingConfig& config, std::unique_ptr<PenaltyModel> model) {
  struct Range {
    double value, lowest, highest;
    const char* message;
  };
  for (const Range& range : {Range{config.mass, 1e-6, 100.0, "coupling mass must be in [1e-6, 100] kg"},
                             {config.inertia, 1e-12, 10.0, "coupling inertia must be in [1e-12, 10] kg m^2"},
                             {config.stiffness, 1.0, 1e6, "coupling stiffness must be in [1, 1e6] N/m"},
                             {config.damping, 0.0, 1e4, "coupling damping must be in [0, 1e4] N s/m"},
                             {config.angular_stiffness, 1e-6, 1e4, "coupling angular stiffness must be in [1e-6, 1e4] N m/rad"},
                             {config.angular_damping, 0.0, 100.0, "coupling angular damping must be in [0, 100] N m s/rad"}})
    if (!(range.value >= range.lowest && range.value <= range.highest)) return Error{ErrorCode::out_of_range, range.message, {}};
  if (!model) return Error{ErrorCode::out_of_range, "a virtual coupling needs a contact model", {}};
  return VirtualCoupling(config, std::move(model));
}

VirtualCoupling::VirtualCoupling(const VirtualCouplingConfig& config, std::unique_ptr<PenaltyModel> model)
    : config_(config), model_(std::move(model)), lever2_(mean_square_lever(model_->shell())) {
  contacts_.contacts.reserve(model_->shell().size());
}

void VirtualCoupling::place(const Pose& world_from_tool) noexcept {
  if (!is_finite(world_from_tool)) return;
  state_ = {};
  state_.world_from_tool = world_from_tool;
  hand_before_ = world_from_tool.rotation;
  spring_.clear();
}

Vec3 VirtualCoupling::turning_of(const HandMotion& hand, double dt) noexcept {
  const Quat turned = glm::normalize(hand.world_from_hand.rotation * glm::conjugate(hand_before_));
  hand_before_ = hand.world_from_hand.rotation;
  if (hand.angular_velocity) return *hand.angular_velocity;
  return Vec3(turned.x, turned.y, turned.z) * ((turned.w < 0.0 ? -2.0 : 2.0) / dt);
}

void VirtualCoupling::stay(std::uint32_t flags) noexcept {
  const Pose pose = state_.world_from_tool;
  state_ = {};
  state_.world_from_tool = pose;
  state_.flags = flags;
}

void VirtualCoupling::hold(const HandMotion& hand) noexcept {
  if (!is_finite(hand.world_from_hand) || !burrhole::is_finite(hand.velocity)) return stay(kContactNotFinite);
  stay(kContactOutsideWindow);
  contacts_.contacts.clear();
  hand_before_ = hand.world_from_hand.rotation;
  const Pose& tool = state_.world_from_tool;
  state_.on_hand.force = config_.stiffness * (tool.translation - hand.world_from_hand.translation) - config_.damping * hand.velocity;
  state_.on_hand.torque = -config_.angular_stiffness * turn_to(hand.world_from_hand.rotation, tool.rotation);
}

void VirtualCoupling::describe(LocalContact& out) const noexcept {
  out.count = 0;
  out.kind = LocalKind::none;
  if ((state_.flags & kContactNotFinite) != 0) return;
  std::size_t touching = 0;
  for (const Contact& contact : contacts_.contacts) touching += contact.depth > 0.0 ? 1 : 0;
  list_penalty(contacts_.contacts, looked_from_, weight_of(contacts_, touching), out);
  out.kind = LocalKind::coupled;
  const Vec3 moved = state_.world_from_tool.translation - looked_from_;
  for (HoldPlane& plane : std::span(out.planes.data(), out.count)) {
    plane.gap += glm::dot(plane.normal, moved);
    plane.force = std::max(0.0, -plane.gap / plane.yield);
  }
  out.engaged = Vec3(0.0);
  out.coupling_stiffness = config_.stiffness;
  out.coupling_damping = config_.damping;
  out.turn_stiffness = config_.angular_stiffness;
  out.cutting_stiffness = config_.stiffness;  // no engagement
  out.tangential = state_.tangential;
  out.spin = state_.spin;
}

Wrench VirtualCoupling::rub(TangentialLaw& law, const Pose& world_from_tool, const Pose& world_from_bone, const Vec3& spin,
                            double dt) noexcept {
  list_pressed(contacts_.contacts, contacts_.wrench.force, world_from_bone, world_from_tool.translation, pressed_);
  const double most = unforeseen_stiffness(config_, dt), most_turning = config_.angular_stiffness + 2.0 * config_.angular_damping / dt;
  const double stiffness = std::min(model_->stiffness(), most);
  const TangentialSpringConfig config{stiffness, std::min(stiffness * lever2_, most_turning)};
  const Pose bone_from_world = world_from_bone.inverse();
  const Wrench load = spring_.step(law, config, pressed_.list(), bone_from_world * world_from_tool, bone_from_world.rotate(spin), dt);
  return {world_from_bone.rotate(load.force), world_from_bone.rotate(load.torque)};
}

const VirtualCouplingState& VirtualCoupling::step(const ContactView& bone, const HandMotion& hand, double dt, const ToolSpin& spin,
                                                  const ContactAdditions& added, const Pose& world_from_bone) noexcept {
  if (!(std::isfinite(dt) && dt > 0.0) || !is_finite(hand.world_from_hand) || !burrhole::is_finite(hand.velocity) ||
      !burrhole::is_finite(hand.angular_velocity.value_or(Vec3(0.0)))) {
    stay(kContactNotFinite);
    return state_;
  }
  const Vec3 turning = turning_of(hand, dt);
  const Pose before = state_.world_from_tool;
  looked_from_ = before.translation;
  model_->evaluate(bone, before, contacts_);
  const VirtualCouplingConfig& c = config_;
  VirtualCouplingState next;
  Wrench on_tool = contacts_.wrench;
  if (added.tangential != nullptr) {
    next.spin = before.rotate(Vec3(0.0, 0.0, spin.rate));
    next.tangential = rub(*added.tangential, before, world_from_bone, next.spin, dt);
    on_tool = {on_tool.force + next.tangential.force, on_tool.torque + next.tangential.torque};
  }
  if (!added.constraints.empty()) {
    const Wrench more = constraint_wrench(added.constraints, before);
    on_tool = {on_tool.force + more.force, on_tool.torque + more.torque};
  }

  Matrix6 matrix{};
  for (std::size_t n = 0; n < 6; ++n)
    matrix[n][n] = n < 3 ? c.mass + dt * (c.damping + dt * c.stiffness) : c.inertia + dt * (c.angular_damping + dt * c.angular_stiffness);
  add_contact_stiffness(contacts_, before.translation, dt * dt, matrix);

  const Vec3 stretch = hand.world_from_hand.translation - before.translation;
  const Vec3 turn = turn_to(hand.world_from_hand.rotation, before.rotation);
  const Vec3 push = c.mass * state_.velocity + dt * (c.stiffness * stretch + c.damping * hand.velocity + on_tool.force);
  const Vec3 twist = c.inertia * state_.angular_velocity + dt * (c.angular_stiffness * turn + c.angular_damping * turning + on_tool.torque);
  const Vector6 u = solve_spd(matrix, {push.x, push.y, push.z, twist.x, twist.y, twist.z});

  next.velocity = {u[0], u[1], u[2]};
  next.angular_velocity = {u[3], u[4], u[5]};
  next.world_from_tool = {glm::normalize(rotation_of(dt * next.angular_velocity) * before.rotation),
                          before.translation + dt * next.velocity};
  next.on_hand.force =
      c.stiffness * (next.world_from_tool.translation - hand.world_from_hand.translation) + c.damping * (next.velocity - hand.velocity);
  next.on_hand.torque = c.angular_damping * (next.angular_velocity - turning) -
                        c.angular_stiffness * turn_to(hand.world_from_hand.rotation, next.world_from_tool.rotation);
  next.on_tool = contacts_.wrench;
  for (const Contact& contact : contacts_.contacts) next.deepest = std::max(next.deepest, contact.depth);
  next.contacts = static_cast<std::uint32_t>(contacts_.contacts.size());
  next.flags = contacts_.flags;
  if (is_finite(next.world_from_tool) && burrhole::is_finite(next.velocity) && burrhole::is_finite(next.angular_velocity) &&
      burrhole::is_finite(next.on_hand.force) && burrhole::is_finite(next.on_hand.torque))
    state_ = next;
  else
    stay(contacts_.flags | kContactNotFinite);
  return state_;
}

}  // namespace burrhole
