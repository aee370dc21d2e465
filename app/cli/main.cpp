// app/cli/main.cpp: burrhole COMMAND. Parses, calls, reports.

#include <cstdio>
#include <exception>

#include "app/cli/front.h"

namespace burrhole::cli {
namespace {

constexpr const char* kAbout =
    R"(burrhole drills craniotomy burrholes through a voxel skull that is felt, eroded and drawn.

  burrhole drill parietal --out out    drill the shipped scene; then look at out/report.html
  burrhole check my_scene.toml         every fault of a scene, with its line
  burrhole tools                       the bits there are to drill with
)";

constexpr const char* kFooter =
    R"(burrhole COMMAND --help tells more about a command; burrhole docs scene lists what a scene may say.
Exit: 0 done, 1 a bug of ours, 2 input or usage, 3 a check failed, 4 no usable device, display or GL,
130 interrupted.)";

void add_commands(CLI::App& app, int& exit_code) {
  add_drill(app, exit_code);
  add_render(app, exit_code);
  add_import(app, exit_code);
  add_replay(app, exit_code);
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

/// Whether a word stands where a command must and is none: told with the nearest, which CLI11 does not do.
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
      std::fprintf(stderr, "burrhole: unknown command \"%s\"%s (--help lists them)\n", argv[n],
                   near ? ("; did you mean \"" + *near + "\"?").c_str() : "");
      return true;
    }
    app = next;
  }
  return false;
}

}  // namespace
}  // namespace burrhole::cli

// NOLINTNEXTLINE(bugprone-exception-escape): outside of the try block only exhausted memory throws.
int main(int argc, char** argv) {
  using namespace burrhole::cli;
  CLI::App app{kAbout, "burrhole"};
  app.formatter(make_formatter());
  app.get_formatter()->column_width(30);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.set_version_flag("--version", BH_VERSION);
  app.require_subcommand(1);
  int exit_code = kDone;
  add_commands(app, exit_code);
  app.footer(kFooter);
  if (refuse_unknown_command(app, argc, argv)) return kBadInput;
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "burrhole: %s (--help tells more)\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "burrhole: our bug: %s\n", error.what());
    return kOurBug;
  }
}
