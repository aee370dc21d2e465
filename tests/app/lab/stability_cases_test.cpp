// Hard cases on the shipped path: what the default model holds, that each case is what it says, and that each sabotage is caught.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>

#include "app/lab/stability_report.h"
#include "app/lab/stability_run.h"
#include "app/report/file.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

const StabilityModel& default_model() { return stability_models().front(); }

StabilityCase case_of(const std::string& name) {
  for (StabilityCase& one : stability_cases())
    if (one.name == name) return one;
  FAIL(name);
  return {};
}

StabilityTrace traced(const std::string& name, bool sabotaged = false) {
  const StabilityCase one = case_of(name);
  auto trace = trace_of(one, default_model(), sabotaged);
  if (!trace) FAIL(trace.error().text());
  return std::move(trace).value();
}

bool fails(const StabilityOutcome& outcome, StabilityMeasure measure) {
  return std::ranges::any_of(outcome.rows, [&](const StabilityRow& row) { return !row.pass && row.measure == name_of(measure); });
}

std::vector<std::string> failures(const StabilityOutcome& outcome) {
  std::vector<std::string> out;
  for (const StabilityRow& row : outcome.rows)
    if (!row.pass) out.push_back(row.measure);
  return out;
}

}  // namespace

TEST_CASE("stability: every case has a name of its own, checks, and a way to break it") {
  std::set<std::string> names;
  for (const StabilityCase& one : stability_cases()) {
    CAPTURE(one.name);
    CHECK(names.insert(one.name).second);
    CHECK_FALSE(one.shows.empty());
    CHECK_FALSE(one.checks.empty());
    if (one.ticks > 0) continue;  // the long one is `rest`, but for its length
    CHECK_FALSE(one.sabotage.what.empty());
    CHECK(std::ranges::any_of(one.checks, [&](const StabilityCheck& check) { return check.measure == one.sabotage.must_fail; }));
  }
  CHECK(names.size() > 30);  // an empty list would pass all that follows
}

TEST_CASE("stability: the default model holds every case") {
  for (const StabilityCase& one : stability_cases()) {
    if (one.ticks > 0) continue;
    const StabilityOutcome outcome = run_stability_case(one, default_model(), false);
    CAPTURE(one.name);
    CHECK(outcome.error == "");
    CHECK(failures(outcome).empty());
  }
}

TEST_CASE("stability: each sabotage is caught by the measure that it names") {
  for (const StabilityCase& one : stability_cases()) {
    if (one.sabotage.what.empty()) continue;
    const StabilityOutcome outcome = run_stability_case(one, default_model(), true);
    CAPTURE(one.name);
    CHECK(outcome.error == "");
    CHECK(fails(outcome, one.sabotage.must_fail));
  }
}

TEST_CASE("stability: with the mesh every kind of sabotage is caught, where the mesh keeps the bound without it") {
  const auto model = std::ranges::find(stability_models(), "mesh", &StabilityModel::name);
  REQUIRE(model != stability_models().end());
  std::set<std::string> kinds, caught;
  for (const StabilityCase& one : stability_cases()) {
    const std::string& kind = one.sabotage.what;
    if (kind.empty() || one.ticks > 0) continue;
    kinds.insert(kind);
    if (caught.contains(kind)) continue;  // the first case that shows it is enough
    CAPTURE(one.name);
    const StabilityOutcome whole = run_stability_case(one, *model, false);
    CHECK(whole.error == "");
    // A check may be one of the default model alone, and a bound that the mesh exceeds by itself shows nothing.
    const auto row = std::ranges::find(whole.rows, name_of(one.sabotage.must_fail), &StabilityRow::measure);
    if (row == whole.rows.end() || fails(whole, one.sabotage.must_fail)) continue;
    const StabilityOutcome sabotaged = run_stability_case(one, *model, true);
    CHECK(sabotaged.error == "");
    if (fails(sabotaged, one.sabotage.must_fail)) caught.insert(kind);
  }
  // The mesh knows a tool by its shell points in any case.
  kinds.erase("contact knows the tool by its shell points only");
  CHECK(caught == kinds);
  CHECK(kinds.size() > 6);
}

TEST_CASE("stability: the cases are what they say") {
  // Each is on bone when it says so: forces at rest of at least half a newton; on the edge the ball slips aside and rests lower.
  for (const std::string name :
       {"rest", "many_points", "edge", "wedge", "pit_as_wide", "pit_narrower", "slot", "noisy", "far_origin", "contact_20_hz"}) {
    CAPTURE(name);
    CHECK(largest_force(traced(name), {1.1, 1.5}) > 0.5);
  }
  StabilityCase endless = case_of("million_ticks");
  CHECK(endless.ticks == 1'000'000);
  endless.ticks = 1000;
  CHECK(run_stability_case(endless, default_model(), false).points <= 100.0);
  CHECK(run_stability_case(case_of("many_points"), default_model(), false).points >= 300.0);
  CHECK(traced("shell_through").samples.back().tool.z < -5e-3);  // the ball is past the shell
  CHECK(largest_force(traced("deep"), {1.1, 1.5}) > 27.0);       // all that the device can show
  CHECK(largest_force(traced("stroke_0.5x"), {}) > 0.1);         // it gets there
  const StabilityTrace chip = traced("loose_chip");
  CHECK(largest_force(chip, {}) > 0.2);
  CHECK(chip.samples[1500].tool.z < -2e-3);  // pushed along, where a fixed one would have held
}

TEST_CASE("stability: bone 10 m away from the origin is felt as bone at it") {
  const StabilityTrace near = traced("rest"), far = traced("far_origin");
  REQUIRE(near.samples.size() == far.samples.size());
  double off = 0.0;
  for (std::size_t n = 0; n < near.samples.size(); ++n) off = std::max(off, glm::length(near.samples[n].force - far.samples[n].force));
  // 10 m have their last bit at 1.8e-15 m, 5000 N/m and the damper's 10 N s/m over 1 ms make 3e-11 N of it; a step of the device's position
  // that falls the other way for it would be 0.25 N.
  CHECK(off <= 1e-6);
}

TEST_CASE("stability: outcomes are the same whatever the threads") {
  const auto run = [](unsigned threads) {
    auto out = run_stability({.only_case = "rest", .only_model = {}, .threads = threads}, [](double, const std::string&) {});
    REQUIRE(out.ok());
    return std::move(out).value();
  };
  const auto one = run(1), three = run(3);
  REQUIRE(one.size() == stability_models().size());
  REQUIRE(three.size() == one.size());
  for (std::size_t n = 0; n < one.size(); ++n) {
    CHECK(one[n].model == three[n].model);
    REQUIRE(one[n].rows.size() == three[n].rows.size());
    for (std::size_t row = 0; row < one[n].rows.size(); ++row) CHECK(one[n].rows[row].value == three[n].rows[row].value);
  }
}

TEST_CASE("stability: a case or model that there is not is refused") {
  const auto quiet = [](double, const std::string&) {};
  CHECK_FALSE(run_stability({.only_case = "nothing", .only_model = {}}, quiet).ok());
  CHECK_FALSE(run_stability({.only_case = "rest", .only_model = "nothing"}, quiet).ok());
}

TEST_CASE("stability: table and page say what failed") {
  const TemporaryFolder folder;
  StabilityOutcome good{.subject = "rest", .model = "surface", .rows = {{"rest", "surface", "force_N", 3.0, 28.0, true}}};
  CHECK_FALSE(default_model_failed(std::vector{good}));
  StabilityOutcome bad = good;
  bad.rows.push_back({"rest", "surface", "cycle_mm", 0.3, 0.1, false});
  const std::vector<StabilityOutcome> outcomes{bad};
  CHECK(default_model_failed(outcomes));
  StabilityOutcome other = bad;
  other.model = "voxmap";
  CHECK_FALSE(default_model_failed(std::vector{other}));
  const std::string csv = (folder.path() / "stability.csv").string(), page = (folder.path() / "stability.html").string();
  REQUIRE(write_stability_csv(outcomes, csv).ok());
  CHECK(*read_file(csv) ==
        "case,model,measure,value,bound,pass\r\nrest,surface,force_N,3,28,true\r\nrest,surface,cycle_mm,0.3,0.1,false\r\n");
  REQUIRE(write_stability_page(outcomes, page).ok());
  CHECK(read_file(page)->find("cycle_mm 0.3 (bound 0.1)") != std::string::npos);
  CHECK(stability_markdown(outcomes).find("- `cycle_mm`: rest 0.3 (0.1)") != std::string::npos);
}

TEST_CASE("stability: voxmap rests with slow contact, as the servo believes its planes no further than a quarter of a voxel") {
  const StabilityModel plain{.name = "voxmap", .keys = "model = \"voxmap\"\n"};
  // Sabotage: planes of the surface voxel are believed as far as the hand goes, and stacked they are ten times a point's stiffness.
  const StabilityModel believed{.name = "voxmap", .keys = "model = \"voxmap\"\nplane = \"surface\"\n"};
  for (const char* name : {"contact_50_hz", "contact_20_hz"}) {
    CAPTURE(std::string(name));
    const StabilityOutcome rests = run_stability_case(case_of(name), plain, false);
    CHECK(rests.error == "");
    for (const StabilityMeasure measure : {StabilityMeasure::cycle, StabilityMeasure::ripple, StabilityMeasure::attractive_force})
      CHECK(!fails(rests, measure));
    CHECK(fails(run_stability_case(case_of(name), believed, false), StabilityMeasure::cycle));
  }
}

TEST_CASE("stability: the page's table of cases is what the program prints") {
  const std::string printed = stability_markdown({});
  const std::string cases = printed.substr(0, printed.find("\n## What fails"));
  REQUIRE(cases.size() > 1000);
  const auto page = read_file(test::in_source("docs/stability.md"));
  REQUIRE(page.ok());
  const bool same = page->find(cases) != std::string::npos;
  CHECK_MESSAGE(same, "docs/stability.md is out of date; run: scripts/stability_page");
}
