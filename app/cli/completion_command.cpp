#include <algorithm>
#include <filesystem>

#include "app/cli/commands.h"
#include "app/cli/completion.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

/// @returns whether a name is one word in every shell without quotes.
bool is_plain(const std::string& name) {
  return !name.empty() && name[0] != '-' && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
  });
}

std::vector<std::string> shipped(const char* folder) {
  std::vector<std::string> names = shipped_names(folder);
  std::erase_if(names, [](const std::string& name) { return !is_plain(name); });
  return names;
}

}  // namespace

std::vector<std::string> allowed_words(const std::string& value) {
  std::vector<std::string> out;
  const std::size_t open = value.find(":{"), close = value.find('}');
  if (open == std::string::npos || close == std::string::npos) return out;
  std::size_t at = open + 2;
  while (at < close) {
    const std::size_t end = std::min(value.find(',', at), close);
    out.push_back(value.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "completion", kReferenceGroup,
      {.summary = "Prints a completion script for bash, zsh or fish",
       .about = "The script completes commands, options, and the names of shipped scenes and tools. The installation includes it; for a "
                "program in a build folder, load it into the running shell.",
       .examples = {"source <(burrhole completion bash)", "burrhole completion fish > ~/.config/fish/completions/burrhole.fish"},
       .exits = {}});
  command->require_subcommand(1);
  const auto add = [&](const char* shell, std::string (*make)(const CommandNode&, const ShippedNames&), const std::string& example) {
    add_command(*command, shell, "Shells",
                {.summary = std::string("Prints the script for ") + shell,
                 .about = "Prints only the script on stdout.",
                 .examples = {example},
                 .exits = {}})
        ->callback([&app, &exit_code, make] {
          print(make(walk_commands(app), {shipped("scenes"), shipped("tools")}));
          exit_code = kDone;
        });
  };
  add("bash", bash_completion, "source <(burrhole completion bash)");
  add("zsh", zsh_completion, "source <(burrhole completion zsh)");
  add("fish", fish_completion, "burrhole completion fish | source");
}

}  // namespace burrhole::cli
