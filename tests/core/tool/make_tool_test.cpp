#include "core/tool/make_tool.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace burrhole;

namespace {

const std::string kGood =
    "title = \"Bit\"\n"                                // 1
    "[shell]\npitch_mm = 1\n"                          // 2, 3
    "[[region]]\n"                                     // 4
    "shape = \"cylinder\"\nz_mm = 0\nheight_mm = 3\n"  // 5, 6, 7
    "diameter_mm = 11\nerosion_factor = 0.1\n";        // 8, 9

/// kGood with one line replaced (1-based), or a line added after the last.
std::string with_line(int line, const std::string& text) {
  std::string out;
  int number = 1;
  for (std::size_t at = 0; at < kGood.size(); ++number) {
    const std::size_t end = kGood.find('\n', at);
    out += number == line ? text : kGood.substr(at, end - at);
    out += '\n';
    at = end + 1;
  }
  return line >= number ? out + text + '\n' : out;
}

std::vector<std::string> faults(const std::string& text, const ToolOptions& options = {}) {
  const auto document = TomlDocument::parse(text, "bit.toml");
  if (!document) return {document.error().text()};
  Issues issues;
  const auto tool = make_tool(document.value(), options, issues);
  CHECK(tool.has_value() == issues.empty());
  std::vector<std::string> lines;
  for (const Error& issue : issues) lines.push_back(issue.text());
  return lines;
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("tool file: a good one fills every field") {
  const auto document = TomlDocument::parse(kGood, "some/folder/bit.toml");
  REQUIRE(document.ok());
  Issues issues;
  const auto tool = make_tool(document.value(), {.erosion_pitch = 0.5e-3}, issues);
  REQUIRE(tool);
  CHECK(tool->name == "bit");
  CHECK(tool->title == "Bit");
  CHECK(tool->shell.size() > 100);
  CHECK(tool->erosion.pitch == 0.5e-3);
  CHECK(tool->erosion.size() > 1000);
  CHECK(tool->mesh.indices.size() > 100);
  CHECK(tool->bound_lo.z == 0.0);
  CHECK(tool->bound_hi.x == doctest::Approx(5.5e-3).epsilon(1e-12));
  CHECK(tool->bound_hi.z == doctest::Approx(3e-3).epsilon(1e-12));
  CHECK(tool->bound_radius == doctest::Approx(std::sqrt(5.5e-3 * 5.5e-3 + 9e-6)).epsilon(1e-12));
}

TEST_CASE("tool file: errors are reported with their line and column") {
  const std::pair<std::string, Lines> table[] = {
      {with_line(8, "diameter_mm = -5"), {"bit.toml:8:1: region[0].diameter_mm = -5 must be in [0.01, 100]"}},
      {with_line(8, "diameter_mm = nan"), {"bit.toml:8:1: region[0].diameter_mm = nan must be a finite number"}},
      {with_line(8, "diameter = 11"), {"bit.toml:8:1: region[0].diameter lacks its unit: write \"diameter_mm\""}},
      {with_line(8, ""), {"bit.toml:4:1: region[0].diameter_mm is missing (largest diameter)"}},
      {with_line(9, "erosion_factor = -1"), {"bit.toml:9:1: region[0].erosion_factor = -1 must be in [0, 100]"}},
      {with_line(10, "rim_facter = 1"), {"bit.toml:10:1: unknown key \"rim_facter\" in [region[0]]; did you mean \"rim_factor\"?"}},
      {with_line(5, "shape = \"cilinder\""),
       {"bit.toml:5:1: region[0].shape = \"cilinder\" must be one of \"cylinder\", \"cone\", \"frustum\", \"tube\", \"sphere\", "
        "\"ellipsoid\", \"box\"; did you mean \"cylinder\"?"}},
      {with_line(3, "pitch_mm = 0"), {"bit.toml:3:1: shell.pitch_mm = 0 must be in [0.01, 20]"}},
      {with_line(3, ""), {"bit.toml:2:2: shell.pitch_mm is missing (largest gap between shell points)"}},
      {with_line(2, "[shel]"),
       {"bit.toml:4:1: region[0].pitch_mm is missing: give it here or in [shell], or give stacks and slices",
        "bit.toml:2:2: unknown table [shel]; did you mean [shell]?"}},
      {with_line(6, "z_mm = 1"), {"bit.toml:6:1: region[0].z_mm = 1 must be 0 for the lowest region: the tip is the origin"}},
      {with_line(10, "stacks = 4"), {"bit.toml:10:1: region[0].stacks = 4 needs slices too"}},
      {with_line(10, "slices = 8"), {"bit.toml:10:1: region[0].slices = 8 needs stacks too"}},
      {with_line(10, "slices = 8\nstacks = 4\npitch_mm = 1"),
       {"bit.toml:12:1: region[0].pitch_mm = 1 cannot stand beside stacks and slices"}},
      {with_line(10, "voxel_mm = 1"), {"bit.toml:10:1: region[0].voxel_mm = 1 needs stacks and slices"}},
      {with_line(10, "[[region]]\nshape=\"sphere\"\nz_mm=5\ndiameter_mm=2\nerosion_factor=0"),
       {"bit.toml:4:3: region is not a single body: regions do not hold together at z = 3 mm"}},
      {with_line(10, "[[region]]\nshape=\"sphere\"\nz_mm=2\ndiameter_mm=2\nerosion_factor=0\nheight_mm = 2"),
       {"bit.toml:15:1: unknown key \"height_mm\" in [region[1]]"}},
      {"title = \"x\"\n", {"bit.toml: region is missing: a tool needs at least one [[region]]"}},
      {"title = \"x\"\nregion = []\n", {"bit.toml:2:1: region is empty: a tool needs at least one [[region]]"}},
      {with_line(1, ""), {"bit.toml: title is missing (what the tool is, one line)"}},
  };
  for (const auto& [text, lines] : table) {
    CAPTURE(text);
    CHECK(faults(text) == lines);
  }
}

TEST_CASE("tool file: more regions than the limit are refused before they are read") {
  std::string text = "title = \"t\"\n[shell]\npitch_mm = 1\n";
  for (int n = 0; n < 129; ++n) text += "[[region]]\nx = 1\n";
  CHECK(faults(text) == Lines{"bit.toml:4:3: region has 129 elements, at most 128 are read"});
}

TEST_CASE("tool file: a frustum needs one end wider than nothing") {
  std::string text = with_line(5, "shape = \"frustum\"");
  text.replace(text.find("diameter_mm = 11"), 16, "bottom_diameter_mm = 0\ntop_diameter_mm = 0");
  CHECK(faults(text) == Lines{"bit.toml:9:1: region[0].top_diameter_mm = 0 must be > 0 when bottom_diameter_mm is 0"});
}

TEST_CASE("tool file: all errors come in one go") {
  CHECK(faults(with_line(8, "diameter_mm = -5\ncolour = \"red\"\nskin_mm = inf")).size() == 3);
}

TEST_CASE("tool file: too many erosion points name the file and are out of range") {
  const auto document = TomlDocument::parse(kGood, "bit.toml");
  REQUIRE(document.ok());
  Issues issues;
  CHECK_FALSE(make_tool(document.value(), {.erosion_pitch = 1e-5}, issues));
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].code == ErrorCode::out_of_range);
  CHECK(issues[0].text() == "bit.toml: an erosion pitch of 0.01 mm makes more than 20000000 erosion points: take a coarser pitch");
  CHECK(faults(kGood, {.erosion_pitch = -1.0}) == Lines{"bit.toml: erosion pitch = -1000 mm must be > 0"});
}

TEST_CASE("tool file: too many shell points are out of range") {
  CHECK(faults(with_line(3, "pitch_mm = 0.01")).at(0).rfind("bit.toml: the point shell would have ", 0) == 0);
}

TEST_CASE("tool file: a missing file and a broken one are issues") {
  Issues issues;
  CHECK_FALSE(load_tool("/nowhere/bit.toml", {}, issues));
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].text() == "/nowhere/bit.toml: cannot be read: No such file or directory");
  CHECK(faults("title = \n").at(0).rfind("bit.toml:1:9: ", 0) == 0);
}

TEST_CASE("tool file: an erosion factor may be overridden by an assignment") {
  auto document = TomlDocument::parse(kGood, "bit.toml");
  REQUIRE(document.ok());
  REQUIRE(document.value().set("region[0].erosion_factor=0.5").ok());
  Issues issues;
  const auto tool = make_tool(document.value(), {.erosion_pitch = 1e-3}, issues);
  REQUIRE(tool);
  for (const float factor : tool->erosion.factors) CHECK(factor == 0.5f);
}

namespace {

/// The region of kGood, given in full.
std::vector<std::string> region_faults(const std::string& keys) {
  return faults("title = \"Bit\"\n[shell]\npitch_mm = 1\n[[region]]\nz_mm = 0\nheight_mm = 3\nerosion_factor = 0.1\n" + keys);  // 7 lines
}

}  // namespace

TEST_CASE("tool file: a tube by two diameters or by four") {
  CHECK(region_faults("shape = \"tube\"\ndiameter_mm = 12\ninner_diameter_mm = 10\n").empty());
  CHECK(region_faults("shape = \"tube\"\nbottom_diameter_mm = 12\ntop_diameter_mm = 11\ninner_bottom_diameter_mm = 12\n"
                      "inner_top_diameter_mm = 9\ninner_factor = 0\n")
            .empty());
  CHECK(region_faults("shape = \"tube\"\ndiameter_mm = 10\ninner_diameter_mm = 10\n") ==
        Lines{"bit.toml:10:1: region[0].inner_diameter_mm = 10 leaves no wall: the bore must be narrower than the tube"});
  CHECK(region_faults("shape = \"tube\"\nbottom_diameter_mm = 12\ntop_diameter_mm = 11\ninner_bottom_diameter_mm = 13\n"
                      "inner_top_diameter_mm = 9\n") ==
        Lines{"bit.toml:12:1: region[0].inner_top_diameter_mm = 9 leaves no wall: the bore must be narrower than the tube"});
  CHECK(region_faults("shape = \"tube\"\ndiameter_mm = 12\n") ==
        Lines{"bit.toml:4:1: region[0].inner_diameter_mm is missing (diameter of the bore)"});
  CHECK(region_faults("shape = \"cylinder\"\ndiameter_mm = 12\ninner_factor = 0\n") ==
        Lines{"bit.toml:10:1: unknown key \"inner_factor\" in [region[0]]"});
}

TEST_CASE("tool file: a box by width, depth and height, sampled by pitch") {
  const std::string box = "shape = \"box\"\nwidth_mm = 12\ndepth_mm = 0.6\n";
  CHECK(region_faults(box + "x_mm = -1\nside_factor = 0\nplus_x_factor = 1\n").empty());
  CHECK(region_faults("shape = \"box\"\nwidth_mm = 0\ndepth_mm = 0.6\n") ==
        Lines{"bit.toml:9:1: region[0].width_mm = 0 must be in [0.01, 100]"});
  CHECK(region_faults(box + "diameter_mm = 3\n") == Lines{"bit.toml:11:1: unknown key \"diameter_mm\" in [region[0]]"});
  CHECK(faults("title = \"Bit\"\n[[region]]\nz_mm = 0\nheight_mm = 3\nerosion_factor = 0.1\n" + box + "stacks = 4\nslices = 8\n") ==
        Lines{"bit.toml:9:1: region[0].stacks = 4 is for what is round: give a box pitch_mm"});
  CHECK(region_faults("shape = \"cylinder\"\ndiameter_mm = 12\nplus_x_factor = 0\n").size() == 1);
}
