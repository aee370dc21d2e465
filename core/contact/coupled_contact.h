/// core/contact/coupled_contact.h: combines a penalty model and a virtual coupling into a ContactModel: the tool is a rigid body
///   with mass that a spring and a damper couple to the hand.
///   Frame  world.   Units  SI.   Thread  contact.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/virtual_coupling.h"

namespace burrhole {

/// @param model from GradientPlane::create() or VoxmapContact::create(); a Result, so that callers can pass it on unchecked.
/// Errors: that of `model`, else those of VirtualCoupling::create().
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_coupled_contact(const VirtualCouplingConfig& config,
                                                                         Result<std::unique_ptr<PenaltyModel>> model,
                                                                         const ContactOptions& options);

}  // namespace burrhole
