/// app/engine/tip_slices.h: three slices through a tool's tip, square to the patient's axes, as grey values; no display is needed.
///   Frame  bone frame, which is the patient's of a scan (LPS: x to the left, y to the back, z up).   Units  SI.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct TipSlice {
  std::string name;                ///< "axial", "coronal" or "sagittal"
  char axis = 'z';                 ///< across which it lies
  double at = 0.0;                 ///< [m] there
  char left, right, top, bottom;   ///< of the picture, in the patient: L R A P S I
  std::vector<std::uint8_t> grey;  ///< size x size, row 0 at the top: mineral density of what is left, 0 none .. 255; outside the volume 0
  /// Where the tool's surface crosses the plane: [pixels] from the upper left corner, y down. Ends come in pairs, a stroke each.
  std::vector<std::array<glm::dvec2, 2>> tool;
};

struct TipSlices {
  int size = 0;                    ///< [pixels] of an edge
  double pixel = 0.0;              ///< [m]
  std::array<TipSlice, 3> planes;  ///< axial, coronal, sagittal
};

/// @param tool of the bit as it erodes. @param half_width [m] > 0 from the tip, which is in the middle, to the edges. @param size >= 2.
/// The grey of a pixel is occupancy x remaining x hardness at its centre, trilinear between voxels.
[[nodiscard]] TipSlices make_tip_slices(Voxmap& voxmap, const TriangleMesh& tool, const Pose& bone_from_tool, double half_width, int size);

}  // namespace burrhole
