// The study of effects: every effect of the registry is priced or refused with a reason; what only watches changes no bit; keys are varied. No
// time is judged.
#include "app/lab/effects_cost.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/effect/registry.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

EffectsCostOptions short_runs() {
  EffectsCostOptions out;
  out.scene_file = test::in_source("app/scenes/parietal.toml");
  out.context.tool_folders = {test::in_source("app/tools")};
  out.repeats = 1;
  out.duration_s = 2.5;  // the bit reaches bone within the first second, and cuts after the second
  out.knobs = false;
  out.ladders = false;
  return out;
}

}  // namespace

TEST_CASE("cost of effects: each of the registry is measured, or refused with a reason, and those that watch change no bit") {
  const auto cost = measure_effects_cost(short_runs());
  REQUIRE(cost);
  std::set<std::string> tables;
  for (const EffectPrice& price : cost->prices) {
    CAPTURE(price.table);
    tables.insert(price.table);
    if (!price.refused.empty()) continue;
    CHECK(price.scene.bits.size() == 32);
    CHECK(price.scene.bits == cost->prices.front().scene.bits);  // the scene itself is the same each time
    CHECK(price.scene.cpu_ms > 0.0);
    CHECK(price.other.cpu_ms > 0.0);
    for (const char* watcher : {"heat", "irrigation", "sound", "record"})
      if (price.table == watcher) CHECK(price.other.bits == price.scene.bits);
    for (const char* changer : {"contact", "erosion", "friction"})
      if (price.table == changer) CHECK(price.other.bits != price.scene.bits);
  }
  std::set<std::string> registered;
  for (const EffectEntry& effect : shipped_effects())
    if (effect.read != nullptr) registered.insert(effect.table);
  CHECK(tables == registered);
  CHECK(std::ranges::count_if(cost->prices, [](const EffectPrice& price) { return price.refused.empty(); }) >= 8);
  CHECK(effects_cost_rows(*cost).size() > 5);
  CHECK(effects_cost_json(*cost).find("\"table\": \"heat\"") != std::string::npos);
}

TEST_CASE("cost of effects: keys at half and twice their default, and the figure that each changes") {
  EffectsCostOptions options = short_runs();
  options.knobs = true;
  options.only = {"irrigation"};
  const auto cost = measure_effects_cost(options);
  REQUIRE(cost);
  REQUIRE(cost->prices.size() == 1);
  CHECK(cost->prices.front().given == "[irrigation]");
  const auto flow =
      std::ranges::find_if(cost->knobs, [](const EffectKnob& knob) { return knob.key == "flow_ml_per_min" && knob.value > knob.fallback; });
  REQUIRE(flow != cost->knobs.end());
  CHECK(flow->value == 2.0 * flow->fallback);
  CHECK(flow->figure == "irrigation: delivered_ml");
  CHECK(std::abs(flow->after - 2.0 * flow->before) < 1e-9 * flow->after);
  // The saline cools nothing without [heat]: its temperature changes no figure, and the study says so.
  const auto warm = std::ranges::find_if(cost->knobs, [](const EffectKnob& knob) { return knob.key == "temperature_C"; });
  REQUIRE(warm != cost->knobs.end());
  CHECK(warm->figure.empty());
}

TEST_CASE("cost of effects: an effect that there is not is an error that names where they are listed") {
  EffectsCostOptions options = short_runs();
  options.only = {"heat", "heta"};
  const auto cost = measure_effects_cost(options);
  REQUIRE_FALSE(cost);
  CHECK(cost.error().message.find("burrhole docs scene") != std::string::npos);
}
