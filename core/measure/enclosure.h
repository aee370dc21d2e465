/// core/measure/enclosure.h: whether bone closes round the space under a site, as a skull does.
///   Frame  bone frame.   Units  SI.   Errors  none.   Thread  any; calls the sampler from the caller's thread.   Source  own definition.
#pragma once

#include <functional>
#include <optional>

#include "core/base/geometry.h"

namespace burrhole {

/// Bone on a grid, of a scan or of a bone model.
struct BoneSamples {
  Vec3i dims{0};                              ///< [voxels]
  Affine bone_from_index;                     ///< [m]
  VoxelBox bone_box;                          ///< [voxels] around all bone
  std::function<bool(const Vec3i&)> is_bone;  ///< at the centre of a voxel of the grid
};

/// The space under the bone, seen from its probe: the point kProbeDepth below the inner surface, on the approach axis.
struct Enclosure {
  static constexpr double kProbeDepth = 15e-3;  ///< [m]
  /// Heads have a share of 0.87 to 1.00 and a reach of 46 mm and more; a pelvis a share of 0.4 to 0.9, or in its spongy bone, whose shell is
  /// closed too, a reach of up to 36 mm.
  static constexpr double kLeastShare = 0.8, kLeastReach = 40e-3;  ///< [-], [m]
  double depth = 0.0;  ///< [m] free of bone below the inner surface on the axis, at most kProbeDepth
  /// [-] share of the directions from the probe that meet bone, of those of which the grid shows it. A direction that leaves the grid through
  /// a face with bone is not counted: the bone is cut there. 0 where `depth` is less than kProbeDepth.
  double share = 0.0;
  double reach = 0.0;  ///< [m] to the bone in nine tenths of the directions that meet it; 0 where the share is 0
  /// @returns whether it is closed as a skull is.
  [[nodiscard]] bool is_closed() const noexcept { return depth >= kProbeDepth && share >= kLeastShare && reach >= kLeastReach; }
};

/// @param entry [m] within 20 mm of the outer surface. @param axis unit vector into bone.
/// @returns nothing if the axis meets no bone there, the bone does not end within 60 mm, bone is cut at three faces of the
/// grid or more, as in one that is cropped to a site, or the grid shows less than a quarter of the directions.
[[nodiscard]] std::optional<Enclosure> measure_enclosure(const BoneSamples& bone, const Vec3& entry, const Vec3& axis);

}  // namespace burrhole
