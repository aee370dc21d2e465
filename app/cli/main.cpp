// app/cli/main.cpp: burrhole COMMAND. Parses, calls, reports.

#include <algorithm>
#include <cstdio>
#include <exception>

#include "app/cli/front.h"

int main(int argc, char** argv) {
  using namespace burrhole::cli;
  CLI::App app{"burrhole: drills craniotomy burrholes through a voxel skull that is felt, eroded and drawn.", "burrhole"};
  app.set_version_flag("--version", BH_VERSION);
  app.require_subcommand(1);
  app.footer("Exit: 0 done, 1 a bug of ours, 2 input or usage, 3 a check failed, 4 no usable device, display or GL, 130 interrupted.");
  int exit_code = kDone;
  add_drill(app, exit_code);
  add_render(app, exit_code);
  add_import(app, exit_code);
  add_check(app, exit_code);
  add_explain(app, exit_code);
  add_tools(app, exit_code);
  add_replay(app, exit_code);
  add_cost(app, exit_code);
  if (argc > 1 && argv[1][0] != '-') {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) == names.end()) {
      const auto near = burrhole::nearest_name(argv[1], names);
      std::fprintf(stderr, "burrhole: unknown command \"%s\"%s (--help lists them)\n", argv[1],
                   near ? ("; did you mean \"" + *near + "\"?").c_str() : "");
      return kBadInput;
    }
  }
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
