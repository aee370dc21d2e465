#include "app/engine/contact_step.h"

namespace burrhole {
namespace {

Result<std::unique_ptr<ContactModel>> make_model(const void* context, PointShell shell) {
  return GradientPlane::create(*static_cast<const GradientPlaneConfig*>(context), std::move(shell));
}

}  // namespace

Result<ContactStep> ContactStep::create(const ContactScene& scene, const PointShell& shell, const ContactBone& bone, bool spinning) {
  ContactStep out;
  out.spinning_ = spinning;
  auto model = make_model(&scene.model, shell);
  if (!model) return model.error();
  out.model_ = std::move(model).value();
  out.result_.contacts.reserve(shell.size());
  if (scene.constrained) {
    auto tool = ConstrainedTool::create(scene.tool, shell, bone.bone_from_index.mean_edge(), &scene.model, make_model);
    if (!tool) return tool.error();
    out.tool_.emplace(std::move(tool).value());
  }
  return out;
}

void ContactStep::place(const Pose& world_from_tool) noexcept {
  if (tool_) tool_->place(world_from_tool);
}

const ContactState& ContactStep::operator()(const ContactView& bone, const HandState& hand, double dt) noexcept {
  state_.tick = hand.tick;
  if (tool_) {
    const ConstrainedToolState& held = tool_->step(bone, {hand.world_from_hand, hand.velocity, spinning_}, dt);
    state_.world_from_tool = held.world_from_tool;
    state_.on_hand = held.on_hand;
    state_.engagement = held.engagement;
    state_.flags = held.flags;
  } else {
    model_->evaluate(bone, hand.world_from_hand, result_);
    state_.world_from_tool = hand.world_from_hand;
    state_.on_hand = result_.wrench;
    state_.engagement = 0.0;
    for (const Contact& contact : result_.contacts) state_.engagement = std::max(state_.engagement, contact.depth);
    state_.flags = result_.flags;
  }
  return state_;
}

}  // namespace burrhole
