/// core/contact/surface_contact.h: contact model `surface`: the constraint-based tool (constrained_tool.h) as a ContactModel.
///   Frame  world.   Units  SI.   Thread  contact.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/contact_model.h"

namespace burrhole {

/// Precondition of every step: BoneView::surface is present (asserted). `shell` is copied. Errors: those of
/// ConstrainedTool::create().
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_surface_contact(const ConstrainedToolConfig& config, const PointShell& shell,
                                                                         const ContactOptions& options);

}  // namespace burrhole
