// Every shipped bit in the shipped scene, with its defaults: the outcome that a user is shown. The table holds what this version does, not what a
// bit should do; a change of an outcome must be seen and written here.

#include <doctest/doctest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "app/job/drill_job.h"
#include "app/job/expectation.h"
#include "app/session/recorded_hand.h"
#include "tests/support/drill_scene.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

struct BitOutcome {
  std::string bit;
  std::string expected;            ///< as --expect writes it
  std::vector<std::string> flags;  ///< all but that of degraded contact
  double most_degraded = 1.0;      ///< [%] of the evaluations of contact
};

// A bit that leaves bone at once falls until the hand stops it, 5 to 51 mm; one that cuts its rim away at full thrust hardly does.
const std::vector<BitOutcome> kFlat{
    {"perforator_14_11", "through, plunge<0.1mm, beyond<1.5mm, cleared>95%", {}},
    {"acosta_liu_perforator", "through, plunge>20mm, cleared>95%", {"plunged"}, 5.0},
    {"trephine_12mm", "through, cleared>95%, plunge>5mm, plunge<6mm, beyond<7mm", {"plunged", "core-left"}},
    {"matchstick_burr_3mm", "through, plunge>20mm, cleared>95%", {"plunged"}},
};
const std::vector<BitOutcome> kBurrs{
    {"round_burr_2mm",
     "through, plunge>20mm, cleared>85%",
     {"plunged", "shelf-left"}},  // 88 to 91 % clear, by the last bits: the flag is for 90 %
    {"round_burr_3mm", "through, plunge<0.1mm, beyond<1.5mm, cleared>50%", {"shelf-left"}},
    {"round_burr_4mm", "through, plunge<0.1mm, beyond<2mm, cleared>85%", {}},
    {"round_burr_5mm", "through, plunge>20mm, cleared>90%", {"plunged"}},
    {"round_burr_6mm", "through, plunge<0.1mm, beyond<3mm, cleared>90%", {}},
    {"acosta_liu_round", "through, plunge>20mm, cleared>90%", {"plunged"}},
};
// The craniotome has a footplate below its router and cannot enter whole bone. The twist drill falls into the diploe, where the hand stops, checks
// the hole and drills on.
const std::vector<BitOutcome> kOthers{
    {"acorn_burr_7_5mm", "through, plunge<0.1mm, beyond<4mm, cleared>80%", {"shelf-left"}},
    {"sagittal_saw_12mm", "through, plunge>10mm, cleared>95%", {"plunged"}},
    {"craniotome_2_3mm", "did-not-cut, depth<0.1mm, removed<0.1mm3", {}},
    {"twist_drill_2_5mm", "through, plunge>20mm, cleared>85%", {"plunged"}},
};

LoadedScene shipped_with(const std::string& bit) {
  auto document = TomlDocument::load(in_source("app/scenes/parietal.toml"));
  REQUIRE(document);
  for (const std::string& set : {std::string("tool.name=" + bit), std::string("output.report=false")}) REQUIRE(document->set(set));
  REQUIRE(document->unset("clutch"));  // few bits have one
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  (void)loaded->scene.effects.remove("display");  // no picture is needed
  return std::move(*loaded);
}

void check(const std::vector<BitOutcome>& rows) {
  for (const BitOutcome& row : rows) {
    CAPTURE(row.bit);
    const auto summary = drill(shipped_with(row.bit), {});
    REQUIRE_MESSAGE(summary.ok(), (summary ? "" : summary.error().text()));
    MESSAGE(row.bit << ": " << result_line(*summary) << "; plunge " << summary->plunge_mm.value_or(-1.0) << " mm, depth "
                    << summary->reached_mm << " mm");
    const auto terms = parse_expectation(row.expected);
    REQUIRE_MESSAGE(terms.ok(), (terms ? "" : terms.error().text()));
    for (const std::string& line : missed_terms(*terms, *summary)) CHECK_MESSAGE(false, line);
    CHECK(flag_names(outcome_of(*summary).flags & ~kFlagContactDegraded) == row.flags);
    CHECK(100.0 * static_cast<double>(summary->contact_degraded) <= row.most_degraded * static_cast<double>(summary->contact_evaluations));
    // What is not through, or plunged, is a warning.
    const bool clean = outcome_of(*summary).result == DrillResult::drilled_through && (outcome_of(*summary).flags & kFlagPlunged) == 0;
    CHECK(outcome_warnings(*summary).empty() == clean);
  }
}

TEST_CASE("outcome of shipped bits: each has a row") {
  std::set<std::string> rows, files;
  for (const auto* table : {&kFlat, &kBurrs, &kOthers})
    for (const BitOutcome& row : *table) rows.insert(row.bit);
  for (const auto& entry : std::filesystem::directory_iterator(in_source("app/tools"))) files.insert(entry.path().stem().string());
  CHECK(rows == files);
}

TEST_CASE("outcome of shipped bits: drills and crowns") { check(kFlat); }
TEST_CASE("outcome of shipped bits: round burrs") { check(kBurrs); }
TEST_CASE("outcome of shipped bits: the others") { check(kOthers); }

TEST_CASE("outcome: a drill on a steep surface skates off, and a tool that is pushed through bone has passed it uncut") {
  const auto drilled = [](const std::vector<std::string>& sets) {
    LoadedScene loaded = load_small({.volume = kSkullPatchKeys, .contact_keys = "", .sets = sets});
    const auto summary = drill(loaded, {});
    REQUIRE_MESSAGE(summary.ok(), (summary ? "" : summary.error().text()));
    return *summary;
  };
  const RunSummary steep =
      drilled({"tool.name=twist_drill_2_5mm", "approach.axis=[0.8,0,-0.6]", "volume.extent_mm=[24,24,12]", "duration_s=6"});
  CHECK_MESSAGE(outcome_of(steep).result == DrillResult::skated_off, result_line(steep));
  CHECK_FALSE(steep.plunge_mm.has_value());
  LoadedScene penalty =
      load_small({.contact_keys = kPenaltyKeys, .sets = {"tool.spin_rpm=0", "hand.push_N=200", "hand.detects=false", "duration_s=2"}});
  const auto pushed = drill(penalty, {});
  REQUIRE(pushed.ok());
  CHECK_MESSAGE(outcome_of(*pushed).result == DrillResult::passed_uncut, result_line(*pushed));
}

TEST_CASE("outcome: a replay of a session has the outcome of its run, figure by figure") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  const SmallScene scene{.sets = {"tool.erosion_scale=4", "duration_s=3"}};
  DrillRun run(scene);
  run_recorded(run, path);
  ReplayRun again(path);
  const auto summary_of = [](DrillRun& of) { return make_summary(of.loaded(), of.simulation(), make_plan(of.loaded()), 1.0); };
  const RunSummary first = summary_of(run), second = summary_of(again.run());
  CHECK(outcome_of(first).result == DrillResult::drilled_through);
  CHECK(result_line(first) == result_line(second));
  for (const ExpectedFigure& figure : expected_figures())
    CHECK_MESSAGE(figure.value(first) == figure.value(second), std::string(figure.name));
}

}  // namespace
}  // namespace burrhole::test
