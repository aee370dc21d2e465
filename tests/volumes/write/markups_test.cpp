#include <doctest/doctest.h>
#include <fmt/format.h>

#include "core/base/random.h"
#include "core/base/units.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/read/volume_files.h"
#include "volumes/read/located_json.h"
#include "volumes/read/markups.h"
#include "volumes/write/planned_line.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// What 3D Slicer 5 writes for a line of two points, shortened; the coordinates in mm.
std::string slicer_line(const std::string& system, const std::string& first, const std::string& second) {
  return fmt::format(R"({{
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
    "markups": [
        {{
            "type": "Line",
            "coordinateSystem": "{}",
            "coordinateUnits": "mm",
            "locked": false,
            "fixedNumberOfControlPoints": false,
            "labelFormat": "%N-%d",
            "lastUsedControlPointNumber": 2,
            "controlPoints": [
                {{
                    "id": "1",
                    "label": "L-1",
                    "description": "",
                    "associatedNodeID": "vtkMRMLScalarVolumeNode1",
                    "position": {},
                    "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],
                    "selected": true,
                    "positionStatus": "defined"
                }},
                {{
                    "id": "2",
                    "label": "L-2",
                    "position": {},
                    "selected": true,
                    "positionStatus": "defined"
                }}
            ],
            "measurements": [{{"name": "length", "enabled": true, "value": 26.9, "units": "mm", "printFormat": "%-#4.4g%s"}}],
            "display": {{"visibility": true, "opacity": 1.0, "color": [0.4, 1.0, 1.0]}}
        }}
    ]
}}
)",
                     system, first, second);
}

std::string slicer_fcsv(const std::string& header, const std::string& rows) {
  return "# Markups fiducial file version = 4.11\n" + header +
         "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n" + rows;
}

PlannedLine line_of(const Result<PlannedLine>& read) {
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  return read.value();
}

bool same(const PlannedLine& line, const Vec3& entry_mm, const Vec3& target_mm) {
  return glm::length(line.entry - entry_mm * kMillimetre) < 1e-15 && glm::length(line.target - target_mm * kMillimetre) < 1e-15;
}

std::string json_error(const std::string& text) {
  const auto read = parse_markups_json(text, "plan.mrk.json");
  return read ? "" : read.error().text();
}
std::string fcsv_error(const std::string& text) {
  const auto read = parse_markups_fcsv(text, "plan.fcsv");
  return read ? "" : read.error().text();
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

constexpr const char* kRows = "1,30.5,-12,80,0,0,0,1,1,1,0,F-1,,vtkMRMLScalarVolumeNode1\n2,10,-2,60.25,0,0,0,1,1,1,0,\"F, \"\"2\"\"\",,\n";

}  // namespace

TEST_CASE("markups: a line of 3D Slicer is read in LPS and in RAS, where x and y change sign") {
  const Vec3 entry(30.5, -12, 80), target(10, -2, 60.25);
  CHECK(same(line_of(parse_markups_json(slicer_line("LPS", "[30.5, -12, 80]", "[10, -2, 60.25]"), "a")), entry, target));
  CHECK(same(line_of(parse_markups_json(slicer_line("RAS", "[-30.5, 12, 8e1]", "[-10, 2, 60.25]"), "a")), entry, target));
  for (const char* const system : {"# CoordinateSystem = LPS\n", "# CoordinateSystem = 1\n"})
    CHECK(same(line_of(parse_markups_fcsv(slicer_fcsv(system, kRows), "a")), entry, target));
  const Vec3 turned_entry(-30.5, 12, 80), turned_target(-10, 2, 60.25);
  for (const char* const system : {"# CoordinateSystem = RAS\r\n", "# CoordinateSystem = 0\n", ""})
    CHECK(same(line_of(parse_markups_fcsv(slicer_fcsv(system, kRows), "a")), turned_entry, turned_target));
  // Sabotage: a file whose frame is read as the other one puts the entry 65 mm away.
  const PlannedLine flipped = line_of(parse_markups_json(slicer_line("RAS", "[30.5, -12, 80]", "[10, -2, 60.25]"), "a"));
  CHECK_FALSE(same(flipped, entry, target));
  CHECK(glm::length(flipped.entry - entry * kMillimetre) > 65.0 * kMillimetre);
}

TEST_CASE("markups: what is written is read as the same line, in both frames and formats; the wrong frame is not") {
  constexpr std::uint64_t kSeed = 19;
  std::uint64_t count = 0;
  const auto number = [&] { return 0.2 * uniform11(kSeed, count++); };
  for (int n = 0; n < 200; ++n) {
    const PlannedLine line{Vec3(number(), number(), number()), Vec3(number(), number(), number())};
    for (const MarkupsFrame frame : {MarkupsFrame::lps, MarkupsFrame::ras}) {
      const std::string json = markups_json(line, frame), fcsv = markups_fcsv(line, frame);
      for (const PlannedLine& read : {line_of(parse_markups_json(json, "a")), line_of(parse_markups_fcsv(fcsv, "a"))}) {
        // A product with 0.001 does not reach every double: one unit in the last place.
        CHECK(glm::length(read.entry - line.entry) <= 0x1p-52);
        CHECK(glm::length(read.target - line.target) <= 0x1p-52);
      }
      const std::string other = frame == MarkupsFrame::lps ? "RAS" : "LPS", own = frame == MarkupsFrame::lps ? "LPS" : "RAS";
      const PlannedLine wrong = line_of(parse_markups_json(replaced(json, "\"" + own + "\"", "\"" + other + "\""), "a"));
      CHECK(glm::length(wrong.entry - line.entry) == doctest::Approx(2.0 * std::hypot(line.entry.x, line.entry.y)));
    }
  }
}

TEST_CASE("markups: labels entry and target decide, in any order and case and beside other points") {
  const auto with_labels = [&](const char* first, const char* second) {
    return replaced(replaced(slicer_line("LPS", "[30.5, -12, 80]", "[10, -2, 60.25]"), "L-1", first), "L-2", second);
  };
  const Vec3 one(30.5, -12, 80), two(10, -2, 60.25);
  CHECK(same(line_of(parse_markups_json(with_labels("a", "b"), "a")), one, two));
  CHECK(same(line_of(parse_markups_json(with_labels("Target", "Entry"), "a")), two, one));
  CHECK(same(line_of(parse_markups_json(with_labels("target", "x"), "a")), two, one));
  CHECK(same(line_of(parse_markups_json(with_labels("x", " ENTRY "), "a")), two, one));
  const std::string three = "0,1,2,3,0,0,0,1,1,1,0,nasion,,\n" + replaced(replaced(kRows, "F-1", "Entry"), "\"F, \"\"2\"\"\"", "target");
  CHECK(same(line_of(parse_markups_fcsv(slicer_fcsv("# CoordinateSystem = LPS\n", three), "a")), one, two));
  CHECK(same(line_of(parse_markups_fcsv(
                 "# CoordinateSystem = LPS\n# columns = label,x,y,z,sel,vis\nentry,30.5,-12,80,1,1\ntarget,10,-2,60.25,1,1\n", "a")),
             one, two));
}

TEST_CASE("markups: points that are not placed are left out; micrometres, several markups and old lists are read") {
  const std::string line = slicer_line("LPS", "[30.5, -12, 80]", "[10, -2, 60.25]");
  const Vec3 entry(30.5, -12, 80), target(10, -2, 60.25);
  const std::string micrometres = slicer_line("LPS", "[30500, -12e3, 80000]", "[1e4, -2000, 60250]");
  CHECK(same(line_of(parse_markups_json(replaced(micrometres, "\"mm\"", "\"um\""), "a")), entry, target));
  CHECK(same(line_of(parse_markups_json(replaced(line, "\"mm\"", "[\"mm\", \"UCUM\", \"millimeter\"]"), "a")), entry, target));
  CHECK(same(line_of(parse_markups_json(replaced(line, "\"Line\"", "\"Fiducial\""), "a")), entry, target));
  CHECK(same(line_of(parse_markups_json(replaced(line, "            \"coordinateSystem\": \"LPS\",\n", ""), "a")), entry, target));
  CHECK(same(line_of(parse_markups_json(replaced(line, "\"markups\": [", "\"markups\": [{\"type\": \"Plane\"}, "), "a")), entry, target));
  const std::string third = "\"controlPoints\": [{\"id\": \"0\", \"positionStatus\": \"undefined\"}, ";
  CHECK(same(line_of(parse_markups_json(replaced(line, "\"controlPoints\": [", third), "a")), entry, target));
}

TEST_CASE("markups: errors of a JSON file name line and column, and what is wrong there") {
  const std::string line = slicer_line("LPS", "[30.5, -12, 80]", "[10, -2, 60.25]");
  CHECK(json_error(replaced(line, "\"LPS\"", "\"IJK\"")) == "plan.mrk.json:6:33: coordinateSystem must be \"LPS\" or \"RAS\"");
  CHECK(json_error(replaced(line, "\"mm\"", "\"inch\"")) == "plan.mrk.json:7:32: coordinateUnits must be \"mm\" or \"um\"");
  CHECK(json_error(replaced(line, "[30.5, -12, 80]", "[30.5, -12]")) == "plan.mrk.json:18:33: position must be three numbers");
  CHECK(json_error(replaced(line, "[30.5, -12, 80]", "[30.5, \"x\", 80]")) == "plan.mrk.json:18:40: position must be three numbers");
  CHECK(json_error(replaced(line, "[30.5, -12, 80]", "[30.5, -12, 80e9]")) == "plan.mrk.json:13:17: a coordinate is beyond 1e5 mm");
  CHECK(json_error(replaced(line, "\"position\": [30.5, -12, 80],", "")) == "plan.mrk.json:13:17: a control point without a position");
  CHECK(json_error(replaced(line, "[10, -2, 60.25]", "[30.5, -12, 80.05]")) ==
        "plan.mrk.json:23:17: entry and target are less than 0.1 mm apart: they have no direction");
  CHECK(json_error(replaced(line, "\"positionStatus\": \"defined\"", "\"positionStatus\": \"undefined\"")) ==
        "plan.mrk.json:12:30: has 1 point: a plan has two, entry and target, or two that are labelled so");
  CHECK(json_error(replaced(line, "\"Line\"", "\"ROI\"")) ==
        "plan.mrk.json:4:9: is a markup of another type: a plan is a \"Line\", or a \"Fiducial\" list of points");
  CHECK(json_error(replaced(replaced(line, "\"Line\"", "\"ROI\""), "\"markups\": [", "\"markups\": [{\"type\": \"Plane\"}, ")) ==
        "plan.mrk.json:3:16: has 2 markups, 0 of them lines: save the planned line alone");
  CHECK(json_error(replaced(line, "controlPoints", "points")) == "plan.mrk.json:4:9: the markup has no list \"controlPoints\"");
  CHECK(json_error("[1, 2]") == "plan.mrk.json:1:1: is no markups file of 3D Slicer: it has no list \"markups\"");
  CHECK(json_error("") ==
        "plan.mrk.json:1:1: is not JSON: syntax error while parsing value - unexpected end of input; expected '[', '{', or a literal");
  CHECK(json_error("{\"markups\": [\n  {\"type\" \"Line\"}]}")
            .starts_with("plan.mrk.json:2:16: is not JSON: syntax error while parsing object separator"));
  CHECK(json_error("{\"a\": 1e999}").starts_with("plan.mrk.json:1:"));
  CHECK(json_error(std::string(100, '[')) == "plan.mrk.json:1:65: is nested deeper than 64 levels");
}

TEST_CASE("markups: errors of a list of points name line and column") {
  const std::string lps = "# CoordinateSystem = LPS\n";
  CHECK(fcsv_error(slicer_fcsv(lps, replaced(kRows, "-12", "twelve"))) == "plan.fcsv:4:8: y is not a number");
  CHECK(fcsv_error(slicer_fcsv(lps, replaced(kRows, "60.25", "nan"))) == "plan.fcsv:5:9: z is not a number");
  CHECK(fcsv_error(slicer_fcsv(lps, "1,2\n")) == "plan.fcsv:4:1: has 2 fields: a point needs id, x, y and z, separated by commas");
  CHECK(fcsv_error(slicer_fcsv("# CoordinateSystem = IJK\n", kRows)) == "plan.fcsv:2:22: CoordinateSystem must be LPS (1) or RAS (0)");
  CHECK(fcsv_error("") == "plan.fcsv:1:1: has 0 points: a plan has two, entry and target, or two that are labelled so");
}

TEST_CASE("markups: values of a JSON text know where they stand") {
  const std::string text = "{\"a\": [1, -2.5e1, \"x\\\"\\\\\"],\n \"b\": {\"c\": null, \"d\": true, \"e\": false}}";
  const auto root = parse_json(text, "a");
  REQUIRE(root.ok());
  const auto starts = [&](const JsonValue* value, const std::string& with) {
    REQUIRE(value != nullptr);
    return text.substr(value->at).starts_with(with);
  };
  const JsonValue* list = root->find("a");
  CHECK(starts(list, "["));
  CHECK(starts(&list->items[0], "1,"));
  CHECK(starts(&list->items[1], "-2.5e1"));
  CHECK(starts(&list->items[2], "\"x"));
  CHECK(list->items[2].text == "x\"\\");
  const JsonValue* object = root->find("b");
  CHECK(starts(object, "{\"c\""));
  CHECK(starts(object->find("c"), "null"));
  CHECK(starts(object->find("d"), "true"));
  CHECK(starts(object->find("e"), "false"));
  CHECK(object->find("f") == nullptr);
  CHECK(place_in(text, object->at, "a") == "a:2:7");
  CHECK(parse_json("12", "a")->at == 0);
}

TEST_CASE("markups: a file is written whole and read by its ending") {
  const TemporaryFolder folder;
  const PlannedLine line{Vec3(0.01, -0.02, 0.03), Vec3(0.005, 0.0, -0.01)};
  for (const char* const name : {"a.mrk.json", "a.fcsv"}) {
    CHECK(is_markups_path(name));
    REQUIRE(write_planned_line(folder.file(name), line).ok());
    CHECK(same(line_of(read_planned_line(folder.file(name))), line.entry / kMillimetre, line.target / kMillimetre));
  }
  CHECK_FALSE(is_markups_path("a.json"));
  CHECK(read_planned_line(folder.file("none.fcsv")).error().text() ==
        folder.file("none.fcsv") + ": cannot be read: No such file or directory");
  CHECK(read_planned_line("plan.txt").error().text() == "plan.txt: must end in .mrk.json or .fcsv");
}
