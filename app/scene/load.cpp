#include "app/scene/load.h"

#include <fmt/format.h>

#include <filesystem>

#include "app/scene/memory_plan.h"
#include "app/scene/volume_scene.h"
#include "app/view/display_config.h"
#include "core/base/input_file.h"
#include "core/config/toml_messages.h"
#include "core/tool/cutting_field.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "core/voxel/paged_bone.h"
#include "haptics/servo/realtime.h"
#include "volumes/phantom/head_bone.h"
#include "volumes/phantom/phantom.h"
#include "volumes/read/mesh_file.h"

namespace burrhole {
namespace {

/// What a bone needs in memory and in a temporary file.
struct BoneNeed {
  BoneShape in_memory, paged;
  std::uint64_t import = 0, paged_import = 0;  ///< [bytes] besides the bone while it is made
  std::uint64_t file = 0;                      ///< [bytes]
};

/// Called before the bone takes memory. @returns where it is to be kept.
using PlaceBone = std::function<Result<BoneStorage>(const BoneNeed&)>;

/// A head: its region as a dense bone, and the coarse head, which stays in memory.
BoneNeed need_of_head(const PhantomSpec& phantom) {
  const HeadGrid grid = head_grid(phantom);
  BoneNeed out;
  out.in_memory = out.paged = {grid.dims, grid.bone_from_index};
  const std::uint64_t head = dense_bone_bytes(grid.coarse_dims, true);
  out.in_memory.bytes = out.in_memory.in_memory = out.paged.in_memory = head + dense_bone_bytes(grid.region.size(), true);
  const double share = static_cast<double>(grid.region.count()) / static_cast<double>(VoxelBox{Vec3i(0), grid.dims}.count());
  out.paged.bytes = head + PagedBone::index_bytes(grid.dims, share);
  out.file = PagedBone::file_bytes(grid.dims, true, share);
  return out;
}

BoneNeed need_of_phantom(const PhantomSpec& phantom) {
  if (phantom.kind == PhantomKind::head) return need_of_head(phantom);
  const Vec3i dims = phantom_dims(phantom);
  BoneNeed out;
  out.in_memory = out.paged = {dims, phantom_bone_from_index(phantom)};
  out.in_memory.bytes = out.in_memory.in_memory = out.paged.in_memory = dense_bone_bytes(dims, true);
  out.paged.bytes = PagedBone::index_bytes(dims, 1.0);
  out.import = out.paged_import = dense_fields_bytes(dims);
  out.file = PagedBone::file_bytes(dims, true, 1.0);
  return out;
}

BoneNeed need_of_grid(const BoneGrid& grid, std::uint64_t scan_bytes) {
  BoneNeed out;
  out.in_memory = out.paged = {grid.dims, grid.bone_from_index};
  const auto made =
      static_cast<std::uint64_t>(grid.bone_share * static_cast<double>(dense_bone_bytes(grid.dims, false)));  // a scan has none
  out.in_memory.bytes = grid.loaded_bytes > 0 ? grid.loaded_bytes : made;
  out.in_memory.in_memory = out.paged.in_memory = out.in_memory.bytes;
  out.paged.bytes = PagedBone::index_bytes(grid.dims, grid.bone_share);
  out.import = out.paged_import = scan_bytes;
  out.file = PagedBone::file_bytes(grid.dims, false, grid.bone_share);
  if (grid.loaded_bytes == 0) return out;
  // A bone model is read as a whole; its blocks in the file take no more than in memory.
  out.paged_import = out.file = grid.loaded_bytes;
  return out;
}

/// @returns an error of an import at the key that caused it. If that is `source`, the scan's own place goes into the text.
Error placed(Error error, const VolumeScene& volume) {
  const BonePlaces& places = volume.scan->request.bone.places;
  if (error.place == places.region) {
    error.message += "; the region lies round entry_mm of [approach]: correct that, or give the scan that holds it as source";
    return error;
  }
  for (const std::string* key : {&places.band, &places.spacing, &places.labels, &places.label_table})
    if (!key->empty() && error.place == *key) return error;
  return {error.code, error.text(), volume.place};
}

/// Generates or imports the bone. Errors are attributed to the key `source`, unless they name another place.
Status load_bone(const LoadOptions& options, const PlaceBone& place, LoadedScene& out) {
  const VolumeScene& volume = out.scene.volume;
  if (volume.phantom) {
    const BoneNeed need = need_of_phantom(*volume.phantom);
    const auto storage = place(need);
    if (!storage) return storage.error();
    out.scan_bytes = storage->is_paged() ? need.paged_import : need.import;
    if (volume.phantom->kind == PhantomKind::head) {
      auto head = make_head_bone(*volume.phantom, *storage);
      if (!head) return head.error();
      out.bone = std::move(head).value();
      return {};
    }
    auto phantom = make_phantom(*volume.phantom);
    if (!phantom) return phantom.error();
    auto bone = BoneModel::create(phantom->bone, *storage);
    if (!bone) return bone.error();
    out.bone = *bone;
    return {};
  }
  ImportRequest request = volume.scan->request;
  request.read.progress = options.progress;
  request.site = BoneSite{out.scene.approach.entry, out.scene.approach.axis};
  if (volume.scan->region)
    request.bone.region = BoneRegion{out.scene.approach.entry + out.scene.approach.axis * kRegionDepth, *volume.scan->region};
  bool refused = false;
  request.accept = [&](const BoneGrid& grid, std::uint64_t scan_bytes) {
    const BoneNeed need = need_of_grid(grid, scan_bytes);
    auto storage = place(need);
    refused = !storage.ok();
    out.scan_bytes = storage && storage->is_paged() ? need.paged_import : need.import;
    return storage;
  };
  auto imported = import_bone(request, options.say);
  if (!imported && refused) return imported.error();
  if (!imported) return placed(imported.error(), volume);
  out.bone = std::move(imported->bone);
  out.import = std::move(imported->report);
  if (auto* display = out.scene.find<DisplayConfig>(); display != nullptr && !knows_directions(*out.import)) display->orientation = false;
  return {};
}

/// @returns the tool's text for a session. A replay does not know the tool's folder, so the path of a mesh is made absolute; other texts
/// are not changed.
std::string text_for_session(const std::string& text, const TomlDocument& tool) {
  Issues ignored;
  const auto spec = has_tool_mesh(tool) ? read_mesh_tool_spec(tool, ignored) : std::nullopt;
  if (!spec) return text;
  std::error_code failed;
  const std::string path = std::filesystem::absolute(spec->path, failed).lexically_normal().string();
  auto copy = TomlDocument::parse(text, tool.file_name());  // a second document: set() would change the places of `tool`
  return copy && copy->set("mesh.file=" + toml_string(path)) ? copy->to_text() : text;
}

/// Scales the erosion factors of the points and of the cutting field, which sub-voxel removal reads.
void scale_factors(Tool& tool, float scale) {
  for (float& factor : tool.erosion.factors) factor *= scale;
  if (!tool.cutting || scale == 1.0f) return;
  auto field = std::make_shared<CuttingField>(*tool.cutting);
  for (float& factor : field->factor) factor *= scale;
  tool.cutting = std::move(field);
}

std::string in_megabytes(std::uint64_t bytes) { return fmt::format("{:.0f} MB", static_cast<double>(bytes) * 1e-6); }

/// The line that reports a paged bone.
std::string note_of(const Scene& scene, const BoneStorage& storage, std::uint64_t in_memory, std::uint64_t paged) {
  std::string out = fmt::format(
      "the bone is kept in a temporary file of about {} in {}: in memory the run may need {}, more than memory_mb = {:.0f}, so it may need "
      "{}",
      in_megabytes(storage.expected_bytes), storage.folder, in_megabytes(in_memory), static_cast<double>(*scene.memory_limit) * 1e-6,
      in_megabytes(paged));
  if (scene.output.bone && scene.output.whole_bone) out += "; bone.vdb will hold the changes alone";
  if (is_in_memory(storage.folder)) out += "; that folder is in memory too (tmpfs): TMPDIR may name one on a disk";
  return out;
}

/// Keeps the bone in memory if the run is predicted to need no more than the scene allows, otherwise in a file. @returns bad_input if it is
/// predicted to need more than that even so. Tools that cannot be loaded are reported later. @param note says why the bone is in a file.
Result<BoneStorage> place_bone(const LoadedScene& loaded, const std::string& tool_name, const std::vector<ToolText>& input_tools,
                               const LoadOptions& options, const BoneNeed& need, std::string& note) {
  note.clear();
  const Scene& scene = loaded.scene;
  if (!scene.memory_limit) return BoneStorage();
  const double edge = need.in_memory.bone_from_index.mean_edge();
  Issues later;
  const auto tool = load_tool(loaded.tool_text, tool_name, scene, scene.effects.needs(scene), edge, later);
  if (!tool) return BoneStorage();
  MemoryRun run{.live = options.live, .locked = options.live && may_lock_memory(), .inputs = static_cast<bool>(options.input_tools)};
  const std::vector<Tool> others = load_tools(input_tools, scene, edge, later);
  for (const Tool& other : others) run.tools.push_back(&other);
  const MemoryPlan memory = plan_memory(scene, *tool, need.in_memory, need.import, run);
  if (memory.peak <= *scene.memory_limit) return BoneStorage();
  const std::uint64_t paged = plan_memory(scene, *tool, need.paged, need.paged_import, run).peak;
  if (paged > *scene.memory_limit)
    return bad_input(fmt::format("limits.memory_mb is exceeded: the run may need {} MB; {} with the bone in a temporary file",
                                 memory.text(), in_megabytes(paged)),
                     scene.memory_place);
  BoneStorage storage{.folder = options.page_folder, .expected_bytes = need.file};
  note = note_of(scene, storage, memory.peak, paged);
  return storage;
}

/// Applies changes to the text of a tool, which must stay valid. Pushes what is wrong with them, at their place.
std::string changed_tool(const std::string& text, const std::string& path, const std::vector<std::string>& sets, Issues& issues) {
  auto document = TomlDocument::parse(text, path);
  if (!document) {
    issues.push_back(document.error());
    return text;
  }
  std::vector<TomlChange> changes;
  for (const std::string& one : sets) changes.push_back({one, "--set-tool", false});
  const Issues refused = document->apply(changes);
  issues.insert(issues.end(), refused.begin(), refused.end());
  if (!issues.empty()) return text;
  if (has_tool_mesh(*document))
    (void)read_mesh_tool_spec(*document, issues);
  else
    (void)read_tool_spec(*document, issues);
  return document->to_text();
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
  if (!path) return bad_input("tool \"" + name + "\" " + tool_not_found(name, scene_file, context));
  const auto text = read_input(*path, kTomlInput);
  if (!text) return text.error();
  const auto document = TomlDocument::parse(*text, *path);
  if (!document) return document.error();
  return text_for_session(*text, *document);
}

BoneShape shape_of(const BoneModel& bone, const ApproachScene& approach) {
  const auto found = make_approach(bone, approach);
  const std::size_t around = bone.surroundings() != nullptr ? bone.surroundings()->coarse->bytes() : 0;
  return {bone.dims(), bone.bone_from_index(), bone.bytes() + around, found ? found->thickness : 0.0, bone.bytes_in_memory() + around};
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
    auto text = read_input(out.scene.tool.path, kTomlInput);
    if (!text) {
      issues.push_back(text.error());
      return std::nullopt;
    }
    out.tool_text = std::move(text).value();
  }
  out.changes = document.changes();
  out.tool_changes = options.tool_sets;
  if (!options.tool_sets.empty()) {
    const std::size_t before = issues.size();
    out.tool_text = changed_tool(out.tool_text, out.scene.tool.path, options.tool_sets, issues);
    if (issues.size() > before) return std::nullopt;
  }
  const std::string name = tool_text ? "the session's tool" : out.scene.tool.path;
  std::vector<ToolText> input_tools;
  if (options.input_tools) {
    const std::size_t before = issues.size();
    input_tools = options.input_tools(out.scene, issues);
    if (issues.size() > before) return std::nullopt;
  }
  const PlaceBone place = [&](const BoneNeed& need) { return place_bone(out, name, input_tools, options, need, out.paged_note); };
  if (const Status loaded = load_bone(options, place, out); !loaded) {
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
