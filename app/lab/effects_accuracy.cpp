#include "app/lab/effects_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace burrhole {
namespace {

constexpr std::size_t kBits = 4;   // numbers of bits_of()
constexpr std::size_t kCosts = 2;  // time and memory of an effect, before its figures

/// The edge of the voxels belongs to no effect. At half the edge there are eight times the voxels.
const AccuracyKnob kSpacing{.key = "spacing_mm", .multiples = {1.6, 1, 0.7}, .reference = 0.5, .of_all = true};

struct NamedKnob {
  std::string table;
  AccuracyKnob knob;
  [[nodiscard]] std::string name() const { return table + "." + knob.key; }
};

/// Effects that are drilled in one run: the scene with the tables of some.
struct Group {
  std::string name;
  std::vector<std::string> sets;
  std::vector<const EffectEntry*> effects;  ///< whose figures are taken
};

/// What one run of a group gives.
struct GroupRun {
  std::vector<double> bits;
  std::vector<LadderRun> effects;  ///< in the order of Group::effects
};

double figure_of(const RunFigures& own, const RunFigures& of_run, const std::string& name) {
  for (const RunFigures* figures : {&own, &of_run})
    for (const auto& [known, value] : *figures)
      if (known == name) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

Result<std::vector<double>> drill_group(const TrialScene& scene, const Group& group, const EffectTrial& trial) {
  const auto run = drill(scene, trial);
  if (!run) return run.error();
  std::vector<double> out = bits_of(run->summary);
  const RunFigures of_run = run_figures(run->summary);
  for (const EffectEntry* effect : group.effects) {
    double bytes = 0.0;
    for (const RunSummary::EffectCost& cost : run->summary.effects)
      if (cost.name == effect->table) bytes += static_cast<double>(cost.bytes);
    out.insert(out.end(), {run->step_ms(effect->table), bytes});
    const RunFigures own = effect_figures(run->summary, effect->table);
    for (const AccuracyFigure& figure : effect->accuracy.figures) out.push_back(figure_of(own, of_run, figure.name));
  }
  return out;
}

/// Runs groups and keeps results: a run that several keys share is drilled once.
class LadderBench {
 public:
  LadderBench(const TrialScene& scene, const StudyRuns& runs, std::size_t trials) : scene_(scene), study_(runs, trials) {}

  [[nodiscard]] Result<GroupRun> run(const Group& group, const std::vector<std::string>& sets) {
    EffectTrial trial{group.name, group.sets};
    for (const std::string& set : sets) {
      // An empty table that gets keys need not be named before.
      std::erase(trial.sets, set.substr(0, set.find('.')) + "={}");
      trial.sets.push_back(set);
    }
    StudyTrial one{.key = {},
                   .name = fmt::format("{}: {}", group.name, sets.empty() ? "as it is" : fmt::format("{}", fmt::join(sets, " "))),
                   .figures = kBits};
    one.key.add("ladder").add(scene_.scene_file).add(scene_.duration_s).add(group.name);
    for (const std::string& set : trial.sets) one.key.add(set);
    for (const EffectEntry* effect : group.effects) {
      one.figures += kCosts + effect->accuracy.figures.size();
      for (const AccuracyFigure& figure : effect->accuracy.figures) one.key.add(figure.name);
    }
    if (const auto found = done_.find(one.key.text()); found != done_.end()) return found->second;
    const auto figures = study_.run(one, [&] { return drill_group(scene_, group, trial); });
    if (!figures) return figures.error();
    return done_.emplace(one.key.text(), read(group, *figures)).first->second;
  }

 private:
  static GroupRun read(const Group& group, const std::vector<double>& figures) {
    GroupRun out{{figures.begin(), figures.begin() + kBits}, {}};
    auto at = figures.begin() + kBits;
    for (const EffectEntry* effect : group.effects) {
      LadderRun run{.time_ms = at[0], .bytes = at[1], .figures = {}};
      at += kCosts;
      const auto end = at + static_cast<std::ptrdiff_t>(effect->accuracy.figures.size());
      run.figures.assign(at, end);
      at = end;
      out.effects.push_back(std::move(run));
    }
    return out;
  }

  TrialScene scene_;
  Study study_;
  std::map<std::string, GroupRun> done_;
};

/// A key of a scene, with its value there.
struct KeyValue {
  double value = 0.0;
  bool whole = false;
};

/// @returns the value of "table.key" in a scene: its own, or the default; nothing if it is no number or has no default.
std::optional<KeyValue> value_of(const TomlDocument& document, const KeyLog& log, const std::string& name) {
  for (const KeyInfo& key : log.keys) {
    if ((key.table.empty() ? key.key : key.table + "." + key.key) != name) continue;
    const bool whole = key.kind == KeyKind::integer;
    if (!key.present) {
      const auto value = default_of(key);
      return value ? std::optional(KeyValue{*value, whole}) : std::nullopt;
    }
    if (!whole && key.kind != KeyKind::number) return std::nullopt;
    Issues ignored;
    TableReader at = document.root(ignored);
    for (std::size_t from = 0; from < key.table.size();) {
      const std::size_t end = std::min(key.table.find('.', from), key.table.size());
      auto inner = at.table(key.table.substr(from, end - from), "");
      if (!inner) return std::nullopt;
      at = *inner;
      from = end + 1;
    }
    return KeyValue{at.number(key.key, {}, ""), whole};
  }
  return std::nullopt;
}

struct Assignment {
  double setting = 0.0;
  std::string text;
};

/// @returns the assignments of a multiple of a knob, the knob's first; none if the scene has no such number.
Result<std::vector<Assignment>> assignments(const TrialScene& scene, const Group& group, const NamedKnob& knob, double multiple) {
  const EffectTrial trial{group.name, group.sets};
  const auto document = document_of(scene, trial);
  if (!document) return document.error();
  const auto log = keys_of(scene, trial);
  if (!log) return log.error();
  std::vector<std::pair<std::string, double>> keys{{knob.name(), 1.0}};
  for (const AccuracyCompanion& along : knob.knob.along) keys.emplace_back(along.key, along.power);
  std::vector<Assignment> out;
  for (const auto& [key, power] : keys) {
    const auto base = value_of(*document, *log, key);
    if (!base) return std::vector<Assignment>{};
    const double value = base->value * std::pow(multiple, power);
    const double setting = base->whole ? std::round(value) : value;
    out.push_back({setting, fmt::format("{}={:.12g}", key, setting)});
  }
  return out;
}

/// Measures one key with a group; adds a ladder for each of its effects.
Status climb(const TrialScene& scene, const Group& group, const NamedKnob& knob, LadderBench& bench, std::vector<Ladder>& out) {
  const std::size_t first = out.size();
  for (const EffectEntry* effect : group.effects) {
    Ladder ladder{.table = effect->table,
                  .knob = knob.name(),
                  .general = knob.knob.of_all,
                  .figures = effect->accuracy.figures,
                  .runs = {},
                  .reference = {},
                  .along = {},
                  .refused = {}};
    for (const AccuracyCompanion& along : knob.knob.along) ladder.along.push_back(along.key);
    out.push_back(std::move(ladder));
  }
  std::vector<double> multiples = knob.knob.multiples;
  multiples.push_back(knob.knob.reference);
  for (const double multiple : multiples) {
    const auto values = assignments(scene, group, knob, multiple);
    if (!values) return values.error();
    if (values->empty()) break;
    std::vector<std::string> sets;
    for (const Assignment& value : *values) sets.push_back(value.text);
    const auto run = bench.run(group, multiple == 1.0 ? std::vector<std::string>{} : sets);
    if (!run && multiple == 1.0) return run.error();
    for (std::size_t n = 0; n < group.effects.size(); ++n) {
      Ladder& ladder = out[first + n];
      if (!run) {
        ladder.refused.push_back(fmt::format("{}: {}", sets.front(), run.error().message));
        continue;
      }
      LadderRun one = run->effects[n];
      one.setting = values->front().setting;
      one.multiple = multiple;
      if (multiple == knob.knob.reference)
        ladder.reference = std::move(one);
      else
        ladder.runs.push_back(std::move(one));
    }
  }
  for (std::size_t n = first; n < out.size(); ++n)
    if (out[n].reference.figures.empty()) out[n].runs.clear();  // without the run of the reference there is no error
  std::erase_if(out, [](const Ladder& ladder) { return ladder.runs.empty() && ladder.refused.empty(); });  // the scene has no such key
  return {};
}

/// @returns the keys that act on every effect and that this scene has.
std::vector<NamedKnob> general_knobs(const EffectRegistry& registry, const TableReader& root) {
  std::vector<NamedKnob> out{{"volume", kSpacing}};
  for (const EffectEntry& effect : registry)
    for (const AccuracyKnob& knob : effect.accuracy.knobs)
      if (knob.of_all && root.has(effect.table)) out.push_back({effect.table, knob});
  return out;
}

std::size_t trials_of(const std::vector<Group>& own, const std::vector<NamedKnob>& general, std::size_t groups) {
  std::size_t out = own.size() + groups;
  for (const Group& group : own)
    for (const EffectEntry* effect : group.effects)
      for (const AccuracyKnob& knob : effect->accuracy.knobs)
        if (!knob.of_all) out += knob.multiples.size();
  for (const NamedKnob& knob : general) out += groups * knob.knob.multiples.size();
  return out;
}

/// @returns a group for each effect that names figures: the scene with its table. @param refused receives a ladder without runs for each effect with
/// which the scene cannot be drilled.
std::vector<Group> groups_of(const TrialScene& scene, const std::vector<std::string>& only, const TableReader& root,
                             std::vector<Ladder>& refused) {
  std::vector<Group> out;
  for (const EffectEntry& effect : *scene.context.registry) {
    if (effect.read == nullptr || effect.accuracy.figures.empty() || !is_named(only, effect.table)) continue;
    Group group{effect.table, {}, {&effect}};
    if (!root.has(effect.table)) {
      AddedTable added = added_table(scene, effect, effect.accuracy.table);
      if (!added.refused.empty()) {
        Ladder ladder;
        ladder.table = effect.table;
        ladder.refused.push_back(std::move(added.refused));
        refused.push_back(std::move(ladder));
        continue;
      }
      group.sets = std::move(added.trial.sets);
    }
    out.push_back(std::move(group));
  }
  return out;
}

/// @returns the groups for keys that act on all: effects that change neither bone nor forces share one, with those of the scene.
Result<std::vector<Group>> shared_groups(const std::vector<Group>& own, LadderBench& bench) {
  std::vector<Group> out;
  const auto plain = bench.run({"scene", {}, {}}, {});
  if (!plain) return plain.error();
  Group shared{"all that watch", {}, {}};
  for (const Group& group : own) {
    const auto run = bench.run(group, {});
    if (!run) return run.error();
    if (run->bits != plain->bits) {
      out.push_back(group);
      continue;
    }
    shared.sets.insert(shared.sets.end(), group.sets.begin(), group.sets.end());
    shared.effects.push_back(group.effects.front());
  }
  if (!shared.effects.empty()) out.insert(out.begin(), std::move(shared));
  return out;
}

}  // namespace

Result<std::vector<Ladder>> measure_ladders(const TrialScene& scene, const std::vector<std::string>& only, const StudyRuns& runs) {
  const auto document = TomlDocument::load(scene.scene_file);
  if (!document) return document.error();
  Issues issues;
  const TableReader root = document->root(issues);
  std::vector<Ladder> out;
  const std::vector<Group> own = groups_of(scene, only, root, out);
  const std::vector<NamedKnob> general = general_knobs(*scene.context.registry, root);
  if (own.empty()) return out;
  LadderBench bench(scene, runs, trials_of(own, general, own.size()));
  for (const Group& group : own)
    for (const AccuracyKnob& knob : group.effects.front()->accuracy.knobs) {
      if (knob.of_all) continue;
      if (const Status done = climb(scene, group, {group.name, knob}, bench, out); !done) return done.error();
    }
  const auto shared = shared_groups(own, bench);
  if (!shared) return shared.error();
  for (const NamedKnob& knob : general)
    for (const Group& group : *shared)
      if (const Status done = climb(scene, group, knob, bench, out); !done) return done.error();
  return out;
}

}  // namespace burrhole
