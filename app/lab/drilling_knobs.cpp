#include "app/lab/drilling_knobs.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/units.h"
#include "core/drill/erosion.h"

namespace burrhole {
namespace {

Needs needs_of(const LoadedScene& loaded) { return loaded.scene.effects.needs(loaded.scene); }

double spacing(const LoadedScene& loaded) { return loaded.bone->bone_from_index().mean_edge() / kMillimetre; }
double erosion_rate(const LoadedScene& loaded) { return needs_of(loaded).simulation_hz; }
double substep(const LoadedScene& loaded) { return loaded.scene.find<ErosionConfig>()->longest_substep; }
double point_pitch(const LoadedScene& loaded) { return needs_of(loaded).erosion_pitch_voxels; }
double contact_rate(const LoadedScene& loaded) { return needs_of(loaded).contact_hz; }
double latency(const LoadedScene& loaded) {
  const Needs needs = needs_of(loaded);
  return needs.latency_ticks >= 0 ? needs.latency_ticks : loaded.scene.servo_hz / needs.contact_hz;
}
double coupling(const LoadedScene& loaded) { return needs_of(loaded).coupling_stiffness; }
double cutting(const LoadedScene& loaded) { return needs_of(loaded).cutting_stiffness; }
double record_bits(const LoadedScene& loaded) { return needs_of(loaded).fields.records == RecordPrecision::bits8 ? 8.0 : 16.0; }
double shell_pitch(const LoadedScene& loaded) {
  Issues issues;
  const auto tool = TomlDocument::parse(loaded.tool_text, loaded.tool.name);
  auto shell = tool ? tool->root(issues).table("shell", "") : std::nullopt;
  return shell ? shell->number("pitch_mm", {}, "") : DrillingResult::kNone;
}

template <const char* const& kKey>
void plain(double value, double, DrillingTrial& trial) {
  trial.sets.push_back(fmt::format("{}={:.6g}", kKey, value));
}

constexpr const char* kSpacing = "volume.spacing_mm";
constexpr const char* kErosionRate = "erosion.rate_hz";
constexpr const char* kSubstep = "erosion.substep_voxels";
constexpr const char* kPointPitch = "erosion.point_pitch_voxels";
constexpr const char* kShellPitch = "shell.pitch_mm";
constexpr const char* kContactRate = "contact.rate_hz";
constexpr const char* kLatency = "contact.latency_ticks";
constexpr const char* kCoupling = "contact.coupling_N_per_m";
constexpr const char* kCutting = "contact.cutting_N_per_m";
constexpr const char* kRecordBits = "contact.record_bits";

void set_shell_pitch(double value, double, DrillingTrial& trial) {
  trial.tool_sets.push_back(fmt::format("{}={:.6g}", kShellPitch, value));
}
/// Contact is not faster than the servo.
void set_contact_rate(double value, double, DrillingTrial& trial) {
  const int servo = StageConfig{}.servo_hz;
  if (value > servo) trial.sets.push_back(fmt::format("servo_hz={:.6g}", value));
  trial.sets.push_back(fmt::format("{}={:.6g}", kContactRate, value));
}
/// The erosion factors are scaled alike, so that the feed (F / K_cut) e s / h of the law stays. The reference is twice as stiff only: at four
/// times the default, leaving bone costs the hand 0.9 % of its force (docs/inputs.md), and it detects breakthrough too early.
void set_cutting(double value, double shipped, DrillingTrial& trial) {
  trial.sets.push_back(fmt::format("{}={:.6g}", kCutting, value));
  trial.sets.push_back(fmt::format("tool.erosion_scale={:.6g}", value / shipped));
}
void set_record_bits(double value, double, DrillingTrial& trial) { trial.sets.push_back(fmt::format("{}=\"{:g}\"", kRecordBits, value)); }

}  // namespace

const std::vector<DrillingKnob>& drilling_knobs() {
  static const std::vector<DrillingKnob> knobs{
      {kSpacing, "mm", {}, {0.6, 0.8, 1, 1.25, 2}, {1, 2}, 0.25, 0.5, spacing, plain<kSpacing>},
      {kErosionRate, "Hz", {}, {0.2, 0.5, 1, 2}, {0.5, 1}, 5, 5, erosion_rate, plain<kErosionRate>},
      {kSubstep, "voxels", {}, {0.5, 1, 2}, {1, 2}, 0.25, 0.25, substep, plain<kSubstep>},
      {kPointPitch, "voxels", {}, {0.5, 1, 2}, {1, 2}, 0.25, 0.5, point_pitch, plain<kPointPitch>},
      {kShellPitch, "mm", {}, {0.5, 1, 2}, {1, 2}, 0.25, 0.25, shell_pitch, set_shell_pitch},
      {kContactRate, "Hz", ", and the servo at that rate", {0.05, 0.1, 0.2, 0.5, 1}, {0.1, 1}, 4, 4, contact_rate, set_contact_rate},
      {kLatency, "ticks", {}, {1, 2, 5, 10}, {1, 10}, 0, 0, latency, plain<kLatency>},
      {kCoupling, "N/m", {}, {0.25, 0.5, 1, 2}, {0.5, 1}, 4, 4, coupling, plain<kCoupling>},
      {kCutting, "N/m", ", at the same feed", {0.25, 0.5, 1}, {0.5, 1}, 2, 2, cutting, set_cutting},
      {kRecordBits, "bits", {}, {0.5, 1}, {0.5, 1}, 1, 1, record_bits, set_record_bits},
  };
  return knobs;
}

double finest_value(const DrillingKnob& knob, const DrillingBit& bit, bool quick, double shipped) {
  const double value = (quick ? knob.quick_finest : knob.finest) * shipped;
  return knob.name == kSpacing ? std::max(value, bit.finest_mm) : value;
}

std::optional<double> second_value(const DrillingKnob& knob, const DrillingBit& bit, bool quick, double shipped) {
  const double finest = finest_value(knob, bit, quick, shipped);
  if (finest == 0.0 || finest == shipped) return std::nullopt;
  return finest < shipped ? 2.0 * finest : 0.5 * finest;
}

}  // namespace burrhole
