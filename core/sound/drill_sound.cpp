#include "core/sound/drill_sound.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"
#include "core/base/random.h"

namespace burrhole {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMostSpin = 1e5;                                               // [rev/s]
constexpr double kIdleShare = 0.3;                                              // [-] of the motor's level without load
constexpr double kHalfPower = 10.0;                                             // [W] of half the level by load
constexpr double kFullThickness = 10e-6;                                        // [m] of the full level at hardness 1
constexpr double kFullRate = 100e-9;                                            // [m^3/s] of the full level at hardness 1
constexpr double kDull = 0.5, kByHardness = 0.35;                               // [-] q
constexpr double kDullRing = 1200.0, kBrightRing = 3600.0, kRingWidth = 800.0;  // [Hz]
constexpr double kFadeFrom = 0.40, kFadeTo = 0.45;                              // [-] of the sample rate
constexpr double kSettled = 1e-9;  // [-] differences below this are taken up at once: no denormals, exact silence
constexpr std::uint64_t kDullSeed = 0x6472696c6cull, kBrightSeed = 0x626f6e65ull;

double positive(double x) noexcept { return std::isfinite(x) && x > 0.0 ? x : 0.0; }

void approach(double& value, double target, double share) noexcept {
  const double away = target - value;
  value = std::abs(away) <= kSettled * std::max(1.0, std::abs(target)) ? target : value + share * away;
}

/// [-] share of a harmonic that is kept at a frequency [Hz].
double kept(double frequency, double rate) noexcept {
  return std::clamp((kFadeTo * rate - frequency) / ((kFadeTo - kFadeFrom) * rate), 0.0, 1.0);
}

double advanced(double phase, double frequency, double rate) noexcept {
  const double next = phase + frequency / rate;
  return next - std::floor(next);
}

}  // namespace

SoundTone tone_of(const SoundConfig& config, const SoundInput& input) noexcept {
  SoundTone out;
  const double spin = std::min(positive(std::abs(input.spin)), kMostSpin);
  if (spin == 0.0) return out;
  const double full = positive(input.full_spin), teeth = positive(input.teeth);
  const double hardness = std::min(1.0, positive(input.hardness));
  const double power = positive(input.power), rate = spin * teeth * positive(input.volume);
  out.teeth = spin * teeth;
  out.hardness = hardness;
  out.brightness = kDull + kByHardness * hardness;
  if (full > 0.0) {
    const double relative = spin / full;
    out.motor = relative * config.motor_speed;
    const double load = power < 1e12 ? power / (power + kHalfPower) : 1.0;
    out.motor_level = config.motor_level * (kIdleShare * std::min(1.0, relative) + (1.0 - kIdleShare) * load);
  }
  if (teeth > 0.0) {
    // [Kienzle52] F = b k_c1 h^(1 - m), here with m = 1/2.
    const double force = std::sqrt(positive(input.thickness) / kFullThickness), radiated = hardness * hardness;
    out.tooth_level = config.tooth_level * std::min(1.0, radiated * force);
    out.chip_level = config.chip_level * std::min(1.0, radiated * std::sqrt(rate / kFullRate));
  }
  return out;
}

Result<DrillSound> DrillSound::create(const SoundConfig& config) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };
  if (config.sample_rate < 8000 || config.sample_rate > 192000 || config.sample_rate % 100 != 0)
    return refuse("the sample rate must be in [8000, 192000] Hz and a multiple of 100");
  if (!within(config.volume, 0.0, 1.0)) return refuse("the volume must be in [0, 1]");
  if (!(config.motor_speed > 0.0 && config.motor_speed <= kMostSpin)) return refuse("the motor's speed must be above 0");
  for (const double level : {config.motor_level, config.tooth_level, config.chip_level})
    if (!within(level, 0.0, 1.0)) return refuse("a level of sound must be in [0, 1]");
  if (!within(config.response, 0.001, 1.0)) return refuse("the response of sound must be in [0.001, 1] s");
  return DrillSound(config);
}

DrillSound::DrillSound(const SoundConfig& config)
    : config_(config),
      rate_(static_cast<double>(config.sample_rate)),
      share_(1.0 - portable_exp(-1.0 / (config.response * rate_))),
      dull_(resonator(kDullRing, rate_)),
      bright_(resonator(std::min(kBrightRing, kFadeFrom * rate_), rate_)) {}

/// y = g x + 2 r cos(w) y1 - r^2 y2. White noise of variance 1 gives (1 + r^2) / ((1 - r^2) (1 + r^4 - 2 r^2 cos 2w)) g^2; the noise here is
/// uniform in -1..1, of variance 1/3.
DrillSound::Resonator DrillSound::resonator(double frequency, double rate) noexcept {
  const double r = portable_exp(-0.5 * kTurn * kRingWidth / rate), w = kTurn * frequency / rate, rr = r * r;
  const double variance = (1.0 + rr) / ((1.0 - rr) * (1.0 + rr * rr - 2.0 * rr * portable_cos(2.0 * w))) / 3.0;
  return {.a1 = 2.0 * r * portable_cos(w), .a2 = -rr, .gain = 1.0 / std::sqrt(variance)};
}

void DrillSound::follow(const SoundTone& target) noexcept {
  approach(now_.motor, target.motor, share_);
  approach(now_.teeth, target.teeth, share_);
  approach(now_.motor_level, target.motor_level, share_);
  approach(now_.tooth_level, target.tooth_level, share_);
  approach(now_.chip_level, target.chip_level, share_);
  // Of a chip that has ended only the level counts: its timbre stays.
  if (target.hardness > 0.0) {
    approach(now_.brightness, target.brightness, share_);
    approach(now_.hardness, target.hardness, share_);
  }
}

bool DrillSound::is_silent(const SoundTone& target) const noexcept {
  for (const SoundTone* tone : {&target, &now_})
    if (tone->motor_level > 0.0 || tone->tooth_level > 0.0 || tone->chip_level > 0.0) return false;
  return true;
}

double DrillSound::motor() noexcept {
  motor_phase_ = advanced(motor_phase_, now_.motor, rate_);
  if (now_.motor_level == 0.0) return 0.0;
  constexpr double kPower = 1.0 + 1.0 / 4 + 1.0 / 9 + 1.0 / 16 + 1.0 / 25 + 1.0 / 36;
  const double c = 2.0 * portable_cos(kTurn * motor_phase_);
  double before = 0.0, sine = portable_sin(kTurn * motor_phase_), sum = 0.0;
  for (int k = 1; k <= kMotorHarmonics; ++k) {
    const double share = kept(k * now_.motor, rate_);
    if (share == 0.0) break;
    sum += share * sine / k;
    const double next = c * sine - before;  // sin((k + 1) x) = 2 cos(x) sin(k x) - sin((k - 1) x)
    before = sine;
    sine = next;
  }
  return now_.motor_level / std::sqrt(kPower) * sum;
}

double DrillSound::teeth() noexcept {
  tooth_phase_ = advanced(tooth_phase_, now_.teeth, rate_);
  if (now_.tooth_level == 0.0) return 0.0;
  const double q = now_.brightness, c = 2.0 * portable_cos(kTurn * tooth_phase_);
  double before = 0.0, sine = portable_sin(kTurn * tooth_phase_), amplitude = 1.0, sum = 0.0, power = 0.0;
  for (int k = 1; k <= kToothHarmonics; ++k) {
    const double share = kept(k * now_.teeth, rate_);
    sum += share * amplitude * sine;
    power += amplitude * amplitude;
    amplitude *= q;
    const double next = c * sine - before;
    before = sine;
    sine = next;
  }
  return now_.tooth_level / std::sqrt(power) * sum;
}

double DrillSound::chips() noexcept {
  // The resonators run on while there is no chip, so their state neither decays nor starts anew.
  const double dull = dull_.step(uniform11(kDullSeed, sample_)), bright = bright_.step(uniform11(kBrightSeed, sample_));
  if (now_.chip_level == 0.0) return 0.0;
  const double h = now_.hardness, mixed = ((1.0 - h) * dull + h * bright) / std::sqrt((1.0 - h) * (1.0 - h) + h * h);
  return now_.chip_level * mixed * 0.5 * (1.0 - portable_cos(kTurn * tooth_phase_));
}

void DrillSound::render(const SoundInput& input, std::span<float> out) noexcept {
  const SoundTone target = tone_of(config_, input);
  for (float& sample : out) {
    ++sample_;
    if (is_silent(target)) {
      now_ = target;
      sample = 0.0f;
      continue;
    }
    follow(target);
    const double sum = motor() + teeth() + chips();
    sample = static_cast<float>(std::clamp(config_.volume * sum, -1.0, 1.0));
  }
}

}  // namespace burrhole
