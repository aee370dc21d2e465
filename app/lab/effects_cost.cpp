#include "app/lab/effects_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/stage/requirement.h"

namespace burrhole {
namespace {

constexpr double kNothing = 1e-9;  // [-] relative change of a figure that counts as none

RunFigures figures_of(const RunSummary& summary, const std::string& table) {
  RunFigures out = run_figures(summary);
  for (const auto& [name, value] : effect_figures(summary, table)) out.emplace_back(table + ": " + name, value);
  return out;
}

/// The figures of a run as numbers: CPU time [ms], bytes, the hash of bone and forces in parts that a double holds, and what figures_of() names.
constexpr std::size_t kFixed = 6;

Result<std::vector<double>> drill_once(const EffectsCostOptions& options, const EffectTrial& trial) {
  const auto run = drill(options, trial);
  if (!run) return run.error();
  double bytes = 0.0;
  for (const RunSummary::EffectCost& effect : run->summary.effects)
    if (effect.name == trial.table) bytes += static_cast<double>(effect.bytes);
  std::vector<double> out{1e3 * run->cpu_s / run->summary.duration_s, bytes};
  for (const double part : bits_of(run->summary)) out.push_back(part);
  for (const auto& [name, value] : figures_of(run->summary, trial.table)) out.push_back(value);
  return out;
}

/// Runs trials, each as often as it is called for; keeps results.
class Bench {
 public:
  Bench(const EffectsCostOptions& options, std::size_t trials) : options_(options), study_(options.runs, trials) {}

  /// @param repeat number of the run of this trial.
  [[nodiscard]] Result<std::vector<double>> run(const EffectTrial& trial, int repeat) {
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
  [[nodiscard]] Result<std::vector<std::string>> names_of(const EffectTrial& trial) {
    const std::string key = trial.table + (!trial.unsets.empty() ? " without" : trial.sets.empty() ? "" : " with");
    if (const auto found = names_.find(key); found != names_.end()) return found->second;
    auto ready = prepare(options_, trial);
    if (!ready) return ready.error();
    std::vector<std::string> out;
    for (const auto& [name, value] : figures_of(summary_of(options_, *ready, 0.0), trial.table)) out.push_back(name);
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

/// The numbers of a table that a scene with it may change, with their defaults.
std::vector<std::pair<std::string, double>> number_keys(const EffectsCostOptions& options, const EffectTrial& trial) {
  std::vector<std::pair<std::string, double>> out;
  const auto log = keys_of(options, trial);
  if (!log) return out;
  for (const KeyInfo& key : log->keys)
    if (const auto value = default_of(key); value && key.table == trial.table) out.emplace_back(key.key, *value);
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

Status measure_knobs(const EffectsCostOptions& options, const EffectTrial& with, Bench& bench, EffectsCost& out) {
  const auto names = bench.names_of(with);
  if (!names) return names.error();
  const auto base = bench.run(with, 0);
  if (!base) return base.error();
  const EffectRun before = merged({*base}, *names);
  for (const auto& [key, fallback] : number_keys(options, with))
    for (const double factor : {0.5, 2.0}) {
      const double value = fallback != 0.0 ? factor * fallback : factor;
      EffectTrial trial = with;
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

/// An effect and the trial that its price compares with the scene.
struct Priced {
  EffectPrice price;
  EffectTrial trial;
};

Result<std::vector<Priced>> priced_effects(const EffectsCostOptions& options) {
  std::vector<Priced> out;
  const auto scene = TomlDocument::load(options.scene_file);
  if (!scene) return scene.error();
  Issues issues;
  const TableReader root = scene->root(issues);
  const auto as_it_is = prepare(options, {});
  if (!as_it_is) return as_it_is.error();
  for (const EffectEntry& effect : *options.context.registry) {
    if (effect.read == nullptr || !is_named(options.only, effect.table)) continue;
    EffectPrice price;
    price.table = effect.table;
    price.named = root.has(effect.table);
    price.given = "as in the scene";
    EffectTrial trial{effect.table};
    if (!price.named) {
      AddedTable added = added_table(options, effect);
      trial = std::move(added.trial);
      price.given = std::move(added.given);
      price.refused = std::move(added.refused);
    } else {
      price.requiring = tables_that_require(effect.table, as_it_is->loaded->scene.effects, as_it_is->loaded->scene);
      trial.unsets = price.requiring;
      trial.unsets.emplace_back(effect.table);
      if (const auto ready = prepare(options, trial); !ready) price.refused = ready.error().message;
    }
    out.push_back({std::move(price), std::move(trial)});
  }
  for (const std::string& table : options.only)
    if (std::ranges::none_of(out, [&](const Priced& effect) { return effect.price.table == table; }))
      return bad_input("there is no effect \"" + table + "\"; burrhole docs scene lists the tables");
  return out;
}

/// @returns the scene with an effect that is priced.
EffectTrial with_effect(const Priced& effect) { return effect.price.named ? EffectTrial{effect.price.table} : effect.trial; }

Status measure_price(const EffectsCostOptions& options, Priced& effect, Bench& bench) {
  const EffectTrial as_it_is{effect.price.table};
  std::vector<std::vector<double>> scenes, others;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    auto scene_run = bench.run(as_it_is, repeat);
    if (!scene_run) return scene_run.error();
    auto other_run = bench.run(effect.trial, repeat);
    if (!other_run) return other_run.error();
    scenes.push_back(std::move(*scene_run));
    others.push_back(std::move(*other_run));
  }
  const auto names = bench.names_of(as_it_is), other_names = bench.names_of(effect.trial);
  if (!names || !other_names) return names ? other_names.error() : names.error();
  effect.price.scene = merged(std::move(scenes), *names);
  effect.price.other = merged(std::move(others), *other_names);
  return {};
}

}  // namespace

Result<EffectsCost> measure_effects_cost(const EffectsCostOptions& options) {
  EffectsCost out;
  auto effects = priced_effects(options);
  if (!effects) return effects.error();
  const auto possible = static_cast<std::size_t>(std::ranges::count_if(*effects, [](const Priced& e) { return e.price.refused.empty(); }));
  std::size_t trials = options.prices ? 2 * possible * static_cast<std::size_t>(options.repeats) : 0;
  for (const Priced& effect : *effects)
    if (options.knobs && effect.price.refused.empty()) trials += 2 * number_keys(options, with_effect(effect)).size();
  Bench bench(options, trials);
  for (Priced& effect : *effects) {
    if (effect.price.refused.empty()) {
      if (options.prices)
        if (const Status done = measure_price(options, effect, bench); !done) return done.error();
      if (options.knobs)
        if (const Status done = measure_knobs(options, with_effect(effect), bench, out); !done) return done.error();
    }
    if (options.prices) out.prices.push_back(std::move(effect.price));
  }
  if (!options.ladders) return out;
  auto ladders = measure_ladders(options, options.only, options.runs);
  if (!ladders) return ladders.error();
  out.ladders = std::move(*ladders);
  return out;
}

}  // namespace burrhole
