// What accuracy costs: errors of a ladder against closed forms, an effect outside the program of known order, and the keys that each shipped effect
// names. No time is judged.
#include "app/lab/effects_accuracy.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/effect/registry.h"
#include "app/lab/effects_cost.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A ladder of figures that are functions of the setting; multiples are of the setting 1.
template <class Figure>
Ladder ladder_of(const std::vector<double>& settings, double reference, Figure figure) {
  Ladder out;
  const auto run = [&](double at) { return LadderRun{.setting = at, .multiple = at, .figures = figure(at)}; };
  for (const double at : settings) out.runs.push_back(run(at));
  out.reference = run(reference);
  return out;
}

// ---- an effect outside the program: figures that converge with a known order, and a key that does nothing

struct SeriesConfig {
  double step = 0.4;   // [mm]
  double inert = 1.0;  // [-] changes nothing
  double wild = 2.0;   // [-] without a limit
};

constexpr double kExact = 5.0, kSlope = 0.25, kSquare = 0.5;

class SeriesEffect final : public Effect {
 public:
  explicit SeriesEffect(const SeriesConfig& config) : config_(config) {}
  Status bind(StepGraph& graph) override {
    (void)graph.step(
        Clock::simulation, "series", "series", [](void* self, const Tick&) { ++static_cast<SeriesEffect*>(self)->steps_; }, this);
    return {};
  }
  void report(Figures& out) const override {
    const double h = config_.step;
    out.add("first_order_N", kExact + kSlope * h);
    out.add("second_order_N", kExact + kSquare * h * h);
    out.add("jumps_N", kExact + std::cos(std::numbers::pi * std::log2(config_.wild)));  // from one to the next power of two
  }

 private:
  SeriesConfig config_;
  std::uint64_t steps_ = 0;
};

class SeriesPlan final : public ConfigPlan<SeriesPlan, SeriesConfig> {
 public:
  explicit SeriesPlan(TableReader& table) {
    config_.step = table.number("step_mm", above_zero(config_.step, 1.0, 100.0), "step of a test");
    config_.inert = table.number("inert", above_zero(config_.inert, 1.0, 100.0), "changes nothing");
    config_.wild = table.number("wild", above_zero(config_.wild, 1.0, 100.0), "without a limit");
  }
  PlanRow row(const PlanContext& context) const override {
    return {.table = "series",
            .clock = Clock::simulation,
            .step = "series",
            .needs = "",
            .gives = "",
            .detail = "",
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = static_cast<std::uint64_t>(4000.0 / config_.step)};
  }
  Result<std::unique_ptr<Effect>> make(Stage&) const override { return std::unique_ptr<Effect>(std::make_unique<SeriesEffect>(config_)); }
};

EffectRegistry with_series() {
  EffectRegistry registry = shipped_effects();
  for (EffectEntry& effect : registry) effect.accuracy = {};  // only the effect of this test is measured
  registry.push_back(
      {"series",
       "figures of known order, for a test",
       [](TableReader& table, const StageConfig&, Issues&) -> std::unique_ptr<EffectPlan> { return std::make_unique<SeriesPlan>(table); },
       {},
       {.figures = {{"first_order_N"}, {"second_order_N"}, {"jumps_N"}},
        .knobs = {{"step_mm", {4, 2, 1}, 0.5}, {"inert", {2, 1}, 0.5}, {"wild", {4, 2, 1}, 0.5}}}});
  return registry;
}

TrialScene short_scene() {
  TrialScene out;
  out.scene_file = test::in_source("app/scenes/parietal.toml");
  out.context.tool_folders = {test::in_source("app/tools")};
  out.duration_s = 0.1;
  return out;
}

const Ladder& of_knob(const std::vector<Ladder>& ladders, const std::string& knob) {
  const auto found = std::ranges::find(ladders, knob, &Ladder::knob);
  REQUIRE(found != ladders.end());
  return *found;
}

}  // namespace

TEST_CASE("ladder: errors are differences from the reference, relative to it, to a stated scale or from a stated zero") {
  Ladder ladder = ladder_of({4, 2, 1}, 0.5, [](double h) { return std::vector<double>{8.0 + h, 0.01 * h, 37.0 + 20.0 + h}; });
  ladder.figures = {{"plain"}, {"near zero", 1.0}, {"temperature", 0.0, 37.0}};
  const auto errors = ladder_errors(ladder);
  REQUIRE(errors.size() == 3);
  for (std::size_t n = 0; n < 3; ++n) {
    const double h = ladder.runs[n].setting;
    CHECK(errors[0].errors[n] == doctest::Approx((h - 0.5) / 8.5));
    CHECK(errors[1].errors[n] == doctest::Approx(0.01 * (h - 0.5)));  // the reference, 0.005, is below the scale
    CHECK(errors[2].errors[n] == doctest::Approx((h - 0.5) / 20.5));
  }
  for (const FigureErrors& figure : errors) CHECK(figure.trend == LadderTrend::falls);
  // Of the first order the reference has the error of the finest run over (ratio - 1): here 0.5 of the limit 8.
  CHECK(errors[0].own * 8.5 == doctest::Approx(0.5));
}

TEST_CASE("ladder: what does not act, does not converge or is absent is not taken for accurate") {
  Ladder ladder = ladder_of({4, 2, 1}, 0.5, [](double h) {
    return std::vector<double>{3.0, h == 2.0 ? 9.0 : 3.0 + 0.1 * h, kNone, h == 4.0 ? kNone : 3.0, 3.0 + 0.2 * (h > 0.5 ? 1.0 : 0.0)};
  });
  ladder.figures = {{"constant"}, {"jumps"}, {"none"}, {"absent once"}, {"the same error"}};
  const auto errors = ladder_errors(ladder);
  CHECK(errors[0].trend == LadderTrend::unaffected);
  CHECK(errors[1].trend == LadderTrend::stays);
  CHECK(errors[2].trend == LadderTrend::none);
  CHECK(errors[3].trend == LadderTrend::stays);
  CHECK(errors[4].trend == LadderTrend::stays);
  CHECK(has_effect(errors));

  ladder.figures = {{"constant"}};
  for (LadderRun& run : ladder.runs) run.figures.resize(1);
  ladder.reference.figures.resize(1);
  CHECK_FALSE(has_effect(ladder_errors(ladder)));
  ladder.knob = "series.inert";
  for (const auto& row : ladder_rows({ladder})) {
    CHECK(std::isnan(row.error));
    CHECK(row.error_name == "constant: without effect");
  }
  for (const auto& row : ladder_cells({ladder})) CHECK((row[3] == "without effect" || row[3] == "reference"));
  REQUIRE(ladder_notes({ladder}).size() == 1);
  CHECK(ladder_notes({ladder}).front().find("without effect") != std::string::npos);
  CHECK(ladder_plot({ladder}).panels.empty());
  EffectsCost cost;
  cost.ladders = {ladder};
  const std::string json = effects_cost_json(cost);
  CHECK(json.find("\"has_effect\": false") != std::string::npos);
  CHECK(json.find("\"constant\": null") != std::string::npos);
}

TEST_CASE("ladder: a key without a run of its reference has no errors, and a line that says why") {
  Ladder ladder;
  ladder.knob = "series.step_mm";
  ladder.figures = {{"plain"}};
  ladder.refused = {"series.step_mm=0: must be above 0"};
  CHECK_FALSE(has_effect(ladder_errors(ladder)));
  CHECK(ladder_rows({ladder}).empty());
  CHECK(ladder_cells({ladder}).empty());
  REQUIRE(ladder_notes({ladder}).size() == 1);
  CHECK(ladder_notes({ladder}).front().find("must be above 0") != std::string::npos);
  CHECK(ladder_plot({ladder}).panels.empty());
  CHECK(general_ladder_plot({ladder}).panels.empty());
  EffectsCost cost;
  cost.ladders = {ladder};
  const std::string json = effects_cost_json(cost);
  CHECK(json.find("\"series.step_mm=0: must be above 0\"") != std::string::npos);
  CHECK(json.find("\"reference\": null") != std::string::npos);
}

TEST_CASE(
    "ladder: an effect with which the scene cannot be drilled is named with the reason, and its own table is not replaced by another") {
  EffectRegistry registry = with_series();
  registry.back().accuracy.table = "step_mm = 1000";
  TrialScene scene = short_scene();
  scene.context.registry = &registry;
  const auto ladders = measure_ladders(scene, {}, {});
  REQUIRE(ladders);
  REQUIRE(ladders->size() == 1);
  const Ladder& ladder = ladders->front();
  CHECK(ladder.table == "series");
  CHECK(ladder.runs.empty());
  REQUIRE(ladder.refused.size() == 1);
  CHECK(ladder.refused.front().find("step_mm") != std::string::npos);
  REQUIRE(ladder_notes(*ladders).size() == 1);
  CHECK(ladder_notes(*ladders).front().find("[series]: not drilled: ") == 0);
  CHECK(ladder_rows(*ladders).empty());
  CHECK(ladder_plot(*ladders).panels.empty());
  EffectsCost cost;
  cost.ladders = *ladders;
  CHECK(effects_cost_json(cost).find("\"key\": null") != std::string::npos);
}

TEST_CASE("ladder: an effect outside the program gets the errors of its closed forms, and an inert key is named") {
  const EffectRegistry registry = with_series();
  TrialScene scene = short_scene();
  scene.context.registry = &registry;
  const auto ladders = measure_ladders(scene, {}, {});
  REQUIRE(ladders);
  const Ladder& step = of_knob(*ladders, "series.step_mm");
  REQUIRE(step.runs.size() == 3);
  const auto errors = ladder_errors(step);
  const double finest = 0.2;
  for (std::size_t n = 0; n < 3; ++n) {
    const double h = step.runs[n].setting;
    CHECK(h == doctest::Approx(std::vector{1.6, 0.8, 0.4}[n]));
    CHECK(errors[0].errors[n] == doctest::Approx(kSlope * (h - finest) / (kExact + kSlope * finest)));
    CHECK(errors[1].errors[n] == doctest::Approx(kSquare * (h * h - finest * finest) / (kExact + kSquare * finest * finest)));
    CHECK(step.runs[n].bytes == std::floor(4000.0 / h));
    CHECK(step.runs[n].time_ms > 0.0);
  }
  CHECK(errors[0].trend == LadderTrend::falls);
  CHECK(errors[1].trend == LadderTrend::falls);
  CHECK(errors[2].trend == LadderTrend::unaffected);
  CHECK_FALSE(has_effect(ladder_errors(of_knob(*ladders, "series.inert"))));
  CHECK(ladder_errors(of_knob(*ladders, "series.wild"))[2].trend == LadderTrend::stays);
  const Ladder& spacing = of_knob(*ladders, "volume.spacing_mm");  // acts on all, but not on these figures
  CHECK(spacing.general);
  CHECK_FALSE(has_effect(ladder_errors(spacing)));
}

TEST_CASE("ladder: the keys and figures that effects name are in their tables and reports, and references are finer than what is shown") {
  std::size_t knobs = 0;
  for (const EffectEntry& effect : shipped_effects()) {
    CAPTURE(effect.table);
    const EffectAccuracy& accuracy = effect.accuracy;
    if (!accuracy.knobs.empty()) CHECK_FALSE(accuracy.figures.empty());
    if (accuracy.figures.empty()) continue;
    const TrialScene scene = short_scene();
    const auto plain = TomlDocument::load(scene.scene_file);
    REQUIRE(plain);
    Issues issues;
    const bool named = plain->root(issues).has(effect.table);
    AddedTable added;
    if (!named) added = added_table(scene, effect, accuracy.table);
    CHECK(added.refused == "");
    if (!accuracy.table.empty()) CHECK(added.trial.sets == sets_of(effect.table, accuracy.table));
    const auto log = keys_of(scene, added.trial);
    REQUIRE(log);
    const auto has_key = [&](const std::string& name) {
      return std::ranges::any_of(log->keys, [&](const KeyInfo& key) {
        return (key.table.empty() ? key.key : key.table + "." + key.key) == name && default_of(key).has_value();
      });
    };
    for (const AccuracyKnob& knob : accuracy.knobs) {
      CAPTURE(knob.key);
      CHECK(has_key(std::string(effect.table) + "." + knob.key));
      for (const AccuracyCompanion& along : knob.along) CHECK(has_key(along.key));
      CHECK(std::ranges::count(knob.multiples, 1.0) == 1);
      const bool falls = knob.reference < 1.0;
      for (std::size_t n = 0; n < knob.multiples.size(); ++n) {
        const double next = n + 1 < knob.multiples.size() ? knob.multiples[n + 1] : knob.reference;
        CHECK((falls ? next < knob.multiples[n] : next > knob.multiples[n]));
      }
      ++knobs;
    }
    CHECK_FALSE(has_key(std::string(effect.table) + ".no_such_key"));
  }
  CHECK(knobs >= 10);
}
