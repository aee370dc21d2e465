// The model `mesh`: its keys.

#include "core/mesh/mesh_form.h"
#include "core/config/rules.h"
#include "core/contact/penalty_form.h"
#include "core/mesh/mesh_contact.h"
#include "core/mesh/mesh_patch.h"
#include "core/mesh/mesh_tool.h"

namespace burrhole {
namespace {

class MeshForm final : public ContactForm {
 public:
  explicit MeshForm(TableReader& table) {
    held_ = table.choice("tool", "held", {"held", "hand"},
                         "held: a tool with its own pose, which the triangles constrain; hand: the tool has the pose of the hand and a "
                         "penalty force, as in [TellesONeill10]") == "held";
    if (held_)
      read_held(table);
    else
      read_penalty(table);
  }

  std::unique_ptr<ContactForm> clone() const override { return std::make_unique<MeshForm>(*this); }
  void* config(std::type_index type) noexcept override {
    if (type == typeid(MeshToolConfig)) return held_ ? &tool_ : nullptr;
    if (type == typeid(MeshContactConfig)) return held_ ? nullptr : &model_;
    return type == typeid(VirtualCouplingConfig) && coupling_ ? &*coupling_ : nullptr;
  }
  ContactFormNeeds needs() const override {
    ContactFormNeeds out;
    out.fields.triangles = make_mesh_patch;
    if (!held_) return out;
    out.holds_back = true;
    out.coupling_stiffness = tool_.coupling_stiffness;
    out.coupling_damping = tool_.coupling_damping;
    out.cutting_stiffness = tool_.cutting_stiffness;
    return out;
  }
  std::string text() const override {
    return held_ ? "mesh, tool held back by triangles" : penalty_text("mesh", false, coupling_.has_value());
  }
  Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const override {
    if (held_) return make_mesh_tool(tool_, shell, options);
    return step_penalty(MeshContact::create(model_, shell), coupling_, options);
  }

 private:
  void read_penalty(TableReader& table) {
    model_.stiffness = table.number("stiffness_N_per_m", above_zero(model_.stiffness, 1.0, 1e7), kPenaltyStiffnessText);
    if (table.choice("stacking", "average", {"average", "deepest"},
                     "force of n colliding points; average: the mean of their forces; deepest: that of the deepest point, as in "
                     "[TellesONeill10]") == "deepest")
      model_.stacking = MeshStacking::deepest;
    coupling_ = read_coupling(table);
  }
  void read_held(TableReader& table) {
    tool_.coupling_stiffness =
        table.number("coupling_N_per_m", above_zero(tool_.coupling_stiffness, 1.0, 1e6), "stiffness of the spring from hand to tool");
    tool_.coupling_damping =
        table.number("coupling_N_s_per_m", at_least_zero(tool_.coupling_damping, 1.0, 1e4), "coefficient of the damper from hand to tool");
    tool_.cutting_stiffness = table.number("cutting_N_per_m", above_zero(tool_.cutting_stiffness, 1.0, 1e9),
                                           "cutting stiffness: force on the cutting points of a spinning tool over its engagement");
    tool_.bone_stiffness =
        table.number("bone_N_per_m", above_zero(tool_.bone_stiffness, 1.0, 1e12), "stiffness of bone under one contact that does not cut");
  }

  bool held_ = true;
  MeshToolConfig tool_;
  MeshContactConfig model_;
  std::optional<VirtualCouplingConfig> coupling_;
};

}  // namespace

std::unique_ptr<ContactForm> read_mesh_form(TableReader& table) { return std::make_unique<MeshForm>(table); }

}  // namespace burrhole
