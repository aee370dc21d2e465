/// app/lab/push_cone.h: what bone round a tool can push with, as an oracle for forces: contacts push along outward normals and never pull,
///   so all that they can give together is the convex cone of the normals. What of a force lies outside it, no bone gave.
///   Frames as named.   Units SI.   Thread any; allocates.
///   Source  own derivation; shares no code with contact: it reads the window's density voxel by voxel.
#pragma once

#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Distance [N] of a force from the convex cone of unit vectors; its length when there are none. One normal: the length where it points
/// into bone, and what lies across where it does not: never less than the force towards bone.
[[nodiscard]] double outside_cone(const Vec3& force, std::span<const Vec3> normals) noexcept;

/// Outward unit normals, in the axes of the bone frame, of the 0.5 surface wherever points of a tool touch it, appended to `out`.
/// Of each cell of eight voxels that the surface passes: the middle of its crossings with the cell's edges, and the slope of the density
/// between the eight there. A point outside bone touches what lies within half a cell's diagonal of it: where the surface passes through
/// the point, the middle is no further. A point inside touches what is no more than that further than the nearest, up to three voxels deep;
/// deeper, nothing is known.
void touched_normals(const MasterWindow& window, const Affine& bone_from_index, std::span<const Vec3> points_in_bone,
                     std::vector<Vec3>& out);

}  // namespace burrhole
