// A plan says exactly what will run and what will not; the summary says what came of it, key by key.

#include "app/engine/plan.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "app/engine/summary.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> kLater{"friction", "vibration", "clutch", "heat", "irrigation", "dust", "bleeding", "dura", "sound"};

std::vector<std::string> row_names(const Plan& plan) {
  std::vector<std::string> names;
  for (const PlanRow& row : plan.rows) names.push_back(row.effect.table);
  return names;
}

std::vector<std::string> with_later(std::vector<std::string> names) {
  names.insert(names.end(), kLater.begin(), kLater.end());
  return names;
}

TEST_CASE("plan: the rows are the tables, in the order of their steps, and the rest is not built") {
  const Plan least = make_plan(load_small({.contact = false, .erosion = false}));
  CHECK(row_names(least) == std::vector<std::string>{"volume", "hand"});
  CHECK(least.not_built == with_later({"contact", "erosion", "display", "record"}));
  CHECK(least.warnings.empty());

  const Plan drilling = make_plan(load_small({.record = true}));
  CHECK(row_names(drilling) == std::vector<std::string>{"volume", "hand", "contact", "erosion", "record"});
  CHECK(drilling.not_built == with_later({"display"}));
  CHECK(drilling.rows[1].rate_hz == 1000.0);
  CHECK(drilling.rows[2].rate_hz == 1000.0);
  CHECK(drilling.rows[3].rate_hz == 100.0);
  for (const PlanRow& row : drilling.rows) CHECK((row.bytes > 0 || row.effect.table == "hand"));
}

TEST_CASE("plan: the shipped scene has every row this version knows") {
  const auto document = TomlDocument::load(BH_SOURCE_DIR "/app/scenes/parietal.toml");
  REQUIRE(document);
  Issues issues;
  const auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  const Plan plan = make_plan(*loaded);
  CHECK(row_names(plan) == std::vector<std::string>{"volume", "hand", "contact", "erosion", "display", "record"});
  CHECK(plan.not_built == kLater);
  CHECK(plan.warnings.empty());
}

TEST_CASE("plan: warns of an engaged depth under a voxel, and of drilling that is not felt") {
  const Plan shallow = make_plan(load_small({.sets = {"contact.cutting_N_per_m=200e3"}}));
  REQUIRE(shallow.warnings.size() == 1);
  CHECK(shallow.warnings.front() ==
        "engaged depth push_N / cutting_N_per_m = 0.100 mm is under a voxel (0.250 mm): little will be cut; push with 50 N or "
        "more, or take a finer spacing_mm");
  const Plan unfelt = make_plan(load_small({.contact = false}));
  REQUIRE(unfelt.warnings.size() == 1);
  CHECK(unfelt.warnings.front() == "no [contact]: the hand feels nothing and the tool goes where the script goes");
}

TEST_CASE("explain: the JSON has the rows of the plan, times only when measured") {
  const LoadedScene loaded = load_small({});
  const Plan plan = make_plan(loaded);
  const Json json = Json::parse(plan_json(loaded, plan, nullptr));
  CHECK(json.at("schema") == 1);
  CHECK(json.at("scene") == "small.toml");
  CHECK(json.at("not_built").size() == plan.not_built.size());
  REQUIRE(json.at("effects").size() == plan.rows.size());
  for (const Json& effect : json.at("effects")) {
    CHECK(effect.at("steps").is_array());
    CHECK(effect.at("bytes").is_number_unsigned());
    CHECK(effect.at("time_us").is_null());
  }
}

Json summary_of(DrillRun& run) {
  return Json::parse(summary_json(make_summary(run.loaded(), run.run().simulation(), make_plan(run.loaded()), 1.0)));
}

TEST_CASE("summary: every promised key is there, with numbers where the run has them") {
  DrillRun run(SmallScene{.sets = {"tool.erosion_scale=4", "duration_s=1.1"}});
  const Json json = summary_of(run);
  CHECK(json.at("schema") == 1);
  CHECK(json.at("scene") == "small.toml");
  for (const char* key : {"dims", "spacing_mm", "bone_voxels", "bytes"}) CHECK_MESSAGE(json.at("volume").contains(key), std::string(key));
  for (const char* key : {"name", "haptic_points", "erosion_points"}) CHECK_MESSAGE(json.at("tool").contains(key), std::string(key));
  for (const char* key : {"removed_mm3", "removed_mass_mm3", "hole_diameter_mm", "inner_diameter_mm", "depth_mm", "thickness_mm",
                          "breakthrough_s", "plunge_mm", "peak_force_N", "angle_deg"}) {
    CAPTURE(std::string(key));
    REQUIRE(json.at("drilling").contains(key));
    CHECK(json.at("drilling").at(key).is_number());
  }
  for (const char* step : {"servo", "contact", "erosion", "gradient", "upload", "frame"})
    for (const char* key : {"count", "p50_us", "p99_us", "p999_us", "max_us"})
      CHECK_MESSAGE(json.at("timing").at(step).contains(key), std::string(step));
  CHECK(json.at("timing").at("missed") == 0);
  CHECK(json.at("memory").at("peak_bytes") > 0);
  for (const Json& effect : json.at("effects"))
    for (const char* key : {"name", "steps", "time_us", "bytes"}) CHECK_MESSAGE(effect.contains(key), std::string(key));
  CHECK(json.at("hash").at("voxels").get<std::string>().size() == 16);
  CHECK(json.at("hash").at("forces").get<std::string>().size() == 16);
  CHECK(json.at("hash").at("image").is_null());
  CHECK(json.at("timing").at("upload").at("count") == 0);
  CHECK(std::abs(json.at("drilling").at("thickness_mm").get<double>() - 3.0) < 1e-3);
}

TEST_CASE("summary: null where it does not apply") {
  DrillRun run(SmallScene{.erosion = false, .sets = {"duration_s=0.3"}});
  const Json json = summary_of(run);
  for (const char* key : {"hole_diameter_mm", "inner_diameter_mm", "depth_mm", "breakthrough_s", "plunge_mm"}) {
    CAPTURE(std::string(key));
    CHECK(json.at("drilling").at(key).is_null());
  }
  CHECK(json.at("drilling").at("removed_mm3") == 0.0);
  CHECK(json.at("tool").at("erosion_points") == 0);
}

}  // namespace
}  // namespace burrhole::test
