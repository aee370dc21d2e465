/// volumes/read/scan_skin.h: the skin of a body in a CT: the surface between air and soft tissue, without what lies beside the body.
///   Frame   bone frame (LPS).   Units  SI; values of the scan in HU.   Errors  bad_input.   Thread  any.
///   Method  The scan as means over voxels of about `pitch`. Voxels above -400 HU, less a layer of one voxel, fall into components joined by
///           faces; the one with most bone (above 250 HU) is the body, and gets its layer back. So a table or headrest that touches the body
///           over a thin contact or through foam is left out; one that is pressed against it over several voxels in depth is not. What air
///           reaches from the sides of the scan through openings of more than four voxels is outside; other cavities belong to the body.
///   Source  own work; the threshold is near the middle between air and soft tissue, where a mean over voxels has the surface.
#pragma once

#include <vector>

#include "core/base/bounds.h"
#include "core/base/result.h"
#include "volumes/read/scan.h"

namespace burrhole {

struct ScanSkin {
  Vec3i dims{0};
  Affine bone_from_index, index_from_bone;
  std::vector<float> value;  ///< [m] about the distance from the skin near it, positive outside; i fastest

  /// @returns the interpolated value at a point of the bone frame; positive outside the scan, so that a plane closes the skin where the scan ends.
  [[nodiscard]] double at(const Vec3& p_bone) const noexcept;
  [[nodiscard]] Bounds box() const noexcept;  ///< [m] bone frame, round the scan with room
};

/// @param offset [HU] added to the scan's values. @param pitch [m] > 0. @returns bad_input if no voxel is bone, or none of it lies in soft
/// tissue.
[[nodiscard]] Result<ScanSkin> find_scan_skin(const Scan& scan, double offset, double pitch);

}  // namespace burrhole
