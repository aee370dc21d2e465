/// core/contact/surface_contact.h: contact model `surface`: makes a ContactModel of the constrained tool.
///   Frame  world.   Units  SI.   Thread  contact.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/contact_model.h"

namespace burrhole {

/// BoneView::surface must be present in every step. Errors as ConstrainedTool::create().
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_surface_contact(const ConstrainedToolConfig& config, const PointShell& shell,
                                                                         const ContactOptions& options);

}  // namespace burrhole
