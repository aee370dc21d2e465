#include "app/job/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "core/base/cpu_model.h"
#include "core/base/hash.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"

namespace burrhole {
namespace {

std::string hash_of(std::string_view text) {
  Hash64 hash;
  for (const char c : text) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return hash.hex();
}

/// @returns an override as results show it.
std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\"'"), last = text.find_last_not_of(" \t\"'");
  return first == std::string_view::npos ? std::string_view() : text.substr(first, last - first + 1);
}

/// @returns an override as results show it. A file of a patient is not named: its name may be theirs.
std::string shown(const std::string& change) {
  const auto equals = change.find('=');
  if (equals == std::string::npos) return without_folders(change);
  const std::string key(trimmed(std::string_view(change).substr(0, equals)));
  const std::string_view value = trimmed(std::string_view(change).substr(equals + 1));
  if ((key == "volume.source" && !value.starts_with("phantom:")) || key == "approach.markups" || key == "volume.labels" ||
      key == "volume.label_table")
    return key + "=<path>";
  if (key != "tool.name" && key != "mesh.file") return without_folders(change);
  return key + "=" + std::string(value.substr(value.rfind('/') + 1));
}

std::vector<std::pair<std::string, double>> factors_of(const LoadedScene& loaded) {
  std::vector<std::pair<std::string, double>> out;
  const double scale = loaded.scene.tool.erosion_scale;
  const auto document = TomlDocument::parse(loaded.tool_text, "tool");
  if (!document) return out;
  Issues ignored;
  if (has_tool_mesh(*document)) {
    const auto spec = read_mesh_tool_spec(*document, ignored);
    if (spec && spec->erosion_factor > 0.0) out.emplace_back("mesh", spec->erosion_factor * scale);
    return out;
  }
  const auto spec = read_tool_spec(*document, ignored);
  if (!spec) return out;
  for (const RegionSpec& region : spec->regions)
    if (region.erosion.base > 0.0) out.emplace_back(region.name, region.erosion.base * scale);
  return out;
}

bool ends_a_path(char c) { return std::string_view(" \t\n\"'`,;:()[]{}<>=").find(c) != std::string_view::npos; }

}  // namespace

std::string without_folders(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const bool begins = text[i] == '/' && (i == 0 || ends_a_path(text[i - 1])) && i + 1 < text.size() && !ends_a_path(text[i + 1]);
    if (!begins) {
      out += text[i++];
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && !ends_a_path(text[end])) ++end;
    std::string_view path = text.substr(i, end - i);
    while (path.size() > 1 && path.back() == '/') path.remove_suffix(1);
    out += path.substr(path.rfind('/') + 1);
    i = end;
  }
  return out;
}

std::optional<std::uint64_t> volume_hash(const BoneModel& bone) {
  if (bone.file_bytes()) return std::nullopt;
  std::vector<std::uint64_t> keys;
  bone.for_each_region([&](const VoxelBox& region) {
    for_each_voxel(blocks_of(region.intersect(bone.bounds())), [&](const Vec3i& block) { keys.push_back(key_of_block(block)); });
  });
  std::ranges::sort(keys);
  keys.erase(std::ranges::unique(keys).begin(), keys.end());
  Hash64 hash;
  for (const int edge : {bone.dims().x, bone.dims().y, bone.dims().z}) hash.add(static_cast<std::uint64_t>(edge));
  for (std::size_t c = 0; c < 3; ++c) hash.add(bone.bone_from_index().linear[c]);
  hash.add(bone.bone_from_index().offset);
  std::vector<float> occupancy(kBlockVoxels), hardness(kBlockVoxels);
  for (const std::uint64_t key : keys) {
    const VoxelBox box = box_of_block(block_of_key(key));
    bone.read_density(box, occupancy);
    bone.read_hardness(box, hardness);
    if (std::ranges::all_of(occupancy, [](float value) { return value == 0.0f; })) continue;
    hash.add(key);
    for (std::size_t n = 0; n < kBlockVoxels; ++n)
      hash.add(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(occupancy[n])) << 32 | std::bit_cast<std::uint32_t>(hardness[n]));
  }
  return hash.value();
}

std::string place_of_scene(const std::string& scene_file, const std::string& results, const std::string& shipped) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const auto clean = [&](const std::string& path) {
    const fs::path absolute = fs::absolute(path, ignored);
    const fs::path known = fs::weakly_canonical(absolute, ignored);
    return (known.empty() ? absolute : known).lexically_normal();
  };
  const fs::path scene = clean(scene_file);
  if (!shipped.empty() && scene.parent_path() == clean(shipped)) return hash_of("shipped " + scene.filename().string());
  return hash_of(scene.lexically_relative(clean(results)).string());
}

std::string run_title(const LoadedScene& loaded) {
  const std::string& title = loaded.scene.title;
  const std::string& tool = loaded.tool.title.empty() ? loaded.tool.name : loaded.tool.title;
  if (title.empty()) return tool;
  return title.find(tool) != std::string::npos ? title : fmt::format("{}: {}", title, tool);
}

RunProvenance text_provenance(const LoadedScene& loaded) {
  RunProvenance out;
  for (const std::string& change : loaded.changes) out.overrides.push_back(shown(change));
  for (const std::string& change : loaded.tool_changes) out.tool_overrides.push_back(shown(change));
  out.erosion_factors = factors_of(loaded);
  out.scene_hash = hash_of(without_folders(loaded.scene.text));
  out.tool_hash = hash_of(without_folders(loaded.tool_text));
  return out;
}

RunProvenance provenance_of(const LoadedScene& loaded, const std::string& date, bool drilled_before) {
  RunProvenance out = text_provenance(loaded);
  out.program = std::string("burrhole ") + BH_VERSION;
  out.date = date;
  out.machine = fmt::format("{}, {} threads", cpu_model(), std::thread::hardware_concurrency());
  if (const auto hash = volume_hash(*loaded.bone)) out.volume_hash = hash_text(*hash);
  out.drilled_before = drilled_before;
  return out;
}

}  // namespace burrhole
