/// app/cli/commands.h: registration of all commands, and their common parts: shipped files, shared options, error output, exit codes.
///   Thread  main.   Errors  bad_input of scene files and options.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command_text.h"
#include "app/cli/standard_streams.h"
#include "app/scene/load.h"
#include "core/config/toml.h"

namespace burrhole::cli {

/// 0 done, 1 internal error, 2 input or usage error, 3 a check or bound failed, 4 no usable device, display or OpenGL, 130 interrupted.
enum ExitCode : int { kDone = 0, kInternalError = 1, kBadInput = 2, kCheckFailed = 3, kUnavailable = 4, kInterrupted = 130 };

[[nodiscard]] int exit_code_of(const Error& error);
/// Prints one line per error to stderr. @returns the exit code of the first error that is not `unavailable`; 4 if all are, 0 if there is
/// none.
int report(const Issues& issues);
int report(const Error& error);

/// @returns <program>/../share/burrhole when installed, the source tree's app folder otherwise.
[[nodiscard]] std::string share_folder();
/// @returns a context that finds the shipped tools.
[[nodiscard]] SceneContext scene_context();
/// @returns the folder "scenes" or "tools" of share_folder().
[[nodiscard]] std::string shipped_folder(const char* name);
/// @returns the path of the shipped scene of that name; otherwise the path as given. A name of a shipped scene is never a file or folder of
/// the current folder: warn_of_namesake() says so.
[[nodiscard]] std::string find_scene(const std::string& scene);
/// Prints a warning if the current folder has a file or folder that a person may mean by the name of a shipped scene.
void warn_of_namesake(const std::string& scene);

/// @returns the names of the shipped scenes, or tools, in alphabetical order. @param folder "scenes" or "tools" of share_folder().
[[nodiscard]] std::vector<std::string> shipped_names(const char* folder);

/// The argument SCENE with the overrides of --set, --set-tool and --unset.
struct SceneOption {
  std::string scene;
  std::vector<std::string> sets, tool_sets, unsets;
  bool no_pictures = false;  ///< [display] is left out, if the scene has it
  void add_to(CLI::App& command);
  /// Parses the file and applies the overrides of the scene. Paths of files in them count from the current folder, then from the scene's.
  [[nodiscard]] Result<TomlDocument> document() const;
};

/// Adds `--stereo` and `--workbench`, which set keys of [display].
void add_stereo_options(CLI::App& command, SceneOption& scene);

/// Adds `--simd`, for commands that run the simulation. The level is set while arguments are parsed, before any step.
void add_simd_option(CLI::App& command);

/// Adds `--gl`, for commands that draw.
void add_gl_option(CLI::App& command, std::string& gl);

/// Adds `--shader-dir`, for commands that write pictures.
void add_shader_option(CLI::App& command, std::string& folder);

/// Loads scene, bone and tool, with a progress bar on long reads. @returns nothing after an error, which is printed; `exit_code` is then
/// set.
/// @param live, inputs of the run, which count for [limits] memory_mb: on threads; a file of timed inputs, empty for none.
[[nodiscard]] std::optional<LoadedScene> load_or_report(const SceneOption& option, int& exit_code, bool quiet = false, bool live = false,
                                                        const std::string& inputs = {});

/// Prints one line to stderr: control characters are escaped, and a very long line is cut.
void print_line(const std::string& text);

/// Prints "FILE: warning: TEXT" to stderr; a warning that begins with a place of the file keeps it in front.
void print_warning(const std::string& file, const std::string& warning);

/// @returns the numbers of "AxB" or "A,B,C"; nothing if the text is not exactly `count` finite numbers.
[[nodiscard]] std::optional<std::vector<double>> split_numbers(const std::string& text, char separator, std::size_t count);

// Each registers one command, whose callback sets the exit code.
void add_drill(CLI::App& app, int& exit_code);
void add_render(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_session(CLI::App& app, int& exit_code);
void add_scenes(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_tools(CLI::App& app, int& exit_code);
void add_devices(CLI::App& app, int& exit_code);
void add_cost(CLI::App& app, int& exit_code);
void add_stability(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_docs(CLI::App& app, int& exit_code);
void add_man(CLI::App& app, int& exit_code);
void add_completion(CLI::App& app, int& exit_code);

}  // namespace burrhole::cli
