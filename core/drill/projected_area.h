/// core/drill/projected_area.h: the area on which a bit bears, for the laws that compare the stress under it with the strength of bone.
///   Frame  any, in metres.   Units  SI.   Errors  none.   Thread  any.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// @returns the area [m^2] of the projection along `direction` (unit) of cubes of edge `edge` [m] round the points, counted on a raster of
/// that edge. `cells` is scratch memory.
[[nodiscard]] double projected_area(std::span<const Vec3> points, const Vec3& direction, double edge, std::vector<std::uint64_t>& cells);

}  // namespace burrhole
