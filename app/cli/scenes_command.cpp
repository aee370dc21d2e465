#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/report/file.h"
#include "core/tool/make_tool.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string name, folder = ".";
  bool force = false, json = false;
};

/// A shipped scene as the list shows it.
struct ShippedScene {
  std::string name, title, tool, source, file;
  std::string data;  ///< folder below $BURRHOLE_DATA that it needs; empty: none
  bool data_found = true;
};

/// @returns the path below $BURRHOLE_DATA that a text names; empty if it names none.
std::string data_named_in(const std::string& text) {
  const std::string start = "\"$BURRHOLE_DATA/";
  const std::size_t at = text.find(start);
  if (at == std::string::npos) return {};
  const std::size_t from = at + start.size();
  return text.substr(from, text.find('"', from) - from);
}

Result<ShippedScene> read_shipped(const std::string& name) {
  ShippedScene out;
  out.name = name;
  const fs::path path = fs::path(share_folder()) / "scenes" / (name + ".toml");
  out.file = path.string();
  const auto document = TomlDocument::load(path.string());
  if (!document) return document.error();
  Issues unread;
  TableReader root = document->root(unread);
  out.title = root.text("title", "", "");
  if (auto tool = root.table("tool", "")) out.tool = tool->text("name", "", "");
  if (auto volume = root.table("volume", "")) out.source = volume->text("source", "", "");
  std::string described = "\"" + out.source + "\"";
  if (out.source.ends_with(".toml")) {
    const auto sidecar = read_file((path.parent_path() / out.source).string());
    if (!sidecar) return sidecar.error();
    described = *sidecar;
  }
  out.data = data_named_in(described);
  const char* const folder = std::getenv("BURRHOLE_DATA");
  std::error_code ignored;
  out.data_found = out.data.empty() || (folder != nullptr && fs::exists(fs::path(folder) / out.data, ignored));
  return out;
}

std::string bone_text(const ShippedScene& scene) {
  if (scene.data.empty()) return "generated bone";
  return scene.data_found ? "a scan" : "a scan that is missing: $BURRHOLE_DATA/" + scene.data + "; scripts/fetch-data gets it";
}

int list_scenes(bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const std::string& name : shipped_names("scenes")) {
    const auto scene = read_shipped(name);
    if (!scene) return report(scene.error());
    if (json)
      rows.push_back({{"name", name},
                      {"title", scene->title},
                      {"tool", scene->tool},
                      {"data", scene->data.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(scene->data)},
                      {"data_found", scene->data_found},
                      {"file", scene->file}});
    else
      print(fmt::format("{:<14} {} ({}; {})\n", name, scene->title, scene->tool, bone_text(*scene)));
  }
  if (json) print(rows.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return kDone;
}

/// Copies one file. bad_input: the copy is there already, and `force` is not given.
Status copy_file(const fs::path& from, const fs::path& to, bool force) {
  std::error_code ignored;
  if (!force && fs::exists(to, ignored)) return bad_input("is there already: --force replaces it", to.string());
  const auto text = read_file(from.string());
  return text ? write_file(to.string(), *text) : Status(text.error());
}

int copy_scene(const Options& option) {
  const std::vector<std::string> names = shipped_names("scenes");
  if (std::ranges::find(names, option.name) == names.end()) {
    const auto near = nearest_name(option.name, names);
    return report(bad_input(fmt::format("no shipped scene \"{}\"{}; there are {}", option.name,
                                        near ? "; did you mean \"" + *near + "\"?" : "", fmt::join(names, ", "))));
  }
  const auto scene = read_shipped(option.name);
  if (!scene) return report(scene.error());
  std::vector<std::pair<fs::path, fs::path>> files{{scene->file, option.name + ".toml"}};
  if (scene->source.ends_with(".toml")) files.emplace_back(fs::path(scene->file).parent_path() / scene->source, scene->source);
  files.emplace_back(fs::path(share_folder()) / "tools" / (scene->tool + ".toml"), scene->tool + ".toml");
  std::error_code ignored;
  for (const auto& [from, to] : files)
    if (!option.force && fs::exists(fs::path(option.folder) / to, ignored))
      return report(bad_input("is there already: --force replaces it", (fs::path(option.folder) / to).lexically_normal().string()));
  for (const auto& [from, to] : files) {
    const fs::path copy = (fs::path(option.folder) / to).lexically_normal();
    if (Status copied = copy_file(from, copy, option.force); !copied) return report(copied.error());
    print(copy.string() + "\n");
  }
  if (!scene->data_found)
    note(fmt::format(
        "the scan is not part of the program: scripts/fetch-data gets it; then set BURRHOLE_DATA to the folder that holds {}, or set "
        "volume.source\n",
        scene->data));
  return kDone;
}

}  // namespace

void add_scenes(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "scenes", kSceneGroup,
      {.summary = "Lists the shipped scenes, or copies one with all that it needs",
       .about =
           "Without an option, lists the shipped scenes with their bit and their bone. --copy writes a scene, the file of its bit and the "
           "description of its volume into a folder, where you can change them; a scan that a scene reads is not copied.",
       .examples = {"burrhole scenes", "burrhole scenes --copy parietal --out my_scene"},
       .exits = {}});
  auto option = std::make_shared<Options>();
  CLI::Option* copy = command->add_option("--copy", option->name, "copy this shipped scene")->type_name(kShippedValue);
  command->add_option("--out", option->folder, "folder for the copies")->type_name(kFolderValue)->needs(copy)->capture_default_str();
  command->add_flag("--force", option->force, "replace files that are there already")->needs(copy);
  command->add_flag("--json", option->json, "print the list as JSON on stdout")->excludes(copy);
  command->callback([option, &exit_code] { exit_code = option->name.empty() ? list_scenes(option->json) : copy_scene(*option); });
}

}  // namespace burrhole::cli
