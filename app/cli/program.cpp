#include "app/cli/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/other_words.h"
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

std::string did_you_mean(const std::string& word) { return "; did you mean \"" + word + "\"?"; }

/// @returns the text of an unknown option, with the nearest that the command has, or of one letter those that begin with it.
std::string unknown_option(const CLI::App& command, const std::string& word) {
  constexpr std::size_t kShort = 2;  // "-o"
  const auto has = [&](const char* name) { return command.get_option_no_throw(name) != nullptr; };
  if (has(word.c_str())) return fmt::format("{1} comes before its command: options follow it, {0} ... {1}", full_name(command), word);
  if (const auto other = option_for(word, has("--image") ? "--image" : has("--volume") ? "--volume" : ""))
    if (other->option.empty() || command.get_option_no_throw(other->option) != nullptr)
      return fmt::format("unknown option \"{}\"; write {}", word, other->instead);
  std::vector<std::string> names, begun;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
      if (word.size() == kShort && name[0] == std::tolower(static_cast<unsigned char>(word[1]))) begun.push_back("--" + name);
    }
  if (!begun.empty()) return fmt::format("unknown option \"{}\"; did you mean {}?", word, fmt::join(begun, " or "));
  const auto near = nearest_name(word, names);
  return "unknown option \"" + word + "\"" + (near ? did_you_mean(*near) : "");
}

/// @returns the error of an assignment whose value is a word of its own: --set tool.spin_rpm 800, or with spaces round the sign.
std::optional<std::string> split_assignment(const CLI::App& command, std::span<const std::string> extra) {
  for (const char* name : {"--set", "--set-tool"}) {
    const CLI::Option* option = command.get_option_no_throw(name);
    if (option == nullptr) continue;
    for (const std::string& given : option->results()) {
      if (given.find('=') + 1 < given.size() && given.find('=') != std::string::npos) continue;
      const std::string key = given.substr(0, given.find('='));
      std::string value = extra.front();
      if (value == "=" && extra.size() > 1) value = extra[1];
      if (value.starts_with('=')) value.erase(0, 1);
      // An assignment before the scene: its value was taken for the scene, and the scene is the word that is left.
      const CLI::Option* scene = command.get_option_no_throw("scene");
      if (is_scene(extra.front()) && scene != nullptr && !scene->results().empty()) value = scene->results().front();
      return fmt::format("{0} {1} is not followed by its value: write {0} {2}={3}", name, given, key, value);
    }
  }
  return std::nullopt;
}

/// @returns the path that the words of a command make if spaces join them, where that path exists.
std::optional<std::string> path_with_spaces(const CLI::App& command, std::span<const std::string> extra) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional() || option->results().empty()) continue;
    std::string path = option->results().back();
    for (const std::string& word : extra) {
      path += " " + word;
      std::error_code ignored;
      if (std::filesystem::exists(path, ignored)) return path;
    }
  }
  return std::nullopt;
}

/// @returns the text of numbers that are words of their own: --size 400 300, where one word with a separator is read.
std::optional<std::string> split_numbers_of(const CLI::App& command, std::span<const std::string> extra) {
  const auto is_number = [](const std::string& text) { return split_numbers(text, ',', 1).has_value(); };
  for (const CLI::Option* option : command.get_options()) {
    const std::string type = option->get_type_name();
    const std::string separator = type.find(',') != std::string::npos ? "," : type == "WIDTHxHEIGHT" ? "x" : "";
    if (separator.empty() || option->results().size() != 1 || !is_number(option->results().front())) continue;
    std::string whole = option->results().front();
    for (const std::string& word : extra) {
      if (!is_number(word)) break;
      whole += separator + word;
    }
    if (whole != option->results().front()) return fmt::format("unexpected \"{}\": write {} {}", extra.front(), option->get_name(), whole);
  }
  return std::nullopt;
}

/// @returns the text of an output that is given without its option: render parietal hole.png.
std::optional<std::string> output_alone(const CLI::App& command, const std::string& word) {
  std::error_code ignored;
  if (!std::filesystem::path(word).has_extension() || std::filesystem::exists(word, ignored)) return std::nullopt;
  for (const char* name : {"--image", "--out", "--volume"})
    if (const CLI::Option* option = command.get_option_no_throw(name); option != nullptr && option->count() == 0)
      return fmt::format("unexpected \"{0}\"; did you mean {1} {0}?", word, name);
  return std::nullopt;
}

/// @returns the text of a stream or a shipped scene that is given without its option: session out --csv servo, scenes parietal.
std::optional<std::string> value_alone(const CLI::App& command, const std::string& word) {
  const std::vector<std::string_view> streams = {"servo", "contact", "bone", "audio", "events", "inputs"};
  if (command.get_option_no_throw("--stream") != nullptr && std::ranges::find(streams, word) != streams.end())
    return fmt::format("unexpected \"{0}\": write --csv --stream {0}", word);
  const CLI::Option* copy = command.get_option_no_throw("--copy");
  if (copy == nullptr) return std::nullopt;
  if (copy->count() > 0) return fmt::format("unexpected \"{0}\": write --out {0}", word);
  return fmt::format("unexpected \"{0}\": --copy {0} copies a shipped scene, burrhole explain {0} describes it", word);
}

std::string unexpected_word(const CLI::App& command, const std::vector<std::string>& extra) {
  const std::string word = extra.front().substr(0, extra.front().find('='));
  const auto numbers = split_numbers_of(command, extra);  // a negative one begins like an option
  if (word.size() > 1 && word.starts_with("-")) return numbers ? *numbers : unknown_option(command, word);
  if (const auto split = split_assignment(command, extra)) return *split;
  if (const auto path = path_with_spaces(command, extra)) return "unexpected \"" + word + "\": write the path in quotes, \"" + *path + "\"";
  if (numbers) return *numbers;
  if (const auto chosen = value_alone(command, extra.front())) return *chosen;
  if (const auto output = output_alone(command, extra.front())) return *output;
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional() && option->get_items_expected_max() == 1 && !option->results().empty())
      return fmt::format("unexpected \"{}\": {} takes one {}, here \"{}\"", extra.front(), full_name(command), option->get_name(),
                         option->results().front());
  return "unexpected \"" + extra.front() + "\"";
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
  return names;
}

/// @returns the text of a command line that ends before its command, or before that of a command of commands.
std::string missing_command(const CLI::App& app) {
  if (app.get_parent() == nullptr) return "a command is missing, such as burrhole drill parietal";
  return fmt::format("{} is incomplete: write {} after it", full_name(app), fmt::join(names_of_commands(app), " or "));
}

/// @returns the text of an argument that is missing, with its description.
std::string missing_argument(const CLI::App& command, const std::string& name) {
  if (name == "scene") return "SCENE is missing: a file, or the name of a shipped scene (burrhole scenes lists them)";
  const CLI::Option* option = command.get_option_no_throw(name);
  return option == nullptr ? name + " is missing" : fmt::format("{} is missing: {}", name, option->get_description());
}

/// @returns the text of an option with too few or too many values, in place of CLI11's, which counts them.
std::string wrong_count(const CLI::App& command, const std::string& text) {
  const CLI::Option* option = command.get_option_no_throw(text.substr(0, text.find(':')));
  if (option == nullptr) return text;
  const std::string name = option->get_name(), type = option->get_type_name();
  if (option->get_items_expected_max() == 1 && option->count() > 1)
    return fmt::format("{} is given {} times: give it once", name, option->count());
  if (text.find("missing") == std::string::npos) return text;
  return fmt::format("{} is not followed by its value: {} {}", name, name, type.substr(0, type.find(':')));
}

/// @returns what is wrong with an option in place of a command: --drill, or help and version as words.
std::optional<std::string> misplaced(const std::string& word, const std::vector<std::string>& names, std::span<const char* const> rest) {
  if (word == "help")
    return "unknown command \"help\"; did you mean \"" +
           (rest.empty() ? std::string("burrhole") : fmt::format("burrhole {}", rest.front())) + " --help\"?";
  if (word == "version") return "unknown command \"version\"" + did_you_mean("burrhole --version");
  if (!word.starts_with('-')) return std::nullopt;
  const std::string bare = word.substr(std::min(word.find_first_not_of('-'), word.size()));
  if (std::ranges::find(names, bare) == names.end()) return std::nullopt;
  return "\"" + word + "\" is a command, not an option" + did_you_mean("burrhole " + bare);
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
  for (std::size_t n = 0; n < words.size() && app->get_require_subcommand_min() > 0; ++n) {
    const std::string word(words[n]);
    const std::vector<std::string> names = names_of_commands(*app);
    if (app == &program)
      if (const auto text = misplaced(word, names, words.subspan(n + 1))) return "burrhole: " + *text + " (--help lists the commands)";
    if (word.starts_with('-')) break;
    if (std::ranges::find(names, word) == names.end()) {
      const auto near = nearest_name(word, names);
      const auto other = app == &program ? command_for(word) : std::nullopt;
      const std::string drilled = app == &program && is_scene(word) ? "drill " + word : other ? *other : near.value_or("");
      std::string next = drilled.empty() ? "" : did_you_mean(drilled);
      if (const auto advice = app == &program ? advice_for(word) : std::nullopt) next = "; " + *advice;
      if (app == &program) return "burrhole: unknown command \"" + word + "\"" + next + " (--help lists them)";
      if (next.empty() && app->get_name() == "docs") next = "; other pages are the files docs/*.md of the source";
      return fmt::format("burrhole: unknown word \"{}\" after {}, which knows {}{}", word, full_name(*app), fmt::join(names, ", "), next);
    }
    app = app->get_subcommand(word);
  }
  return std::nullopt;
}

std::string usage_text(const CLI::App& program, const CLI::ParseError& error) {
  constexpr std::string_view kRequired = " is required";
  const CLI::App& command = named_command(program);
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  const std::vector<std::string> extra = program.remaining(true);
  std::string text = error.what();
  const bool option = !extra.empty() && extra.front().size() > 1 && extra.front().starts_with('-');
  if (!extra.empty() && (code == CLI::ExitCodes::ExtrasError || (code == CLI::ExitCodes::RequiredError && option)))
    text = unexpected_word(command, extra);
  else if (code == CLI::ExitCodes::RequiredError && text == "A subcommand is required")
    text = missing_command(command);
  else if (code == CLI::ExitCodes::RequiredError && text.ends_with(kRequired))
    text = missing_argument(command, text.substr(0, text.size() - kRequired.size()));
  else if (code == CLI::ExitCodes::ArgumentMismatch)
    text = wrong_count(command, text);
  return text + " (see " + full_name(command) + " --help)";
}

}  // namespace burrhole::cli
