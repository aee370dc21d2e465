// app/cli/main.cpp: the program burrhole: parses the command line, runs one command, reports errors.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <span>
#include <sstream>

#include "app/cli/choose.h"
#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/cli/program.h"
#include "core/base/caught_error.h"

namespace burrhole::cli {
namespace {

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
  int exit_code = kDone;
  const std::unique_ptr<CLI::App> app = make_program(exit_code);
  const std::span<const char* const> words(argv, static_cast<std::size_t>(argc));
  if (const auto unknown = unknown_command(*app, words.subspan(std::min<std::size_t>(words.size(), 1)))) {
    print_line(*unknown);
    return kBadInput;
  }
  try {
    run_command(*app, argc, argv, exit_code);
    return exit_code;
  } catch (const NoOutput& failure) {
    return report(failure);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return print_asked(*app, error);
    print_line("burrhole: " + usage_text(*app, error));
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
