/// core/sound/warning_tone.h: a tone that beeps faster the nearer something is, and does not stop where it is reached.
///   Units  SI; samples -1..1.   Errors  none.   Thread  one; no allocation.
///   Bits   depend on the inputs and on the samples at which they change only.
///   Source  own. A tone of 1 kHz, of which (2 + 8 x) beeps a second are heard, each for half of its time; x the nearness, 0..1.
#pragma once

#include <span>

namespace burrhole {

class WarningTone {
 public:
  static constexpr double kFrequency = 1000.0;              ///< [Hz]
  static constexpr double kSlowest = 2.0, kFastest = 10.0;  ///< [1/s] beeps just below nearness 1
  static constexpr double kRise = 0.004;                    ///< [s] time constant of the edges of a beep, so that it does not click

  /// @param rate [Hz] samples per second.
  explicit WarningTone(double rate) noexcept;
  /// Adds the next samples to `out`, which is left as it is while there is no tone. @param nearness 0: none; 1 and more: without pause.
  /// @param level [-] amplitude. Numbers that are not finite count as 0.
  void add(double nearness, double level, std::span<float> out) noexcept;

 private:
  double rate_, share_;                           // [Hz]; [-] of a difference that one sample takes up
  double phase_ = 0.0, beep_ = 0.0, gate_ = 0.0;  // [periods]; [beeps]; [-] amplitude now
};

}  // namespace burrhole
