#include "app/cli/choose.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/report/file.h"
#include "app/session/session.h"
#include "app/stage/result_files.h"
#include "app/window/chooser.h"
#include "app/window/panel_text.h"
#include "app/window/window_run.h"
#include "core/base/input_file.h"
#include "core/config/toml_messages.h"
#include "core/tool/make_tool.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kResults = "out";  // folder of the results, as for drill
constexpr std::size_t kMostSessions = 8;

constexpr const char* kBit = "perforator_14_11";  // of a site on a scan, as in skull_site.h

struct Item {
  Choice choice;
  Words words;
};

std::string text_of(const fs::path& path) {
  const auto text = read_input(path.string(), kTomlInput);
  return text ? *text : std::string();
}

/// @returns why a scene's data are not there; empty: they are, or it needs none.
std::string missing_data(const fs::path& scene, const std::string& source) {
  const std::string sidecar = source.ends_with(".toml") ? text_of(scene.parent_path() / source) : std::string();
  const bool needs = source.find("$BURRHOLE_DATA") != std::string::npos || sidecar.find("$BURRHOLE_DATA") != std::string::npos;
  const char* const folder = std::getenv("BURRHOLE_DATA");
  std::error_code ignored;
  if (!needs || (folder != nullptr && fs::is_directory(folder, ignored))) return {};
  return "Its scan is not part of the program: scripts/fetch-data gets it, or set BURRHOLE_DATA to the folder that holds it";
}

/// @returns what a folder holds; nothing of one that cannot be read.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator(); at.increment(error)) out.push_back(at->path());
  return out;
}

/// @returns a new folder for results.
std::string results_of(const std::string& name) {
  return fmt::format("{}/{}-{:%Y%m%d-%H%M%S}", kResults, name, fmt::localtime(std::time(nullptr)));
}

Words drill_words(const std::string& scene, const std::string& folder) { return {"drill", scene, "--window", "--out", folder}; }

/// The shipped scenes: those without further data first, and of them burrholes before bone that is moved.
std::vector<Item> scenes() {
  std::vector<std::pair<bool, Item>> found;
  for (const fs::path& path : entries_of(fs::path(share_folder()) / "scenes")) {
    if (path.extension() != ".toml") continue;
    const auto document = TomlDocument::load(path.string());
    if (!document) continue;
    Issues issues;
    TableReader root = document->root(issues);
    const std::string name = path.stem().string(), title = root.text("title", name, "");
    auto volume = root.table("volume", "");
    auto tool = root.table("tool", "");
    const std::string source = volume ? volume->text("source", "", "") : "", bit = tool ? tool->text("name", "", "") : "";
    const std::string made = source.starts_with("phantom:") ? "generated bone" : "bone from a scan";
    const std::string folder = results_of(name);
    found.push_back({root.has("motion"),
                     {{{}, title, fmt::format("{}, {}; results in {}", made, tool_title(bit), folder), missing_data(path, source)},
                      drill_words(name, folder)}});
  }
  std::ranges::sort(found, {}, [](const auto& f) { return std::tuple(!f.second.choice.missing.empty(), f.first, f.second.words[1]); });
  std::vector<Item> out;
  for (auto& [moves, item] : found) out.push_back(std::move(item));
  if (!out.empty()) out.front().choice.heading = "DRILL";
  return out;
}

/// @returns the date and time of an ISO 8601 text, as people write them.
std::string spoken(std::string iso) {
  if (iso.size() != std::string_view("2026-01-01T00:00:00Z").size()) return iso;
  iso[10] = ' ';
  return iso.substr(0, 16) + " UTC";
}

/// Recorded sessions below the folder of the results, the newest first.
std::vector<Item> sessions() {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code ignored;
  const auto look = [&](const fs::path& folder) {
    const fs::path session = folder / kSessionFile;
    if (fs::is_regular_file(session, ignored)) found.emplace_back(fs::last_write_time(session, ignored), session);
  };
  look(kResults);
  for (const fs::path& path : entries_of(kResults)) look(path);
  std::ranges::sort(found, std::greater<>());
  std::vector<Item> out;
  for (const auto& [time, path] : found) {
    if (out.size() == kMostSessions) break;
    const auto session = SessionReader::open(path.string());
    if (!session) continue;
    const auto document = TomlDocument::parse(session->meta().scene, session->meta().scene_path);
    if (!document) continue;
    Issues issues;
    out.push_back({{{},
                    document->root(issues).text("title", path.string(), ""),
                    fmt::format("{}, {}", spoken(session->meta().created), path.string())},
                   {"replay", path.string(), "--view"}});
  }
  if (!out.empty()) out.front().choice.heading = "WATCH A RECORDED SESSION";
  return out;
}

/// A scene is UTF-8: it cannot name a scan whose path has other bytes. Such a scan gets a link with a plain name in the scene's folder.
Status link_source(SkullSource& source, const fs::path& folder) {
  if (printable_text(source.path) == source.path) return {};
  std::error_code error;
  const fs::path path = fs::absolute(source.path, error), name = path.filename();
  const bool plain = printable_text(name.string()) == name.string();  // then its folder is linked, and files beside it are found
  std::string ending = fs::is_directory(path, error) ? std::string() : path.extension().string();
  if (name.string().ends_with(".nii.gz")) ending = ".nii.gz";
  for (const char* header : {".hdr", ".nhdr", ".mhd"})
    if (!plain && ending == header)
      return bad_input("the name is not UTF-8, and the header's data are in a file beside it: rename both", source.path);
  const std::string link = plain ? "scans" : "scan" + ending;
  fs::create_directories(folder, error);
  fs::create_symlink(plain ? path.parent_path() : path, folder / link, error);
  if (error) return bad_input("a link to the scan cannot be made: " + error.message(), (folder / link).string());
  source.link = plain ? (fs::path(link) / name).string() : link;
  return {};
}

/// @returns the command for a scene file, or for a site on a scan, whose scene is written into the folder of the results.
Result<Words> words_of_file(const Chosen& chosen) {
  if (!chosen.site) return drill_words(chosen.scene, results_of(fs::path(chosen.scene).stem().string()));
  const fs::path source(chosen.source.path);
  const fs::path folder = results_of((source.has_stem() ? source.stem() : source.parent_path().filename()).string());
  const fs::path scene = folder / kChosenSceneFile;
  SkullSource named = chosen.source;
  if (const Status linked = link_source(named, folder); !linked) return linked.error();
  if (const Status written = write_file(scene.string(), site_scene(*chosen.site, named)); !written) return written.error();
  print_line("scene: " + scene.string());
  return drill_words(scene.string(), folder.string());
}

}  // namespace

Result<Words> choose_command() {
  if (!has_display())
    return Error{
        ErrorCode::unavailable,
        "there is no display for the window in which to choose: neither DISPLAY nor WAYLAND_DISPLAY is set; burrhole drill parietal "
        "drills offscreen, burrhole --help lists the commands",
        {}};
  std::vector<Item> items = scenes();
  items.push_back(
      {{"YOUR OWN", "Open a CT or scene ...", "a folder of DICOM slices, NIfTI, NRRD, MetaImage, a mesh, or a scene file", "", true}, {}});
  for (Item& item : sessions()) items.push_back(std::move(item));
  std::vector<Choice> choices;
  choices.reserve(items.size());
  for (const Item& item : items) choices.push_back(item.choice);
  catch_signals();
  ChooserConfig config;
  Issues issues;
  if (auto bit = load_tool((fs::path(share_folder()) / "tools" / (std::string(kBit) + ".toml")).string(), {}, issues)) {
    config.bit = std::move(bit->look);
    config.solid = std::move(bit->mesh);
  }
  const auto chosen = choose_in_window("burrhole", choices, config, &stop_requested());
  if (!chosen) return chosen.error();
  if (!*chosen) return Words();
  if ((*chosen)->line) return items[*(*chosen)->line].words;
  return words_of_file(**chosen);
}

}  // namespace burrhole::cli
