// A plan says exactly what will run and what will not; the summary says what came of it, key by key.

#include "app/job/plan.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "app/job/summary.h"
#include "tests/support/drill_scene.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {
namespace {

using Json = nlohmann::json;

/// All tables of the registry but those of the scene, in its order.
std::vector<std::string> all_but(const std::set<std::string>& built) {
  std::vector<std::string> names;
  for (const EffectEntry& effect : shipped_effects())
    if (!built.contains(effect.table)) names.emplace_back(effect.table);
  return names;
}

std::vector<std::string> row_names(const Plan& plan) {
  std::vector<std::string> names;
  for (const PlanRow& row : plan.rows) names.push_back(row.table);
  return names;
}

TEST_CASE("plan: the rows are the tables, in the order of their steps, and the rest is not built") {
  const Plan least = make_plan(load_small({.contact = false, .erosion = false}));
  CHECK(row_names(least) == std::vector<std::string>{"volume", "hand"});
  CHECK(least.not_built == all_but({}));
  CHECK(least.warnings.empty());

  const Plan drilling = make_plan(load_small({.record = true, .sets = {"erosion.rate_hz=200"}}));
  CHECK(row_names(drilling) == std::vector<std::string>{"volume", "publish", "hand", "contact", "erosion", "record"});
  CHECK(drilling.not_built == all_but({"contact", "erosion", "record"}));
  CHECK(drilling.rows[1].rate_hz == 200.0);
  CHECK(drilling.rows[2].rate_hz == 1000.0);
  CHECK(drilling.rows[3].rate_hz == 1000.0);
  CHECK(drilling.rows[4].rate_hz == 200.0);
  for (const PlanRow& row : drilling.rows) CHECK((row.bytes > 0 || row.table == "hand"));
}

TEST_CASE("plan: the shipped scene has every row this version knows") {
  const auto document = TomlDocument::load(test::in_source("app/scenes/parietal.toml"));
  REQUIRE(document);
  Issues issues;
  const auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  const Plan plan = make_plan(*loaded);
  CHECK(row_names(plan) == std::vector<std::string>{"volume", "publish", "hand", "clutch", "contact", "erosion", "display", "record"});
  CHECK(plan.not_built == all_but({"clutch", "contact", "erosion", "display", "record"}));
  CHECK(plan.warnings.empty());
}

const PlanRow& row_of(const Plan& plan, const std::string& name) {
  const auto found = std::find_if(plan.rows.begin(), plan.rows.end(), [&](const PlanRow& row) { return row.table == name; });
  REQUIRE_MESSAGE(found != plan.rows.end(), name);
  return *found;
}

TEST_CASE("plan: [spindle] is a row between erosion and display, with its figures") {
  const Plan plan =
      make_plan(load_small({.spindle = true, .record = true, .sets = {"erosion.rate_hz=200", "spindle.stall_torque_Nm=0.5"}}));
  CHECK(row_names(plan) == std::vector<std::string>{"volume", "publish", "hand", "contact", "erosion", "spindle", "record"});
  CHECK(row_of(plan, "spindle").detail == "1000 rpm free, stalls at 0.5 N m");
  CHECK(row_of(plan, "spindle").rate_hz == 200.0);
  CHECK(plan.warnings.empty());
}

// By hand: copies of density (4 bytes), and of words (4) or records (8, or 4) with hardness (1), which are kept once more where they are made:
// one copy where all steps run on one thread, three in a live run.
TEST_CASE("plan: bytes of publishing are those of the fields that its model reads, for one copy and for three") {
  for (const bool live : {false, true}) {
    const auto bytes = [&](const std::string& keys) {
      // Without thrust: the window of a tool on a spring reaches to where the spring would take it.
      const LoadedScene loaded = load_small({.contact_keys = keys, .sets = {"hand.push_N=0"}});
      return static_cast<std::int64_t>(row_of(make_plan(loaded, shipped_effects(), {.live = live}), "publish").bytes);
    };
    const std::string planes = kPenaltyKeys;
    const std::int64_t copies = live ? 3 : 1, density = bytes("model = \"voxmap\"\n");
    const std::int64_t words = bytes(planes) - density, records8 = bytes("record_bits = \"8\"\n") - density,
                       records16 = bytes("") - density, voxels = density / (4 * copies);
    CHECK(voxels > 30 * 30 * 30);                     // the ball of 8 voxels and 16 free ones round it
    CHECK(words == voxels * (4 * (copies + 1) + 3));  // and three bytes for their leaps
    CHECK(records8 == voxels * 5 * (copies + 1));
    CHECK(records16 == voxels * 9 * (copies + 1));
  }
}

TEST_CASE("plan: the predicted bytes of publishing are those of the run's window, before it slides") {
  for (const char* keys : {kPenaltyKeys, kHeldKeys}) {
    // Long enough for the copy to be there.
    DrillRun run(SmallScene{.contact_keys = keys, .sets = {"duration_s=0.3", "hand.push_N=2"}});
    const auto planned = static_cast<double>(row_of(make_plan(run.loaded()), "publish").bytes);
    const auto taken = static_cast<double>(run.run().simulation().bone_step().publisher()->bytes());
    MESSAGE(planned << " bytes planned, " << taken << " taken by the window's copies");
    // Rounding of poses may make the window of 42 voxels two wider along each axis: 15 %.
    CHECK(std::abs(taken / planned - 1.0) < 0.15);
  }
}

TEST_CASE("plan: erosion says its law, and how it takes voxels") {
  CHECK(row_of(make_plan(load_small({})), "erosion").detail.ends_with("law rate, sub-voxel"));
  CHECK(row_of(make_plan(load_small({.sets = {"erosion.subvoxel=false"}})), "erosion").detail.ends_with("law rate"));
  CHECK(row_of(make_plan(load_small({.sets = {"erosion.law=energy"}})), "erosion").detail.ends_with("law energy, sub-voxel"));
  CHECK(row_of(make_plan(load_small({.sets = {"erosion.law=per-update"}})), "erosion").detail.ends_with("law per-update"));
}

TEST_CASE("plan: warns of walls on which the surface model may hold the bit, and of a spindle that nothing loads") {
  const auto warnings = [](const SmallScene& scene) { return make_plan(load_small(scene)).warnings; };
  const std::vector<std::string> rough = warnings({.sets = {"erosion.subvoxel=false"}});
  REQUIRE(rough.size() == 1);
  CHECK(rough.front() ==
        "[erosion] subvoxel = false leaves walls with a roughness of a voxel, on which the model \"surface\" may block the "
        "bit: set it to true");
  const std::vector<std::string> by_update = warnings({.sets = {"erosion.law=per-update"}});
  REQUIRE(by_update.size() == 1);
  CHECK(by_update.front().starts_with("[erosion] law = \"per-update\""));
  // Neither a tool at rest, nor a penalty model, nor sub-voxel removal.
  CHECK(warnings({.sets = {"erosion.subvoxel=false", "tool.spin_rpm=0"}}).empty());
  CHECK(warnings({.contact_keys = kPenaltyKeys, .sets = {"erosion.subvoxel=false"}}).empty());
  CHECK(warnings({.sets = {"erosion.law=energy"}}).empty());
  // Without [contact] drilling is not felt.
  CHECK(warnings({.contact = false}).size() == 1);

  const std::vector<std::string> idle = warnings({.spindle = true, .sets = {"tool.spin_rpm=0"}});
  REQUIRE(idle.size() == 1);
  CHECK(idle.front().starts_with("[spindle] the tool's spin is 0"));
}

TEST_CASE("plan: warns of an engaged depth under a voxel where bone is cut by whole voxels, and of drilling that is not felt") {
  const Plan shallow = make_plan(load_small({.sets = {"contact.cutting_N_per_m=200e3", "erosion.subvoxel=false"}}));
  REQUIRE(shallow.warnings.size() == 2);
  CHECK(make_plan(load_small({.sets = {"contact.cutting_N_per_m=200e3"}})).warnings.empty());  // a face recedes by any part of a voxel
  CHECK(shallow.warnings.front() ==
        "engaged depth push_N / cutting_N_per_m = 0.100 mm is less than a voxel (0.250 mm): little will be cut; set push_N to 50 or "
        "more, or use a smaller spacing_mm");
  const Plan unfelt = make_plan(load_small({.contact = false}));
  REQUIRE(unfelt.warnings.size() == 1);
  CHECK(unfelt.warnings.front() == "no [contact]: no force acts on the hand, and the tool follows the script through bone");
}

TEST_CASE("plan: warns of a cutting feature under two voxels at the key, with the spacing that resolves it") {
  const auto warned = [](const std::string& tool, double spacing) {
    const std::string volume = "source = \"phantom:plate\"\nspacing_mm = " + std::to_string(spacing) + "\nextent_mm = [20, 20, 6]\n";
    std::vector<std::string> out = make_plan(load_small({.volume = volume, .sets = {"tool.name=" + tool, "hand.push_N=200"}})).warnings;
    std::erase_if(out, [](const std::string& line) { return line.find("do not resolve") == std::string::npos; });
    return out;
  };
  struct Case {
    const char* tool;
    double feature_mm;
    const char* what;
  };
  // Kerf, wall, ledge behind the pilot (7 - 5.3 mm), router, and the land and point of the drill together.
  for (const Case& c : {Case{"sagittal_saw_12mm", 0.6, "depth of its region \"teeth\", 0.6 mm"},
                        {"trephine_12mm", 1.0, "wall of its region \"teeth\", 1 mm"},
                        {"perforator_14_11", 1.7, "step of its region \"outer drill\", 1.7 mm"},
                        {"twist_drill_2_5mm", 1.251, "height of its region \"lips\", 1.25 mm"}}) {
    CAPTURE(std::string(c.tool));
    CHECK(warned(c.tool, 0.499 * c.feature_mm).empty());
    const std::vector<std::string> lines = warned(c.tool, 0.51 * c.feature_mm);
    REQUIRE(lines.size() == 1);
    CHECK(lines.front().find(c.what) != std::string::npos);
    CHECK(lines.front().starts_with("small.toml:"));
    // The spacing that is named gives no warning.
    const double fits = std::stod(lines.front().substr(lines.front().find("spacing_mm to ") + 14));
    CHECK(fits > 0.4 * c.feature_mm);
    CHECK(warned(c.tool, fits).empty());
  }
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

TEST_CASE("summary: what drew is reported key by key, null where nothing chose the quality") {
  DrillRun run(SmallScene{.sets = {"duration_s=0.1"}});
  RunSummary summary = make_summary(run.loaded(), run.run().simulation(), make_plan(run.loaded()), 1.0);
  summary.display = RunSummary::Display{"osmesa", "4.5", "llvmpipe", {.bisections = 3, .resolution = 0.5}, std::nullopt, std::nullopt};
  const Json told = Json::parse(summary_json(summary)).at("display");
  CHECK(told.at("backend") == "osmesa");
  CHECK(told.at("version") == "4.5");
  CHECK(told.at("renderer") == "llvmpipe");
  CHECK(told.at("quality") == Json{{"step_voxels", 0.5}, {"bisections", 3}, {"finish", true}, {"supersample", 1}, {"resolution", 0.5}});
  CHECK(told.at("budget_ms").is_null());
  CHECK(told.at("expected_ms").is_null());
  summary.display->budget_ms = 30.0;
  CHECK(Json::parse(summary_json(summary)).at("display").at("budget_ms") == 30.0);
}

TEST_CASE("summary: every promised key is there, with numbers where the run has them") {
  DrillRun run(SmallScene{.sets = {"tool.erosion_scale=4", "duration_s=1.6"}});
  const Json json = summary_of(run);
  CHECK(json.at("display").is_null());  // the scene has none
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
  for (const char* step : {"servo", "contact", "erosion", "gradient", "publish"})
    for (const char* key : {"count", "p50_us", "p99_us", "p999_us", "max_us"})
      CHECK_MESSAGE(json.at("timing").at(step).contains(key), std::string(step));
  CHECK(json.at("timing").at("missed") == 0);
  CHECK(json.at("memory").at("peak_bytes") > 0);
  for (const Json& effect : json.at("effects"))
    for (const char* key : {"name", "steps", "time_us", "bytes"}) CHECK_MESSAGE(effect.contains(key), std::string(key));
  CHECK(json.at("hash").at("voxels").get<std::string>().size() == 16);
  CHECK(json.at("hash").at("forces").get<std::string>().size() == 16);
  CHECK(json.at("hash").at("image").is_null());
  CHECK_FALSE(json.at("timing").contains("upload"));  // no [display], no timer of it
  CHECK(std::abs(json.at("drilling").at("thickness_mm").get<double>() - 3.0) < 1e-3);
}

TEST_CASE("summary: an effect reports its own figures, and nothing where it is not") {
  DrillRun with(SmallScene{.spindle = true, .sets = {"duration_s=0.5", "erosion.rate_hz=100", "spindle.stall_torque_Nm=0.02"}});
  const Json json = summary_of(with);
  CHECK(json.at("timing").at("spindle").at("count") == 50);
  const Json& row =
      *std::find_if(json.at("effects").begin(), json.at("effects").end(), [](const Json& e) { return e.at("name") == "spindle"; });
  CHECK(row.at("time_us") > 0.0);
  CHECK(row.at("figures").at("slowest_rpm").get<double>() < 1000.0);
  DrillRun without(SmallScene{.sets = {"duration_s=0.1"}});
  const Json json_without = summary_of(without);
  for (const Json& effect : json_without.at("effects")) CHECK(effect.at("name") != "spindle");
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
