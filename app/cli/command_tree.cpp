#include "app/cli/command_tree.h"

namespace burrhole::cli {
namespace {

OptionNode option_node(const CLI::Option& option) {
  OptionNode node;
  for (const std::string& name : option.get_snames()) node.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) node.names.push_back("--" + name);
  if (option.get_type_size() != 0) node.value = option.get_type_name();
  node.fallback = option.get_default_str();
  node.about = option.get_description();
  return node;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \n");
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(" \n") + 1 - first);
}

CommandNode command_node(const CLI::App& app, const std::string& path) {
  CommandNode node;
  node.name = app.get_name();
  node.path = path;
  node.group = app.get_group();
  const std::string description = app.get_description();
  const std::size_t line = std::min(description.find('\n'), description.size());
  node.summary = description.substr(0, line);
  node.about = trimmed(description.substr(line));
  node.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional())
      node.arguments.push_back({option->get_name(true, false), option->get_type_name(), option->get_description(), option->get_required()});
    else
      node.options.push_back(option_node(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    node.commands.push_back(command_node(*command, path.empty() ? command->get_name() : path + " " + command->get_name()));
  return node;
}

void collect(const CommandNode& node, std::vector<const CommandNode*>& out) {
  out.push_back(&node);
  for (const CommandNode& command : node.commands) collect(command, out);
}

}  // namespace

CommandNode walk_commands(const CLI::App& program) { return command_node(program, {}); }

std::vector<const CommandNode*> every_command(const CommandNode& root) {
  std::vector<const CommandNode*> out;
  collect(root, out);
  return out;
}

}  // namespace burrhole::cli
