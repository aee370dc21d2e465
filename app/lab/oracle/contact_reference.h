/// app/lab/oracle/contact_reference.h: reference forces from the closed form of a phantom; no voxel is read.
///   Frame  bone frame; poses are those of the tool in it.   Units  SI.   Errors  none.   Source  own derivations, at each function.
#pragma once

#include "core/tool/tool.h"
#include "volumes/phantom/truth.h"

namespace burrhole {

/// Force [N] of the averaging law of [AcostaLiu07] section 2 with exact depths: k times the mean, over the shell points in bone, of
/// (distance below the true surface) x (true outward normal). Zero without contact.
[[nodiscard]] Vec3 exact_average_force(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, double stiffness) noexcept;

/// Force [N] of the deepest point alone, eq. (1) of [TellesONeill10] with exact depths: k times the largest distance below the true surface
/// over the shell points, along the true outward normal there. Zero without contact.
[[nodiscard]] Vec3 exact_deepest_force(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, double stiffness) noexcept;

/// Translation distance [m] along `out` (unit) after which no shell point is in bone. Exact for convex bones: the largest distance, over
/// the points in bone, to the surface ahead. 0 without contact.
[[nodiscard]] double exact_translation_distance(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool,
                                                const Vec3& out) noexcept;

}  // namespace burrhole
