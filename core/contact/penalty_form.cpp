#include "core/contact/penalty_form.h"

#include "core/config/rules.h"
#include "core/contact/coupled_contact.h"
#include "core/contact/penalty_contact.h"

namespace burrhole {

std::optional<VirtualCouplingConfig> read_coupling(TableReader& table) {
  if (table.choice("coupling", "none", {"none", "virtual"},
                   "none: the tool has the pose of the hand; virtual: the tool is a rigid body on springs and dampers to the hand") ==
      "none")
    return std::nullopt;
  VirtualCouplingConfig out;
  out.stiffness = table.number("coupling_N_per_m", within(out.stiffness, 1.0, 1e6), "stiffness of the spring from hand to tool");
  out.damping = table.number("coupling_N_s_per_m", at_least_zero(out.damping, 1.0, 1e4), "coefficient of the damper from hand to tool");
  out.angular_stiffness =
      table.number("coupling_Nm_per_rad", within(out.angular_stiffness, 1e-6, 1e4), "rotational stiffness of the coupling");
  out.angular_damping =
      table.number("coupling_Nm_s_per_rad", at_least_zero(out.angular_damping, 1.0, 100.0), "rotational damping of the coupling");
  out.mass = table.number("mass_kg", within(out.mass, 1e-6, 100.0), "mass of the coupled tool");
  out.inertia =
      table.number("inertia_kg_m2", within(out.inertia, 1e-12, 10.0), "moment of inertia of the coupled tool, the same about every axis");
  return out;
}

std::string penalty_text(const char* name, bool paper_mode, bool coupled) {
  return std::string(name) + (paper_mode ? ", paper mode, " : ", surface mode, ") +
         (coupled ? "tool on a virtual coupling" : "tool where the hand is");
}

Result<std::unique_ptr<ContactModel>> step_penalty(Result<std::unique_ptr<PenaltyModel>> model,
                                                   const std::optional<VirtualCouplingConfig>& coupling, const ContactOptions& options) {
  if (coupling) return make_coupled_contact(*coupling, std::move(model), options);
  return make_penalty_contact(std::move(model), options);
}

}  // namespace burrhole
