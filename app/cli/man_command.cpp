#include "app/cli/commands.h"
#include "app/cli/man_page.h"

namespace burrhole::cli {

void add_man(CLI::App& app, int& exit_code) {
  add_command(
      app, "man", kReferenceGroup,
      {.summary = "Prints the manual page as troff",
       .about = "The page has every command with its options, exit codes, files and environment variables. The installation includes it: "
                "man burrhole.",
       .examples = {"burrhole man | man -l -"},
       .exits = {}})
      ->callback([&app, &exit_code] {
        print(man_page(walk_commands(app), BH_VERSION));
        exit_code = kDone;
      });
}

}  // namespace burrhole::cli
