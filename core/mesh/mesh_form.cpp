// The model `mesh`: its keys.

#include "core/mesh/mesh_form.h"
#include "core/config/rules.h"
#include "core/contact/penalty_form.h"
#include "core/mesh/mesh_contact.h"
#include "core/mesh/mesh_patch.h"

namespace burrhole {
namespace {

class MeshForm final : public ContactForm {
 public:
  explicit MeshForm(TableReader& table) {
    model_.stiffness = table.number("stiffness_N_per_m", above_zero(model_.stiffness, 1.0, 1e7), kPenaltyStiffnessText);
    if (table.choice("stacking", "average", {"average", "deepest"},
                     "force of n colliding points; average: the mean of their forces; deepest: that of the deepest point, as in "
                     "[TellesONeill10]") == "deepest")
      model_.stacking = MeshStacking::deepest;
    coupling_ = read_coupling(table);
  }

  std::unique_ptr<ContactForm> clone() const override { return std::make_unique<MeshForm>(*this); }
  void* config(std::type_index type) noexcept override {
    if (type == typeid(MeshContactConfig)) return &model_;
    return type == typeid(VirtualCouplingConfig) && coupling_ ? &*coupling_ : nullptr;
  }
  ContactFormNeeds needs() const override {
    ContactFormNeeds out;
    out.fields.triangles = make_mesh_patch;
    return out;
  }
  std::string text() const override { return penalty_text("mesh", false, coupling_.has_value()); }
  Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const override {
    return step_penalty(MeshContact::create(model_, shell), coupling_, options);
  }

 private:
  MeshContactConfig model_;
  std::optional<VirtualCouplingConfig> coupling_;
};

}  // namespace

std::unique_ptr<ContactForm> read_mesh_form(TableReader& table) { return std::make_unique<MeshForm>(table); }

}  // namespace burrhole
