/// core/contact/penalty_contact.h: makes a ContactModel of a penalty model in the form of its paper: the tool pose is the device pose.
///   Frame  world.   Units  SI.   Thread  contact.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/contact_model.h"
#include "core/contact/penalty_model.h"

namespace burrhole {

/// @param model result of GradientPlane::create() or VoxmapContact::create(). Errors: that of `model`.
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_penalty_contact(Result<std::unique_ptr<PenaltyModel>> model,
                                                                         const ContactOptions& options);

}  // namespace burrhole
