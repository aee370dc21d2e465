#include "core/sound/warning_tone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kInaudible = 1e-5;  // [-] amplitude, below the step of a sample of 16 bits

}  // namespace

WarningTone::WarningTone(double rate) noexcept : rate_(rate), share_(1.0 - portable_exp(-1.0 / (kRise * rate))) {}

void WarningTone::add(double nearness, double level, std::span<float> out) noexcept {
  const double x = std::isfinite(nearness) && std::isfinite(level) ? std::clamp(nearness, 0.0, 1.0) : 0.0;
  if (x == 0.0 && gate_ == 0.0) return;
  const double beeps = (kSlowest + (kFastest - kSlowest) * x) / rate_;
  for (float& sample : out) {
    const bool on = x > 0.0 && (x >= 1.0 || beep_ < 0.5);
    gate_ += share_ * ((on ? level : 0.0) - gate_);
    sample += static_cast<float>(gate_ * portable_sin(2.0 * std::numbers::pi * phase_));
    phase_ += kFrequency / rate_;
    phase_ -= std::floor(phase_);
    beep_ += beeps;
    beep_ -= std::floor(beep_);
  }
  if (x > 0.0 || std::abs(gate_) > kInaudible) return;
  gate_ = phase_ = beep_ = 0.0;
}

}  // namespace burrhole
