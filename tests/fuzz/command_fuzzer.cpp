// Any words as a command line: each command's own parser, without running the command. Errors are texts, and nothing but CLI11's own
// errors is thrown. Words are separated by a zero byte, which no argument holds.
#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "app/cli/program.h"
#include "core/config/toml_messages.h"

namespace {

using namespace burrhole;

constexpr int kInputsOfOne = 64;  // inputs that share a program: making it takes far longer than parsing

/// Thrown once the words are parsed and checked, before the callback of a command, which would run it.
struct Parsed {};

CLI::App& program() {
  static int exit_code = 0, used = kInputsOfOne;
  static std::unique_ptr<CLI::App> app;
  if (used++ >= kInputsOfOne) {
    app = cli::make_program(exit_code);
    app->parse_complete_callback([] { throw Parsed(); });
    used = 1;
  }
  return *app;
}

/// @returns a text as the program prints it, which must be one line of printable characters.
void demand_line(const std::string& text) {
  const std::string line = one_line(text, 2000);
  if (line.empty() || std::ranges::any_of(line, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> texts{"burrhole"};
  std::istringstream bytes(std::string(reinterpret_cast<const char*>(data), size));
  for (std::string word; std::getline(bytes, word, '\0') && texts.size() < 64;) texts.push_back(word);
  std::vector<const char*> words;
  for (const std::string& text : texts) words.push_back(text.c_str());
  CLI::App& app = program();
  if (const auto unknown = cli::unknown_command(app, std::span(words).subspan(1))) demand_line(*unknown);
  try {
    app.parse(static_cast<int>(words.size()), words.data());
    std::abort();  // the command ran
  } catch (const Parsed&) {
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      demand_line(cli::usage_text(app, error));
    } else {  // --help, --version
      std::ostringstream text, none;
      static_cast<void>(app.exit(error, text, none));
      if (text.str().empty() || !none.str().empty()) std::abort();
    }
  }
  return 0;
}
