#include "app/cli/command_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>

namespace burrhole::cli {
namespace {

class FirstLines : public CLI::Formatter {
 public:
  std::string make_subcommand(const CLI::App* command) const override {
    const std::string description = command->get_description();
    std::stringstream out;
    CLI::detail::format_help(out, command->get_display_name(true), description.substr(0, description.find('\n')), get_column_width());
    return out.str();
  }
};

constexpr std::size_t kLongestPath = 4095;    // [bytes] of Linux
constexpr std::size_t kLongestValue = 65536;  // [bytes] of any option

/// @returns whether the values of an option are paths or names of files.
bool names_files(const CLI::Option& option) {
  constexpr std::array kPaths{std::string_view(kSceneValue), std::string_view(kToolValue),   std::string_view(kShippedValue),
                              std::string_view(kFileValue),  std::string_view(kFolderValue), std::string_view("PATH"),
                              std::string_view("OUT.vdb")};
  return option.get_positional() || std::ranges::find(kPaths, option.get_type_name()) != kPaths.end();
}

std::string path_error(const std::string& value) {
  if (value.empty()) return "must name a file or a folder: the text is empty";
  if (value.size() > kLongestPath) return fmt::format("has {} bytes: a path has at most {}", value.size(), kLongestPath);
  return {};
}

std::string length_error(const std::string& value) {
  return value.size() > kLongestValue ? fmt::format("has {} bytes, at most {} are read", value.size(), kLongestValue) : std::string();
}

}  // namespace

CLI::Validator number_in(double low, double high) {
  const auto check = [low, high](std::string& text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), end, value);
    if (error == std::errc() && rest == end && value >= low && value <= high) return std::string();
    return fmt::format("{} is not a number in [{:g}, {:g}]", text, low, high);
  };
  return CLI::Validator(check, fmt::format("FLOAT in [{:g} - {:g}]", low, high));
}

void check_given_values(CLI::App& program) {
  for (CLI::Option* option : program.get_options()) {
    if (option->get_items_expected_max() == 0) continue;  // a flag
    option->check(
        CLI::Validator([paths = names_files(*option)](std::string& text) { return paths ? path_error(text) : length_error(text); }, ""));
  }
  for (CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) check_given_values(*command);
}

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& group, const CommandText& text) {
  CLI::App* command = parent.add_subcommand(name, text.summary + "\n\n" + wrapped(text.about) + "\n");
  command->group(group);
  std::string footer;
  if (!text.examples.empty()) footer += text.examples.size() == 1 ? "Example:\n" : "Examples:\n";
  for (const std::string& example : text.examples) footer += "  " + example + "\n";
  if (!text.exits.empty()) footer += "\n" + wrapped(text.exits) + "\n";
  if (!footer.empty()) footer.pop_back();  // the formatter adds the last line break
  command->footer(footer);
  return command;
}

std::shared_ptr<CLI::Formatter> make_formatter() { return std::make_shared<FirstLines>(); }

std::string wrapped(std::string_view text, std::size_t width) {
  std::string out;
  std::size_t column = 0;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\n' || text[i] == ' ') {
      if (text[i] == '\n') out += '\n', column = 0;
      ++i;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(" \n", i), text.size());
    if (column > 0 && column + 1 + (end - i) > width) out += '\n', column = 0;
    if (column > 0) out += ' ', ++column;
    out += text.substr(i, end - i);
    column += end - i;
    i = end;
  }
  return out;
}

}  // namespace burrhole::cli
