/// app/cli/command_text.h: the description of a command, shared by --help, the manual and shell completion.   Thread  main.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace burrhole::cli {

/// Headings of `burrhole --help`, in the order of registration.
inline constexpr const char* kDrillGroup = "Drill and view";
inline constexpr const char* kSceneGroup = "Scenes and tools";
inline constexpr const char* kMeasureGroup = "Measure";
inline constexpr const char* kReferenceGroup = "Reference and shell";

/// Kinds of value as help shows them; completion chooses between files, folders and shipped names by them.
inline constexpr const char* kSceneValue = "SCENE";
inline constexpr const char* kToolValue = "NAME";
inline constexpr const char* kShippedValue = "SHIPPED";  // a shipped scene, no file
inline constexpr const char* kFileValue = "FILE";
inline constexpr const char* kFolderValue = "FOLDER";

struct CommandText {
  std::string summary;                ///< one line without full stop, for lists of commands
  std::string about;                  ///< one paragraph
  std::vector<std::string> examples;  ///< command lines, without a prompt
  std::string exits;                  ///< exit codes beyond 0, 1 and 2, one sentence; empty: none
};

/// Registers a sub-command. Its description is the summary and, after an empty line, `about`; its footer has the examples and exit codes.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& group, const CommandText& text);

/// @returns a check of a number in [low, high]. CLI::Range accepts nan.
[[nodiscard]] CLI::Validator number_in(double low, double high);

/// Adds to each option of all commands that takes a path a check that its value is neither empty nor longer than a path may be, and to every
/// option one of its length. Call it once all commands are added.
void check_given_values(CLI::App& program);

/// @returns a formatter whose lists of commands show only the first line of each description. Set it on the root before commands are added.
[[nodiscard]] std::shared_ptr<CLI::Formatter> make_formatter();

/// @returns text broken between words into lines of at most `width` characters; existing line breaks stay.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width = 96);

}  // namespace burrhole::cli
