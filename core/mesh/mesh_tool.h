/// core/mesh/mesh_tool.h: contact model `mesh` with `tool = "held"`: a massless tool with its own pose, which the triangles constrain and
///   springs and dampers couple to the hand.
///   Frame  world.   Units  SI.   Thread  contact.
///   Reason  With eq. (1) of [TellesONeill10] the tool is where the hand is. A thrust above stiffness times half the thickness of the bone
///           puts it past the middle, and the nearest triangle is on the far side. This tool moves in steps of less than a voxel and is
///           constrained at each, so its nearest triangle is always the one that it came to.
///   Tool    A tool at rest cannot enter the surface. A spinning tool engages by F / K_cut along the push. Its cutting points are tested at
///           its pose moved back by that, and have a clearance across the push, as in constrained_tool.h.
///   Departures  The orientation is that of the hand. Contact is at the points of the shell, not between them. Flanks have no lateral stiffness of their own.
///   Source  [TellesONeill10] section 4.3.2: the nearest triangle; hold_solver.h for the pose.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/contact/contact_model.h"

namespace burrhole {

struct MeshToolConfig {
  double coupling_stiffness = 5000.0;  ///< [N/m] hand to tool
  double coupling_damping = 10.0;      ///< [N s/m]
  double cutting_stiffness = 140e3;    ///< [N/m] K_cut: thrust over engaged depth of a spinning tool
  double bone_stiffness = 20e6;        ///< [N/m] of bone under one point that does not cut
  double push_out = 0.025;             ///< [N] depenetration limit of a spinning tool (constrained_tool.h)
  int max_moves = 40;                  ///< largest number of moves in a step
};

/// Errors: out_of_range when a stiffness is not above 0, damping is negative, or the shell is empty or too large.
[[nodiscard]] Result<std::unique_ptr<ContactModel>> make_mesh_tool(const MeshToolConfig& config, const PointShell& shell,
                                                                   const ContactOptions& options);

}  // namespace burrhole
