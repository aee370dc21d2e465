/// core/contact/distance_slope.h: the surface's direction from the distances in its records, for the few points that carry load.
///   Frame  index coordinates in, axes of the bone frame out.   Thread  contact.
///   Source own derivation: the gradient of the distances, smoothed by a cubic B-spline over 4 x 4 x 4 records. Such a gradient is exact
///   where distance is a polynomial of second degree (a plane, and a ball to second order), continuous, and the mean of enough records to
///   be some times steadier than the normals stored, which see two voxels of density each way: near edges, and at single places of a ramp.
#pragma once

#include <optional>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// @returns the outward unit normal; nothing where the records round the point are not all known, or are too far from the surface to tell.
[[nodiscard]] std::optional<Vec3> distance_slope(const RecordView& bone, const Vec3& index) noexcept;

}  // namespace burrhole
