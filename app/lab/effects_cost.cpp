#include "app/lab/effects_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "app/job/plan.h"
#include "app/job/summary.h"
#include "app/run/simulation.h"
#include "app/scene/schema_samples.h"
#include "app/stage/requirement.h"

namespace burrhole {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNothing = 1e-9;  // [-] relative change of a figure that counts as none

/// A scene with an effect added or taken away, or with one key changed.
struct Trial {
  std::string table;
  std::vector<std::string> sets;
  std::vector<std::string> unsets;  ///< the table, before it those that require it
};

Result<TomlDocument> document_of(const EffectsCostOptions& options, const Trial& trial) {
  auto document = TomlDocument::load(options.scene_file);
  if (!document) return document.error();
  for (const std::string& set : trial.sets)
    if (const Status done = document->set(set); !done) return done.error();
  for (const std::string& unset : trial.unsets)
    if (const Status done = document->unset(unset); !done) return done.error();
  if (options.duration_s > 0.0)
    if (const Status done = document->set(fmt::format("duration_s={}", options.duration_s)); !done) return done.error();
  return document;
}

/// A simulation that is ready to run.
struct Ready {
  std::unique_ptr<LoadedScene> loaded;  // at a place of its own: the simulation refers to it
  std::unique_ptr<Simulation> simulation;
};

Result<Ready> prepare(const EffectsCostOptions& options, const Trial& trial) {
  const auto document = document_of(options, trial);
  if (!document) return document.error();
  Issues issues;
  auto read = load_scene(*document, options.context, issues);
  if (!read) return issues.front();
  auto loaded = std::make_unique<LoadedScene>(std::move(*read));
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
  if (!simulation) return issues.front();
  return Ready{std::move(loaded), std::move(simulation)};
}

double number_of(const Figures::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return *number;
  if (const std::uint64_t* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? 1.0 : 0.0;
  return kNone;
}

RunFigures figures_of(const RunSummary& summary, const std::string& table) {
  const auto or_none = [](const std::optional<double>& value) { return value.value_or(kNone); };
  RunFigures out{{"breakthrough_s", or_none(summary.breakthrough_s)},
                 {"plunge_mm", or_none(summary.plunge_mm)},
                 {"hole_diameter_mm", or_none(summary.hole_diameter_mm)},
                 {"removed_mass_mm3", summary.removed_mass_mm3},
                 {"reached_mm", summary.reached_mm},
                 {"peak_force_N", summary.peak_force_N}};
  for (const RunSummary::EffectCost& effect : summary.effects)
    if (effect.name == table)
      for (const auto& [name, value] : effect.figures.rows()) out.emplace_back(table + ": " + name, number_of(value));
  return out;
}

/// The figures of a run as numbers: CPU time [ms], bytes, the hash of bone and forces in parts that a double holds, and what figures_of() names.
constexpr std::size_t kFixed = 6;

Result<std::vector<double>> drill_once(const EffectsCostOptions& options, const Trial& trial) {
  auto ready = prepare(options, trial);
  if (!ready) return ready.error();
  const double start = cpu_now();
  if (const Status ran = ready->simulation->run(); !ran) return ran.error();
  const double cpu = cpu_now() - start;
  const Plan plan = make_plan(*ready->loaded);
  const RunSummary summary = make_summary(*ready->loaded, *ready->simulation, plan, cpu);
  double bytes = 0.0;
  for (const RunSummary::EffectCost& effect : summary.effects)
    if (effect.name == trial.table) bytes += static_cast<double>(effect.bytes);
  std::vector<double> out{1e3 * cpu / summary.duration_s, bytes};
  for (const std::string& hash : {summary.voxel_hash, summary.force_hash})
    for (const std::size_t half : {0u, 8u}) out.push_back(static_cast<double>(std::stoul(hash.substr(half, 8), nullptr, 16)));
  for (const auto& [name, value] : figures_of(summary, trial.table)) out.push_back(value);
  return out;
}

/// Runs trials, each as often as it is called for; keeps results.
class Bench {
 public:
  Bench(const EffectsCostOptions& options, std::size_t trials) : options_(options), study_(options.runs, trials) {}

  /// @param repeat number of the run of this trial.
  [[nodiscard]] Result<std::vector<double>> run(const Trial& trial, int repeat) {
    const auto names = names_of(trial);
    if (!names) return names.error();
    StudyTrial one{.key = {},
                   .name = fmt::format("[{}]{}{}", trial.table, trial.sets.empty() ? "" : " ", fmt::join(trial.sets, " ")),
                   .figures = kFixed + names->size()};
    one.key.add("effects")
        .add(options_.scene_file)
        .add(trial.table)
        .add(static_cast<double>(trial.unsets.size()))
        .add(repeat)
        .add(options_.duration_s);
    for (const std::string& set : trial.sets) one.key.add(set);
    return study_.run(one, [&] { return drill_once(options_, trial); });
  }

  /// @returns the names of the figures of a trial, from a run that is not begun.
  [[nodiscard]] Result<std::vector<std::string>> names_of(const Trial& trial) {
    const std::string key = trial.table + (!trial.unsets.empty() ? " without" : trial.sets.empty() ? "" : " with");
    if (const auto found = names_.find(key); found != names_.end()) return found->second;
    const auto ready = prepare(options_, trial);
    if (!ready) return ready.error();
    std::vector<std::string> out;
    for (const auto& [name, value] :
         figures_of(make_summary(*ready->loaded, *ready->simulation, make_plan(*ready->loaded), 0.0), trial.table))
      out.push_back(name);
    return names_.emplace(key, std::move(out)).first->second;
  }

 private:
  const EffectsCostOptions& options_;
  Study study_;
  std::map<std::string, std::vector<std::string>> names_;
};

EffectRun merged(std::vector<std::vector<double>> runs, const std::vector<std::string>& names) {
  std::vector<double> times;
  for (const std::vector<double>& run : runs) times.push_back(run[0]);
  EffectRun out{.cpu_ms = at_share(times, 0.5), .bytes = runs.front()[1], .bits = {}, .figures = {}};
  for (std::size_t n = 2; n < kFixed; ++n) out.bits += fmt::format("{:08x}", static_cast<std::uint32_t>(runs.front()[n]));
  for (std::size_t n = 0; n < names.size(); ++n) out.figures.emplace_back(names[n], runs.front()[kFixed + n]);
  return out;
}

/// @returns the assignments that give the scene this table, by lines as a scene has them.
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

/// Finds the smallest table with which the scene can be drilled: the empty one, or the first sample that works.
Trial trial_with(const EffectsCostOptions& options, const EffectEntry& effect, EffectPrice& price) {
  std::vector<std::string> tables{""};
  for (const std::string& sample : effect.samples)
    if (sample.find('[') == std::string::npos) tables.push_back(sample);
  for (const std::string& lines : tables) {
    Trial trial{effect.table, sets_of(effect.table, lines), {}};
    const auto ready = prepare(options, trial);
    if (ready) {
      price.refused.clear();
      price.given = lines.empty() ? fmt::format("[{}]", effect.table) : fmt::format("[{}] {}", effect.table, lines);
      std::replace(price.given.begin(), price.given.end(), '\n', ' ');
      return trial;
    }
    if (price.refused.empty()) price.refused = ready.error().message;
  }
  return {};
}

/// The numbers of a table that a scene with it may change, with their defaults.
std::vector<std::pair<std::string, double>> number_keys(const std::string& scene_text, const std::string& table) {
  std::vector<std::pair<std::string, double>> out;
  for (const KeyInfo& key : read_sample(SchemaFile::scene, scene_text).log.keys) {
    if (key.table != table || (key.kind != KeyKind::number && key.kind != KeyKind::integer)) continue;
    double value = 0.0;
    const auto [end, error] = std::from_chars(key.fallback.data(), key.fallback.data() + key.fallback.size(), value);
    if (error == std::errc() && end == key.fallback.data() + key.fallback.size()) out.emplace_back(key.key, value);
  }
  return out;
}

/// Names the figure that differs most between two runs.
void find_change(const EffectRun& before, const EffectRun& after, EffectKnob& out) {
  double most = kNothing;
  for (std::size_t n = 0; n < before.figures.size() && n < after.figures.size(); ++n) {
    const double a = before.figures[n].second, b = after.figures[n].second;
    const double scale = std::max(std::abs(a), std::abs(b));
    const double change = std::isnan(a) != std::isnan(b) ? 1.0 : scale > 0.0 ? std::abs(a - b) / scale : 0.0;
    if (!(change > most)) continue;
    most = change;
    out.figure = before.figures[n].first;
    out.before = a;
    out.after = b;
  }
}

Status measure_knobs(const EffectsCostOptions& options, const Trial& with, Bench& bench, EffectsCost& out) {
  const auto document = document_of(options, with);
  if (!document) return document.error();
  const auto names = bench.names_of(with);
  if (!names) return names.error();
  const auto base = bench.run(with, 0);
  if (!base) return base.error();
  const EffectRun before = merged({*base}, *names);
  for (const auto& [key, fallback] : number_keys(document->to_text(), with.table))
    for (const double factor : {0.5, 2.0}) {
      const double value = fallback != 0.0 ? factor * fallback : factor;
      Trial trial = with;
      if (trial.sets.size() == 1 && trial.sets.front().ends_with("={}")) trial.sets.clear();
      trial.sets.push_back(fmt::format("{}.{}={:.12g}", with.table, key, value));
      if (!prepare(options, trial)) continue;  // outside the key's range, or a contradiction
      const auto run = bench.run(trial, 0);
      if (!run) return run.error();
      const EffectRun after = merged({*run}, *names);
      EffectKnob knob{.table = with.table,
                      .key = key,
                      .value = value,
                      .fallback = fallback,
                      .figure = {},
                      .before = 0.0,
                      .after = 0.0,
                      .cpu_ms = after.cpu_ms,
                      .fallback_ms = before.cpu_ms};
      find_change(before, after, knob);
      out.knobs.push_back(std::move(knob));
    }
  return {};
}

}  // namespace

Result<EffectsCost> measure_effects_cost(const EffectsCostOptions& options) {
  EffectsCost out;
  std::vector<Trial> trials;
  const auto scene = TomlDocument::load(options.scene_file);
  if (!scene) return scene.error();
  Issues issues;
  const TableReader root = scene->root(issues);
  const auto as_it_is = prepare(options, {});
  if (!as_it_is) return as_it_is.error();
  for (const EffectEntry& effect : shipped_effects()) {
    if (effect.read == nullptr || (!options.only.empty() && options.only != effect.table)) continue;
    EffectPrice price;
    price.table = effect.table;
    price.named = root.has(effect.table);
    price.given = "as in the scene";
    Trial trial{effect.table, {}, {}};
    if (!price.named) {
      trial = trial_with(options, effect, price);
    } else {
      price.requiring = tables_that_require(effect.table, as_it_is->loaded->scene.effects, as_it_is->loaded->scene);
      trial.unsets = price.requiring;
      trial.unsets.emplace_back(effect.table);
      if (const auto ready = prepare(options, trial); !ready) price.refused = ready.error().message;
    }
    trials.push_back(std::move(trial));
    out.prices.push_back(std::move(price));
  }
  if (out.prices.empty()) return bad_input("there is no effect \"" + options.only + "\"; burrhole docs scene lists the tables");
  const auto possible = static_cast<std::size_t>(std::ranges::count_if(out.prices, [](const EffectPrice& p) { return p.refused.empty(); }));
  std::size_t values = 0;  // of keys
  for (std::size_t n = 0; n < trials.size() && options.knobs; ++n) {
    if (!out.prices[n].refused.empty()) continue;
    const auto document = document_of(options, out.prices[n].named ? Trial{trials[n].table, {}, {}} : trials[n]);
    if (document) values += 2 * number_keys(document->to_text(), trials[n].table).size();
  }
  Bench bench(options, 2 * possible * static_cast<std::size_t>(options.repeats) + values);
  for (std::size_t n = 0; n < trials.size(); ++n) {
    if (!out.prices[n].refused.empty()) continue;
    const Trial unchanged{trials[n].table, {}, {}};
    std::vector<std::vector<double>> scenes, others;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      auto scene_run = bench.run(unchanged, repeat);
      if (!scene_run) return scene_run.error();
      auto other_run = bench.run(trials[n], repeat);
      if (!other_run) return other_run.error();
      scenes.push_back(std::move(*scene_run));
      others.push_back(std::move(*other_run));
    }
    const auto names = bench.names_of(unchanged), other_names = bench.names_of(trials[n]);
    if (!names || !other_names) return names ? other_names.error() : names.error();
    out.prices[n].scene = merged(std::move(scenes), *names);
    out.prices[n].other = merged(std::move(others), *other_names);
    if (!options.knobs) continue;
    const Trial& with = out.prices[n].named ? unchanged : trials[n];
    if (const Status done = measure_knobs(options, with, bench, out); !done) return done.error();
  }
  return out;
}

}  // namespace burrhole
