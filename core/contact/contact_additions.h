/// core/contact/contact_additions.h: inputs of a contact step besides bone and hand: the spin of the tool, and additions of other effects.
///   Units  SI.   Thread  contact.
#pragma once

#include <span>

#include "core/contact/contact_constraint.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

/// Rotation of the tool about its +z axis, separate from its pose.
struct ToolSpin {
  bool spinning = false;  ///< the drive is on, so cutting points cut; also true while the bit is stalled
  double rate = 0.0;      ///< [rad/s] about +z of the tool, right-handed; gives the rim speed of a tangential law
};

/// Empty by default; empty additions cost at most one test per member and move.
struct ContactAdditions {
  std::span<const ContactConstraint> constraints{};  ///< at most kMaxConstraints are used
  TangentialLaw* tangential = nullptr;               ///< not owned; it keeps its state between the steps of one model
};

}  // namespace burrhole
