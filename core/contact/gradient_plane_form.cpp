// The model `gradient-plane`: its keys.

#include "core/config/rules.h"
#include "core/contact/gradient_plane.h"
#include "core/contact/penalty_form.h"

namespace burrhole {
namespace {

class GradientPlaneForm final : public ContactForm {
 public:
  explicit GradientPlaneForm(TableReader& table) {
    model_.paper_mode = table.choice("mode", "surface", {"surface", "paper"}, kPenaltyModeText) == "paper";
    model_.stiffness = table.number("stiffness_N_per_m", above_zero(model_.stiffness, 1.0, 1e7), kPenaltyStiffnessText);
    paper_grids_ = table.choice("storage", "window", {"window", "vdb"},
                                "storage from which bone is read; window: a dense window; vdb: sparse grids, as in [AcostaLiu07]") == "vdb";
    coupling_ = read_coupling(table);
  }

  std::unique_ptr<ContactForm> clone() const override { return std::make_unique<GradientPlaneForm>(*this); }
  void* config(std::type_index type) noexcept override {
    if (type == typeid(GradientPlaneConfig)) return &model_;
    return type == typeid(VirtualCouplingConfig) && coupling_ ? &*coupling_ : nullptr;
  }
  ContactFormNeeds needs() const override {
    ContactFormNeeds out;
    out.any_density = model_.paper_mode;
    out.fields.words = !paper_grids_;
    out.paper_grids = paper_grids_;
    return out;
  }
  std::string text() const override { return penalty_text("gradient-plane", model_.paper_mode, coupling_.has_value()); }
  Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const override {
    return step_penalty(GradientPlane::create(model_, shell), coupling_, options);
  }

 private:
  GradientPlaneConfig model_;
  bool paper_grids_ = false;
  std::optional<VirtualCouplingConfig> coupling_;
};

}  // namespace

std::unique_ptr<ContactForm> read_gradient_plane_form(TableReader& table) { return std::make_unique<GradientPlaneForm>(table); }

}  // namespace burrhole
