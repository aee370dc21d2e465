#include "app/cli/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "app/cli/progress.h"
#include "app/job/drill_job.h"
#include "core/base/simd.h"

namespace burrhole::cli {

namespace fs = std::filesystem;

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
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return exit_code_of(error);
}

int report(const Issues& issues) {
  int code = kDone;
  for (const Error& issue : issues) {
    const int own = report(issue);
    // An input error has precedence over `unavailable`, because the user can fix it.
    if (code == kDone || code == kUnavailable) code = own;
  }
  return code;
}

std::string share_folder() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share" / "burrhole";
  return fs::is_directory(installed / "tools", ignored) ? installed.string() : std::string(BH_SHARE_FALLBACK);
}

SceneContext scene_context() { return {{(fs::path(share_folder()) / "tools").string()}}; }

std::string find_scene(const std::string& scene) {
  if (fs::exists(scene) || scene.find('/') != std::string::npos) return scene;
  const std::string file = scene.ends_with(".toml") ? scene : scene + ".toml";
  const fs::path shipped = fs::path(share_folder()) / "scenes" / file;
  return fs::exists(shipped) ? shipped.string() : scene;
}

void SceneOption::add_to(CLI::App& command) {
  command.add_option("scene", scene, "scene file (TOML), or the name of a shipped scene")->type_name(kSceneValue)->required();
  command.add_option("--set", sets, "override a key, e.g. --set tool.spin_rpm=800 (repeatable)")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
}

void add_stereo_options(CLI::App& command, SceneOption& scene) {
  command
      .add_option_function<std::string>(
          "--stereo", [&scene](const std::string& mode) { scene.sets.push_back(fmt::format("display.stereo=\"{}\"", mode)); },
          "pictures of two eyes in one: side-by-side, top-bottom or anaglyph")
      ->type_name("MODE")
      ->check(CLI::IsMember({"off", "side-by-side", "top-bottom", "anaglyph"}));
  command
      .add_option_function<double>(
          "--workbench", [&scene](double height) { scene.sets.push_back(fmt::format("display.workbench_mm={}", height)); },
          "bone at its true size on a screen of that height (keys workbench_mm, head_mm, mirrored)")
      ->type_name("MM")
      ->check(CLI::Range(1.0, 5000.0));
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

Result<TomlDocument> SceneOption::document() const {
  auto document = TomlDocument::load(find_scene(scene));
  if (!document) return document.error();
  for (const std::string& assignment : sets)
    if (Status applied = document->set(assignment); !applied) return applied.error();
  return document;
}

void print_warning(const std::string& file, const std::string& warning) {
  const std::size_t end = warning.starts_with(file + ":") ? warning.find(": ", file.size()) : std::string::npos;
  if (end == std::string::npos)
    fmt::print(stderr, "{}: warning: {}\n", file, warning);
  else
    fmt::print(stderr, "{}: warning: {}\n", warning.substr(0, end), warning.substr(end + 2));
}

std::optional<LoadedScene> load_or_report(const SceneOption& option, int& exit_code, bool quiet, bool live, const std::string& inputs) {
  const auto document = option.document();
  if (!document) {
    exit_code = report(document.error());
    return std::nullopt;
  }
  Issues issues;
  Progress progress(quiet, kReadingDelay);
  LoadOptions options;
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

void print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

}  // namespace burrhole::cli
