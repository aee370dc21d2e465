#include "app/cli/command_text.h"
#include "app/cli/completion.h"

namespace burrhole::cli {
namespace {

/// Text inside [...] of an _arguments specification, or behind the colon of a _describe entry.
std::string spec_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string function_name(const CommandNode& node) {
  std::string name = "_burrhole";
  for (const char c : node.path.empty() ? "" : "_" + node.path) name += c == ' ' || c == '-' ? '_' : c;
  return name;
}

/// @returns the completion action of zsh for a value of this kind.
std::string action(const std::string& value) {
  if (value == kSceneValue) return "__burrhole_scenes";
  if (value == kToolValue) return "__burrhole_tools";
  if (value == kFolderValue) return "_files -/";
  if (value == kShippedValue) return "__burrhole_shipped";
  if (const auto words = allowed_words(value); !words.empty()) return "(" + joined(words) + ")";
  return value == kFileValue ? "_files" : " ";
}

std::string option_specs(const CommandNode& node) {
  std::string out;
  for (const OptionNode& option : node.options)
    for (const std::string& name : option.names) {
      const std::string value = option.value.empty() ? "" : ":" + spec_text(option.value) + ":" + action(option.value);
      out += " \\\n    " + shell_quoted("*" + name + "[" + spec_text(option.about) + "]" + value);
    }
  return out;
}

std::string leaf_function(const CommandNode& node) {
  std::string out = function_name(node) + "() {\n  _arguments" + option_specs(node);
  for (const ArgumentNode& argument : node.arguments)
    out += " \\\n    " + shell_quoted((argument.required ? ":" : "::") + spec_text(argument.name) + ":" + action(argument.value));
  return out + "\n}\n\n";
}

std::string branch_function(const CommandNode& node) {
  std::string list, cases;
  for (const CommandNode& command : node.commands) {
    list += "    " + shell_quoted(command.name + ":" + spec_text(command.summary)) + "\n";
    cases += "        " + command.name + ") " + function_name(command) + " ;;\n";
  }
  return function_name(node) + "() {\n  local curcontext=$curcontext state line\n  local -a commands\n  commands=(\n" + list +
         "  )\n  _arguments -C" + option_specs(node) + " \\\n    '1: :->command' \\\n    '*:: :->rest'\n  case $state in\n" +
         "    command) _describe -t commands command commands ;;\n    rest)\n      case $line[1] in\n" + cases +
         "      esac ;;\n  esac\n}\n\n";
}

std::string names_function(const std::string& name, const std::vector<std::string>& names) {
  return name + "() {\n  _alternative 'names:shipped:(" + joined(names) + ")' 'files:file:_files -g \"*.toml(-.)\"'\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandNode& program, const ShippedNames& shipped) {
  std::string out = "#compdef burrhole\n# zsh completion of burrhole; printed by `burrhole completion zsh`.\n\n";
  out += names_function("__burrhole_scenes", shipped.scenes) + names_function("__burrhole_tools", shipped.tools);
  out += "__burrhole_shipped() {\n  compadd -- " + joined(shipped.scenes) + "\n}\n\n";
  for (const CommandNode* node : every_command(program)) out += node->commands.empty() ? leaf_function(*node) : branch_function(*node);
  // Autoloaded from a folder of fpath, the file is the body of the function; sourced, it registers the function.
  return out + "if [ \"$funcstack[1]\" = _burrhole ]; then\n  _burrhole \"$@\"\nelse\n  compdef _burrhole burrhole\nfi\n";
}

}  // namespace burrhole::cli
