/// core/contact/coupled_contact.h: makes a ContactModel of a penalty model and a virtual coupling: the tool is a body with mass.
///   Frame  world.   Units  SI.   Thread  contact.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/virtual_coupling.h"

namespace burrhole {

/// @param model result of GradientPlane::create() or VoxmapContact::create(); its error is returned. Errors: else as
/// VirtualCoupling::create().
/// VirtualCoupling::create().
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_coupled_contact(const VirtualCouplingConfig& config,
                                                                         Result<std::unique_ptr<PenaltyModel>> model,
                                                                         const ContactOptions& options);

}  // namespace burrhole
