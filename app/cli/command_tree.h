/// app/cli/command_tree.h: the command line as plain values, read from CLI11's App; used by the manual and by shell completion.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace burrhole::cli {

struct OptionNode {
  std::vector<std::string> names;  ///< "-h", "--help": as typed
  std::string value;               ///< "FILE"; empty: a flag
  std::string fallback;            ///< default value; empty: none
  std::string about;
};

struct ArgumentNode {
  std::string name, value, about;
  bool required = false;
};

struct CommandNode {
  std::string name;
  std::string path;  ///< commands from the program down to this one: "cost contact"; empty for the program itself
  std::string group;
  std::string summary;  ///< first line of the description
  std::string about;    ///< the rest of the description
  std::string footer;   ///< examples and exit codes, lines as printed
  std::vector<OptionNode> options;
  std::vector<ArgumentNode> arguments;
  std::vector<CommandNode> commands;
};

[[nodiscard]] CommandNode walk_commands(const CLI::App& program);

/// @returns the node and all its descendants, parents first.
[[nodiscard]] std::vector<const CommandNode*> every_command(const CommandNode& root);

}  // namespace burrhole::cli
