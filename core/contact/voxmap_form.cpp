// The model `voxmap`: its keys.

#include "core/config/rules.h"
#include "core/contact/penalty_form.h"
#include "core/contact/voxmap_contact.h"

namespace burrhole {
namespace {

constexpr std::pair<const char*, Stacking> kStackings[] = {
    {"sum", Stacking::sum}, {"sum-limited", Stacking::sum_limited}, {"average", Stacking::average}, {"deepest", Stacking::deepest}};

class VoxmapForm final : public ContactForm {
 public:
  explicit VoxmapForm(TableReader& table) {
    model_.paper_mode = table.choice("mode", "surface", {"surface", "paper"}, kPenaltyModeText) == "paper";
    model_.stiffness = table.number("stiffness_N_per_m", above_zero(model_.stiffness, 1.0, 1e7), kPenaltyStiffnessText);
    std::vector<std::string> words;
    std::string shipped;
    for (const auto& [word, stacking] : kStackings) {
      words.emplace_back(word);
      if (stacking == model_.stacking) shipped = word;
    }
    const std::string stacking = table.choice(
        "stacking", shipped, words,
        "force of n colliding points; sum: the sum of their forces; sum-limited: for n above 10, that sum times 10 / n; average: the sum "
        "over n; deepest: along the sum, as long as the longest projection of a point's force on it");
    for (const auto& [word, value] : kStackings)
      if (stacking == word) model_.stacking = value;
    model_.plane_voxel =
        table.choice("plane", model_.plane_voxel == PlaneVoxel::own ? "own" : "surface", {"own", "surface"},
                     "voxel through whose centre the tangent plane runs; own: that of the point; surface: the last solid one along the "
                     "point's inward normal") == "own"
            ? PlaneVoxel::own
            : PlaneVoxel::surface;
    coupling_ = read_coupling(table);
  }

  std::unique_ptr<ContactForm> clone() const override { return std::make_unique<VoxmapForm>(*this); }
  void* config(std::type_index type) noexcept override {
    if (type == typeid(VoxmapContactConfig)) return &model_;
    return type == typeid(VirtualCouplingConfig) && coupling_ ? &*coupling_ : nullptr;
  }
  ContactFormNeeds needs() const override {
    ContactFormNeeds out;
    out.any_density = model_.paper_mode;
    // The plane is that of the voxel of a point, and the model's force never exceeds that of half a voxel. A point that moves inwards
    // leaves its plane after a quarter of a voxel on average. Beyond that, planes would act as walls of ten times a point's stiffness.
    if (!coupling_ && model_.plane_voxel != PlaneVoxel::surface) out.plane_reach = 0.25;
    return out;
  }
  std::string text() const override { return penalty_text("voxmap", model_.paper_mode, coupling_.has_value()); }
  Result<std::unique_ptr<ContactModel>> make(const PointShell& shell, const ContactOptions& options) const override {
    return step_penalty(VoxmapContact::create(model_, shell), coupling_, options);
  }

 private:
  VoxmapContactConfig model_;
  std::optional<VirtualCouplingConfig> coupling_;
};

}  // namespace

std::unique_ptr<ContactForm> read_voxmap_form(TableReader& table) { return std::make_unique<VoxmapForm>(table); }

}  // namespace burrhole
