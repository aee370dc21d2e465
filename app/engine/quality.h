/// app/engine/quality.h: which knobs a picture is drawn with when a scene asks for the best within a time ([display] quality = "auto").
///   The front is measured: `burrhole cost render` writes it as quality_front.inc, which is built in. Costs are relative, so that one
///   picture timed on the machine at hand, by the front's cheapest point, turns them into seconds. Knows no OpenGL.
#pragma once

#include <span>
#include <string>

#include "app/engine/view.h"

namespace burrhole {

/// A set of knobs that no other beats in both cost and accuracy.
struct QualityPoint {
  DrawingQuality quality;
  double cost = 1.0;     ///< CPU time of a picture over that of the first point's
  double psnr_db = 0.0;  ///< against the best that can be drawn
};

/// Costs and accuracies rise; at least one point. `translucent`: bone as a translucent body, otherwise its surface.
[[nodiscard]] std::span<const QualityPoint> shipped_front(bool translucent);

struct QualityChoice {
  DrawingQuality quality;
  double expected = 0.0;  ///< [s] of a picture
  bool met = false;       ///< the budget holds what is expected; otherwise the cheapest point is taken
};

/// The most accurate point within the budget. @param front as shipped_front(). @param first [s] of a picture drawn by its first point, > 0.
/// @param budget [s] > 0.
[[nodiscard]] QualityChoice choose_quality(std::span<const QualityPoint> front, double first, double budget);

/// "step 0.5 voxel, 5 bisections, finish, 2 x 2 rays a pixel, resolution 1"; of translucent bone the knobs that it has.
[[nodiscard]] std::string quality_text(const DrawingQuality& quality, bool translucent);

}  // namespace burrhole
