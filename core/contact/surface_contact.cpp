#include "core/contact/surface_contact.h"

namespace burrhole {
namespace {

class SurfaceContact final : public ContactModel {
 public:
  SurfaceContact(ConstrainedTool tool, const ContactOptions& options) : tool_(std::move(tool)), options_(options) {}

  void place(const Pose& world_from_tool) noexcept override { tool_.place(world_from_tool); }
  [[nodiscard]] std::size_t points() const noexcept override { return tool_.shell().size(); }

  void step(const ContactInput& in, ContactState& out) noexcept override {
    BH_ASSERT(in.bone.surface.has_value());
    const SurfaceView& bone = *in.bone.surface;
    const ConstrainedToolState& held = tool_.step(bone, in.hand, in.dt, in.spin, in.added);
    out.world_from_tool = held.world_from_tool;
    out.on_hand = held.on_hand;
    out.engagement = held.engagement;
    out.cutting_force = held.cutting_force;
    out.flags = held.flags;
    if (options_.planes) {
      // The distance that the hand may cover until the next result.
      tool_.describe(bone, glm::length(in.hand.velocity) * options_.foresight, out.local);
      out.force_gradient = force_gradient(out.local);
    }
    if ((held.flags & kContactOutsideWindow) != 0)
      out.force_gradient = Mat3(held.on_hand.force != Vec3(0.0) ? -tool_.config().coupling_stiffness : 0.0);
    out.world_from_hand = in.hand.world_from_hand;
  }

 private:
  ConstrainedTool tool_;
  ContactOptions options_;
};

}  // namespace

Result<std::unique_ptr<ContactModel>> make_surface_contact(const ConstrainedToolConfig& config, const PointShell& shell,
                                                           const ContactOptions& options) {
  auto tool = ConstrainedTool::create(config, shell, options.voxel_edge, {.cutting = options.cutting, .surface = options.surface});
  if (!tool) return tool.error();
  return std::unique_ptr<ContactModel>(std::make_unique<SurfaceContact>(std::move(tool).value(), options));
}

}  // namespace burrhole
