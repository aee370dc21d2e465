// Cutting regions that the bit's own passive regions cover.

#include "core/tool/buried_cutters.h"

#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/shipped_spec.h"

namespace burrhole::test {
namespace {

RegionSpec region(const char* name, const Solid& solid, double factor) {
  RegionSpec out;
  out.name = name;
  out.solid = solid;
  out.erosion.base = factor;
  return out;
}

ToolSpec bit(std::vector<RegionSpec> regions) {
  ToolSpec out;
  out.regions = std::move(regions);
  return out;
}

TEST_CASE("buried cutters: a cutter inside a passive body is named with the body and all of its surface, wherever it stands in the file") {
  const RegionSpec cutter = region("cutter", make_sphere(2e-3, 1e-3), 0.2), body = region("body", make_cylinder(0.0, 8e-3, 3e-3), 0.0);
  for (const bool first : {true, false}) {
    const auto found = find_buried_cutters(first ? bit({cutter, body}) : bit({body, cutter}));
    REQUIRE(found.size() == 1);
    CHECK(found[0].region == "cutter");
    CHECK(found[0].body == "body");
    CHECK(found[0].share == 1.0);
    CHECK(buried_text(found[0]).find("\"cutter\" lies inside the passive region \"body\", 100 % of its surface") != std::string::npos);
  }
}

TEST_CASE("buried cutters: the share is that of the surface") {
  // A cylinder of height h and diameter d with its lowest part s outside of the body: of the faces of cells, which are square to the axes, the
  // ends count pi d^2 / 4 each and the side 4 d for each unit of height.
  constexpr double kPi = 3.14159265358979, kDiameter = 2e-3, kHeight = 12e-3;
  const double ends = 2.0 * kPi * kDiameter * kDiameter / 4.0, side = 4.0 * kDiameter * kHeight;
  for (const double out : {0.2e-3, 0.5e-3, 3e-3}) {
    CAPTURE(out);
    const auto found = find_buried_cutters(
        bit({region("cutter", make_cylinder(0.0, kHeight, 0.5 * kDiameter), 0.2), region("body", make_cylinder(out, kHeight, 3e-3), 0.0)}));
    const double share = 1.0 - (0.5 * ends + side * out / kHeight) / (ends + side);
    CHECK(found.empty() == (share < kBuried));
    // A cell is a 96th of the height: 0.7 % of the side.
    if (!found.empty()) CHECK(found[0].share == doctest::Approx(share).epsilon(0.02));
  }
}

TEST_CASE("buried cutters: a coating, a ring that is flush with its body and a cutter between cutters are none") {
  const Solid core = make_cylinder(0.0, 6e-3, 2e-3), coat = make_cylinder(0.0, 6e-3, 2.2e-3);
  CHECK(find_buried_cutters(bit({region("core", core, 0.0), region("coat", coat, 0.2)})).empty());
  const RegionSpec ring = region("ring", make_cylinder(2e-3, 2e-3, 2e-3), 0.2), body = region("body", core, 0.0);
  CHECK(find_buried_cutters(bit({ring, body})).empty());
  // Listed after the body, the ring owns nothing.
  CHECK(find_buried_cutters(bit({body, ring})).size() == 1);
  const RegionSpec inner = region("inner", make_cylinder(1e-3, 2e-3, 1e-3), 0.2), outer = region("outer", core, 0.2);
  CHECK(find_buried_cutters(bit({inner, outer})).empty());
}

TEST_CASE("buried cutters: no shipped bit has one") {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(in_source("app/tools"))) {
    CAPTURE(entry.path().string());
    CHECK(find_buried_cutters(shipped_spec(entry.path().stem().string())).empty());
    ++count;
  }
  CHECK(count >= 14);
}

}  // namespace
}  // namespace burrhole::test
