#include "core/contact/penalty_contact.h"

#include "core/contact/constraint_planes.h"
#include "core/contact/hold_force.h"
#include "core/contact/shell_cover.h"
#include "core/contact/tangential_spring.h"

namespace burrhole {
namespace {

class PenaltyContact final : public ContactModel {
 public:
  PenaltyContact(std::unique_ptr<PenaltyModel> model, const ContactOptions& options)
      : model_(std::move(model)),
        options_(options),
        cover_(model_->shell().positions),
        spring_config_{model_->stiffness(), model_->stiffness() * mean_square_lever(model_->shell())} {
    result_.contacts.reserve(model_->shell().size());
    result_.list_contacts = options.planes;
  }

  void place(const Pose& world_from_tool) noexcept override {
    spring_.clear();
    hold_force_.clear();
    read_ = {world_from_tool.translation, {}};
  }
  [[nodiscard]] std::size_t points() const noexcept override { return model_->shell().size(); }

  void step(const ContactInput& in, ContactState& out) noexcept override {
    const Pose& world_from_tool = in.hand.world_from_hand;
    if (in.added.tangential != nullptr) result_.list_contacts = true;
    model_->evaluate(in.bone.voxels, world_from_tool, result_);
    out.world_from_hand = world_from_tool;
    out.world_from_tool = world_from_tool;
    out.on_hand = result_.wrench;
    out.engagement = result_.deepest;
    out.cutting_force = glm::length(result_.wrench.force);
    out.flags = result_.flags;
    out.force_gradient = result_.force_gradient;
    if ((out.flags & kContactOutsideWindow) != 0 && in.bone.coarse != nullptr) {
      if (cover_.reaches_unread(in.bone.voxels, *in.bone.coarse, world_from_tool)) return hold(out);
      out.flags &= ~kContactOutsideWindow;
    }
    read_ = {world_from_tool.translation, out.on_hand};
    hold_force_.note(out.on_hand.force);
    if (options_.planes) list(world_from_tool.translation, in.added.tangential != nullptr, out.local);
    if (!in.added.constraints.empty()) add(constraint_wrench(in.added.constraints, world_from_tool), out.on_hand);
    if (in.added.tangential != nullptr) rub(in, out);
  }

 private:
  /// Where bone has not been read: a spring of the model's stiffness from the last place at which it was.
  void hold(ContactState& out) const noexcept {
    const double stiffness = model_->stiffness();
    const Vec3 force = hold_force_.of(read_.load.force + stiffness * (read_.place - out.world_from_tool.translation));
    const bool holds = force != Vec3(0.0);
    out.on_hand = {force, holds ? read_.load.torque : Vec3(0.0)};
    out.force_gradient = Mat3(holds ? -stiffness : 0.0);
    out.engagement = out.cutting_force = 0.0;
    out.local.count = 0;
    out.local.kind = LocalKind::none;
  }
  static void add(const Wrench& more, Wrench& to) noexcept {
    to.force += more.force;
    to.torque += more.torque;
  }

  /// Adds the tangential law's load, and writes what the servo needs to extrapolate it.
  void rub(const ContactInput& in, ContactState& out) noexcept {
    const Pose& world_from_tool = out.world_from_tool;
    list_pressed(result_.contacts, result_.wrench.force, in.bone.world_from_bone, world_from_tool.translation, pressed_);
    const Pose bone_from_tool = in.bone.world_from_bone.inverse() * world_from_tool;
    const Vec3 spin(0.0, 0.0, in.spin.rate);
    const Wrench load =
        spring_.step(*in.added.tangential, spring_config_, pressed_.list(), bone_from_tool, bone_from_tool.rotate(spin), in.dt);
    out.local.tangential = {in.bone.world_from_bone.rotate(load.force), in.bone.world_from_bone.rotate(load.torque)};
    out.local.spin = world_from_tool.rotate(spin);
    out.local.tangential_stiffness = spring_config_.stiffness;
    out.local.tangential_turn_stiffness = spring_config_.turn_stiffness;
    add(out.local.tangential, out.on_hand);
  }

  void list(const Vec3& tool_origin, bool by_place, LocalContact& out) const noexcept {
    const Mat3& g = result_.force_gradient;
    std::size_t pushing = 0;
    for (const Contact& contact : result_.contacts) pushing += contact.depth > 0.0 ? 1 : 0;
    list_penalty(result_.contacts, tool_origin, pushing > 0 ? -(g[0][0] + g[1][1] + g[2][2]) / static_cast<double>(pushing) : 0.0, out,
                 by_place);
  }

  std::unique_ptr<PenaltyModel> model_;
  ContactOptions options_;
  ContactResult result_;
  ShellCover cover_;
  HoldForce hold_force_;
  struct Read {
    Vec3 place{0.0};
    Wrench load;
  } read_;  // the last place where all bone near the tool was known, and the wrench there
  TangentialSpringConfig spring_config_;
  TangentialSpring spring_;
  PressedPoints pressed_;
};

}  // namespace

Result<std::unique_ptr<ContactModel>> make_penalty_contact(Result<std::unique_ptr<PenaltyModel>> model, const ContactOptions& options) {
  if (!model) return model.error();
  return std::unique_ptr<ContactModel>(std::make_unique<PenaltyContact>(std::move(model).value(), options));
}

}  // namespace burrhole
