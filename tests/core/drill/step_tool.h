/// tests/core/drill/step_tool.h: a small perforator: an inner drill of 4 mm and an outer drill of 6 mm behind it.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "core/drill/region_spin.h"
#include "core/tool/make_tool.h"
#include "core/tool/tool_surface.h"

namespace burrhole::test {

struct StepTool {
  double voxel = 0.25e-3;                           ///< [m] of the bone
  double inner_factor = 0.05, outer_factor = 0.25;  ///< [1/rev]
};

inline std::string step_tool_text(const StepTool& step) {
  const auto region = [](const char* name, const char* place, double factor) {
    return std::string("[[region]]\nname = \"") + name + "\"\nshape = \"cylinder\"\n" + place +
           "erosion_factor = " + std::to_string(factor) + "\n";
  };
  return "title = \"Step\"\n[shell]\npitch_mm = 0.5\n" +
         region("inner drill", "z_mm = 0\nheight_mm = 1.5\ndiameter_mm = 4\n", step.inner_factor) +
         region("outer drill", "z_mm = 1.5\nheight_mm = 2\ndiameter_mm = 6\n", step.outer_factor) +
         region("shank", "z_mm = 3.5\nheight_mm = 6\ndiameter_mm = 3\n", 0.0);
}

inline Tool step_tool(const StepTool& step) {
  Issues issues;
  const auto document = TomlDocument::parse(step_tool_text(step), "step.toml");
  REQUIRE(document.ok());
  auto tool = make_tool(*document, {.erosion_pitch = 0.5 * step.voxel, .cutting_voxel = step.voxel}, issues);
  REQUIRE_MESSAGE(tool.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*tool);
}

inline DrillRegions regions_of_step(const Tool& tool) {
  const auto inner = tool.surface->find_region("inner drill"), outer = tool.surface->find_region("outer drill");
  REQUIRE(inner);
  REQUIRE(outer);
  return {*inner, *outer};
}

}  // namespace burrhole::test
