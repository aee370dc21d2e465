/// app/window/quality_steps.h: the quality of a picture at rest as a person changes it, with the accuracy that is known of it.
///   Source  the Pareto front of `burrhole cost render` (app/view/quality.h), which docs/drawing.md tables.
///   Units   dB, s.   Errors  none.   Thread  any.
#pragma once

#include <optional>

#include "app/view/quality.h"

namespace burrhole {

/// @returns the PSNR [dB] of the Pareto front's point with this quality, against the best that can be drawn; nothing if it is none of its points.
[[nodiscard]] std::optional<double> known_psnr(std::span<const QualityPoint> front, const DrawingQuality& quality);

/// @returns the next point of the Pareto front, finer or coarser. From a quality beside it, the nearest point with more or fewer rays.
/// At an end, the point there; of an empty Pareto front, `quality`.
[[nodiscard]] DrawingQuality next_quality(std::span<const QualityPoint> front, const DrawingQuality& quality, bool finer);

/// @returns the PSNR [dB] of a picture against another of the same size, over red, green and blue, as in docs/drawing.md; nothing if they
/// are equal or differ in size.
[[nodiscard]] std::optional<double> psnr_of(const Image& image, const Image& reference);

/// When a picture at rest is refined: so that it is finished `target` after the last change, where the machine is fast enough for that.
/// It does not read a clock.
class RefinePace {
 public:
  static constexpr double kTarget = 0.5;              ///< [s] from the last change to the refined picture
  static constexpr double kLeast = 0.1, kMost = 0.3;  ///< [s] of rest; a shorter one would refine between two steps of a turning view

  /// @returns the time [s] without a change after which refining starts.
  [[nodiscard]] double rest() const noexcept;
  /// @returns whether a picture with one ray a pixel is drawn before the refined one, because that would come too late.
  [[nodiscard]] bool has_steps() const noexcept { return took_ + kLeast > kTarget; }
  /// Records the time [s] that a refined picture took.
  void record(double seconds) noexcept { took_ = seconds; }

 private:
  double took_ = kTarget;  // nothing is known yet
};

}  // namespace burrhole
