/// core/sound/drill_sound.h: synthesises the sound of a drill from its spin and from what a tooth cuts.
///   Units  SI; samples -1..1, mono.   Errors  out_of_range from create().   Thread  one; no lock, allocation or exception after create().
///   Bits   depend on the inputs and on the samples at which they change only, not on the lengths of the blocks.
///   Source  own derivation. Symbols: n spin [rev/s], z teeth, h uncut chip thickness [m], H hardness [-], P cutting power [W],
///           Q volume rate of removal [m^3/s].
///     motor   f_m = (n / n_0) f_0, n_0 the spin and f_0 the motor's speed at full command; six harmonics, 1 / k.
///             Level  L_m (0.3 n / n_0 + 0.7 P / (P + 10 W)).
///     teeth   f_t = n z, the tooth passing frequency; harmonics k with the amplitudes q^(k - 1), q = 0.5 + 0.35 H: a hard chip gives a
///             shorter pulse of force. Level  L_t min(1, H H (h / 10 um)^(1/2)). One H and the thickness are Kienzle's cutting force
///             b k_c1 h^(1 - m) [Kienzle52], with a specific force in proportion to H and m = 1/2. The other H: an alternating force
///             radiates in proportion to its rate of change (acoustic dipole), and its pulse rises in a time that goes with 1 / H.
///     chips   white noise through two resonators, at 1.2 kHz (weight 1 - H) and 3.6 kHz (weight H), modulated by the passing teeth.
///             Level  L_c min(1, H H (Q / 100 mm^3/s)^(1/2)): as for a tooth, and the powers of independent fractures add.
///   A level of tones is the amplitude of the sine of equal power; that of noise is its root mean square without modulation. Harmonics fade
///   out between 0.40 and 0.45 of the sample rate. Spin and levels follow the inputs with the time constant `response`, so no step clicks.
///   Assumptions: f_0, all levels, m, q, and the frequencies of the noise; no recording of a drill was fitted.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/result.h"

namespace burrhole {

struct SoundConfig {
  int sample_rate = 48000;     ///< [Hz] in [8000, 192000], a multiple of 100
  double volume = 0.5;         ///< [-] in [0, 1]
  double motor_speed = 400.0;  ///< [rev/s] > 0: f_0
  double motor_level = 0.1;    ///< [-] in [0, 1]: L_m
  double tooth_level = 0.3;    ///< [-] in [0, 1]: L_t
  double chip_level = 0.15;    ///< [-] in [0, 1]: L_c
  double response = 0.01;      ///< [s] in [0.001, 1]
  bool wav = true;             ///< the samples are written to a file
};

/// What sounds. Numbers that are not finite count as 0, and a negative spin as its magnitude.
struct SoundInput {
  double spin = 0.0;       ///< [rev/s] n
  double full_spin = 0.0;  ///< [rev/s] n_0 at full command; 0: the motor has no tone
  double teeth = 0.0;      ///< [-] z
  double thickness = 0.0;  ///< [m] h
  double volume = 0.0;     ///< [m^3] that a tooth removes in one pass; Q = n z volume
  double hardness = 0.0;   ///< [-] H, 0..1
  double power = 0.0;      ///< [W] P
};

/// Levels and frequencies that an input leads to when it lasts.
struct SoundTone {
  double motor = 0.0;                                             ///< [Hz] f_m
  double teeth = 0.0;                                             ///< [Hz] f_t
  double motor_level = 0.0, tooth_level = 0.0, chip_level = 0.0;  ///< [-] without `volume`
  double brightness = 0.0;                                        ///< [-] q
  double hardness = 0.0;                                          ///< [-] H
};
[[nodiscard]] SoundTone tone_of(const SoundConfig& config, const SoundInput& input) noexcept;

class DrillSound {
 public:
  static constexpr int kMotorHarmonics = 6, kToothHarmonics = 24;

  /// @returns out_of_range if a number of the config is outside its range.
  [[nodiscard]] static Result<DrillSound> create(const SoundConfig& config);

  /// Fills `out` with the next samples. Silence is exactly 0.
  void render(const SoundInput& input, std::span<float> out) noexcept;

 private:
  /// Band-pass with two poles, scaled to an output of root mean square 1 for white noise.
  struct Resonator {
    double a1 = 0.0, a2 = 0.0, gain = 0.0;
    double y1 = 0.0, y2 = 0.0;
    double step(double in) noexcept {
      const double y = gain * in + a1 * y1 + a2 * y2;
      y2 = y1;
      y1 = y;
      return y;
    }
  };

  explicit DrillSound(const SoundConfig& config);
  [[nodiscard]] static Resonator resonator(double frequency, double rate) noexcept;
  void follow(const SoundTone& target) noexcept;
  [[nodiscard]] bool is_silent(const SoundTone& target) const noexcept;
  [[nodiscard]] double motor() noexcept;
  [[nodiscard]] double teeth() noexcept;
  [[nodiscard]] double chips() noexcept;

  SoundConfig config_;
  double rate_, share_;                           // [Hz]; [-] of a difference that one sample takes up
  SoundTone now_;                                 // smoothed
  double motor_phase_ = 0.0, tooth_phase_ = 0.0;  // [periods] 0..1
  Resonator dull_, bright_;
  std::uint64_t sample_ = 0;
};

}  // namespace burrhole
