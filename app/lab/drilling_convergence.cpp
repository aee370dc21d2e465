#include "app/lab/drilling_convergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/base/random.h"
#include "core/base/units.h"
#include "core/drill/erosion.h"

namespace burrhole {
namespace {

constexpr const char* kBits[] = {"ball 6 mm", "ball 2 mm", "flat 4 mm", "cone 8 mm", "perforator 14/11 mm", "trephine 12 mm"};
constexpr DrillingBone kBones[] = {DrillingBone::plate, DrillingBone::edge, DrillingBone::patch};
constexpr const char* kLaws[] = {"rate", "energy"};
constexpr double kSpacings[] = {0.15, 0.2, 0.25, 0.3125};  // [mm] finest first
constexpr int kRates[] = {500, 200, 100, 50};              // [Hz] finest first
constexpr int kSlowRate = 20;                              // [Hz] below the default
constexpr double kFactors[] = {0.02, 0.05, 0.1};           // [1/rev]
constexpr const char* kStepped = "stepped 9/6 mm";

// Bounds of a default scene: a hole within 3 %, its time within 5 %, which a hand cannot distinguish.
constexpr double kVolume = 3.0, kTime = 5.0;           // [%]
constexpr double kPlunge = 0.1, kPlungeVoxels = 0.25;  // [mm], [voxels]

DrillingTrial trial_of(const DrillingSetting& setting, DrillingHand hand, const std::vector<std::string>& sabotage) {
  DrillingTrial out{.bit = setting.bit, .bone = setting.bone, .hand = hand};
  if (setting.law) out.sets.push_back("erosion.law=" + *setting.law);
  if (setting.spacing_mm) out.sets.push_back(fmt::format("volume.spacing_mm={:g}", *setting.spacing_mm));
  if (setting.erosion_hz) out.sets.push_back(fmt::format("erosion.rate_hz={}", *setting.erosion_hz));
  out.sets.insert(out.sets.end(), sabotage.begin(), sabotage.end());
  return out;
}

DrillingSetting finest_of(DrillingSetting setting) {
  setting.spacing_mm = kSpacings[0];
  setting.erosion_hz = kRates[0];
  return setting;
}

/// What a scene takes that says nothing.
struct Defaults {
  std::string law;
  double spacing_mm;
  int erosion_hz;

  /// @returns the setting without what is a default anyway.
  [[nodiscard]] DrillingSetting without(DrillingSetting setting) const {
    if (setting.law == law) setting.law.reset();
    if (setting.spacing_mm && std::abs(*setting.spacing_mm - spacing_mm) < 1e-9) setting.spacing_mm.reset();
    if (setting.erosion_hz == erosion_hz) setting.erosion_hz.reset();
    return setting;
  }
};

Result<Defaults> defaults_of(const std::string& tool_folder) {
  const auto loaded = load_drilling({.bit = kBits[0]}, tool_folder);
  if (!loaded) return loaded.error();
  const ErosionConfig& erosion = *loaded->scene.find<ErosionConfig>();
  return Defaults{erosion.law == ErosionLaw::energy ? "energy" : "rate", loaded->bone->bone_from_index().mean_edge() / kMillimetre,
                  loaded->scene.effects.needs(loaded->scene).simulation_hz};
}

/// A corner of the box of voxel edges and rates, other than the finest one, with a bit, bone and law by chance.
DrillingSetting corner(std::uint64_t seed, std::uint64_t n) {
  std::uint64_t counter = 8 * n;
  const auto any = [&](std::size_t count) { return static_cast<std::size_t>(uniform01(seed, counter++) * static_cast<double>(count)); };
  DrillingSetting out{.bit = kBits[any(std::size(kBits))], .bone = kBones[any(std::size(kBones))], .law = kLaws[any(std::size(kLaws))]};
  const std::size_t which = 1 + any(3);
  out.spacing_mm = (which & 1u) != 0 ? kSpacings[std::size(kSpacings) - 1] : kSpacings[0];
  out.erosion_hz = (which & 2u) != 0 ? kRates[std::size(kRates) - 1] : kRates[0];
  return out;
}

double off(double value, double reference) { return 100.0 * std::abs(value / reference - 1.0); }

/// Largest error [%] of volume and mass, the smaller of those from the closed form and from the finest run if there is one.
struct HoleErrors {
  double volume, mass;
  [[nodiscard]] bool within() const { return volume <= kVolume && mass <= kVolume; }
};
HoleErrors hole_errors(const DrillingResult& bench, const DrillingResult* finest) {
  const RunSummary& s = bench.summary;
  HoleErrors out{off(s.removed_mm3, bench.volume_mm3), off(s.removed_mass_mm3, bench.volume_mm3)};
  if (finest != nullptr) {
    out.volume = std::min(out.volume, off(s.removed_mm3, finest->summary.removed_mm3));
    out.mass = std::min(out.mass, off(s.removed_mass_mm3, finest->summary.removed_mass_mm3));
  }
  return out;
}

/// The runs of one point.
struct PointRuns {
  const DrillingResult &bench, &script, &finest_script;
  const DrillingResult* finest_bench;  // null where the closed form is met
};

void judge(const DrillingSetting& setting, const PointRuns& runs, std::vector<StabilityRow>& rows) {
  const auto add = [&](const char* measure, double value, double bound) {
    rows.push_back({name_of(setting), setting.law.value_or("default law"), measure, value, bound, value <= bound});
  };
  const HoleErrors hole = hole_errors(runs.bench, runs.finest_bench);
  add("volume_off_percent", hole.volume, kVolume);
  add("mass_off_percent", hole.mass, kVolume);
  const auto stopped = [](const DrillingResult& run) { return unfinished_warning(run.summary) ? 1.0 : 0.0; };
  add("early_stops", stopped(runs.bench) + stopped(runs.script), 0.0);
  add("time_off_percent", off(runs.script.drilled_s, runs.finest_script.drilled_s), kTime);
  add("plunge_off_mm", std::abs(runs.script.plunge_mm - runs.finest_script.plunge_mm),
      kPlunge + kPlungeVoxels * runs.script.summary.spacing_mm);
}

std::vector<DrillingTrial> factor_trials(const std::vector<std::string>& sabotage) {
  std::vector<DrillingTrial> out;
  for (const double factor : kFactors) {
    out.push_back(trial_of({.bit = kStepped}, DrillingHand::script, sabotage));
    for (const int region : {0, 1}) out.back().tool_sets.push_back(fmt::format("region[{}].erosion_factor={:g}", region, factor));
  }
  return out;
}

StabilityRow judge_factors(std::span<const DrillingResult> results) {
  double not_falling = 0.0;
  for (std::size_t n = 1; n < results.size(); ++n) not_falling += results[n].drilled_s < results[n - 1].drilled_s ? 0.0 : 1.0;
  return {fmt::format("{}, factors {:g} to {:g}", kStepped, kFactors[0], kFactors[std::size(kFactors) - 1]),
          "default law",
          "time_not_falling",
          not_falling,
          0.0,
          not_falling <= 0.0};
}

}  // namespace

std::string name_of(const DrillingSetting& setting) {
  std::string out = setting.bit + ", " + name_of(setting.bone);
  if (setting.law) out += ", law " + *setting.law;
  if (setting.spacing_mm) out += fmt::format(", {:g} mm", *setting.spacing_mm);
  if (setting.erosion_hz) out += fmt::format(", {} Hz", *setting.erosion_hz);
  return out;
}

Result<std::vector<DrillingSetting>> convergence_settings(const ConvergenceOptions& options) {
  const auto defaults = defaults_of(options.runs.tool_folder);
  if (!defaults) return defaults.error();
  const DrillingSetting base{.bit = options.quick ? "flat 4 mm" : kBits[0]};
  std::vector<DrillingSetting> out{base};
  const auto add = [&](auto member, const auto& values) {
    for (const auto& value : values) {
      DrillingSetting one = base;
      one.*member = value;
      one = defaults->without(one);
      if (!(one == base)) out.push_back(one);
    }
  };
  if (options.quick) {
    add(&DrillingSetting::spacing_mm, std::array{kSpacings[3]});
    add(&DrillingSetting::erosion_hz, std::array{kSlowRate});
    return out;
  }
  add(&DrillingSetting::bit, kBits);
  add(&DrillingSetting::bone, kBones);
  add(&DrillingSetting::law, kLaws);
  add(&DrillingSetting::spacing_mm, kSpacings);
  add(&DrillingSetting::erosion_hz, kRates);
  add(&DrillingSetting::erosion_hz, std::array{kSlowRate});
  for (int n = 0; n < options.corners; ++n) out.push_back(defaults->without(corner(options.seed, static_cast<std::uint64_t>(n))));
  return out;
}

Result<std::vector<StabilityRow>> measure_convergence(const ConvergenceOptions& options) {
  const auto chosen = convergence_settings(options);
  if (!chosen) return chosen.error();
  const std::vector<DrillingSetting>& settings = *chosen;
  const std::size_t count = settings.size();
  const auto trials_of = [&](DrillingHand hand, bool finest) {
    std::vector<DrillingTrial> out;
    for (const DrillingSetting& setting : settings) out.push_back(trial_of(finest ? finest_of(setting) : setting, hand, options.sabotage));
    return out;
  };
  std::vector<DrillingTrial> trials;
  const auto append = [&](const std::vector<DrillingTrial>& more) { trials.insert(trials.end(), more.begin(), more.end()); };
  append(trials_of(DrillingHand::script, true));  // they take longest
  append(trials_of(DrillingHand::script, false));
  append(trials_of(DrillingHand::bench, false));
  if (!options.quick) append(factor_trials(options.sabotage));
  const auto results = run_drillings(trials, options.runs);
  if (!results) return results.error();
  const std::span<const DrillingResult> all(*results), benches = all.subspan(2 * count, count);
  // A finest hole takes minutes: only where the closed form is not met.
  std::vector<DrillingTrial> more;
  std::vector<std::optional<std::size_t>> finest_bench(count);
  for (std::size_t n = 0; n < count; ++n)
    if (!hole_errors(benches[n], nullptr).within()) {
      finest_bench[n] = more.size();
      more.push_back(trial_of(finest_of(settings[n]), DrillingHand::bench, options.sabotage));
    }
  const auto finest = run_drillings(more, options.runs);
  if (!finest) return finest.error();
  std::vector<StabilityRow> rows;
  for (std::size_t n = 0; n < count; ++n)
    judge(settings[n], {benches[n], all[count + n], all[n], finest_bench[n] ? &(*finest)[*finest_bench[n]] : nullptr}, rows);
  if (!options.quick) rows.push_back(judge_factors(all.subspan(3 * count)));
  return rows;
}

bool convergence_failed(const std::vector<StabilityRow>& rows) {
  return !std::ranges::all_of(rows, [](const StabilityRow& row) { return row.pass; });
}

}  // namespace burrhole
