/// core/measure/approach.h: the planned axis into bone, measured on the bone as loaded.
///   Frame  bone frame unless stated; approach frame: origin on the outer surface, +z up the shaft.   Units  SI.
///   Errors  bad_input if the axis meets no bone or the bone does not end within the search range.   Thread  any; reads the bone only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

/// Table [approach]. Bone frame.
struct ApproachScene {
  Vec3 entry{0.0};               ///< [m] near the outer surface; moved onto the surface along the axis
  Vec3 axis{0.0, 0.0, -1.0};     ///< [-] unit vector into bone
  std::string place;             ///< location of the table in the file, for errors found later
  std::optional<Vec3> target{};  ///< [m] end of a planned line, on the axis; no run reads it
  std::string markups{};         ///< path of the planned line's file; empty: there is none
};

struct Approach {
  Pose bone_from_approach;     ///< origin on the outer surface
  double thickness = 0.0;      ///< [m] of bone along the axis, by the 0.5 level of occupancy
  Vec3 normal{0.0, 0.0, 1.0};  ///< [-] unit, bone frame: outward normal of the surface at the entry
  double angle = 0.0;          ///< [rad] between the tool's axis and this normal
  bool from_inside = false;    ///< dura or brain lies above the entry: the axis points out of the skull
  /// Samples along the axis inside bone as loaded, a quarter voxel apart, outermost first.
  std::vector<Vec3> axis_index;    ///< [voxels] index coordinates
  std::vector<double> axis_depth;  ///< [m] depth from the entry
  /// A layer along the axis.
  struct Layer {
    VoxelLabel label;
    double from, to;  ///< [m] depth range from the entry
  };
  std::vector<Layer> layers;
};

/// Searches the outer surface from 20 mm above `entry` to 20 mm below it along the axis, and the inner surface up to 60 mm deeper. A gap of
/// less than 2 mm counts as bone. @returns bad_input if the axis meets no bone or bone does not end there.
[[nodiscard]] Result<Approach> make_approach(const BoneModel& bone, const ApproachScene& scene);

/// @returns the trilinear occupancy [-] as loaded at a point in index coordinates.
[[nodiscard]] double sample_occupancy(const BoneModel& bone, const Vec3& index);

}  // namespace burrhole
