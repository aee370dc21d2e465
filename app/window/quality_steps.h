/// app/window/quality_steps.h: the quality of a picture at rest as a person changes it, with the accuracy that is known of it.
///   Source  the Pareto front of `burrhole cost render` (app/view/quality.h), which docs/drawing.md tables.
///   Units   dB, s.   Errors  none.   Thread  any.
#pragma once

#include <optional>
#include <string>

#include "app/view/quality.h"

namespace burrhole {

/// @returns the PSNR [dB] of the Pareto front's point with this quality, against the best that can be drawn; nothing if it is none of its points.
[[nodiscard]] std::optional<double> known_psnr(std::span<const QualityPoint> front, const DrawingQuality& quality);

/// @returns the next point of the Pareto front, finer or coarser. From a quality beside it, the nearest point with more or fewer rays.
/// At an end, the point there; of an empty Pareto front, `quality`.
[[nodiscard]] DrawingQuality next_quality(std::span<const QualityPoint> front, const DrawingQuality& quality, bool finer);

/// What a change of shadows and highlights did to the picture at rest, of the same view.
struct LightsChange {
  double more_ms = 0.0;          ///< time of all its pixels after the change, less that before
  std::optional<double> psnr{};  ///< [dB] of the picture before against that after; absent: no pixel differs
};
/// @returns the price and the error of the last change of shadows and highlights, for the person. @param change absent: not measured.
[[nodiscard]] std::string lights_text(const std::optional<LightsChange>& change);

/// @returns the PSNR [dB] of a picture against another of the same size, over red, green and blue, as in docs/drawing.md; nothing if they
/// are equal or differ in size.
[[nodiscard]] std::optional<double> psnr_of(const Image& image, const Image& reference);

}  // namespace burrhole
