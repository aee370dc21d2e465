#include "app/scene/load.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/scene/memory_plan.h"
#include "app/scene/volume_scene.h"
#include "core/tool/cutting_field.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "haptics/servo/realtime.h"
#include "volumes/phantom/phantom.h"
#include "volumes/read/mesh_file.h"

namespace burrhole {
namespace {

/// Called with the shape of the bone, and the bytes of the scan that it will be made from, before either takes memory.
using AcceptBone = std::function<Status(const BoneShape& bone, std::uint64_t scan_bytes)>;

/// Generates or imports the bone. Errors are attributed to the key `source`, unless they name another place.
Status load_bone(const LoadOptions& options, const AcceptBone& accept, LoadedScene& out) {
  const VolumeScene& volume = out.scene.volume;
  if (volume.phantom) {
    const Vec3i dims = phantom_dims(*volume.phantom);
    if (Status accepted = accept({dims, phantom_bone_from_index(*volume.phantom), dense_bone_bytes(dims, true)}, 0); !accepted)
      return accepted;
    auto phantom = make_phantom(*volume.phantom);
    if (!phantom) return phantom.error();
    auto bone = BoneModel::create(phantom->bone);
    if (!bone) return bone.error();
    out.bone = *bone;
    return {};
  }
  ImportRequest request = volume.scan->request;
  request.read.progress = options.progress;
  if (volume.scan->region)
    request.bone.region = BoneRegion{out.scene.approach.entry + out.scene.approach.axis * kRegionDepth, *volume.scan->region};
  bool refused = false;
  request.accept = [&](const BoneGrid& grid, std::uint64_t scan_bytes) {
    out.scan_bytes = scan_bytes;
    const auto bytes =
        static_cast<std::uint64_t>(grid.bone_share * static_cast<double>(dense_bone_bytes(grid.dims, false)));  // a scan has none
    Status accepted = accept({grid.dims, grid.bone_from_index, bytes}, scan_bytes);
    refused = !accepted.ok();
    return accepted;
  };
  auto imported = import_bone(request, options.say);
  if (!imported && refused) return imported.error();
  // The place of the error is the key `source`; the scan's own place goes into the text.
  if (!imported) return Error{imported.error().code, imported.error().text(), volume.place};
  out.bone = std::move(imported->bone);
  out.import = std::move(imported->report);
  return {};
}

/// @returns the tool's text for a session. A replay does not know the tool's folder, so the path of a mesh is made absolute; other texts
/// are not changed.
std::string text_for_session(const std::string& text, const TomlDocument& tool) {
  Issues ignored;
  const auto spec = has_tool_mesh(tool) ? read_mesh_tool_spec(tool, ignored) : std::nullopt;
  if (!spec) return text;
  std::string quoted;
  for (const char c : std::filesystem::absolute(spec->path).lexically_normal().string()) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  auto copy = TomlDocument::parse(text, tool.file_name());  // a second document: set() would change the places of `tool`
  return copy && copy->set("mesh.file=\"" + quoted + "\"") ? copy->to_text() : text;
}

/// Scales the erosion factors of the points and of the cutting field, which sub-voxel removal reads.
void scale_factors(Tool& tool, float scale) {
  for (float& factor : tool.erosion.factors) factor *= scale;
  if (!tool.cutting || scale == 1.0f) return;
  auto field = std::make_shared<CuttingField>(*tool.cutting);
  for (float& factor : field->factor) factor *= scale;
  tool.cutting = std::move(field);
}

/// @returns bad_input if the run is predicted to need more memory than the scene allows. Tools that cannot be loaded are reported later.
Status check_limit(const LoadedScene& loaded, const std::string& tool_name, const std::vector<ToolText>& input_tools,
                   const LoadOptions& options, const BoneShape& bone, std::uint64_t scan_bytes) {
  const Scene& scene = loaded.scene;
  if (!scene.memory_limit) return {};
  const double edge = bone.bone_from_index.mean_edge();
  Issues later;
  const auto tool = load_tool(loaded.tool_text, tool_name, scene, scene.effects.needs(scene), edge, later);
  if (!tool) return {};
  MemoryRun run{.live = options.live, .locked = options.live && may_lock_memory(), .inputs = static_cast<bool>(options.input_tools)};
  const std::vector<Tool> others = load_tools(input_tools, scene, edge, later);
  for (const Tool& other : others) run.tools.push_back(&other);
  const MemoryPlan memory = plan_memory(scene, *tool, bone, scan_bytes, run);
  if (memory.peak <= *scene.memory_limit) return {};
  return bad_input("limits.memory_mb is exceeded: the run may need " + memory.text() + " MB", scene.memory_place);
}

Result<std::string> text_of_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) return bad_input("the file cannot be read", path);
  return text.str();
}

}  // namespace

std::optional<Tool> load_tool(const std::string& text, const std::string& name, const StageConfig& config, const Needs& needs,
                              double voxel_edge, Issues& issues) {
  auto document = TomlDocument::parse(text, name);
  if (!document) {
    issues.push_back(document.error());
    return std::nullopt;
  }
  auto tool = make_tool(*document,
                        {.erosion_pitch = needs.erosion_pitch_voxels * voxel_edge,
                         .cutting_voxel = needs.cutting_field ? voxel_edge : 0.0,
                         .read_mesh = read_mesh},
                        issues);
  if (tool) scale_factors(*tool, static_cast<float>(config.tool.erosion_scale));
  return tool;
}

std::vector<Tool> load_tools(const std::vector<ToolText>& texts, const Scene& scene, double voxel_edge, Issues& issues) {
  const Needs needs = scene.effects.needs(scene);
  std::vector<Tool> out;
  for (const ToolText& one : texts)
    if (auto tool = load_tool(one.text, one.name, scene, needs, voxel_edge, issues)) out.push_back(std::move(*tool));
  return out;
}

Result<std::string> read_tool_text(const std::string& name, const std::string& scene_file, const SceneContext& context) {
  const auto path = find_tool(name, scene_file, context);
  if (!path) return bad_input("\"" + name + "\" is no tool (burrhole tools lists them)");
  const auto text = text_of_file(*path);
  if (!text) return text.error();
  const auto document = TomlDocument::parse(*text, *path);
  if (!document) return document.error();
  return text_for_session(*text, *document);
}

BoneShape shape_of(const BoneModel& bone, const ApproachScene& approach) {
  const auto found = make_approach(bone, approach);
  return {bone.dims(), bone.bone_from_index(), bone.bytes(), found ? found->thickness : 0.0};
}

std::optional<LoadedScene> load_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                      const LoadOptions& options) {
  const std::optional<std::string>& tool_text = options.tool_text;
  SceneContext own_context = context;
  own_context.tool_given = tool_text.has_value();
  auto scene = read_scene(document, own_context, issues);
  if (!scene) return std::nullopt;
  LoadedScene out;
  out.scene = std::move(*scene);

  if (tool_text) {
    out.tool_text = *tool_text;
  } else {
    auto text = text_of_file(out.scene.tool.path);
    if (!text) {
      issues.push_back(text.error());
      return std::nullopt;
    }
    out.tool_text = std::move(text).value();
  }
  const std::string name = tool_text ? "the session's tool" : out.scene.tool.path;
  std::vector<ToolText> input_tools;
  if (options.input_tools) {
    const std::size_t before = issues.size();
    input_tools = options.input_tools(out.scene, issues);
    if (issues.size() > before) return std::nullopt;
  }
  const AcceptBone within_limit = [&](const BoneShape& bone, std::uint64_t scan_bytes) {
    return check_limit(out, name, input_tools, options, bone, scan_bytes);
  };
  if (const Status loaded = load_bone(options, within_limit, out); !loaded) {
    issues.push_back(loaded.error());
    if (issues.back().place.empty()) issues.back().place = out.scene.volume.place;
    return std::nullopt;
  }
  auto tool =
      load_tool(out.tool_text, name, out.scene, out.scene.effects.needs(out.scene), out.bone->bone_from_index().mean_edge(), issues);
  if (!tool) return std::nullopt;
  if (!tool_text)
    if (const auto parsed = TomlDocument::parse(out.tool_text, name)) out.tool_text = text_for_session(out.tool_text, *parsed);
  out.tool = std::move(*tool);
  return out;
}

}  // namespace burrhole
