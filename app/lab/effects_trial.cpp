#include "app/lab/effects_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>

#include "app/job/plan.h"
#include "app/lab/cost_row.h"

namespace burrhole {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double number_of(const Figures::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return *number;
  if (const std::uint64_t* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? 1.0 : 0.0;
  return kNone;
}

}  // namespace

bool is_named(const std::vector<std::string>& only, std::string_view table) {
  return only.empty() || std::ranges::find(only, table) != only.end();
}

Result<TomlDocument> document_of(const TrialScene& scene, const EffectTrial& trial) {
  auto document = TomlDocument::load(scene.scene_file);
  if (!document) return document.error();
  for (const std::string& set : trial.sets)
    if (const Status done = document->set(set); !done) return done.error();
  for (const std::string& unset : trial.unsets)
    if (const Status done = document->unset(unset); !done) return done.error();
  if (scene.duration_s > 0.0)
    if (const Status done = document->set(fmt::format("duration_s={}", scene.duration_s)); !done) return done.error();
  return document;
}

Result<ReadyTrial> prepare(const TrialScene& scene, const EffectTrial& trial) {
  const auto document = document_of(scene, trial);
  if (!document) return document.error();
  Issues issues;
  auto read = load_scene(*document, scene.context, issues);
  if (!read) return issues.front();
  auto loaded = std::make_unique<LoadedScene>(std::move(*read));
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
  if (!simulation) return issues.front();
  return ReadyTrial{std::move(loaded), std::move(simulation)};
}

RunSummary summary_of(const TrialScene& scene, ReadyTrial& ready, double wall_s) {
  return make_summary(*ready.loaded, *ready.simulation, make_plan(*ready.loaded, *scene.context.registry), wall_s);
}

Result<TrialRun> drill(const TrialScene& scene, const EffectTrial& trial) {
  auto ready = prepare(scene, trial);
  if (!ready) return ready.error();
  const double start = cpu_now();
  const auto wall_start = std::chrono::steady_clock::now();
  if (const Status ran = ready->simulation->run(); !ran) return ran.error();
  const double cpu = cpu_now() - start, wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  return TrialRun{cpu, wall, summary_of(scene, *ready, wall)};
}

double TrialRun::step_ms(std::string_view table) const {
  double us = 0.0;
  for (const RunSummary::EffectCost& effect : summary.effects)
    if (effect.name == table) us += effect.time_us;
  return 1e-3 * us / summary.duration_s * std::min(1.0, cpu_s / wall_s);
}

RunFigures run_figures(const RunSummary& summary) {
  const auto or_none = [](const std::optional<double>& value) { return value.value_or(kNone); };
  return {{"breakthrough_s", or_none(summary.breakthrough_s)},
          {"plunge_mm", or_none(summary.plunge_mm)},
          {"hole_diameter_mm", or_none(summary.hole_diameter_mm)},
          {"removed_mass_mm3", summary.removed_mass_mm3},
          {"reached_mm", summary.reached_mm},
          {"peak_force_N", summary.peak_force_N}};
}

RunFigures effect_figures(const RunSummary& summary, std::string_view table) {
  RunFigures out;
  for (const RunSummary::EffectCost& effect : summary.effects)
    if (effect.name == table)
      for (const auto& [name, value] : effect.figures.rows()) out.emplace_back(name, number_of(value));
  return out;
}

std::vector<double> bits_of(const RunSummary& summary) {
  std::vector<double> out;
  for (const std::string& hash : {summary.voxel_hash, summary.force_hash})
    for (const std::size_t half : {0u, 8u}) out.push_back(static_cast<double>(std::stoul(hash.substr(half, 8), nullptr, 16)));
  return out;
}

std::vector<std::string> sets_of(const std::string& table, const std::string& lines) {
  if (lines.empty()) return {table + "={}"};
  std::vector<std::string> out;
  for (std::size_t from = 0; from < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', from), lines.size());
    out.push_back(table + "." + lines.substr(from, end - from));
    from = end + 1;
  }
  return out;
}

AddedTable added_table(const TrialScene& scene, const EffectEntry& effect, const std::string& lines) {
  std::vector<std::string> tables{lines};
  if (lines.empty())
    for (const std::string& sample : effect.samples)
      if (sample.find('[') == std::string::npos) tables.push_back(sample);
  AddedTable out;
  for (const std::string& table : tables) {
    EffectTrial trial{effect.table, sets_of(effect.table, table)};
    const auto ready = prepare(scene, trial);
    if (!ready) {
      if (out.refused.empty()) out.refused = ready.error().message;
      continue;
    }
    out.given = table.empty() ? fmt::format("[{}]", effect.table) : fmt::format("[{}] {}", effect.table, table);
    std::ranges::replace(out.given, '\n', ' ');
    out.trial = std::move(trial);
    out.refused.clear();
    return out;
  }
  return out;
}

Result<KeyLog> keys_of(const TrialScene& scene, const EffectTrial& trial) {
  const auto document = document_of(scene, trial);
  if (!document) return document.error();
  Issues issues;
  KeyLog log;
  (void)read_scene(*document, scene.context, issues, &log);
  return log;
}

std::optional<double> default_of(const KeyInfo& key) {
  if (key.kind != KeyKind::number && key.kind != KeyKind::integer) return std::nullopt;
  double value = 0.0;
  const char* const last = key.fallback.data() + key.fallback.size();
  const auto [end, error] = std::from_chars(key.fallback.data(), last, value);
  return error == std::errc() && end == last ? std::optional(value) : std::nullopt;
}

}  // namespace burrhole
