// Tables that are missing, or that contradict the scene: each is one line with its place, and no run begins.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/scene/other_branch.h"
#include "app/scene/schema_samples.h"
#include "app/stage/requirement.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

/// The errors of a text with changes, explained as the program does; "unset TABLE" removes a table.
std::vector<std::string> errors_of(const std::string& text, const std::vector<std::string>& changes = {}) {
  auto document = TomlDocument::parse(text, "bad.toml");
  REQUIRE(document);
  for (const std::string& change : changes) {
    const bool removes = change.starts_with("unset ");
    REQUIRE((removes ? document->unset(change.substr(6)) : document->set(change)));
  }
  Issues issues;
  (void)read_scene(*document, test_context(), issues);
  explain_unknown_keys(issues);
  std::vector<std::string> lines;
  for (const Error& issue : issues) lines.push_back(issue.text());
  return lines;
}

const std::string kPlain = scene_text({});  // 28 lines, the last [erosion]; [contact] is line 25

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("contradiction: a table that every scene needs is missing at the start of the file, with what to add") {
  const auto missing = [](const std::string& table, const std::string& keys) {
    return Lines{"bad.toml:1:1: [" + table + "] is missing: every scene needs this table; add it" + keys};
  };
  CHECK(errors_of(kPlain).empty());
  CHECK(errors_of(kPlain, {"unset tool"}) == missing("tool", " with the keys name and spin_rpm"));
  CHECK(errors_of(kPlain, {"unset hand"}) == missing("hand", "; it may be empty"));
  CHECK(errors_of(kPlain, {"unset volume"}) == missing("volume", " with the key source"));
  CHECK(errors_of(kPlain, {"unset approach"}) == missing("approach", " with the key entry_mm, site or markups"));
  CHECK(errors_of("", {}).size() == 4);
  CHECK(errors_of(kPlain, {"unset hand", "hand=3"}) == Lines{"--set hand: hand = 3 must be a table: [hand]"});
}

TEST_CASE("contradiction: an effect of erosion without [erosion], and of contact without [contact], is an error at its table") {
  struct Case {
    std::string table, lines, lacking, subject, without;
  };
  const Case cases[] = {
      {"dust", "", "erosion", "[dust]", "no bone is cut, so there are no chips"},
      {"heat", "", "erosion", "[heat]", "no bone is cut, so nothing is warmed"},
      {"bleeding", "", "erosion", "[bleeding]", "no bone is opened, so nothing bleeds"},
      {"clutch", "", "erosion", "[clutch]", "no bone is cut, so the tip never loses its support"},
      {"clutch", "", "contact", "[clutch]", "nothing presses the tip, so the clutch never engages"},
      {"spindle", "", "erosion", "[spindle]", "there is no cutting torque, so it does not slow"},
      {"spindle", "", "contact", "[spindle]", "there is no cutting torque, so it does not slow"},
      {"friction", "", "contact", "[friction]", "there is no normal force, so there is no friction"},
      {"vibration", "source = \"chips\"", "erosion", "[vibration] source = \"chips\"", "no chips are cut, so nothing vibrates"},
      {"vibration", "[vibration.drilling_force]", "erosion", "[vibration] drilling_force",
       "the bone before the drill is not known, so there is no force"},
  };
  const auto line = static_cast<std::size_t>(std::ranges::count(kPlain, '\n')) + 1;
  for (const Case& one : cases) {
    CAPTURE(one.subject);
    const std::string text = kPlain + "[" + one.table + "]\n" + one.lines + "\n";
    CHECK(errors_of(text).empty());  // the twin: with everything there is no error
    const bool keys = one.subject.size() > one.table.size() + 2;
    CHECK(errors_of(text, {"unset " + one.lacking}) ==
          Lines{"bad.toml:" + std::to_string(line) + ":2: " + one.subject + " has no effect without [" + one.lacking + "]: " + one.without +
                "; add [" + one.lacking + "], or " +
                (one.lines.starts_with("[") ? "remove " + one.lines
                 : keys                     ? "change that key"
                                            : "remove [" + one.table + "]")});
  }
  for (const char* const law : {"energy", "threshold", "progressive"})
    CHECK(errors_of(kPlain, {std::string("erosion.law=") + law, "unset contact"}) ==
          Lines{"bad.toml:28:2: [erosion] law = \"" + std::string(law) +
                "\" has no effect without [contact]: there is no thrust, so nothing is removed; add [contact], or change that key"});
  CHECK(errors_of(kPlain, {"unset contact"}).empty());  // the law "rate" needs no thrust
  CHECK(
      errors_of(kPlain, {"unset erosion", "dust={}"}) ==
      Lines{"--set dust: [dust] has no effect without [erosion]: no bone is cut, so there are no chips; add [erosion], or remove [dust]"});
}

TEST_CASE("contradiction: it is reported alone, not as a consequence of another error") {
  CHECK(errors_of(kPlain + "[dust]\n", {"unset erosion", "hand.push_N=-1"}).size() == 1);
  CHECK(errors_of(kPlain + "[dust]\n[heat]\n[friction]\n", {"unset erosion", "unset contact"}).size() == 3);
}

TEST_CASE("contradiction: tables that go with one that is removed are found from the plans") {
  const auto going = [](const std::string& more, const std::string& table) {
    const Scene scene = load_text(kPlain + more, {}).scene;
    return tables_that_require(table, scene.effects, scene);
  };
  CHECK(going("", "erosion").empty());
  CHECK(going("[dust]\n[zones]\n[heat]\n[friction]\n", "erosion") == Lines{"heat", "dust"});
  CHECK(going("[dust]\n[zones]\n[heat]\n[friction]\n", "contact") == Lines{"friction"});
  CHECK(going("law = \"energy\"\n[dust]\n[friction]\n", "contact") == Lines{"erosion", "friction", "dust"});  // what needs what needs it
}

TEST_CASE("contradiction: a table of another choice is named with that choice, and a zone without a name is one error") {
  CHECK(errors_of(kPlain + "[[erosion.curve]]\nstrain = 0.01\nstress_MPa = 100\n") ==
        Lines{"bad.toml:29:11: [erosion.curve] is read only with law = progressive: remove the table, or change that choice"});
  CHECK(errors_of(kPlain + "[nothing]\n") == Lines{"bad.toml:29:2: unknown table [nothing]"});
  CHECK(errors_of(kPlain + "[[zones.zone]]\nlabel = \"dura\"\n") ==
        Lines{"bad.toml:29:1: zones.zone[0].name is missing (name of the zone in figures: small letters, digits and _)"});
  CHECK(errors_of(kPlain + "[[zones.zone]]\nname = \"Dura\"\n") ==
        Lines{"bad.toml:30:1: zones.zone[0].name = \"Dura\" must be of small letters, digits and _"});
  CHECK(errors_of(kPlain + "[[zones.zone]]\nname = \"\"\n").size() == 1);
  CHECK(errors_of(kPlain + "[[zones.zone]]\nname = 5\n").size() == 1);
}

}  // namespace burrhole::test
