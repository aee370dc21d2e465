/// app/render/dynamic_resolution.h: chooses the resolution of pictures while the camera moves so that each meets a time budget.
///   Units s; a resolution is the share of a picture's width and height.   Errors  none.   Thread  one owner; not synchronised.
#pragma once

namespace burrhole {

/// Computes the resolution of the next picture from the measured times of previous pictures. It assumes that the time is proportional to
/// the number of pixels. It does not read a clock.
class DynamicResolution {
 public:
  static constexpr double kCoarsest = 0.25;  ///< [-] smallest resolution, unless another is given
  static constexpr double kStep = 0.125;     ///< [-] step of the resolution; coarse, because a render target is allocated per size

  /// @param budget [s] per picture, > 0. @param coarsest [-] smallest resolution, a multiple of kStep.
  explicit DynamicResolution(double budget, double coarsest = kCoarsest) : budget_(budget), coarsest_(coarsest) {}
  /// @returns the coarsest resolution before the first record(); afterwards the finest step that is predicted to fit, or the coarsest.
  [[nodiscard]] double resolution() const noexcept;
  /// Records that a whole picture at `resolution` took `seconds`. If it was slower than predicted, the new time replaces the prediction; if it
  /// was faster, their mean does. So the budget is met while bone fills more of the picture.
  void record(double resolution, double seconds) noexcept;
  [[nodiscard]] double budget() const noexcept { return budget_; }

 private:
  double budget_, coarsest_;
  double full_time_ = 0.0;  ///< [s] predicted for a picture at resolution 1; 0: nothing recorded
};

}  // namespace burrhole
