#include "app/engine/contact_step.h"

#include "core/contact/surface_view.h"

namespace burrhole {

std::uint64_t ContactBone::number() const noexcept { return grids != nullptr ? 0 : window->front().number; }

BoneView ContactBone::view() const {
  if (grids != nullptr) return {ContactView(*grids, bone_from_index, world_from_bone), {}};
  const ContactWindow& copy = window->latest();
  return {ContactView(copy, bone_from_index, world_from_bone), surface_view(copy, bone_from_index, world_from_bone)};
}

Result<ContactStep> ContactStep::create(const ContactScene& scene, const PointShell& shell, const Use& use) {
  ContactStep out;
  out.planes_ = use.planes;
  out.foresight_ = use.foresight;
  out.spinning_ = use.spinning;
  out.shell_points_ = shell.size();
  if (scene.model == ContactModelKind::surface) {
    auto tool = ConstrainedTool::create(scene.surface, shell, use.voxel_edge);
    if (!tool) return tool.error();
    out.tool_.emplace(std::move(tool).value());
    return out;
  }
  auto model = scene.model == ContactModelKind::voxmap ? VoxmapContact::create(scene.voxmap, shell)
                                                       : GradientPlane::create(scene.gradient_plane, shell);
  if (!model) return model.error();
  if (scene.coupling) {
    auto coupled = VirtualCoupling::create(*scene.coupling, std::move(model).value());
    if (!coupled) return coupled.error();
    out.coupled_.emplace(std::move(coupled).value());
    return out;
  }
  out.model_ = std::move(model).value();
  out.result_.contacts.reserve(shell.size());
  out.result_.list_contacts = use.planes;
  return out;
}

void ContactStep::place(const Pose& world_from_tool) noexcept {
  if (tool_) tool_->place(world_from_tool);
  if (coupled_) coupled_->place(world_from_tool);
  hand_before_ = world_from_tool.rotation;
}

void ContactStep::hold(const SurfaceView& bone, const HandState& hand, double dt) noexcept {
  const ConstrainedToolState& held = tool_->step(bone, {hand.world_from_hand, hand.velocity, spinning_}, dt);
  state_.world_from_tool = held.world_from_tool;
  state_.on_hand = held.on_hand;
  state_.engagement = held.engagement;
  state_.cutting_force = held.cutting_force;
  state_.flags = held.flags;
  if (!planes_) return;
  // As far as the hand may come until the next result is there.
  tool_->describe(bone, glm::length(hand.velocity) * foresight_, state_.local);
  state_.force_gradient = force_gradient(state_.local);
}

void ContactStep::push(const ContactView& bone, const HandState& hand) noexcept {
  model_->evaluate(bone, hand.world_from_hand, result_);
  state_.world_from_tool = hand.world_from_hand;
  state_.on_hand = result_.wrench;
  state_.engagement = result_.deepest;
  state_.cutting_force = glm::length(result_.wrench.force);
  state_.flags = result_.flags;
  state_.force_gradient = result_.force_gradient;
  if (!planes_) return;
  const Mat3& g = result_.force_gradient;
  std::size_t pushing = 0;
  for (const Contact& contact : result_.contacts) pushing += contact.depth > 0.0 ? 1 : 0;
  list_penalty(result_.contacts, hand.world_from_hand.translation,
               pushing > 0 ? -(g[0][0] + g[1][1] + g[2][2]) / static_cast<double>(pushing) : 0.0, state_.local);
}

void ContactStep::couple(const ContactView& bone, const HandState& hand, double dt) noexcept {
  // The hand tells its speed but not its rate of turning: that of the last period stands in.
  const Quat turned = glm::normalize(hand.world_from_hand.rotation * glm::conjugate(hand_before_));
  const Vec3 rate = Vec3(turned.x, turned.y, turned.z) * ((turned.w < 0.0 ? -2.0 : 2.0) / dt);
  hand_before_ = hand.world_from_hand.rotation;
  const VirtualCouplingState& coupled = coupled_->step(bone, {hand.world_from_hand, hand.velocity, rate}, dt);
  state_.world_from_tool = coupled.world_from_tool;
  state_.on_hand = coupled.on_hand;
  state_.engagement = coupled.deepest;
  state_.cutting_force = glm::length(coupled.on_tool.force);
  state_.flags = coupled.flags;
  if (!planes_) return;
  coupled_->describe(state_.local);
  state_.force_gradient = force_gradient(state_.local);
}

const ContactState& ContactStep::operator()(const BoneView& bone, const HandState& hand, double dt) noexcept {
  const std::uint64_t answered = state_.tick;
  const Pose answered_hand = state_.world_from_hand;
  state_.tick = hand.tick;
  state_.world_from_hand = hand.world_from_hand;
  if (tool_) {
    BH_ASSERT(bone.surface.has_value());
    hold(*bone.surface, hand, dt);
  } else if (coupled_) {
    couple(bone.voxels, hand, dt);
  } else {
    push(bone.voxels, hand);
  }
  if (tool_ && (state_.flags & kContactOutsideWindow) != 0) {
    // The force is that of an earlier look: it answers the motion of then, and grows old.
    state_.tick = answered;
    state_.world_from_hand = answered_hand;
  }
  return state_;
}

}  // namespace burrhole
