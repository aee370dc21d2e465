#include "app/cli/command_text.h"

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

}  // namespace

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
