#include "app/cli/program.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "app/cli/commands.h"
#include "core/config/toml_messages.h"

namespace burrhole::cli {
namespace {

constexpr const char* kAbout =
    R"(burrhole simulates the drilling of craniotomy burrholes in a voxel skull, with haptic contact, erosion and
rendering.

  burrhole                             choose in a window, where there is a display
  burrhole drill parietal --out out    drill the shipped scene; then open out/report.html
  burrhole check my_scene.toml         print every error of a scene with its line
  burrhole tools                       list the shipped bits
)";

constexpr const char* kFooter =
    R"(burrhole COMMAND --help describes a command; burrhole docs scene lists the keys of a scene.
Exit: 0 done, 1 internal error, 2 input or usage error, or an output that cannot be written, 3 a check
failed, 4 no usable device, display or OpenGL, 130 interrupted.)";

void add_commands(CLI::App& app, int& exit_code) {
  add_drill(app, exit_code);
  add_render(app, exit_code);
  add_import(app, exit_code);
  add_export(app, exit_code);
  add_replay(app, exit_code);
  add_compare(app, exit_code);
  add_session(app, exit_code);
  add_scenes(app, exit_code);
  add_check(app, exit_code);
  add_explain(app, exit_code);
  add_tools(app, exit_code);
  add_devices(app, exit_code);
  add_cost(app, exit_code);
  add_stability(app, exit_code);
  add_docs(app, exit_code);
  add_completion(app, exit_code);
  add_man(app, exit_code);
}

bool is_scene(const std::string& word) {
  const std::vector<std::string> shipped = shipped_names("scenes");
  return std::ranges::find(shipped, word) != shipped.end() || (word.ends_with(".toml") && word.size() > std::string_view(".toml").size());
}

/// @returns the command that was named last on the command line.
const CLI::App& named_command(const CLI::App& program) {
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return *app;
}

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : full_name(*app.get_parent()) + " " + app.get_name();
}

/// @returns the text of an unknown option, with the nearest that the command has.
std::string unknown_option(const CLI::App& command, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const auto near = nearest_name(word, names);
  return "unknown option \"" + word + "\"" + (near ? "; did you mean \"" + *near + "\"?" : "");
}

}  // namespace

std::unique_ptr<CLI::App> make_program(int& exit_code) {
  auto app = std::make_unique<CLI::App>(kAbout, "burrhole");
  app->formatter(make_formatter());
  app->get_formatter()->column_width(30);
  app->get_formatter()->label("SUBCOMMAND", "COMMAND");
  app->set_version_flag("--version", BH_VERSION);
  app->require_subcommand(1);
  add_commands(*app, exit_code);
  check_given_values(*app);
  app->footer(kFooter);
  return app;
}

std::optional<std::string> unknown_command(const CLI::App& program, std::span<const char* const> words) {
  const CLI::App* app = &program;
  for (const std::string_view word : words) {
    if (word.starts_with('-')) break;
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
      if (command->get_name() == word) next = command;
    }
    if (app->get_require_subcommand_min() == 0) break;
    if (next == nullptr) {
      const std::string name(word);
      const auto near = nearest_name(name, names);
      const std::string drilled = app == &program && is_scene(name) ? "drill " + name : near.value_or("");
      return "burrhole: unknown command \"" + name + "\"" + (drilled.empty() ? "" : "; did you mean \"" + drilled + "\"?") +
             " (--help lists them)";
    }
    app = next;
  }
  return std::nullopt;
}

std::string usage_text(const CLI::App& program, const CLI::ParseError& error) {
  const CLI::App& command = named_command(program);
  std::string text = error.what();
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
    const std::vector<std::string> extra = program.remaining(true);
    if (!extra.empty()) {
      const std::string word = extra.front().substr(0, extra.front().find('='));
      text = word.starts_with("-") ? unknown_option(command, word) : "unexpected \"" + word + "\"";
    }
  } else if (text == "scene is required") {
    text = "SCENE is missing: a file, or the name of a shipped scene (burrhole scenes lists them)";
  }
  return text + " (see " + full_name(command) + " --help)";
}

}  // namespace burrhole::cli
