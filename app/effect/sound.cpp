// [sound]: the sound of the drill, made on the audio clock from the spin and from what a tooth cuts. It goes to a file or a sound device;
// where there is neither, no step exists.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "app/stage/zone_state.h"
#include "core/base/hash.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "core/sound/drill_sound.h"
#include "core/sound/warning_tone.h"

namespace burrhole {
namespace {

std::size_t block_samples(const SoundConfig& config) { return static_cast<std::size_t>(config.sample_rate * kAudioPeriod + 0.5); }

class SoundEffect final : public Effect {
 public:
  SoundEffect(const SoundConfig& config, const DrillSound& sound, Stage& stage)
      : config_(config), sound_(sound), tone_(config.sample_rate), sink_(stage.outside().sound), full_spin_(stage.config.tool.spin) {
    if (sink_ == nullptr) return;
    stage.needs.chip_load = stage.needs.removes;
    block_.resize(block_samples(config));
    teeth_ = stage.tool->teeth;
  }

  Status bind(StepGraph& graph) override {
    if (sink_ == nullptr) return {};
    auto step = graph.step(
        Clock::audio, "sound", "sound", [](void* self, const Tick&) { static_cast<SoundEffect*>(self)->run(); }, this);
    spin_ = step.latest(slots::kSpin);
    chips_ = step.latest_if_written(slots::kChipLoad);
    zone_ = step.latest_if_written(slots::kZone);
    return {};
  }
  Status change_tool(Stage& stage) override {
    teeth_ = stage.tool->teeth;
    return {};
  }
  void report(Figures& out) const override {
    if (sink_ == nullptr) return;
    out.add("seconds", static_cast<double>(samples_) / config_.sample_rate);
    out.add("peak", static_cast<double>(peak_));
    out.add("clipped_samples", clipped_);
    out.add("hash", hash_.hex());
  }
  void warn(std::vector<std::string>& out) const override {
    if (clipped_ > 0) out.push_back(fmt::format("[sound] {} samples were clipped: lower volume", clipped_));
  }

 private:
  void run() {
    sound_.render({.spin = *spin_,
                   .full_spin = full_spin_,
                   .teeth = static_cast<double>(teeth_),
                   .thickness = chips_->thickness,
                   .volume = chips_->volume,
                   .hardness = chips_->hardness,
                   .power = chips_->power},
                  block_);
    tone_.add(zone_->nearness, zone_->tone * config_.volume, block_);
    for (const float sample : block_) {
      hash_.add(sample);
      const float size = std::abs(sample);
      peak_ = std::max(peak_, size);
      clipped_ += size >= 1.0f ? 1 : 0;
    }
    samples_ += block_.size();
    sink_->write(block_);
  }

  SoundConfig config_;
  DrillSound sound_;
  WarningTone tone_;  // of [zones]
  SoundSink* sink_;
  double full_spin_;  // [rev/s]
  int teeth_ = 0;
  std::vector<float> block_;
  const double* spin_ = nullptr;
  const ChipLoad* chips_ = nullptr;
  const ZoneState* zone_ = nullptr;
  Hash64 hash_;
  float peak_ = 0.0f;  // [-]
  std::uint64_t samples_ = 0, clipped_ = 0;
};

class SoundPlan final : public ConfigPlan<SoundPlan, SoundConfig> {
 public:
  SoundPlan(TableReader& table, const StageConfig&) {
    SoundConfig& c = config_;
    c.sample_rate = static_cast<int>(table.integer("sample_rate_hz", c.sample_rate, 8000, 192000, "samples per second; a multiple of 100"));
    if (c.sample_rate % 100 != 0) table.fault("sample_rate_hz", "must be a multiple of 100");
    c.volume = table.number("volume", within(c.volume, 0.0, 1.0), "factor on all samples");
    c.motor_speed = table.number("motor_rpm", above_zero(c.motor_speed / kRevPerMinute, kRevPerMinute, 2e5),
                                 "speed of the motor at the tool's spin_rpm, geared down to it; pitch of the motor's tone");
    c.motor_level = table.number("motor_level", within(c.motor_level, 0.0, 1.0), "amplitude of the motor's tone under full load");
    c.tooth_level = table.number("tooth_level", within(c.tooth_level, 0.0, 1.0),
                                 "amplitude of the tone at the tooth passing frequency, of a thick hard chip");
    c.chip_level = table.number("chip_level", within(c.chip_level, 0.0, 1.0), "root mean square of the noise of breaking chips");
    c.response = table.number("response_ms", {.fallback = c.response * 1e3, .min = 1.0, .max = 1e3, .to_si = 1e-3},
                              "time constant with which pitch and levels follow the drill");
    c.wav = table.boolean("wav", c.wav, "write sound.wav into the output folder");
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "sound",
            .clock = Clock::audio,
            .step = "a block of sound",
            .needs = "spin, chip load",
            .gives = "samples",
            .detail = fmt::format("{} Hz, motor {:.0f} rpm, {} teeth", config_.sample_rate, config_.motor_speed / kRevPerMinute,
                                  context.tool.teeth),
            .rate_hz = 1.0 / kAudioPeriod,
            .bytes = sizeof(SoundEffect) + block_samples(config_) * sizeof(float)};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (context.config.tool.spin <= 0.0) out.push_back("[sound] the tool's spin is 0: there is no sound");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto sound = DrillSound::create(config_);
    if (!sound) return sound.error();
    return std::unique_ptr<Effect>(std::make_unique<SoundEffect>(config_, *sound, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<SoundPlan>(table, stage);
}

}  // namespace

EffectEntry sound_effect() { return {"sound", "the sound of the drill, to sound.wav and in the window; without it none is made", read}; }

}  // namespace burrhole
