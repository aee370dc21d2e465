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
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(share_folder()) / folder, ignored))
    if (const std::string name = entry.path().stem().string(); entry.path().extension() == ".toml" && is_plain(name)) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

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
