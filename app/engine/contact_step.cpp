#include "app/engine/contact_step.h"

#include "core/contact/surface_view.h"

namespace burrhole {

BoneView ContactBone::view() const {
  if (grids != nullptr) return {ContactView(*grids, bone_from_index, world_from_bone), {}};
  const ContactWindow& copy = window->latest();
  return {ContactView(copy, bone_from_index, world_from_bone), surface_view(copy, bone_from_index, world_from_bone)};
}

Result<ContactStep> ContactStep::create(const ContactScene& scene, const PointShell& shell, double voxel_edge, bool spinning) {
  ContactStep out;
  out.spinning_ = spinning;
  out.shell_points_ = shell.size();
  if (scene.model == ContactModelKind::surface) {
    auto tool = ConstrainedTool::create(scene.surface, shell, voxel_edge);
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
  out.result_.list_contacts = false;
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
}

void ContactStep::push(const ContactView& bone, const HandState& hand) noexcept {
  model_->evaluate(bone, hand.world_from_hand, result_);
  state_.world_from_tool = hand.world_from_hand;
  state_.on_hand = result_.wrench;
  state_.engagement = result_.deepest;
  state_.cutting_force = glm::length(result_.wrench.force);
  state_.flags = result_.flags;
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
}

const ContactState& ContactStep::operator()(const BoneView& bone, const HandState& hand, double dt) noexcept {
  state_.tick = hand.tick;
  if (tool_) {
    BH_ASSERT(bone.surface.has_value());
    hold(*bone.surface, hand, dt);
  } else if (coupled_) {
    couple(bone.voxels, hand, dt);
  } else {
    push(bone.voxels, hand);
  }
  return state_;
}

}  // namespace burrhole
