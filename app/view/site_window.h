/// app/view/site_window.h: the window round the entry in a drape, and the opening of the skin.
///   Frame  approach frame; only x and y count.   Units  SI.   Errors  none.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/geometry.h"

namespace burrhole {

struct SiteWindow {
  double width = 0.0;  ///< [m]
  bool round = false;  ///< otherwise square with rounded corners, its sides along x and y

  /// @returns the distance [m] of a point beyond the edge, negative inside.
  [[nodiscard]] double beyond(const Vec3& p) const noexcept {
    const double half = 0.5 * width;
    if (round) return std::sqrt(p.x * p.x + p.y * p.y) - half;
    const double corner = 0.2 * half;
    const double x = std::abs(p.x) - half + corner, y = std::abs(p.y) - half + corner;
    const double ox = std::max(x, 0.0), oy = std::max(y, 0.0);
    return std::sqrt(ox * ox + oy * oy) + std::min(std::max(x, y), 0.0) - corner;
  }
};

}  // namespace burrhole
