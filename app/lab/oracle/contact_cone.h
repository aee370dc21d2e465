/// app/lab/oracle/contact_cone.h: the set of forces that bone around a tool can exert, as an oracle. Contacts push along outward normals and
///   cannot attract, so the set is the convex cone of the normals. The part of a force outside the cone cannot come from bone.
///   Frames as the members state.   Units SI.   Errors  none.   Thread any; allocates.
///   Source  own derivation; shares no code with contact: it reads the density of the window voxel by voxel.
#pragma once

#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// @returns the distance [N] of a force from the convex cone of unit vectors; its length if there are none. For one normal: the full length
/// if the force points into bone, otherwise its lateral part; never less than the force towards bone.
[[nodiscard]] double outside_cone(const Vec3& force, std::span<const Vec3> normals) noexcept;

/// Appends to `out` the outward unit normals, in the axes of the bone frame, of the 0.5 surface where points of a tool touch it. For each
/// cell of eight voxels that the surface passes: the mean of its crossings with the cell's edges, and the gradient of the density there. A
/// point outside bone touches the cells within half a cell diagonal of it. A point inside touches the nearest cells, those at most half a
/// diagonal farther than the nearest, up to three voxels deep; for deeper points no normal is known.
void touched_normals(const MasterWindow& window, const Affine& bone_from_index, std::span<const Vec3> points_in_bone,
                     std::vector<Vec3>& out);

}  // namespace burrhole
