#include "app/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <utility>

#include "app/cli/given_paths.h"
#include "app/cli/progress.h"
#include "app/job/drill_job.h"
#include "app/scene/other_branch.h"
#include "app/stage/result_files.h"
#include "core/base/simd.h"
#include "core/config/toml_messages.h"

namespace burrhole::cli {

namespace fs = std::filesystem;

constexpr std::size_t kLongestMessage = 2000;  // [bytes] of a line on stderr
constexpr std::size_t kMostIssues = 50;        // that are printed of one file

int exit_code_of(const Error& error) {
  switch (error.code) {
    case ErrorCode::bad_input:
    case ErrorCode::out_of_range:
      return kBadInput;
    case ErrorCode::check_failed:
      return kCheckFailed;
    case ErrorCode::unavailable:
      return kUnavailable;
    case ErrorCode::internal:
      return kInternalError;
  }
  return kInternalError;
}

int report(const Error& error) {
  std::fprintf(stderr, "%s\n", one_line(error.text(), kLongestMessage).c_str());
  return exit_code_of(error);
}

int report(const Issues& found) {
  Issues issues = found;
  explain_unknown_keys(issues);
  int code = kDone;
  std::size_t printed = 0;
  for (const Error& issue : issues) {
    const int own = printed++ < kMostIssues ? report(issue) : exit_code_of(issue);
    // An input error has precedence over `unavailable`, because the user can fix it.
    if (code == kDone || code == kUnavailable) code = own;
  }
  if (issues.size() > kMostIssues) std::fprintf(stderr, "and %zu more errors\n", issues.size() - kMostIssues);
  return code;
}

std::string share_folder() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share" / "burrhole";
  return fs::is_directory(installed / "tools", ignored) ? installed.string() : std::string(BH_SHARE_FALLBACK);
}

std::string shipped_folder(const char* name) { return (fs::path(share_folder()) / name).string(); }

SceneContext scene_context() { return {{shipped_folder("tools")}}; }

std::string find_scene(const std::string& scene) {
  if (scene.find('/') != std::string::npos) return scene;
  const bool by_file = scene.ends_with(".toml");
  std::error_code ignored;
  if (by_file && fs::exists(scene, ignored)) return scene;
  const fs::path shipped = fs::path(shipped_folder("scenes")) / (by_file ? scene : scene + ".toml");
  return fs::exists(shipped, ignored) ? shipped.string() : scene;
}

void warn_of_namesake(const std::string& scene) {
  const std::string found = find_scene(scene);
  if (found == scene) return;
  std::error_code ignored;
  if (scene.ends_with(".toml") && fs::exists(found, ignored))
    print_warning(scene, fmt::format("is not in the current folder, so the shipped scene is taken; burrhole scenes --copy {} writes a copy "
                                     "to edit",
                                     fs::path(scene).stem().string()));
  for (const std::string& name : {scene, scene + ".toml"})
    if (fs::exists(name, ignored))
      print_warning(scene, fmt::format("the shipped scene of that name is taken; for the {} in the current folder write ./{}",
                                       fs::is_directory(name, ignored) ? "folder" : "file", name));
}

void SceneOption::add_to(CLI::App& command) {
  command.add_option("scene", scene, "scene file (TOML), or the name of a shipped scene")->type_name(kSceneValue)->required();
  command.add_option("--set", sets, "override a key, e.g. --set tool.spin_rpm=800 (repeatable)")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--unset", unsets, "leave a table or key of the scene out, e.g. --unset record (repeatable)")
      ->type_name("TABLE")
      ->allow_extra_args(false);
  command.add_option("--set-tool", tool_sets, "override a key of the tool's file, e.g. --set-tool region.head.erosion_factor=0.1")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
}

void add_stereo_options(CLI::App& command, SceneOption& scene) {
  command
      .add_option_function<std::string>(
          "--stereo", [&scene](const std::string& mode) { scene.sets.push_back(fmt::format("display.stereo=\"{}\"", mode)); },
          "two eyes: side-by-side, top-bottom, anaglyph; quad: a window with stereo buffers")
      ->type_name("MODE")
      ->check(CLI::IsMember({"off", "side-by-side", "top-bottom", "anaglyph", "quad"}));
  command
      .add_option_function<double>(
          "--workbench", [&scene](double height) { scene.sets.push_back(fmt::format("display.workbench_mm={}", height)); },
          "bone at its true size on a screen of that height (keys workbench_mm, head_mm, mirrored)")
      ->type_name("MM")
      ->check(number_in(1.0, 5000.0));
}

void add_simd_option(CLI::App& command) {
  const auto choose = [](const std::string& name) {
    if (const Status chosen = choose_simd(name); !chosen) throw CLI::ValidationError("--simd", chosen.error().message);
  };
  command
      .add_option_function<std::string>("--simd", choose,
                                        "vector instructions: auto (the best), sse4, avx2 or avx512; results do not depend on it")
      ->type_name("LEVEL");
}

void add_gl_option(CLI::App& command, std::string& gl) {
  command.add_option("--gl", gl, "OpenGL context: auto (egl if it has a GPU, else osmesa), window (hidden), osmesa or egl")
      ->type_name("BACKEND")
      ->check(CLI::IsMember({"auto", "window", "osmesa", "egl"}))
      ->capture_default_str();
}

void add_shader_option(CLI::App& command, std::string& folder) {
  command.add_option("--shader-dir", folder, "folder of shaders to use instead of the built-in ones")->type_name(kFolderValue);
}

std::vector<std::string> shipped_names(const char* folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(share_folder()) / folder, ignored))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

namespace {

/// @returns the error of a scene that is not there, with the folders that were searched.
Error scene_not_found(const std::string& scene) {
  const fs::path path(scene);
  const bool by_path = scene.find('/') != std::string::npos;
  const std::string folder =
      by_path ? path.parent_path().string() : "the current folder, " + (fs::path(share_folder()) / "scenes").string();
  const auto near = nearest_name(path.stem().string(), shipped_names("scenes"));
  return bad_input(fmt::format("scene not found in {}{}", folder,
                               near ? "; did you mean \"" + *near + "\"?" : " (burrhole scenes lists the shipped ones)"),
                   scene);
}

/// @returns an error for what is likely a volume or a mesh in place of a scene.
Status is_a_scene(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored) && fs::exists(fs::path(path) / kSummaryFile, ignored))
    return bad_input(fmt::format("is the folder of a run, not a scene: burrhole replay {0} computes it again; to drill on from its bone, "
                                 "give its scene and --restore {1}",
                                 path, (fs::path(path) / kBoneFile).string()),
                     path);
  if (fs::is_directory(path, ignored))
    return bad_input(fmt::format("is a folder, not a scene: for a DICOM folder give --set volume.source=FOLDER with a scene, or burrhole "
                                 "import {}",
                                 path),
                     path);
  std::string ending = fs::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (path.ends_with(".mrk.json") || ending == ".fcsv")
    return bad_input(
        fmt::format("is no scene: a plan of 3D Slicer is given to a scene by --unset approach --set approach.markups={}", path), path);
  if (ending == ".sqlite")
    return bad_input(fmt::format("is a recorded session, not a scene: burrhole replay {0} computes it again, burrhole session {0} "
                                 "describes it",
                                 path),
                     path);
  constexpr const char* kNoText[] = {".json", ".html", ".png", ".csv", ".wav", ".md"};
  if (std::ranges::find(kNoText, ending) != std::end(kNoText))
    return bad_input("is no scene: a scene is a TOML file (burrhole scenes --copy NAME writes one to edit)", path);
  constexpr const char* kOtherPrograms[] = {".mrml", ".mrb", ".pvsm", ".vti", ".vtp", ".vtk", ".vtu", ".mitk"};
  if (std::ranges::find(kOtherPrograms, ending) != std::end(kOtherPrograms))
    return bad_input("is a file of another program, not a scene: save its volume as NRRD, NIfTI or MetaImage there (burrhole import)",
                     path);
  constexpr const char* kVolumes[] = {".vdb", ".nii", ".gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".dcm", ".stl", ".ply", ".obj", ".raw"};
  if (std::ranges::find(kVolumes, ending) == std::end(kVolumes)) return {};
  return bad_input(
      fmt::format("is a volume or a mesh, not a scene: burrhole render {0} --image FILE.png draws it; to drill it, give it to a "
                  "scene by --unset volume --set volume.source={0}",
                  path),
      path);
}

/// @returns an error for the file of a tool in place of a scene.
Status is_no_tool(const TomlDocument& document) {
  Issues unread;
  const TableReader root = document.root(unread);
  const bool tool = (root.has("region") || root.has("mesh")) && !root.has("volume") && !root.has("approach") && !root.has("tool");
  if (!tool) return {};
  return bad_input(fmt::format("is a tool file, not a scene: burrhole tools {0} shows it, and --set tool.name={0} uses it in a scene",
                               document.file_name()),
                   document.file_name());
}

/// Tables that a person may set to the value of one of their keys.
constexpr std::pair<std::string_view, const char*> kMainKeys[] = {
    {"tool", "tool.name"}, {"volume", "volume.source"}, {"hand", "hand.kind"}, {"contact", "contact.model"}};

/// @returns an error for an assignment that separates its words by other signs than a dot and an equals sign.
Status is_written_as_assignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('='), colon = assignment.find_first_of(":/");
  if (colon == std::string::npos || colon > equals) return {};
  std::string written = assignment;
  for (std::size_t at = 0; at < std::min(equals, written.size()); ++at)
    if (written[at] == '/' || (written[at] == ':' && equals != std::string::npos)) written[at] = '.';
  if (equals == std::string::npos) {
    const std::size_t sign = written.find(':');
    if (sign == std::string::npos) return {};
    const std::size_t value = written.find_first_not_of(' ', sign + 1);
    if (value == std::string::npos) return {};
    written = written.substr(0, sign) + "=" + written.substr(value);
  }
  return bad_input("must read table.key=value: write --set " + written, "--set " + assignment);
}

/// @returns an error for the value of a key that is given to its table.
Status is_no_value_of_a_table(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return {};
  const std::size_t value = assignment.find_first_not_of(" \t", equals + 1);
  if (value == std::string::npos || assignment[value] == '{') return {};
  const std::string name = assignment.substr(0, assignment.find_last_not_of(" \t", equals - 1) + 1);
  for (const auto& [table, key] : kMainKeys)
    if (name == table)
      return bad_input(fmt::format("{} is a table: write --set {}={}", table, key, assignment.substr(value)), "--set " + assignment);
  return {};
}

/// @returns an error for a tool file of the current folder that is given by its name alone, as shipped tools are.
Status is_a_shipped_tool(const std::string& assignment, const fs::path& scene_folder) {
  constexpr std::string_view kKey = "tool.name=";
  if (!assignment.starts_with(kKey)) return {};
  const std::string name = assignment.substr(kKey.size()), here = tool_file_here(name);
  std::error_code ignored;
  if (here.empty() || fs::exists(scene_folder / here, ignored)) return {};
  return bad_input(fmt::format("no shipped tool has that name; for the file in the current folder write --set tool.name={}", here),
                   "--set " + assignment);
}

/// The keys whose values are paths of files that are read.
constexpr const char* kPathKeys[] = {"volume.source", "volume.labels", "volume.label_table",       "approach.markups",
                                     "tool.name",     "mesh.file",     "display.exterior_texture", "display.interior_texture"};

/// @returns the assignment with the path of a file below the current folder made absolute; others unchanged.
std::string from_current_folder(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return assignment;
  const auto trimmed = [](const std::string& text) {
    const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
    return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
  };
  const std::string key = trimmed(assignment.substr(0, equals));
  std::string value = trimmed(assignment.substr(equals + 1));
  if (std::ranges::find(kPathKeys, key) == std::end(kPathKeys)) return assignment;
  if (value.size() >= 2 && value.front() == value.back() && (value.front() == '"' || value.front() == '\''))
    value = value.substr(1, value.size() - 2);
  std::error_code ignored;
  const char* const ending = key == "tool.name" ? ".toml" : key.ends_with("_texture") ? ".png" : nullptr;  // of files that may be named too
  const bool by_name = ending != nullptr && !value.ends_with(ending) && value.find('/') == std::string::npos;
  if (value.empty() || by_name || value.front() == '/' || value.front() == '$' || !fs::exists(value, ignored)) return assignment;
  return key + "=" + toml_string(fs::absolute(value, ignored).lexically_normal().string());
}

}  // namespace

Result<TomlDocument> SceneOption::document() const {
  const std::string path = find_scene(scene);
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return scene_not_found(scene);
  if (const Status valid = is_a_scene(path); !valid) return valid.error();
  auto document = TomlDocument::load(path);
  if (!document) return document.error();
  if (const Status valid = is_no_tool(*document); !valid) return valid.error();
  for (const std::string& assignment : sets)
    for (const Status& valid : {is_written_as_assignment(assignment), is_no_value_of_a_table(assignment),
                                is_a_shipped_tool(assignment, fs::path(path).parent_path())})
      if (!valid) return valid.error();
  // First what goes: --unset approach --set approach.markups=FILE gives another approach.
  std::vector<TomlChange> changes;
  for (const std::string& name : unsets) changes.push_back({name, "--unset", true});
  for (const std::string& assignment : sets) changes.push_back({from_current_folder(assignment)});
  if (const Issues refused = document->apply(changes); !refused.empty()) return refused.front();
  Issues unread;
  if (no_pictures && document->root(unread).has("display"))
    if (Status removed = document->unset("display", "--no-pictures"); !removed) return removed.error();
  return document;
}

void print_line(const std::string& text) { note(one_line(text, kLongestMessage) + "\n"); }

void print_warning(const std::string& file, const std::string& warning) {
  const std::size_t end = warning.starts_with(file + ":") ? warning.find(": ", file.size()) : std::string::npos;
  if (end == std::string::npos)
    print_line(fmt::format("{}: warning: {}", file, warning));
  else
    print_line(fmt::format("{}: warning: {}", warning.substr(0, end), warning.substr(end + 2)));
}

std::optional<LoadedScene> load_or_report(const SceneOption& option, int& exit_code, bool quiet, bool live, const std::string& inputs) {
  warn_of_namesake(option.scene);
  const auto document = option.document();
  if (!document) {
    exit_code = report(document.error());
    return std::nullopt;
  }
  Issues issues;
  Progress progress(quiet, kReadingDelay);
  LoadOptions options;
  for (const std::string& assignment : option.tool_sets) options.tool_sets.push_back(from_current_folder(assignment));
  options.progress = [&](double share) { progress.show(share, "reading the scan"); };
  options.say = [&](const std::string& line) { progress.say(line); };
  options.live = live;
  if (!inputs.empty())
    options.input_tools = [&](const Scene& scene, Issues& found) {
      const auto read = load_inputs(inputs, scene, scene_context(), found);
      return read ? tools_of(*read).texts : std::vector<ToolText>();
    };
  auto loaded = load_scene(*document, scene_context(), issues, options);
  if (!loaded) exit_code = report(issues);
  return loaded;
}

std::optional<std::vector<double>> split_numbers(const std::string& text, char separator, std::size_t count) {
  std::vector<double> out;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    try {
      std::size_t used = 0;
      const std::string word = text.substr(start, end - start);
      out.push_back(std::stod(word, &used));
      if (used != word.size() || !std::isfinite(out.back())) return std::nullopt;
    } catch (const std::exception&) {
      return std::nullopt;
    }
    start = end + 1;
  }
  return out.size() == count ? std::optional(out) : std::nullopt;
}

}  // namespace burrhole::cli
