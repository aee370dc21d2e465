/// tests/volumes/read/scanned_body.h: bodies of closed form, scanned by averages over voxels, and the errors of the surface that is imported.
///   Frame  bone frame; the outer surface of a body passes through the origin.   Units SI; HU.   Errors none.   Thread any.
#pragma once

#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/bone_model.h"
#include "volumes/read/scan.h"

namespace burrhole::test {

/// Bone below a plane or in a ball, or a plate or a shell of it.
struct Body {
  Vec3 normal{0.0, 0.0, 1.0};       ///< [-] outward, at the origin
  std::optional<double> radius;     ///< [m] of the ball; absent: a plane
  std::optional<double> thickness;  ///< [m] of the shell or plate; absent: solid
};

/// Outward normal `tilt` [degrees] away from the axis of the slices, towards a direction that is no axis of the pixels.
[[nodiscard]] Vec3 tilted_normal(double tilt);

struct Scanner {
  Vec3 spacing{0.94e-3, 0.94e-3, 1.9e-3};  ///< [m]
  double slice = 1.9e-3;                   ///< [m] width of the slice profile, a box
  double blur = 0.0;                       ///< [m] in the slice, beside the pixel: standard deviation of three points on each axis
  double noise = 0.0;                      ///< [HU] standard deviation, independent voxels
  double extent = 15e-3;                   ///< [m] the scan spans at least so much on either side of the origin
  double phase = 0.0;                      ///< [slices] of the origin between two slices
};

inline constexpr double kTissueHu = 40.0, kBoneHu = 1200.0;

/// Each voxel is the mean over its box: exact along x, midpoints of 6 x 12 lines across it.
[[nodiscard]] Scan scan_body(const Body& body, const Scanner& scanner);

/// Errors of the 0.5 surface of the imported bone along the body's normals, on a patch of 16 mm x 16 mm round the origin.
struct SurfaceFigures {
  double mean = 0.0;    ///< [m] positive: outside the body's surface
  double rms = 0.0;     ///< [m] about zero
  double p95 = 0.0;     ///< [m] of the absolute error
  double ripple = 0.0;  ///< [m] standard deviation of the error
  double angle = 0.0;   ///< [degrees] 95th percentile of the angle between the normals, over 0.5 mm
  int missing = 0;      ///< normals that meet no surface within 2.5 mm
};

/// Of the outer surface, or of the inner one of a shell or plate.
[[nodiscard]] SurfaceFigures measure_surface(const BoneModel& bone, const Body& body, bool inner = false);

/// Errors of the distance between both surfaces along the normals; `angle` is 0.
[[nodiscard]] SurfaceFigures measure_thickness(const BoneModel& bone, const Body& body);

/// @returns the largest number of separate stretches of bone on a normal, 6 mm to either side of the outer surface.
[[nodiscard]] int most_layers(const BoneModel& bone, const Body& body);

}  // namespace burrhole::test
