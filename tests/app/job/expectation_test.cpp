// The grammar of --expect, and what it finds in a summary.

#include "app/job/expectation.h"

#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

#include "app/job/outcome_doc.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {
namespace {

/// A run that is through, with a plunge of 0.4 mm.
RunSummary through() {
  RunSummary s;
  s.end = "done";
  s.erosion_points = 1000, s.spin_rpm = 1000.0;
  s.thickness_mm = 7.0, s.reached_mm = 7.4;
  s.breakthrough_s = s.passed_s = 20.0;
  s.cleared_share = 0.95, s.uncut_share = 0.0;
  s.section_mm2 = 95.0, s.section_radius_mm = 5.5, s.removed_mass_mm3 = 900.0;
  s.plunge_mm = 0.4, s.beyond_mm = 0.4, s.depth_mm = 7.0, s.peak_force_N = 29.0, s.spacing_mm = 0.25;
  return s;
}

std::vector<std::string> missed(const char* text, const RunSummary& summary) {
  const auto terms = parse_expectation(text);
  REQUIRE_MESSAGE(terms.ok(), (terms ? "" : terms.error().text()));
  return missed_terms(*terms, summary);
}

TEST_CASE("expectation: what holds is missed by none, with or without blanks") {
  for (const char* text : {"through", "drilled-through", "through, plunge<0.5mm", " through ,plunge < 0.5 mm,peak-force>28N", "cleared>90%",
                           "no plunged, no shelf-left", "depth>7.39mm, depth<7.41mm", "time<20.1 s"})
    CHECK_MESSAGE(missed(text, through()).empty(), std::string(text));
}

TEST_CASE("expectation: each missed term is one line with what was found") {
  CHECK(missed("plunge<0.3mm", through()) == std::vector<std::string>{"expected plunge<0.3mm: plunge is 0.4 mm"});
  CHECK(missed("plunge<0.4mm", through()).size() == 1);  // strictly
  CHECK(missed("plunge>0.4mm", through()).size() == 1);
  CHECK(
      missed("stopped-short", through()) ==
      std::vector<std::string>{"expected stopped-short: the result is drilled-through: 95 % of the bit's cross-section is clear of bone"});
  CHECK(missed("did-not-cut, plunge<0.1mm, peak-force>1N", through()).size() == 2);
  RunSummary plunged = through();
  plunged.limits.plunge_mm = 0.3;
  CHECK(missed("no plunged", plunged) == std::vector<std::string>{"expected no plunged: the flag plunged is set"});
}

TEST_CASE("expectation: a figure that a run does not have does not hold, above or below") {
  RunSummary s = through();
  s.plunge_mm.reset();
  CHECK(missed("plunge<0.5mm", s) == std::vector<std::string>{"expected plunge<0.5mm: the run has no plunge"});
  CHECK(missed("plunge>0mm", s).size() == 1);
}

TEST_CASE("expectation: a wrong term is one line with what is allowed") {
  for (const char* text : {"", "thru", "through,", "plunge", "plunge<", "plunge<0.5", "plunge<0.5cm", "plunge<0.5mm2", "depht<1mm",
                           "plunge=1mm", "plunge<<1mm", "plunge<nan mm", "no", "no plunge", "plunge<-inf mm"}) {
    CAPTURE(std::string(text));
    const auto terms = parse_expectation(text);
    REQUIRE_FALSE(terms.ok());
    CHECK(terms.error().code == ErrorCode::bad_input);
    const bool no_figure = terms.error().message.find("names no figure") != std::string::npos;
    CHECK(no_figure == std::string(text).starts_with("depht"));
    const bool no_flag = terms.error().message.find("names no flag") != std::string::npos;
    CHECK(no_flag == (std::string(text) == "no plunge"));
    const std::string term = text;
    const char* const listed = no_figure                                           ? "figures: plunge, depth, "
                               : no_flag                                           ? "did you mean \"no plunged\"? flags: plunged, "
                               : term == "plunge<0.5"                              ? ": write \"plunge<0.5mm\""
                               : term == "plunge<0.5cm" || term == "plunge<0.5mm2" ? ": plunge is in mm"
                               : term == "plunge=1mm"                              ? ": write \"plunge>LOW, plunge<HIGH\""
                               : term == "plunge<<1mm"                             ? ": write \"plunge<1mm\""
                                                                                   : "; allowed: through, faulted";
    CHECK(terms.error().message.find(listed) != std::string::npos);
    CHECK(terms.error().message.find('\n') == std::string::npos);
  }
}

TEST_CASE("expectation: a term in the words of other languages is refused with the term to write, which is valid") {
  for (const auto& [text, instead] :
       {std::pair("plunge<=1mm", "plunge<1mm"), std::pair("plunge >= 1 mm", "plunge>1 mm"), std::pair("plunge=<1mm", "plunge<1mm"),
        std::pair("1mm>plunge", "plunge<1mm"), std::pair("1 mm < plunge", "plunge>1 mm"), std::pair("plunge<1", "plunge<1mm"),
        std::pair("through and no plunged", "through, no plunged"), std::pair("through && plunge<1mm", "through, plunge<1mm"),
        std::pair("through;plunge<1mm", "through, plunge<1mm"), std::pair("through plunge<1mm", "through, plunge<1mm"),
        std::pair("not plunged", "no plunged"), std::pair("!plunged", "no plunged"), std::pair("plunged", "no plunged")}) {
    CAPTURE(std::string(text));
    const auto terms = parse_expectation(text);
    REQUIRE_FALSE(terms.ok());
    CHECK_MESSAGE(terms.error().message.find("write \"" + std::string(instead) + "\"") != std::string::npos, terms.error().message);
    CHECK(terms.error().message.size() < 200);  // one line that is read
    CHECK(parse_expectation(instead).ok());
  }
  for (const char* text : {"through or no plunged", "through || no plunged"}) {
    const auto terms = parse_expectation(text);
    REQUIRE_FALSE(terms.ok());
    CHECK(terms.error().message.find("all terms of --expect must hold") != std::string::npos);
  }
}

TEST_CASE("expectation: a figure has the names that summary.json gives it, and the unit of such a name may be left out") {
  for (const char* text :
       {"peak_force_N<30", "peak_force_N>28N", "reached_mm>7.39, reached_mm<7.41", "plunge_mm<0.5 mm", "peak_force>28N",
        "drilling.plunge_mm<0.5", "depth_mm>6.9, depth_mm<7.1", "cleared_share>0.9", "cleared_share>90%", "duration_s<1"})
    CHECK_MESSAGE(missed(text, through()).empty(), std::string(text));
  for (const char* text : {"peak_force_N<28", "reached_mm<7", "depth_mm<6.9", "cleared_share>0.96", "uncut_share>0"})
    CHECK_MESSAGE(missed(text, through()).size() == 1, std::string(text));
  // Without a unit only where the name holds it.
  for (const char* text : {"peak_force<30", "plunge<0.5", "cleared>0.9", "outer.plunge_mm<1", "_mm<1", "mm<1"})
    CHECK_FALSE_MESSAGE(parse_expectation(text).ok(), std::string(text));
}

TEST_CASE("expectation: an unknown figure is named with the nearest and a short list") {
  for (const auto& [text, near] : {std::pair("peakforce<3N", "peak-force"), std::pair("plunge_m<3mm", "plunge_mm"),
                                   std::pair("reachd_mm<3", "reached_mm"), std::pair("thicknes<3mm", "thickness")}) {
    const auto terms = parse_expectation(text);
    REQUIRE_FALSE(terms.ok());
    CHECK_MESSAGE(terms.error().message.find("did you mean \"" + std::string(near) + "\"?") != std::string::npos, terms.error().message);
    CHECK(terms.error().message.size() < 300);  // one line that is read
  }
}

TEST_CASE("expectation: names of figures are unique, and each has a value in a complete run") {
  RunSummary s = through();
  s.hole_diameter_mm = 14.0, s.inner_diameter_mm = 11.0;
  for (const ExpectedFigure& figure : expected_figures()) {
    CAPTURE(std::string(figure.name));
    CHECK(figure.value(s).has_value());
    CHECK(parse_expectation(std::string(figure.name) + ">1" + figure.unit).ok());
    int same = 0;
    for (const ExpectedFigure& other : expected_figures()) same += std::string(other.name) == figure.name ? 1 : 0;
    CHECK(same == 1);
    const auto by_key = parse_expectation(std::string(figure.about) + ">1");
    REQUIRE_MESSAGE(by_key.ok(), (by_key ? "" : by_key.error().text()));
    CHECK(by_key->front().figure == &figure);
  }
}

TEST_CASE("outcome: docs/outcome.md is what the program prints") {
  std::ostringstream page;
  page << std::ifstream(in_source("docs/outcome.md")).rdbuf();
  CHECK_MESSAGE(page.str() == outcome_markdown(), "docs/outcome.md is out of date; run: burrhole docs outcome > docs/outcome.md");
}

}  // namespace
}  // namespace burrhole::test
