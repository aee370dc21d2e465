/// core/contact/tool_sweep.h: what the tools with a pose of their own share (constrained_tool.h, core/mesh/mesh_tool.h): the limits of a
///   sweep, the moves of one contact period, and the end of a force reversal.
///   Frame  bone.   Units  SI; lengths of the limits in voxel edges.   Thread  contact.   Source  own derivation.
#pragma once

#include "core/base/geometry.h"
#include "core/contact/hold_solver.h"
#include "core/contact/tangential_hold.h"

namespace burrhole {

inline constexpr double kLookAhead = 0.6;         ///< [voxel edges] a move knows all planes nearer than this
inline constexpr double kLongestMove = 0.4;       ///< [voxel edges] of any point near bone: less than kLookAhead, with margin for curvature
inline constexpr double kSettled = 0.05;          ///< [voxel edges] a last move below this needs no new probe: its error is of second order
inline constexpr double kPlaneTolerance = 0.002;  ///< [voxel edges] tolerance of the planes
/// Factor on that tolerance with a tangential law. Friction needs the place of the load on a face: 1 um on a 3 mm face is 7e-3 N m of a
/// coupling of 20 N m/rad, which moves the load from the middle to the edge, and friction there would drive a spinning tool sideways.
inline constexpr double kFineTolerance = 1e-4;
/// Fraction of a cutting plane's compliance that is its own, in bone that is cut by whole voxels; the rest is the shared engagement.
/// Opposed walls act on each other through this fraction alone, so it sets the clamping force on a tool slightly too wide for its hole. A
/// face that recedes sees it as overlap.
inline constexpr double kOwnGiveWholeVoxels = 0.05;
/// [voxel edges] largest clearance of a spinning tool in bone that is cut by whole voxels: the distance by which cutting points that face
/// away from the push move inwards. The corner between wall and floor is rounded by a voxel.
inline constexpr double kClearance = 0.75;
/// [voxel edges] largest distance from the equilibrium of its springs at which a force reversal of a spinning tool is suppressed for a
/// period: it may penetrate bone that it cuts to this depth.
inline constexpr double kSuppressedReversal = 0.2;

/// The parts of a tool that the end of a force reversal changes.
struct SweptTool {
  HoldSolver& solver;
  TangentialHold& tangential;
  TangentialLaw* law;  ///< null: frictionless
  Vec3& position;      ///< [m] of the tool
  HoldMove& since_look;
  Vec3& engaged;  ///< [m]
};

/// Prevents a force reversal within a period. The compliance of bone under a ring of loads can move a cutting tool slightly beyond the
/// equilibrium of its springs; the tool then stays at the equilibrium for this period, without load.
/// @param target [m] the equilibrium. @param before [N] force of the last period. @returns whether a reversal was suppressed.
bool suppress_reversal(const SweptTool& tool, const Vec3& target, const Vec3& before, double voxel_edge) noexcept;

}  // namespace burrhole
