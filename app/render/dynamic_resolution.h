/// app/render/pace.h: resolution of pictures while the camera moves, controlled so that each takes a given time.
///   Units s; a resolution is the share of a picture's width and height.   Errors  none.   Thread  one owner.
#pragma once

namespace burrhole {

/// Computes the resolution of the next picture from the measured times of previous pictures. It assumes that the time is proportional to
/// the number of pixels. It does not read a clock.
class Pace {
 public:
  static constexpr double kCoarsest = 0.25;
  static constexpr double kStep = 0.125;  ///< [-] of resolution: targets are made for each size, so there are few sizes

  /// @param budget [s] per picture, > 0.
  explicit Pace(double budget) : budget_(budget) {}
  /// @returns the coarsest resolution before the first record(); afterwards the finest step that is predicted to fit, or the coarsest.
  [[nodiscard]] double resolution() const noexcept;
  /// Records that a whole picture at `resolution` took `seconds`. A slower picture counts fully, a faster one by half, so that the rate
  /// holds while bone fills more of the picture.
  void record(double resolution, double seconds) noexcept;
  [[nodiscard]] double budget() const noexcept { return budget_; }

 private:
  double budget_;
  double full_ = 0.0;  ///< [s] predicted for a picture at resolution 1; 0: nothing recorded
};

}  // namespace burrhole
