// app/cli/main.cpp: the program burrhole: parses the command line, runs one command, reports errors.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <sstream>

#include "app/cli/choose.h"
#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "core/base/caught_error.h"

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

/// @returns whether a word in place of a command is unknown; prints it with the nearest known command, which CLI11 does not do.
bool refuse_unknown_command(const CLI::App& program, int argc, char** argv) {
  const CLI::App* app = &program;
  for (int n = 1; n < argc && argv[n][0] != '-'; ++n) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
      if (command->get_name() == argv[n]) next = command;
    }
    if (app->get_require_subcommand_min() == 0) return false;
    if (next == nullptr) {
      const auto near = nearest_name(argv[n], names);
      const std::string drilled = app == &program && is_scene(argv[n]) ? std::string("drill ") + argv[n] : near.value_or("");
      print_line(std::string("burrhole: unknown command \"") + argv[n] + "\"" +
                 (drilled.empty() ? "" : "; did you mean \"" + drilled + "\"?") + " (--help lists them)");
      return true;
    }
    app = next;
  }
  return false;
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

/// @returns what is wrong with the words after the program's name, in one line without its end.
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

/// Parses the command line; without a command, that which a person chooses in a window.
void run_command(CLI::App& app, int argc, char** argv, int& exit_code) {
  if (argc > 1) return app.parse(argc, argv);
  const auto chosen = choose_command();
  if (!chosen) {
    exit_code = report(chosen.error());
    return;
  }
  std::vector<std::string> words = *chosen;
  if (words.empty()) {  // closed
    if (stop_requested().load()) exit_code = kInterrupted;
    return;
  }
  std::ranges::reverse(words);  // CLI11 takes them from the last to the first
  app.parse(words);
}

/// Prints what --help or --version asked for. @returns the exit code.
int print_asked(const CLI::App& app, const CLI::ParseError& asked) {
  std::ostringstream text, none;
  static_cast<void>(app.exit(asked, text, none));
  try {
    print(text.str());
  } catch (const NoOutput& failure) {
    return report(failure);
  }
  return kDone;
}

int run_program(int argc, char** argv) {
  CLI::App app{kAbout, "burrhole"};
  app.formatter(make_formatter());
  app.get_formatter()->column_width(30);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.set_version_flag("--version", BH_VERSION);
  app.require_subcommand(1);
  int exit_code = kDone;
  add_commands(app, exit_code);
  check_given_values(app);
  app.footer(kFooter);
  if (refuse_unknown_command(app, argc, argv)) return kBadInput;
  try {
    run_command(app, argc, argv, exit_code);
    return exit_code;
  } catch (const NoOutput& failure) {
    return report(failure);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return print_asked(app, error);
    print_line("burrhole: " + usage_text(app, error));
    return kBadInput;
  }
}

}  // namespace
}  // namespace burrhole::cli

int main(int argc, char** argv) {
  using namespace burrhole;
  cli::prepare_streams();
  try {
    return cli::run_program(argc, argv);
  } catch (...) {
    try {
      const Error error = caught_error();
      return cli::report(Error{error.code, "burrhole: " + error.text(), {}});
    } catch (...) {  // even the message found no memory
      std::fputs("burrhole: there is not enough memory\n", stderr);
      return cli::kUnavailable;
    }
  }
}
