/// app/cli/command_text.h: what a command says about itself, in one form for --help, the manual and completion.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace burrhole::cli {

/// Headings of `burrhole --help`, in the order of registration.
inline constexpr const char* kDrillGroup = "Drill and look";
inline constexpr const char* kSceneGroup = "Scenes and tools";
inline constexpr const char* kMeasureGroup = "Measure";
inline constexpr const char* kFrontGroup = "Front door";

/// Kinds of value as help shows them; completion offers files, folders and shipped names by them.
inline constexpr const char* kSceneValue = "SCENE";
inline constexpr const char* kToolValue = "NAME";
inline constexpr const char* kFileValue = "FILE";
inline constexpr const char* kFolderValue = "FOLDER";

struct CommandText {
  std::string summary;                ///< one line, no full stop, for lists of commands
  std::string about;                  ///< one paragraph
  std::vector<std::string> examples;  ///< command lines, without a prompt
  std::string exits;                  ///< exit codes beyond 0, 1 and 2, one sentence; empty: none
};

/// Registers a sub-command. The summary becomes the first line of its description, examples and exit codes its footer.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& group, const CommandText& text);

/// Lists of commands show the first line of each description only. Set on the root before commands are added.
[[nodiscard]] std::shared_ptr<CLI::Formatter> make_formatter();

/// Breaks text between words into lines of at most `width` letters; line breaks in it stay.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width = 96);

}  // namespace burrhole::cli
