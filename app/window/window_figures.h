/// app/window/window_figures.h: what a window did: pictures and times, for the person who wants to know what a machine can.
///   Units  s.   Errors  none.   Thread  one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace burrhole {

/// Times [s] of the last pictures, for percentiles.
class PictureTimes {
 public:
  void add(double seconds);
  /// @returns the time that `share` of the kept ones do not exceed; 0 without any.
  [[nodiscard]] double at(double share) const;

 private:
  static constexpr std::size_t kMost = 20'000;  // ten minutes; then the oldest go
  std::vector<float> seconds_;
  std::size_t next_ = 0;
};

/// Pictures while something went on, and how long it did.
struct PictureRate {
  std::uint64_t pictures = 0;
  double time = 0.0;  ///< [s]
  void add(double seconds) noexcept {
    ++pictures;
    time += seconds;
  }
  [[nodiscard]] double per_second() const noexcept { return time > 0.0 ? static_cast<double>(pictures) / time : 0.0; }
};

/// What a window did, for the person who wants to know what a machine can.
struct WindowFigures {
  PictureRate drilling;  ///< the drill spun, the view stood
  PictureRate turning;   ///< the view moved
  PictureTimes picture;  ///< time of one
  PictureTimes latency;  ///< from the first event that it shows to the picture on the screen
  PictureTimes refined;  ///< from the last change to the picture at rest on the screen
};

}  // namespace burrhole
