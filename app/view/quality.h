/// app/view/quality.h: selection of the drawing options when a scene requests the best quality within a time ([display] quality = "auto").
///   The Pareto front of cost and accuracy is measured: `burrhole cost render` writes it as quality_front.inc, which is compiled in. Costs
///   are relative; one picture timed on this machine with the cheapest point of the Pareto front converts them to seconds. No OpenGL.
///   Units  s.   Errors  none.
#pragma once

#include <span>
#include <string>

#include "app/view/view.h"

namespace burrhole {

/// A point of the Pareto front: no other set of options is better in both cost and accuracy.
struct QualityPoint {
  DrawingQuality quality;
  double cost = 1.0;     ///< [-] CPU time of a picture relative to the first point
  double psnr_db = 0.0;  ///< [dB] against the best quality
};

/// @returns the Pareto front; costs and accuracies increase; at least one point. @param translucent bone as a translucent body, not a
/// surface.
[[nodiscard]] std::span<const QualityPoint> shipped_front(bool translucent);

struct QualityChoice {
  DrawingQuality quality;
  double expected = 0.0;  ///< [s] predicted time of a picture
  bool met = false;       ///< the prediction is within the budget; otherwise the cheapest point is used
};

/// @returns the most accurate point within the budget.
/// @param front as shipped_front(). @param first [s] > 0, time of a picture drawn with the first point. @param budget [s] > 0.
[[nodiscard]] QualityChoice choose_quality(std::span<const QualityPoint> front, double first, double budget);

/// @returns "step 0.5 voxel, 5 bisections, finish, 2 x 2 rays a pixel, resolution 1"; for translucent bone only the options it uses.
[[nodiscard]] std::string quality_text(const DrawingQuality& quality, bool translucent);

}  // namespace burrhole
