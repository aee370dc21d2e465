#include <algorithm>

#include "app/cli/command_text.h"
#include "app/cli/completion.h"

namespace burrhole::cli {
namespace {

/// @returns switches of `complete` that offer values of a kind. The script disables files (`complete -f`) unless -F enables them.
std::string values(const std::string& value, const ShippedNames& shipped) {
  if (value == kSceneValue) return " -F -a " + fish_quoted(joined(shipped.scenes));
  if (value == kToolValue) return " -F -a " + fish_quoted(joined(shipped.tools));
  if (value == kFolderValue) return " -a '(__fish_complete_directories)'";
  if (value == kShippedValue) return " -a " + fish_quoted(joined(shipped.scenes));
  if (const auto words = allowed_words(value); !words.empty()) return " -a " + fish_quoted(joined(words));
  return value == kFileValue ? " -F" : "";
}

std::string command_lines(const CommandNode& node, const ShippedNames& shipped) {
  const std::string start = "complete -c burrhole -n " + fish_quoted("__burrhole_at" + (node.path.empty() ? "" : " " + node.path));
  std::string out;
  for (const CommandNode& command : node.commands) out += start + " -a " + command.name + " -d " + fish_quoted(command.summary) + "\n";
  for (const ArgumentNode& argument : node.arguments)
    if (const std::string offered = values(argument.value, shipped); !offered.empty())
      out += start + offered + " -d " + fish_quoted(argument.name) + "\n";
  for (const OptionNode& option : node.options) {
    out += start;
    for (const std::string& name : option.names) out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.value.empty()) out += " -r" + values(option.value, shipped);
    out += " -d " + fish_quoted(option.about) + "\n";
  }
  return out;
}

}  // namespace

std::string fish_completion(const CommandNode& program, const ShippedNames& shipped) {
  std::vector<std::string> names;
  std::string lines;
  for (const CommandNode* node : every_command(program)) {
    if (!node->path.empty() && std::find(names.begin(), names.end(), node->name) == names.end()) names.push_back(node->name);
    lines += command_lines(*node, shipped);
  }
  return "# fish completion of burrhole; printed by `burrhole completion fish`.\n\n"
         "# Whether the commands typed so far are exactly these.\n"
         "function __burrhole_at\n    set -l path\n    set -l words (commandline -opc)\n    for word in $words[2..-1]\n"
         "        contains -- $word " +
         joined(names) +
         "; and set -a path $word\n    end\n    test \"$path\" = \"$argv\"\nend\n\n"
         "complete -c burrhole -f\n" +
         lines;
}

}  // namespace burrhole::cli
