/// core/contact/distance_slope.h: the surface normal from the gradient of the recorded distances, for the few points that carry load.
///   Frame  index coordinates in, axes of the bone frame out.   Thread  contact.
///   Source own derivation: the gradient of the distances, smoothed by a cubic B-spline over 4 x 4 x 4 records. It is continuous, and exact
///   where distance is a polynomial of second degree (a plane, and a ball to second order). As a mean of many records it has several times
///   less noise than the stored normals, which depend on two voxels of density in each direction; the difference is largest near edges and
///   at single voxels of a ramp.
#pragma once

#include <optional>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// @returns the outward unit normal; empty where a record around the point is unknown or too far from the surface to hold its distance.
[[nodiscard]] std::optional<Vec3> distance_slope(const RecordView& bone, const Vec3& index) noexcept;

}  // namespace burrhole
