/// app/cli/command_tree.h: the command line as plain values: one walk over CLI11's App, used by the manual and by completion.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace burrhole::cli {

struct OptionNode {
  std::vector<std::string> names;  ///< "-h", "--help": as typed
  std::string value;               ///< "FILE"; empty: a flag
  std::string fallback;            ///< of the value, empty: none
  std::string about;
};

struct ArgumentNode {
  std::string name, value, about;
  bool required = false;
};

struct CommandNode {
  std::string name;
  std::string path;  ///< of commands below the program: "cost contact"; empty for the program itself
  std::string group;
  std::string summary;  ///< first line of the description
  std::string about;    ///< the rest of it
  std::string footer;   ///< examples and exit codes, lines as printed
  std::vector<OptionNode> options;
  std::vector<ArgumentNode> arguments;
  std::vector<CommandNode> commands;
};

[[nodiscard]] CommandNode walk_commands(const CLI::App& program);

/// The node and all below it, parents first.
[[nodiscard]] std::vector<const CommandNode*> every_command(const CommandNode& root);

}  // namespace burrhole::cli
