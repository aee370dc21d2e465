/// app/cli/completion.h: completion scripts for shells, made from the walk of the command line.
///   Offered: commands, options, and by kind of value shipped scenes and tools, files and folders. Names are those of this installation
///   at the time of printing; names that a shell would have to quote are left out.
#pragma once

#include <string>
#include <vector>

#include "app/cli/command_tree.h"

namespace burrhole::cli {

struct ShippedNames {
  std::vector<std::string> scenes, tools;
};

[[nodiscard]] std::string bash_completion(const CommandNode& program, const ShippedNames& shipped);
[[nodiscard]] std::string zsh_completion(const CommandNode& program, const ShippedNames& shipped);
[[nodiscard]] std::string fish_completion(const CommandNode& program, const ShippedNames& shipped);

/// 'text' as one word of any of the three shells. zsh and bash need '\'' for a quote, fish \'.
[[nodiscard]] std::string shell_quoted(const std::string& text);
[[nodiscard]] std::string fish_quoted(const std::string& text);

[[nodiscard]] std::string joined(const std::vector<std::string>& words);

}  // namespace burrhole::cli
