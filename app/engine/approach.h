/// app/engine/approach.h: the planned way into bone, measured on the bone as loaded.
///   Frame  bone frame unless said; approach frame: origin on the outer surface, +z up the shaft.   Units SI.
#pragma once

#include <vector>

#include "app/engine/scene.h"
#include "core/base/result.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

struct Approach {
  Pose bone_from_approach;   ///< origin on the outer surface
  double thickness = 0.0;    ///< [m] of bone along the axis, by the 0.5 level of occupancy
  double angle = 0.0;        ///< [rad] between the tool's axis and the outward normal at the entry
  bool from_inside = false;  ///< dura or brain lies before the entry: the axis points out of the skull
  /// Places along the axis inside bone as loaded, a quarter voxel apart, outer first: index coordinates and depth from the entry [m].
  std::vector<Vec3> axis_index;
  std::vector<double> axis_depth;
  /// Layers met along the axis: label and depth range [m].
  struct Layer {
    VoxelLabel label;
    double from, to;
  };
  std::vector<Layer> layers;
};

/// Looks for the outer surface from 20 mm above `entry` to 20 mm below it along the axis, and for the inner one up to 60 mm deeper; gaps of
/// under 2 mm count as bone passed through. bad_input when the axis meets no bone or bone does not end there.
[[nodiscard]] Result<Approach> make_approach(const BoneModel& bone, const ApproachScene& scene);

/// Trilinear occupancy as loaded at a point in index coordinates.
[[nodiscard]] double sample_occupancy(const BoneModel& bone, const Vec3& index);

}  // namespace burrhole
