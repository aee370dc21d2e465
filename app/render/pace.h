/// app/render/pace.h: how much of each picture is drawn while the camera moves, so that pictures keep coming at a rate.
///   Units seconds; a resolution is the share of a picture's width and height.
#pragma once

namespace burrhole {

/// Told what each picture took, it says how finely the next one can be drawn. The time of a picture is taken to grow with its pixels. It
/// knows no clock.
class Pace {
 public:
  static constexpr double kCoarsest = 0.25;
  static constexpr double kStep = 0.125;  ///< of resolution: targets are made anew for each size, so there are few sizes

  /// @param budget [s] for a picture, > 0.
  explicit Pace(double budget) : budget_(budget) {}
  /// The coarsest until a picture was told of; then the finest step that is expected to fit, or the coarsest if none is.
  [[nodiscard]] double resolution() const noexcept;
  /// A whole picture at that resolution took so long. A slower one counts at once, a faster one by half, so that the rate holds where bone
  /// fills more and more of the picture.
  void tell(double resolution, double seconds) noexcept;
  [[nodiscard]] double budget() const noexcept { return budget_; }

 private:
  double budget_;
  double full_ = 0.0;  ///< [s] expected of a picture at resolution 1; 0: nothing was told yet
};

}  // namespace burrhole
