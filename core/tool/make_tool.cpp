#include "core/tool/make_tool.h"

#include <algorithm>

#include "core/tool/cutting_field.h"
#include "core/tool/erosion_points.h"
#include "core/tool/fluted_mesh.h"
#include "core/tool/join_rounded.h"
#include "core/tool/mesh_tool.h"
#include "core/tool/point_shell.h"
#include "core/tool/tool_mesh.h"
#include "core/tool/tool_spec.h"
#include "core/tool/tool_surface.h"

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

/// Final steps of both kinds of tool. Errors are pushed to issues with the place given.
std::optional<Tool> assemble(Result<PointShell> shell, Result<ErosionPoints> erosion, const std::string& place, Issues& issues) {
  const auto refuse = [&](Error error) {
    error.place = place;
    issues.push_back(std::move(error));
  };
  if (!shell) refuse(shell.error());
  if (!erosion) refuse(erosion.error());
  if (!shell || !erosion) return std::nullopt;
  Tool tool;
  tool.shell = std::move(shell).value();
  tool.erosion = std::move(erosion).value();
  fill_bounds(tool);
  return tool;
}

/// Half the smallest extent of the cutting part.
double least_radius(const ErosionPoints& points) {
  if (points.size() == 0) return 0.0;
  Vec3 lo = points.positions.front(), hi = lo;
  for (const Vec3& p : points.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const Vec3 size = hi - lo + points.pitch;
  return 0.5 * std::min({size.x, size.y, size.z});
}

/// Adds the cutting field that `options` request, made by `make(size)`. @returns false if an issue was pushed.
template <class Make>
bool add_cutting_field(Tool& tool, const ToolOptions& options, const std::string& place, Issues& issues, Make&& make) {
  if (!(options.cutting_voxel > 0.0)) return true;
  Result<CuttingField> field = make(cutting_field_size(options.cutting_voxel, least_radius(tool.erosion)));
  if (field) {
    tool.cutting = std::make_shared<const CuttingField>(std::move(field).value());
    return true;
  }
  Error error = field.error();
  error.place = place;
  issues.push_back(std::move(error));
  return false;
}

/// The surface of a [mesh] in the tool frame; errors name the key `file`.
std::optional<SurfaceMesh> read_tool_mesh(const MeshToolSpec& spec, const ToolOptions& options, Issues& issues) {
  const auto refuse = [&](Error error) {
    error.message = "mesh.file = \"" + spec.file + "\" " + error.message;
    error.place = spec.file_place;
    issues.push_back(std::move(error));
    return std::nullopt;
  };
  if (!options.read_mesh) return refuse(bad_input("cannot be read: this program has no mesh reader"));
  Result<SurfaceMesh> mesh = options.read_mesh(spec.path, spec.unit);
  if (!mesh) return refuse(mesh.error());
  join_rounded(*mesh);
  Result<SurfaceMesh> placed = place_tool_mesh(spec, std::move(mesh).value());
  if (!placed) return refuse(placed.error());
  return std::move(placed).value();
}

std::optional<Tool> make_from_mesh(const TomlDocument& document, const ToolOptions& options, Issues& issues) {
  const std::optional<MeshToolSpec> spec = read_mesh_tool_spec(document, issues);
  if (!spec) return std::nullopt;
  const std::optional<SurfaceMesh> mesh = read_tool_mesh(*spec, options, issues);
  if (!mesh) return std::nullopt;
  auto tool =
      assemble(make_mesh_shell(*spec, *mesh), make_mesh_erosion_points(*spec, *mesh, options.erosion_pitch), document.file_name(), issues);
  if (!tool) return std::nullopt;
  const auto field = [&](const CuttingFieldSize& size) { return make_mesh_cutting_field(*spec, *mesh, size); };
  if (!add_cutting_field(*tool, options, document.file_name(), issues, field)) return std::nullopt;
  tool->name = spec->name;
  tool->title = spec->title;
  tool->teeth = spec->teeth;
  tool->surface = std::make_shared<const ToolSurface>(*spec, *mesh);
  tool->mesh = make_mesh_picture(*mesh);
  tool->look = tool->mesh;
  return tool;
}

}  // namespace

std::string find_tool_repair(const TomlDocument& document, const ToolOptions& options) {
  Issues ignored;
  if (!has_tool_mesh(document) || !options.read_mesh) return "";
  const auto spec = read_mesh_tool_spec(document, ignored);
  if (!spec) return "";
  auto mesh = options.read_mesh(spec->path, spec->unit);
  if (!mesh) return "";
  const RoundingJoin join = join_rounded(*mesh);
  return join.joined > 0 ? "mesh.file = \"" + spec->file + "\": " + join.text() : "";
}

std::optional<Tool> make_tool(const TomlDocument& document, const ToolOptions& options, Issues& issues) {
  if (has_tool_mesh(document)) return make_from_mesh(document, options, issues);
  const std::optional<ToolSpec> spec = read_tool_spec(document, issues);
  if (!spec) return std::nullopt;
  auto tool = assemble(make_point_shell(*spec), make_erosion_points(*spec, options.erosion_pitch), document.file_name(), issues);
  if (!tool) return std::nullopt;
  const auto field = [&](const CuttingFieldSize& size) { return make_cutting_field(*spec, size); };
  if (!add_cutting_field(*tool, options, document.file_name(), issues, field)) return std::nullopt;
  tool->name = spec->name;
  tool->title = spec->title;
  tool->surface = std::make_shared<const ToolSurface>(*spec);
  tool->mesh = make_tool_mesh(*spec);
  tool->look = make_fluted_mesh(*spec);
  tool->teeth = teeth_of(*spec);
  tool->turns = std::all_of(spec->regions.begin(), spec->regions.end(), [](const RegionSpec& r) { return r.solid.revolves(); });
  return tool;
}

std::optional<Tool> load_tool(const std::string& path, const ToolOptions& options, Issues& issues) {
  const Result<TomlDocument> document = TomlDocument::load(path);
  if (document) return make_tool(document.value(), options, issues);
  issues.push_back(document.error());
  return std::nullopt;
}

}  // namespace burrhole
