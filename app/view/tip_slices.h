/// app/view/tip_slices.h: three slices through the tip of a tool, perpendicular to the patient axes, as grey values; no display needed.
///   Frame  bone frame, which is the patient frame of a scan (LPS: x left, y posterior, z superior).   Units  SI.   Errors  none.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct TipSlice {
  std::string name;                ///< "axial", "coronal" or "sagittal"
  char axis = 'z';                 ///< axis perpendicular to the plane
  double at = 0.0;                 ///< [m] position on the axis
  char left, right, top, bottom;   ///< patient directions of the sides of the picture: L R A P S I
  std::vector<std::uint8_t> grey;  ///< size x size, row 0 at the top: remaining mineral density, 0 none .. 255; 0 outside the volume
  /// Section of the tool's surface with the plane: [pixels] from the upper left corner, y down; each pair is a line segment.
  std::vector<std::array<glm::dvec2, 2>> tool;
};

struct TipSlices {
  int size = 0;                    ///< [pixels] edge of the picture
  double pixel = 0.0;              ///< [m] edge of a pixel
  std::array<TipSlice, 3> planes;  ///< axial, coronal, sagittal
};

/// Grey values in a box of voxels, 0..1: for `render`, occupancy x remaining x hardness; in a window, what is drawn.
struct MineralBox {
  VoxelBox box;
  Affine index_from_bone;     ///< of the voxels
  std::vector<float> values;  ///< [-] of the box, x fastest

  /// @returns whether a point lies between the centres of the voxels.
  [[nodiscard]] bool holds(const Vec3& p_bone) const;
  /// @returns the value at a point, trilinear; 0 where the box does not hold it.
  [[nodiscard]] double at(const Vec3& p_bone) const;
};
/// @returns the voxels, in any grid, that a cube around a point needs. @param half_width [m].
[[nodiscard]] VoxelBox voxels_around(const Affine& index_from_bone, const Vec3& p_bone, double half_width) noexcept;

/// @param tool mesh of the bit as it erodes. @param half_width [m] > 0 from the tip, which is the centre, to the edges. @param size >= 2.
/// The grey value of a pixel is occupancy x remaining x hardness at its centre, trilinear between voxels.
[[nodiscard]] TipSlices make_tip_slices(Voxmap& voxmap, const TriangleMesh& tool, const Pose& bone_from_tool, double half_width, int size);
/// The same from voxels that were read before. @param levels the first that holds a point gives its value.
[[nodiscard]] TipSlices make_tip_slices(std::span<const MineralBox> levels, const TriangleMesh& tool, const Pose& bone_from_tool,
                                        double half_width, int size);

}  // namespace burrhole
