#include "app/job/earlier_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "app/job/provenance.h"
#include "app/job/run_folder.h"
#include "app/report/file.h"
#include "app/stage/result_files.h"
#include "core/base/hash.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kNext = "give another folder by --out, or --force to replace them";

std::optional<std::string> text_at(const Json& json, const char* pointer) {
  const auto at = Json::json_pointer(pointer);
  if (!json.contains(at) || !json[at].is_string()) return std::nullopt;
  return json[at].get<std::string>();
}

std::vector<std::string> texts_at(const Json& json, const char* pointer) {
  const auto at = Json::json_pointer(pointer);
  std::vector<std::string> out;
  if (!json.contains(at) || !json[at].is_array()) return out;
  for (const Json& one : json[at])
    if (one.is_string()) out.push_back(one.get<std::string>());
  return out;
}

/// @returns what the first list has and the second has not, at most three; "the scene's own" if there is none.
std::string beyond(const std::vector<std::string>& list, const std::vector<std::string>& other, const char* none) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> out;
  for (const std::string& one : list)
    if (std::ranges::find(other, one) == other.end()) out.push_back(one);
  if (out.empty()) return none;
  const bool more = out.size() > kMost;
  if (more) out.resize(kMost);
  return fmt::format("{}{}", fmt::join(out, ", "), more ? ", ..." : "");
}

/// @returns what differs between the run of a summary.json and a new one; empty: nothing.
std::string difference(const Json& old, const LoadedScene& loaded) {
  const auto scene = text_at(old, "/provenance/hash/scene"), tool = text_at(old, "/provenance/hash/tool"),
             volume = text_at(old, "/provenance/hash/volume");
  const RunProvenance now = text_provenance(loaded);
  struct Changes {
    const char *pointer, *what, *none;
    const std::vector<std::string>* now;
  };
  for (const Changes& changes :
       {Changes{"/provenance/overrides", "overrides of the scene", "the scene's own values", &now.overrides},
        Changes{"/provenance/tool_overrides", "overrides of the tool", "the tool's own values", &now.tool_overrides}}) {
    const auto before = texts_at(old, changes.pointer);
    if (before != *changes.now)
      return fmt::format("with other {}: {} there, {} now", changes.what, beyond(before, *changes.now, changes.none),
                         beyond(*changes.now, before, changes.none));
  }
  if (scene && *scene != now.scene_hash) return "from before its file was edited";
  if (tool && *tool != now.tool_hash) return "with another tool, or from before its file was edited";
  if (!volume) return {};  // of a bone in a temporary file
  const auto bone = volume_hash(*loaded.bone);
  return bone && hash_text(*bone) != *volume ? "with another bone: the volume was replaced since, or is read differently" : "";
}

}  // namespace

Status check_earlier_run(const LoadedScene& loaded, const std::string& folder, const std::string& shipped_scenes) {
  const std::string path = (fs::path(folder) / kSummaryFile).string();
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return check_is_ours(folder);
  const auto text = read_file(path);
  const Json old = text ? Json::parse(*text, nullptr, false) : Json();
  if (!old.is_object() || !old.contains("scene") || !old["scene"].is_string())
    return bad_input(fmt::format("holds a summary.json that is none of burrhole drill: {}", kNext), folder);
  const std::string before = fs::path(old["scene"].get<std::string>()).filename().string();
  const std::string now = fs::path(loaded.scene.file).filename().string();
  if (before != now) return bad_input(fmt::format("holds results of another scene, {}: {}", before, kNext), folder);
  const auto place = text_at(old, "/provenance/scene_place");
  if (!place) return {};  // of an earlier version
  if (*place != place_of_scene(loaded.scene.file, folder, shipped_scenes))
    return bad_input(fmt::format("holds results of another scene, of a {} in another folder: {}", before, kNext), folder);
  if (const std::string what = difference(old, loaded); !what.empty())
    return bad_input(fmt::format("holds results of this scene {}: {}", what, kNext), folder);
  return {};
}

}  // namespace burrhole
