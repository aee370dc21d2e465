/// app/lab/contact_reference.h: what contact ought to say, from the closed form of a phantom alone: no voxel is read.
///   Frame  bone frame; poses are of the tool in it.   Units  SI.   Source  own derivations, at each function.
#pragma once

#include "core/tool/tool.h"
#include "volumes/phantom/truth.h"

namespace burrhole {

/// Force [N] of the averaging law of [AcostaLiu07] section 2 with exact depths: k times the mean, over the shell points in bone, of
/// (distance below the true surface) x (true outward normal). Zero when apart.
[[nodiscard]] Vec3 exact_average_force(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, double stiffness) noexcept;

/// Shortest way [m] along `out` (unit) after which no shell point is in bone. Exact for convex bones: the longest of the ways that the
/// points in bone have ahead of them. 0 when apart.
[[nodiscard]] double exact_way_out(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, const Vec3& out) noexcept;

}  // namespace burrhole
