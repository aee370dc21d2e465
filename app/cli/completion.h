/// app/cli/completion.h: completion scripts for bash, zsh and fish, generated from the command tree.
///   They complete commands, options, and, by kind of value, shipped scenes and tools, files and folders. The names are those of this
///   installation at the time of printing; names that need quoting in a shell are left out.
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

/// @returns the words that a kind of value allows, from its form "KIND:{a,b,c}"; empty if it allows others.
[[nodiscard]] std::vector<std::string> allowed_words(const std::string& value);

/// @returns 'text' as one quoted word for bash and zsh, which write a quote as '\''.
[[nodiscard]] std::string shell_quoted(const std::string& text);
/// @returns 'text' as one quoted word for fish, which writes a quote as \'.
[[nodiscard]] std::string fish_quoted(const std::string& text);

/// @returns the words with spaces between them.
[[nodiscard]] std::string joined(const std::vector<std::string>& words);

}  // namespace burrhole::cli
