/// app/cli/front.h: what every command shares: where shipped files lie, how faults are printed, which exit code follows.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command_text.h"
#include "app/scene/load.h"
#include "core/config/toml.h"

namespace burrhole::cli {

/// 0 done, 1 our bug, 2 input or usage, 3 a check or bound failed, 4 no usable device, display or GL, 130 interrupted.
enum ExitCode : int { kDone = 0, kOurBug = 1, kBadInput = 2, kCheckFailed = 3, kUnavailable = 4, kInterrupted = 130 };

[[nodiscard]] int exit_code_of(const Error& error);
/// Prints one line a fault to stderr. @returns the exit code: 2, or 4 when every fault is that something is not available.
int report(const Issues& issues);
int report(const Error& error);

/// <program>/../share/burrhole when installed, the source tree's app folder otherwise.
[[nodiscard]] std::string share_folder();
[[nodiscard]] SceneContext scene_context();
/// The path as given; or, for a bare name, the shipped scene of that name.
[[nodiscard]] std::string find_scene(const std::string& scene);

/// A scene argument with its overrides.
struct SceneOption {
  std::string scene;
  std::vector<std::string> sets;
  void add_to(CLI::App& command);
  /// Parses and applies overrides.
  [[nodiscard]] Result<TomlDocument> document() const;
};

/// `--simd`, for every command that steps the simulation: chosen while arguments are read, before any step.
void add_simd_option(CLI::App& command);

/// `--gl`, for every command that draws.
void add_gl_option(CLI::App& command, std::string& gl);

/// `--shader-dir`, for the commands that write pictures.
void add_shader_option(CLI::App& command, std::string& folder);

/// Document, scene, bone and tool in one go, with a bar on long reads. Nothing when something was at fault: it is then printed and
/// `exit_code` set.
[[nodiscard]] std::optional<LoadedScene> load_or_report(const SceneOption& option, int& exit_code, bool quiet = false);

/// "AxB" or "A,B,C" as numbers; nothing when it is not exactly `count` finite numbers.
[[nodiscard]] std::optional<std::vector<double>> split_numbers(const std::string& text, char separator, std::size_t count);

/// Prints to stdout, unbuffered by anything else.
void print(const std::string& text);

// One function a command: registers it; its run function sets the exit code.
void add_drill(CLI::App& app, int& exit_code);
void add_render(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_tools(CLI::App& app, int& exit_code);
void add_devices(CLI::App& app, int& exit_code);
void add_cost(CLI::App& app, int& exit_code);
void add_stability(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_import(CLI::App& app, int& exit_code);
void add_docs(CLI::App& app, int& exit_code);
void add_man(CLI::App& app, int& exit_code);
void add_completion(CLI::App& app, int& exit_code);

}  // namespace burrhole::cli
