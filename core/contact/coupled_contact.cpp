#include "core/contact/coupled_contact.h"

#include "core/contact/hold_force.h"
#include "core/contact/shell_cover.h"

namespace burrhole {
namespace {

class CoupledContact final : public ContactModel {
 public:
  CoupledContact(VirtualCoupling tool, const ContactOptions& options)
      : tool_(std::move(tool)), options_(options), cover_(tool_.model().shell().positions) {}

  void place(const Pose& world_from_tool) noexcept override {
    tool_.place(world_from_tool);
    hold_force_.clear();
  }
  [[nodiscard]] std::size_t points() const noexcept override { return tool_.model().shell().size(); }

  void step(const ContactInput& in, ContactState& out) noexcept override {
    const bool held = in.bone.coarse != nullptr && cover_.reaches_unread(in.bone.voxels, *in.bone.coarse, tool_.state().world_from_tool);
    if (held) tool_.hold(in.hand);
    const VirtualCouplingState& coupled =
        held ? tool_.state() : tool_.step(in.bone.voxels, in.hand, in.dt, in.spin, in.added, in.bone.world_from_bone);
    out.world_from_hand = in.hand.world_from_hand;
    out.world_from_tool = coupled.world_from_tool;
    out.on_hand = coupled.on_hand;
    if (held && hold_force_.of(coupled.on_hand.force) == Vec3(0.0)) out.on_hand = {};
    if (!held) hold_force_.note(coupled.on_tool.force);
    out.engagement = coupled.deepest;
    out.cutting_force = glm::length(coupled.on_tool.force);
    out.flags = coupled.flags;
    if (in.bone.coarse != nullptr && !held) out.flags &= ~kContactOutsideWindow;  // far from bone
    if (!options_.planes) return;
    if (held) {
      out.local.count = 0;
      out.local.kind = LocalKind::none;
      out.force_gradient = Mat3(out.on_hand.force != Vec3(0.0) ? -tool_.config().stiffness : 0.0);
      return;
    }
    tool_.describe(out.local);
    out.force_gradient = force_gradient(out.local);
  }

 private:
  VirtualCoupling tool_;
  ContactOptions options_;
  ShellCover cover_;
  HoldForce hold_force_;
};

}  // namespace

Result<std::unique_ptr<ContactModel>> make_coupled_contact(const VirtualCouplingConfig& config, Result<std::unique_ptr<PenaltyModel>> model,
                                                           const ContactOptions& options) {
  if (!model) return model.error();
  auto tool = VirtualCoupling::create(config, std::move(model).value());
  if (!tool) return tool.error();
  return std::unique_ptr<ContactModel>(std::make_unique<CoupledContact>(std::move(tool).value(), options));
}

}  // namespace burrhole
