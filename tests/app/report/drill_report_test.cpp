#include "app/report/drill_report.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include "app/report/file.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

DrillReport make_report() {
  DrillReport report;
  report.title = "Parietal <burrhole>";
  report.scene = "parietal.toml";
  for (int i = 0; i < 4000; ++i) {
    report.time_s.push_back(0.001 * i);
    report.force_N.push_back(2.0);
    report.depth_mm.push_back(0.002 * i);
    report.speed_mm_s.push_back(2.0);
  }
  report.layers = {{"outer table", 0.0, 2.4}, {"diploe", 2.4, 5.3}, {"inner table", 5.3, 7.0}};
  report.events = {{0.1, "contact"}, {3.5, "breakthrough"}};
  report.breakthrough_s = 3.5;
  report.plunge_mm = 1.25;
  report.hashes = {{"voxels", "0123456789abcdef"}};
  return report;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST_CASE("drill report: shows what applies, escaped, and nothing that does not") {
  const Result<std::string> page = make_drill_report(make_report());
  REQUIRE(page);
  for (const char* part :
       {"Parietal &lt;burrhole&gt;", "inner table", "Force (N)", "Depth (mm)", "Feed (mm/s)", "0123456789abcdef", "1.25"})
    CHECK_MESSAGE(contains(*page, part), std::string(part));
  CHECK_FALSE(contains(*page, "Peak force"));
  CHECK_FALSE(contains(*page, "Time taken by the steps"));
}

TEST_CASE("drill report: times of the steps are folded away, results are not") {
  DrillReport report = make_report();
  report.timing = {{.name = "servo", .count = 10}};
  const auto page = make_drill_report(report);
  REQUIRE(page);
  const std::size_t open = page->find("<details>"), close = page->find("</details>"), table = page->find("99th percentile");
  REQUIRE(open != std::string::npos);
  CHECK(open < table);
  CHECK(table < close);
  CHECK(page->find("<details", open + 1) == std::string::npos);
  CHECK(page->find("0123456789abcdef") > close);
  CHECK(page->find("Events") < open);
}

TEST_CASE("drill report: a plunge beyond the limit is marked, one within it is not") {
  DrillReport report = make_report();
  CHECK(contains(*make_drill_report(report), "class=\"tile alert\""));
  report.plunge_mm = 0.2;
  CHECK_FALSE(contains(*make_drill_report(report), "class=\"tile alert\""));
}

TEST_CASE("drill report: result, reason and flags are in one line, and missed steps are those of every clock") {
  DrillReport report = make_report();
  report.result = "stopped-short", report.reason = "the hand withdrew", report.flags = {"plunged", "missed-steps"};
  report.timing = {{.name = "servo", .count = 10}};
  CHECK(contains(*make_drill_report(report),
                 "Result: stopped-short (the hand withdrew). Flags: plunged, missed-steps (burrhole docs outcome defines them)."));
  CHECK(contains(*make_drill_report(report), "Missed steps: none, in lockstep."));
  report.missed = {{"servo", 0, 44040}, {"contact", 3, 44040}, {"simulation", 972, 4404}};
  CHECK(contains(*make_drill_report(report),
                 "Missed steps: 0 of 44040 of the servo clock, 3 of 44040 of the contact clock, 972 of 4404 of the simulation clock."));
  report.result = "drilled-through", report.flags.clear();
  CHECK_FALSE(contains(*make_drill_report(report), "Flags:"));
}

TEST_CASE("drill report: a breakthrough of a run that is not through is not reported as drilled through") {
  DrillReport report = make_report();
  report.through = false, report.outcome = "The bit skated off.";
  CHECK(contains(*make_drill_report(report), "The bit skated off."));
  CHECK_FALSE(contains(*make_drill_report(report), "was drilled through after"));
}

TEST_CASE("drill report: a run that did not break through says so") {
  DrillReport report = make_report();
  report.breakthrough_s.reset();
  CHECK(contains(*make_drill_report(report), "ended before the bone was drilled through"));
}

/// The plots of a page, in its order: of each the wide and the narrow form.
std::vector<std::string> plots_of(const std::string& page) {
  std::vector<std::string> out;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1))
    out.push_back(page.substr(at, page.find("</svg>", at) - at));
  return out;
}

TEST_CASE("drill report: a hole is drilled through where the tip came out, and plunges where support was lost, not before") {
  CHECK(exit_sentence({27.9, 28.3, 30.3, 0.4}) ==
        "The bone was drilled through: the axis was clear after 27.90 s, the tip came out after 28.30 s, the bone carried the thrust until "
        "30.30 s, and the tip then plunged 0.40 mm");
  CHECK(exit_sentence({.breakthrough_s = 27.9, .plunge_mm = 0.0})
            .ends_with("the bone carried the thrust to the end, and the plunge is 0.00 mm"));
  CHECK(
      exit_sentence({.support_lost_s = 9.2, .plunge_mm = 5.6}).starts_with("The bone was drilled through round a core, the bone carried"));
  CHECK(exit_sentence({.breakthrough_s = 27.9}).ends_with("the axis was clear after 27.90 s"));
  DrillReport report = make_report();
  report.tip_out_s = 3.625, report.support_lost_s = 3.75, report.beyond_mm = 2.125;
  for (const char* part : {"until 3.75 s, and the tip then plunged 1.25 mm, which is more than 0.50 mm.", "Support lost", "2.12",
                           "Tip out of the bone", "came out after 3.62 s"})
    CHECK_MESSAGE(contains(*make_drill_report(report), part), part);
}

TEST_CASE("drill report: the axis of the feed is that of drilling; a fast approach, a fall and the retreat are clipped and named") {
  DrillReport report = make_report();
  report.time_s.clear(), report.force_N.clear(), report.depth_mm.clear(), report.speed_mm_s.clear();
  for (int i = 0; i < 4000; ++i) {
    const bool approach = i < 200, fall = i >= 3500 && i < 3520, retreat = i >= 3520;
    report.time_s.push_back(0.001 * i);
    report.force_N.push_back(approach || retreat ? 0.0 : 20.0);
    report.speed_mm_s.push_back(approach ? 30.0 : fall ? 700.0 : retreat ? -45.0 : 0.4);
    report.depth_mm.push_back((report.depth_mm.empty() ? -6.0 : report.depth_mm.back()) + 0.001 * report.speed_mm_s.back());
  }
  const Result<std::string> page = make_drill_report(report);
  if (contains(*page, "No plot: ")) return;  // no gnuplot
  const std::string plot = plots_of(*page).front();
  CHECK(contains(plot, "off the scale, -45 to 700 mm/s"));
  CHECK(contains(plot, "0.4<"));  // a tic of an axis up to 0.6 mm/s
  CHECK_FALSE(contains(plot, "700<"));
  report.speed_mm_s.assign(report.speed_mm_s.size(), 0.4);
  CHECK_FALSE(contains(plots_of(*make_drill_report(report)).front(), "off the scale"));
}

TEST_CASE("drill report: infinite and unknown speeds, as of samples at one time, draw a page with the axis of those that are known") {
  DrillReport report = make_report();
  report.force_N.assign(report.force_N.size(), 20.0);
  for (const double strange : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::max()}) {
    INFO(strange);
    report.speed_mm_s.assign(report.speed_mm_s.size(), strange);
    report.speed_mm_s[7] = 0.4;
    const Result<std::string> page = make_drill_report(report);
    REQUIRE_MESSAGE(page.ok(), page.error().text());
    if (contains(*page, "No plot: ")) return;  // no gnuplot
    CHECK_FALSE(contains(plots_of(*page).front(), "inf mm/s"));
    CHECK(contains(plots_of(*page).front(), "0.4<"));
    report.speed_mm_s[7] = strange;
    REQUIRE(make_drill_report(report));
  }
  report.speed_mm_s.assign(report.speed_mm_s.size(), std::numeric_limits<double>::quiet_NaN());
  CHECK(contains(*make_drill_report(report), "no data"));
}

/// A run of 20 s with a large force in its first second only.
DrillReport make_long_report() {
  DrillReport report = make_report();
  report.time_s.clear(), report.force_N.clear(), report.depth_mm.clear(), report.speed_mm_s.clear();
  for (int i = 0; i <= 2000; ++i) {
    report.time_s.push_back(0.01 * i);
    report.force_N.push_back(i < 100 ? 70.0 : 2.0);
  }
  report.layers.clear();
  report.events = {{0.1, "contact"}, {18.0, "breakthrough"}};
  report.breakthrough_s = 18.0;
  return report;
}

TEST_CASE("drill report: the last seconds of a long run are drawn again, from half a second before the breakthrough, 3 to 8 s") {
  DrillReport report = make_long_report();
  if (contains(*make_drill_report(report), "No plot: ")) return;  // no gnuplot
  struct Case {
    std::optional<double> through;
    const char* caption;
  };
  for (const Case& one : {Case{18.0, "The last 3.0 s."}, Case{14.0, "The last 6.5 s."}, Case{5.0, "The last 8.0 s."},
                          Case{std::nullopt, "The last 3.0 s."}}) {
    report.breakthrough_s = one.through;
    const Result<std::string> page = make_drill_report(report);
    CHECK_MESSAGE(contains(*page, one.caption), one.caption);
    CHECK(plots_of(*page).size() == 4);
  }
}

TEST_CASE("drill report: the plot of the last seconds has their samples and events, no others") {
  const Result<std::string> page = make_drill_report(make_long_report());
  if (contains(*page, "No plot: ")) return;  // no gnuplot
  const std::vector<std::string> plots = plots_of(*page);
  REQUIRE(plots.size() == 4);
  for (const std::size_t whole : {0u, 1u}) {
    CHECK(contains(plots[whole], "contact"));
    CHECK(contains(plots[whole], "breakthrough"));
    CHECK(contains(plots[whole], "> 60<"));
    CHECK(contains(plots[whole], ">0<"));
  }
  for (const std::size_t last : {2u, 3u}) {
    CHECK_FALSE(contains(plots[last], "contact"));
    CHECK(contains(plots[last], "breakthrough"));
    CHECK_FALSE(contains(plots[last], "> 60<"));
    CHECK(contains(plots[last], ">18<"));
    CHECK_FALSE(contains(plots[last], ">16<"));  // before the last 3 s
  }
}

TEST_CASE("drill report: a run that is not more than twice as long as its last seconds is drawn once") {
  const Result<std::string> page = make_drill_report(make_report());  // 4 s
  if (contains(*page, "No plot: ")) return;                           // no gnuplot
  CHECK_FALSE(contains(*page, "The last "));
  CHECK(plots_of(*page).size() == 2);
}

TEST_CASE("drill report: without gnuplot there is a page that says why it has no plot") {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nonexistent", 1);
  const Result<std::string> page = make_drill_report(make_report());
  ::setenv("PATH", path.c_str(), 1);
  REQUIRE(page);
  CHECK(contains(*page, "No plot: gnuplot cannot be run"));
  CHECK_FALSE(contains(*page, "<svg"));
}

TEST_CASE("drill report: a missing picture or an unwritable path is an error that names it") {
  const TemporaryFolder folder;
  DrillReport report = make_report();
  report.pictures = {{folder.file("none.png"), "start"}};
  const Result<std::string> page = make_drill_report(report);
  REQUIRE_FALSE(page);
  CHECK(contains(page.error().text(), "none.png"));
  REQUIRE(write_file(folder.file("plain"), ""));
  const Status status = write_drill_report(make_report(), folder.file("plain/report.html"));
  REQUIRE_FALSE(status);
  CHECK(status.error().code == ErrorCode::bad_input);
}

}  // namespace
}  // namespace burrhole
