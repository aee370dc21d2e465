#include "core/config/key_log.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/config/toml.h"

using namespace burrhole;

namespace {

TomlDocument parsed(std::string_view text) {
  auto document = TomlDocument::parse(text, "skull.toml");
  REQUIRE_MESSAGE(document.ok(), (document.ok() ? "" : document.error().text()));
  return std::move(document).value();
}

const KeyInfo& find(const KeyLog& log, std::string_view table, std::string_view key) {
  for (const KeyInfo& info : log.keys)
    if (info.table == table && info.key == key) return info;
  FAIL("no record of [", std::string(table), "] ", std::string(key));
  return log.keys.front();
}

/// Every kind of read, as a reader of some format would make them. @returns what they gave, to compare logged and plain reading.
std::string read_all(TableReader root) {
  std::string out;
  const auto add = [&](double value) { out += std::to_string(value) + " "; };
  add(root.number("radius_mm", {.min = 0.0, .max = 20.0, .min_open = true, .to_si = 1e-3}, "of the bur"));
  add(root.number("noise", {.fallback = 0.25, .min = 0.0, .max = 0.5, .max_open = true}, "amplitude"));
  add(root.number("anything", {.fallback = -3.0}, "free"));
  add(root.number("gap_mm", {.fallback = 0.0, .min = 0.0, .max = 20.0, .min_open = true}, "none when absent"));
  add(static_cast<double>(root.integer("stacks", 0, 1, 1000, "rows")));
  add(static_cast<double>(root.integer("seed", 1, 0, std::numeric_limits<std::int64_t>::max(), "of the noise")));
  out += root.boolean("feels", true, "or not") ? "yes " : "no ";
  out += root.text("title", "", "one line");
  out += root.text("path", "a.sqlite", "file");
  out += root.text("name", std::nullopt, "who");
  out += root.choice("law", "rate", {"rate", "per-update"}, "which", {"per-chip"});
  for (const double value : root.numbers("size", std::vector<double>{1200, 900}, 2, {.min = 16, .max = 8192}, "pixels")) add(value);
  add(root.vector("entry_mm", std::nullopt, {.min = -1e5, .max = 1e5, .to_si = 1e-3}, "where").x);
  if (auto hand = root.table("hand", "who holds it")) add(hand->number("push_N", {.fallback = 20.0, .min = 0.0, .max = 1e9}, "thrust"));
  for (TableReader& region : root.tables("region", "parts")) {
    out += region.choice("shape", std::nullopt, {"cone", "ball"}, "primitive");
    if (region.has("extra")) out += "extra";
  }
  root.finish();
  return out;
}

constexpr const char* kText =
    "radius_mm = 2\nname = \"x\"\nlaw = \"per-update\"\nentry_mm = [1, 2, 3]\n[hand]\n[[region]]\nshape = \"cone\"\n[[region]]\nshape = "
    "\"ball\"\n";

}  // namespace

TEST_CASE("key log: every read is a record, present or not, in the order of asking") {
  const TomlDocument document = parsed(kText);
  Issues issues;
  KeyLog log;
  read_all(document.root(issues, &log));
  REQUIRE(issues.empty());
  std::string order;
  for (const KeyInfo& info : log.keys) order += info.table + (info.table.empty() ? "" : ".") + info.key + " ";
  CHECK(order ==
        "radius_mm noise anything gap_mm stacks seed feels title path name law size entry_mm hand hand.push_N region region[].shape ");
  CHECK(find(log, "", "radius_mm").present);
  CHECK_FALSE(find(log, "", "noise").present);
}

TEST_CASE("key log: kind, unit, default, range, words and about are those of the rule") {
  const TomlDocument document = parsed(kText);
  Issues issues;
  KeyLog log;
  read_all(document.root(issues, &log));
  struct Expected {
    const char *table, *key;
    KeyKind kind;
    const char *unit, *fallback, *range, *about;
  };
  const Expected all[] = {
      {"", "radius_mm", KeyKind::number, "mm", "required", "(0, 20]", "of the bur"},
      {"", "noise", KeyKind::number, "", "0.25", "[0, 0.5)", "amplitude"},
      {"", "anything", KeyKind::number, "", "-3", "", "free"},
      {"", "gap_mm", KeyKind::number, "mm", "none", "(0, 20]", "none when absent"},
      {"", "stacks", KeyKind::integer, "", "none", "[1, 1000]", "rows"},
      {"", "seed", KeyKind::integer, "", "1", "[0, inf)", "of the noise"},
      {"", "feels", KeyKind::boolean, "", "true", "", "or not"},
      {"", "title", KeyKind::text, "", "none", "", "one line"},
      {"", "path", KeyKind::text, "", "\"a.sqlite\"", "", "file"},
      {"", "name", KeyKind::text, "", "required", "", "who"},
      {"", "law", KeyKind::choice, "", "\"rate\"", "", "which"},
      {"", "size", KeyKind::numbers, "", "[1200, 900]", "[16, 8192]", "pixels"},
      {"", "entry_mm", KeyKind::numbers, "mm", "required", "[-1e5, 1e5]", "where"},
      {"", "hand", KeyKind::table, "", "", "", "who holds it"},
      {"hand", "push_N", KeyKind::number, "N", "20", "[0, 1e9]", "thrust"},
      {"", "region", KeyKind::tables, "", "", "", "parts"},
      {"region[]", "shape", KeyKind::choice, "", "required", "", "primitive"},
  };
  CHECK(log.keys.size() == std::size(all));
  for (const Expected& e : all) {
    CAPTURE(e.key);
    const KeyInfo& info = find(log, e.table, e.key);
    CHECK(info.kind == e.kind);
    CHECK(info.unit == e.unit);
    CHECK(info.fallback == e.fallback);
    CHECK(info.range == e.range);
    CHECK(info.about == e.about);
  }
  CHECK(find(log, "", "law").allowed == std::vector<std::string>{"rate", "per-update"});
  CHECK(find(log, "", "law").later == std::vector<std::string>{"per-chip"});
  CHECK(find(log, "", "law").word == "per-update");
  CHECK(find(log, "", "path").word == "a.sqlite");  // absent: the default is what was read
  CHECK(find(log, "", "size").count == 2);
  CHECK(find(log, "", "entry_mm").count == 3);
}

TEST_CASE("key log: questions by has() alone are no records") {
  const TomlDocument document = parsed("a = 1\n");
  Issues issues;
  KeyLog log;
  const TableReader root = document.root(issues, &log);
  CHECK(root.has("a"));
  CHECK_FALSE(root.has("b"));
  CHECK(log.keys.empty());
}

TEST_CASE("key log: reading gives the same values and errors with a log and without") {
  for (const char* text : {kText, "radius_mm = -1\nlaw = \"rat\"\nentry_mm = 3\nhand = 1\nregion = 2\nradus_mm = 1\n"}) {
    const TomlDocument document = parsed(text);
    Issues plain_issues, issues;
    KeyLog log;
    CHECK(read_all(document.root(plain_issues)) == read_all(document.root(issues, &log)));
    REQUIRE(issues.size() == plain_issues.size());
    for (std::size_t n = 0; n < issues.size(); ++n) CHECK(issues[n].text() == plain_issues[n].text());
  }
}

TEST_CASE("key log: of two reads of one key the first stands, unless the second says more") {
  const TomlDocument document = parsed("kind = \"script\"\n[contact]\nrate_hz = 1\n");
  Issues issues;
  KeyLog log;
  TableReader root = document.root(issues, &log);
  (void)root.text("kind", "script", "looked at");
  (void)root.choice("kind", "script", {"script"}, "chosen");
  (void)root.text("kind", "script", "looked at again");
  (void)root.table("contact", "");
  (void)root.table("contact", "force feedback");
  (void)root.table("contact", "");
  REQUIRE(log.keys.size() == 2);
  CHECK(log.keys[0].kind == KeyKind::choice);
  CHECK(log.keys[0].about == "chosen");
  CHECK(log.keys[1].about == "force feedback");
  CHECK(log.keys[1].present);
}

TEST_CASE("key log: units are written as people write them") {
  const char* const pairs[][2] = {{"spacing_mm", "mm"},
                                  {"damping_N_s_per_m", "N s/m"},
                                  {"stiffness_N_per_m", "N/m"},
                                  {"rate_hz", "Hz"},
                                  {"feed_mm_per_s", "mm/s"},
                                  {"turn_deg", "deg"},
                                  {"advance_um_per_rev", "um/rev"},
                                  {"slip_per_rev", "1/rev"},
                                  {"push_N", "N"},
                                  {"seed", ""},
                                  {"plate_normal", ""},
                                  {"_mm", ""},
                                  {"substep_voxels", "voxels"},
                                  {"latency_ticks", "ticks"},
                                  {"stall_torque_Nm", "N m"},
                                  {"coupling_Nm_per_rad", "N m/rad"},
                                  {"coupling_Nm_s_per_rad", "N m s/rad"},
                                  {"inertia_kg_m2", "kg m^2"},
                                  {"specific_energy_J_per_mm3", "J/mm^3"},
                                  {"hardness", ""}};
  for (const auto& [key, unit] : pairs) {
    CAPTURE(key);
    CHECK(unit_of(key) == unit);
  }
}

TEST_CASE("key log: indices of arrays are dropped from paths") {
  CHECK(without_indices("region[12].part[0].z") == "region[].part[].z");
  CHECK(without_indices("") == "");
  CHECK(without_indices("volume") == "volume");
}
