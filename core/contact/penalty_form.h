/// core/contact/penalty_form.h: shared parts of the forms of penalty models: the tool at the device pose, or on a virtual coupling.
#pragma once

#include <optional>

#include "core/contact/contact_form.h"
#include "core/contact/virtual_coupling.h"

namespace burrhole {

inline constexpr const char* kPenaltyModeText =
    "bone that collides; surface: density of 0.5 or more; paper: any density above 0, as in [AcostaLiu07]";
inline constexpr const char* kPenaltyStiffnessText = "penalty force of a point over its penetration depth";

/// Reads the keys of the virtual coupling; empty where the tool pose is the device pose.
[[nodiscard]] std::optional<VirtualCouplingConfig> read_coupling(TableReader& table);
/// The text "NAME, MODE mode, ..." for `burrhole explain`.
[[nodiscard]] std::string penalty_text(const char* name, bool paper_mode, bool coupled);
/// Makes the model at the device pose, or on the coupling. Errors of VirtualCoupling::create().
[[nodiscard]] Result<std::unique_ptr<ContactModel>> step_penalty(Result<std::unique_ptr<PenaltyModel>> model,
                                                                 const std::optional<VirtualCouplingConfig>& coupling,
                                                                 const ContactOptions& options);

}  // namespace burrhole
