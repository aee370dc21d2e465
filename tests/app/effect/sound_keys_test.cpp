// [sound] in a run: each key changes the samples by a stated amount, of the motor that turns freely sample by sample, of cutting by closed forms.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/drill/chip_load.h"
#include "core/drill/energy.h"
#include "core/sound/sound_sink.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMotorPower = 1.0 + 1.0 / 4 + 1.0 / 9 + 1.0 / 16 + 1.0 / 25 + 1.0 / 36;  // of six harmonics 1 / k
constexpr double kHardness = 0.8, kStep = 0.02;                                           // [-] of the plate; [s] of the bone

class Heard final : public SoundSink {
 public:
  void write(std::span<const float> samples) noexcept override { all.insert(all.end(), samples.begin(), samples.end()); }
  std::vector<double> all;
};

/// What the keys say of the motor's tone, in their units.
struct MotorKeys {
  double sample_rate_hz = 48000, volume = 0.5, motor_rpm = 24000, motor_level = 0.1, response_ms = 10;
  [[nodiscard]] std::string text() const {
    return fmt::format("sound={{sample_rate_hz={:.0f}, volume={}, motor_rpm={}, motor_level={}, response_ms={}}}", sample_rate_hz, volume,
                       motor_rpm, motor_level, response_ms);
  }
  [[nodiscard]] double level() const { return volume * 0.3 * motor_level / std::sqrt(kMotorPower); }  ///< of the first harmonic, no load
  /// The samples of a motor that is at its speed from the start: what is heard follows it.
  [[nodiscard]] std::vector<double> samples(std::size_t count) const {
    std::vector<double> out(count);
    double phase = 0.0;
    for (std::size_t n = 0; n < count; ++n) {
      const double come = 1.0 - std::exp(-static_cast<double>(n + 1) / (response_ms * 1e-3 * sample_rate_hz));
      phase += come * motor_rpm / 60.0 / sample_rate_hz;
      for (int k = 1; k <= 6; ++k) out[n] += come * level() * std::sin(kTurn * k * phase) / k;
    }
    return out;
  }
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) out = std::max(out, std::abs(a[n] - b[n]));
  return out;
}

/// A pin that has come to its feed in the plate after a second.
struct Drilled {
  static constexpr double kFrom = 1.0, kTo = 4.0;  // [s]
  std::vector<double> samples;                     // at 48 kHz
  std::vector<double> removed;                     // [m^3] in each bone step from kFrom to kTo
  CuttingTeeth teeth;
  double radius = 0.0;  // [m] of the torque

  /// [-] amplitude of a frequency [Hz] of which kTo - kFrom holds whole periods.
  [[nodiscard]] double amplitude(double frequency) const {
    double cosine = 0.0, sine = 0.0;
    for (auto n = static_cast<std::size_t>(kFrom * 48000.0); n < static_cast<std::size_t>(kTo * 48000.0); ++n) {
      const double angle = kTurn * frequency * static_cast<double>(n) / 48000.0;
      cosine += samples[n] * std::cos(angle);
      sine += samples[n] * std::sin(angle);
    }
    return 2.0 * std::hypot(cosine, sine) / ((kTo - kFrom) * 48000.0);
  }
  [[nodiscard]] double rms() const {
    double sum = 0.0;
    const auto from = static_cast<std::size_t>(kFrom * 48000.0), to = static_cast<std::size_t>(kTo * 48000.0);
    for (std::size_t n = from; n < to; ++n) sum += samples[n] * samples[n];
    return std::sqrt(sum / static_cast<double>(to - from));
  }
  /// Mean of the root of what is removed in a step.
  [[nodiscard]] double mean_root() const {
    double sum = 0.0;
    for (const double one : removed) sum += std::sqrt(one);
    return sum / static_cast<double>(removed.size());
  }
};

Drilled drilled(const std::string& sound, const std::vector<std::string>& sets = {}) {
  const TemporaryFolder folder;
  Heard heard;
  SimulationOptions options;
  options.sound = &heard;
  SmallScene scene{.record = true, .sets = {"duration_s=4.2", "tool.name=\"pin\"", "volume.thickness_mm=4", sound}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  DrillRun run(scene, options);
  run_recorded(run, folder.file("run.sqlite"));
  Drilled out{
      .samples = heard.all, .removed = {}, .teeth = cutting_teeth(run.loaded().tool), .radius = rubbing_radius(run.loaded().tool.erosion)};
  const std::vector<double> sum = session_column(folder.file("run.sqlite"), "removed_mass");
  for (auto n = static_cast<std::size_t>(Drilled::kFrom / kStep); n < static_cast<std::size_t>(Drilled::kTo / kStep); ++n)
    out.removed.push_back(sum[n] - sum[n - 1]);
  REQUIRE(out.samples.size() > 4.0 * 48000.0);
  REQUIRE(*std::ranges::min_element(out.removed) > 0.0);
  return out;
}

}  // namespace

TEST_CASE("sound of a motor that turns freely: sample_rate_hz, volume, motor_rpm, motor_level and response_ms give each sample") {
  // Speed and level follow as 1 - exp(-t / T), and where 1e-9 of them is left they are there: some 1e-8 turns and 1e-9 of the level, and a float
  // has 6e-8 of itself. A tenth more of a key is seen.
  constexpr double kRounding = 1e-6;
  for (const MotorKeys& keys : {MotorKeys{}, MotorKeys{.sample_rate_hz = 44100}, MotorKeys{.sample_rate_hz = 96000, .volume = 0.8},
                                MotorKeys{.motor_rpm = 9000, .response_ms = 40}, MotorKeys{.volume = 1.0, .motor_level = 0.7},
                                MotorKeys{.motor_rpm = 60000, .response_ms = 2}}) {
    CAPTURE(keys.text());
    Heard heard;
    SimulationOptions options;
    options.sound = &heard;
    DrillRun run(SmallScene{.sets = {"duration_s=0.3", "hand.standoff_mm=6", keys.text()}}, options);
    run.run();
    const std::vector<double>& samples = heard.all;
    CHECK(static_cast<double>(samples.size()) == 0.3 * keys.sample_rate_hz);
    const double worst = largest_difference(samples, keys.samples(samples.size())) / keys.level();
    MESSAGE("within " << worst << " of the level");
    CHECK(worst < kRounding);
    for (double MotorKeys::*const key :
         {&MotorKeys::sample_rate_hz, &MotorKeys::volume, &MotorKeys::motor_rpm, &MotorKeys::motor_level, &MotorKeys::response_ms}) {
      MotorKeys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(largest_difference(samples, wrong.samples(samples.size())) > 0.05 * keys.level());
    }
  }
}

TEST_CASE("sound of cutting: motor_level gives the motor's amplitude under load") {
  // Level L (0.3 + 0.7 P / (P + 10 W)), P = 2 pi n mu F r: half of 20 N at the mean radius of the pin. The radius of what is removed is that of whole
  // voxels, 5 %, of which the level takes a quarter.
  for (const auto& [level, rpm] : {std::pair{0.1, 20000.0}, {0.2, 20000.0}, {0.1, 5000.0}}) {
    CAPTURE(level);
    CAPTURE(rpm);
    const Drilled run = drilled(fmt::format("sound={{motor_level={}, tooth_level=0.0, chip_level=0.0}}", level),
                                {fmt::format("tool.spin_rpm={}", rpm), fmt::format("tool.erosion_scale={}", 1000.0 / rpm)});
    const double power = kTurn * rpm / 60.0 * 0.5 * 20.0 * run.radius;
    const double expected = 0.5 * level * (0.3 + 0.7 * power / (power + 10.0)) / std::sqrt(kMotorPower);
    MESSAGE("power " << power << " W, amplitude " << run.amplitude(400.0) << ", expected " << expected);
    CHECK(run.amplitude(400.0) == doctest::Approx(expected).epsilon(0.0125).scale(0.0));
  }
}

TEST_CASE("sound of cutting: tooth_level gives the amplitude at the tooth passing frequency") {
  // Level L H^2 (h / 10 um)^(1/2), h the recorded removal of a step over the passes of the teeth and the area of the pin; its first harmonic
  // is that of a sum of powers of q = 0.5 + 0.35 H. The lag takes up the change of one step later, of 150.
  for (const double level : {0.3, 0.1}) {
    const Drilled run = drilled(fmt::format("sound={{motor_level=0.0, tooth_level={}, chip_level=0.0}}", level));
    const double passes = 1000.0 / 60.0 * kStep * run.teeth.count, q = 0.5 + 0.35 * kHardness;
    const double power = (1.0 - std::pow(q, 48)) / (1.0 - q * q);
    const double expected =
        0.5 * level * kHardness * kHardness * run.mean_root() / std::sqrt(passes * run.teeth.area * 10e-6) / std::sqrt(power);
    const double found = run.amplitude(1000.0 / 60.0 * run.teeth.count);
    MESSAGE(run.teeth.count << " teeth, amplitude " << found << ", expected " << expected);
    CHECK(found == doctest::Approx(expected).epsilon(0.02).scale(0.0));
  }
}

TEST_CASE("sound of cutting: chip_level gives the power of the noise") {
  // Level L H^2 (Q / 100 mm3/s)^(1/2), Q what a step removes over its time; a passing tooth leaves (1 - cos) / 2 of it, of which the mean square is 3/8.
  // Two bands of 800 Hz hold some 7500 independent values in 3 s: their root mean square has an error of 0.8 %, a fourth of the bound.
  for (const double level : {0.15, 0.6}) {
    const Drilled run = drilled(fmt::format("sound={{motor_level=0.0, tooth_level=0.0, chip_level={}}}", level));
    const double expected = 0.5 * level * kHardness * kHardness * run.mean_root() / std::sqrt(kStep * 100e-9) * std::sqrt(3.0 / 8.0);
    MESSAGE("rms " << run.rms() << ", expected " << expected);
    CHECK(run.rms() == doctest::Approx(expected).epsilon(0.03).scale(0.0));
  }
}

TEST_CASE("sound of cutting: it is the sum of motor, teeth and chips, each in proportion to its level, and all to volume") {
  // A tone starts with the first sound, so the motor is in all of them. A float of less than 0.25 is rounded by 7.5e-9; three times that and what else is
  // added are below 1e-7.
  constexpr double kRounding = 1e-7;
  const auto with = [](double volume, double motor, double tooth, double chip) {
    return drilled(fmt::format("sound={{volume={}, motor_level={}, tooth_level={}, chip_level={}}}", volume, motor, tooth, chip)).samples;
  };
  const std::vector<double> all = with(0.5, 0.1, 0.3, 0.15), motor = with(0.5, 0.1, 0.0, 0.0), louder = with(0.5, 0.2, 0.0, 0.0),
                            teeth = with(0.5, 0.1, 0.1, 0.0), chips = with(0.5, 0.1, 0.0, 0.6), quiet = with(0.11, 0.1, 0.3, 0.15);
  REQUIRE(std::ranges::max(all) < 0.25);
  std::vector<double> sum(all.size()), wrong(all.size()), halved(all.size()), scaled(all.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    sum[n] = motor[n] + 3.0 * (teeth[n] - motor[n]) + (chips[n] - motor[n]) / 4.0;
    wrong[n] = sum[n] + 0.1 * (chips[n] - motor[n]) / 4.0;
    halved[n] = louder[n] / 2.0;
    scaled[n] = quiet[n] * 0.5 / 0.11;
  }
  CHECK(largest_difference(all, sum) < kRounding);
  CHECK(largest_difference(motor, halved) < kRounding);
  CHECK(largest_difference(all, scaled) < kRounding);
  CHECK(largest_difference(all, wrong) > 1e-3);  // sabotage: a tenth more of the least of them
}

}  // namespace burrhole::test
