#include "core/drill/chip_load.h"

#include <doctest/doctest.h>

#include <numbers>
#include <string>

#include "core/tool/make_tool.h"

using namespace burrhole;

namespace {

constexpr const char* kFlat = R"(
[shell]
pitch_mm = 0.5
[[region]]
shape = "cylinder"
z_mm = 0
height_mm = 2
diameter_mm = 8
erosion_factor = 0.1
[[region]]
shape = "cylinder"
z_mm = 2
height_mm = 4
diameter_mm = 12
erosion_factor = 0
)";

Tool make(const std::string& text) {
  const auto document = TomlDocument::parse(text, "flat.toml");
  REQUIRE(document);
  Issues issues;
  auto tool = make_tool(*document, {.erosion_pitch = 0.1e-3}, issues);
  REQUIRE_MESSAGE(tool, (issues.empty() ? "" : issues.front().text()));
  return std::move(*tool);
}

}  // namespace

TEST_CASE("chip load: the area is that of the cutting part alone, and the teeth are those of the tool file or of the shape") {
  const Tool by_shape = make(std::string("title = \"flat\"\n") + kFlat);
  const CuttingTeeth teeth = cutting_teeth(by_shape);
  // A lattice of 0.1 mm: the rim of 25 mm is uncertain by half a cell.
  CHECK(teeth.area == doctest::Approx(std::numbers::pi * 16e-6).epsilon(0.5 * 25.1 * 0.1 / 50.3));
  CHECK(teeth.count == 4);  // a flat bit of 8 mm
  CHECK(by_shape.teeth == 4);
  CHECK(cutting_teeth(make(std::string("title = \"flat\"\nteeth = 3\n") + kFlat)).count == 3);
}

TEST_CASE("chip load: a bit that is fed by f a revolution cuts chips of f / z") {
  const CuttingTeeth teeth{.count = 4, .area = 50e-6};
  const double feed = 20e-6, spin = 1000.0 / 60.0, dt = 0.02;
  const double mass = teeth.area * feed * spin * dt;
  const ChipLoad load = chip_load(teeth, {.mass = mass, .hardness = 0.6, .tangential = 14.0, .torque = 0.07, .spin = spin, .dt = dt});
  CHECK(load.cuts);
  CHECK(load.thickness == doctest::Approx(feed / 4));
  CHECK(load.volume == doctest::Approx(teeth.area * feed / 4));
  CHECK(load.volume * teeth.count * spin * dt == doctest::Approx(mass));  // nothing is lost
  CHECK(load.hardness == 0.6);
  CHECK(load.force == doctest::Approx(3.5));
  CHECK(load.power == doctest::Approx(2.0 * std::numbers::pi * spin * 0.07));
}

TEST_CASE("chip load: without spin, teeth or removal there is no chip, and no division by zero") {
  const CuttingTeeth teeth{.count = 2, .area = 5e-6};
  for (const ChipLoad& load : {chip_load(teeth, {.mass = 1e-9, .hardness = 1.0, .spin = 0.0, .dt = 0.02}),
                               chip_load({}, {.mass = 1e-9, .hardness = 1.0, .spin = 10.0, .dt = 0.02}),
                               chip_load(teeth, {.mass = 0.0, .hardness = 0.0, .tangential = 5.0, .spin = 10.0, .dt = 0.02})}) {
    CHECK_FALSE(load.cuts);
    CHECK(load.volume == 0.0);
    CHECK(load.thickness == 0.0);
    CHECK(load.hardness == 0.0);
  }
  CHECK(chip_load(teeth, {.tangential = 5.0, .spin = 10.0, .dt = 0.02}).force == doctest::Approx(2.5));  // it rubs
}
