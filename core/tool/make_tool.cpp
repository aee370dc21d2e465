#include "core/tool/make_tool.h"

#include <algorithm>

#include "core/tool/erosion_points.h"
#include "core/tool/point_shell.h"
#include "core/tool/tool_mesh.h"
#include "core/tool/tool_spec.h"

namespace burrhole {
namespace {

void fill_bounds(Tool& tool) {
  tool.bound_lo = tool.bound_hi = tool.shell.positions.front();
  for (const auto* points : {&tool.shell.positions, &tool.erosion.positions})
    for (const Vec3& p : *points) {
      tool.bound_radius = std::max(tool.bound_radius, glm::length(p));
      tool.bound_lo = glm::min(tool.bound_lo, p);
      tool.bound_hi = glm::max(tool.bound_hi, p);
    }
}

}  // namespace

std::optional<Tool> make_tool(const TomlDocument& document, const ToolOptions& options, Issues& issues) {
  std::optional<ToolSpec> spec = read_tool_spec(document, issues);
  if (!spec) return std::nullopt;
  Result<PointShell> shell = make_point_shell(*spec);
  Result<ErosionPoints> erosion = make_erosion_points(*spec, options.erosion_pitch);
  const auto refuse = [&](Error error) {
    error.place = document.file_name();
    issues.push_back(std::move(error));
  };
  if (!shell) refuse(shell.error());
  if (!erosion) refuse(erosion.error());
  if (!shell || !erosion) return std::nullopt;
  Tool tool;
  tool.name = spec->name;
  tool.title = spec->title;
  tool.shell = std::move(shell).value();
  tool.erosion = std::move(erosion).value();
  tool.mesh = make_tool_mesh(*spec);
  fill_bounds(tool);
  return tool;
}

std::optional<Tool> load_tool(const std::string& path, const ToolOptions& options, Issues& issues) {
  const Result<TomlDocument> document = TomlDocument::load(path);
  if (document) return make_tool(document.value(), options, issues);
  issues.push_back(document.error());
  return std::nullopt;
}

}  // namespace burrhole
