#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "core/tool/make_tool.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

const std::filesystem::path kFolder = test::in_source("app/tools");

Tool shipped(const std::string& name, double pitch = 0.25e-3) {
  Issues issues;
  auto tool = load_tool((kFolder / (name + ".toml")).string(), {.erosion_pitch = pitch}, issues);
  for (const Error& issue : issues) FAIL_CHECK(issue.text());
  REQUIRE(tool);
  return std::move(*tool);
}

}  // namespace

TEST_CASE("shipped tools: every file loads without an issue and stays within its bounds") {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const Tool tool = shipped(entry.path().stem().string());
    CAPTURE(tool.name);
    CHECK(tool.name == entry.path().stem().string());
    CHECK_FALSE(tool.title.empty());
    CHECK(tool.erosion.size() > 100);
    CHECK(tool.shell.size() >= 72);    // the paper's round bit
    CHECK(tool.shell.size() <= 5000);  // what a servo at 1 kHz can look at
    CHECK(std::any_of(tool.shell.cutting.begin(), tool.shell.cutting.end(), [](std::uint8_t c) { return c != 0; }));
    for (const auto* points : {&tool.shell.positions, &tool.erosion.positions})
      for (const Vec3& p : *points) {
        CHECK(glm::length(p) <= tool.bound_radius);
        CHECK(glm::all(glm::lessThanEqual(tool.bound_lo, p)));
        CHECK(glm::all(glm::lessThanEqual(p, tool.bound_hi)));
      }
    CHECK(tool.bound_lo.z == 0.0);  // the tip is the origin
  }
  CHECK(count >= 14);
}

TEST_CASE("shipped tools: the paper's two bits have 316 and 72 points, all of them cutting") {
  for (const auto& [name, points] : {std::pair<const char*, std::size_t>{"acosta_liu_perforator", 316}, {"acosta_liu_round", 72}}) {
    const Tool tool = shipped(name);
    CHECK(tool.shell.size() == points);
    CHECK(std::count(tool.shell.cutting.begin(), tool.shell.cutting.end(), 1) == static_cast<std::ptrdiff_t>(points));
  }
}

TEST_CASE("shipped tools: the 14/11 perforator leads with 11 mm by 3 mm and its drills cut at their own rates") {
  const Tool tool = shipped("perforator_14_11");
  double inner_radius = 0.0, outer_radius = 0.0, top = 0.0;
  float inner = -1.0f, outer = -1.0f;
  for (std::size_t i = 0; i < tool.erosion.size(); ++i) {
    const Vec3& p = tool.erosion.positions[i];
    float& factor = p.z < 3e-3 ? inner : outer;
    double& radius = p.z < 3e-3 ? inner_radius : outer_radius;
    if (factor < 0.0f) factor = tool.erosion.factors[i];
    CHECK(tool.erosion.factors[i] == factor);
    radius = std::max(radius, std::hypot(p.x, p.y));
    top = std::max(top, p.z);
  }
  CHECK(inner > 0.0f);
  CHECK(outer > 0.0f);
  CHECK(inner != outer);
  // the outermost cell centre lies within a cell's diagonal, 0.36 mm, of the rim
  CHECK(inner_radius == doctest::Approx(5.5e-3).epsilon(0.07));
  CHECK(outer_radius == doctest::Approx(7e-3).epsilon(0.06));
  CHECK(top < 12e-3);  // shoulder and shank are passive
}

TEST_CASE("shipped tools: round burrs of 2 to 6 mm cut with the volume of their head alone") {
  for (int diameter = 2; diameter <= 6; ++diameter) {
    CAPTURE(diameter);
    const double d = diameter * 1e-3;
    const Tool tool = shipped("round_burr_" + std::to_string(diameter) + "mm", d / 40.0);
    const double volume = static_cast<double>(tool.erosion.size()) * std::pow(tool.erosion.pitch, 3);
    // a sphere of 20 cells radius: the lattice's own error is well under 1 %
    CHECK(volume == doctest::Approx(std::numbers::pi / 6.0 * d * d * d).epsilon(0.01));
    // slow at the axis, full at the rim
    const auto [least, most] = std::minmax_element(tool.erosion.factors.begin(), tool.erosion.factors.end());
    CHECK(*least < 0.3f * *most);
  }
}
