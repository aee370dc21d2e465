#include "core/config/toml_parsed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "core/config/toml.h"
#include "core/config/toml_messages.h"
#include "core/config/toml_shape.h"

namespace burrhole::toml_wrapper {
namespace {

constexpr std::size_t kMostAssignments = 1000;  // given one by one, each is applied again for every later one

/// Whether `path` equals `top` or lies under it.
bool lies_under(const std::string& path, const std::string& top) {
  if (path.compare(0, top.size(), top) != 0) return false;
  return path.size() == top.size() || path[top.size()] == '.' || path[top.size()] == '[';
}

struct Step {
  std::string key;
  std::optional<std::size_t> index;  ///< set: element of the array at the key before
};

bool is_bare(char c) noexcept { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; }

/// Reads a bare or quoted key at path[i] and moves i behind it. @returns the key; empty: there is none.
std::string_view take_key(std::string_view path, std::size_t& i) {
  const std::size_t start = i;
  if (i < path.size() && (path[i] == '"' || path[i] == '\'')) {
    const std::size_t end = path.find(path[i], i + 1);
    if (end == std::string_view::npos) return {};
    i = end + 1;
    return path.substr(start + 1, end - start - 1);
  }
  while (i < path.size() && is_bare(path[i])) ++i;
  return path.substr(start, i - start);
}

/// Parses "a.b[2].c" into steps; nothing if the text is not such a path.
std::optional<std::vector<Step>> parse_path(std::string_view path) {
  std::vector<Step> steps;
  std::size_t i = 0;
  while (true) {
    const std::string_view key = take_key(path, i);
    if (key.empty()) return std::nullopt;
    steps.push_back({std::string(key), std::nullopt});
    if (i < path.size() && path[i] == '[') {
      std::size_t index = 0;
      const std::size_t first = ++i;
      for (; i < path.size() && path[i] >= '0' && path[i] <= '9' && i - first < 6; ++i)
        index = index * 10 + static_cast<std::size_t>(path[i] - '0');
      if (i == first || i >= path.size() || path[i] != ']') return std::nullopt;
      ++i;
      steps.push_back({{}, index});
    }
    if (i == path.size()) return steps;
    if (path[i++] != '.') return std::nullopt;
  }
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Whether the parser found the end of a line inside a text in quotes.
bool ends_inside_text(std::string_view message, std::string_view text, const toml::source_position& at) {
  if (message.find("parsing string") == std::string_view::npos || message.find("control characters") == std::string_view::npos)
    return false;
  std::size_t start = 0;
  for (toml::source_index line = 1; line < at.line; ++line) {
    const std::size_t end = text.find('\n', start);
    if (end == std::string_view::npos) return false;
    start = end + 1;
  }
  // Columns count characters, and bytes in front of them are no fewer: the end of the line is the error if no other control is in it.
  const std::string_view row = text.substr(start, text.find('\n', start) - start);
  return std::ranges::all_of(row, [](char c) { return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\r'; });
}

/// @returns a message of the parser; of a text that is not closed, and of a table that is there twice, as after a proposed [approach] was pasted, with what to do.
std::string with_next_step(std::string message, std::string_view text, const toml::source_position& at_error) {
  if (ends_inside_text(message, text, at_error)) return "a text in quotes has no closing quote on its line";
  constexpr std::string_view kTwice = "cannot redefine existing table '";
  const auto at = message.find(kTwice), end = message.rfind('\'');
  if (at == std::string::npos || end < at + kTwice.size()) return message;
  const std::string name = message.substr(at + kTwice.size(), end - at - kTwice.size());
  return fmt::format("the file has the table [{0}] twice: replace the scene's own [{0}] by this one, or leave this one out", name);
}

/// The value of an assignment as a table with the one key "v": TOML syntax, or a bare word or path taken as text.
std::optional<toml::table> parse_value(std::string_view value) {
  if (value.empty() || value.find_first_of("\r\n") != std::string_view::npos) return std::nullopt;
  auto table = parse_table("v = " + std::string(value), "");
  if (table.ok() && table->size() == 1) return std::move(table).value();
  const char first = value.front();
  const bool wordlike = (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z') || std::strchr("_./~$", first) != nullptr;
  if (!wordlike || value.find_first_of("\"'[]{}=#,") != std::string_view::npos || one_line(value, value.size()) != value)
    return std::nullopt;
  toml::table word;
  word.insert("v", std::string(value));
  return word;
}

/// @returns the names of the elements of an array of tables.
std::vector<std::string> element_names(const toml::array& array) {
  std::vector<std::string> out;
  for (const toml::node& node : array) {
    const toml::table* table = node.as_table();
    out.push_back(table != nullptr ? table->get_as<std::string>("name") != nullptr ? table->get_as<std::string>("name")->get() : "" : "");
  }
  return out;
}

/// @returns a name with blanks for what stands for them.
std::string with_blanks(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '_' || c == '-'; }, ' ');
  return name;
}

/// Makes a step by a name into one by its index. @returns an error if there is no element of that name; it lists the names as one writes
/// them.
Status resolve(const toml::array& array, const std::string& stopped_at, Step& step) {
  std::vector<std::string> names = element_names(array);
  for (std::size_t n = 0; n < names.size(); ++n)
    if (!names[n].empty() && with_blanks(names[n]) == with_blanks(step.key)) {
      step = {{}, n};
      return {};
    }
  for (std::string& name : names) std::ranges::replace(name, ' ', '_');
  return bad_input(fmt::format("{} has no \"{}\"; it has \"{}\"", stopped_at, step.key, fmt::join(names, "\", \"")));
}

std::string text_of(const std::vector<Step>& steps) {
  std::string out;
  for (const Step& step : steps)
    if (step.index)
      out += fmt::format("[{}]", *step.index);
    else
      out += (out.empty() ? "" : ".") + step.key;
  return out;
}

/// Walks to the table that holds the last key and, if `creates`, creates missing tables; steps by name become steps by index.
Result<toml::table*> descend(toml::table& root, std::vector<Step>& steps, bool creates) {
  toml::table* table = &root;
  std::string stopped_at;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    stopped_at += (stopped_at.empty() ? "" : ".") + steps[i].key;
    toml::node* node = table->get(steps[i].key);
    if (node == nullptr && creates && !steps[i + 1].index) node = &table->insert(steps[i].key, toml::table{}).first->second;
    if (node == nullptr && !creates) return bad_input(fmt::format("the file has no \"{}\"", stopped_at));
    if (node != nullptr && node->as_array() != nullptr && !steps[i + 1].index)
      if (Status found = resolve(*node->as_array(), stopped_at, steps[i + 1]); !found) return found.error();
    if (node != nullptr && steps[i + 1].index) {
      const std::size_t index = *steps[++i].index;
      stopped_at += fmt::format("[{}]", index);
      toml::array* array = node->as_array();
      node = array != nullptr && index < array->size() ? array->get(index) : nullptr;
    }
    table = node != nullptr ? node->as_table() : nullptr;
    if (table == nullptr) return bad_input(fmt::format("\"{}\" is not a table", stopped_at));
  }
  return table;
}

/// @returns the error of a key that is not there, with the nearest one.
Error absent(const toml::table& table, const std::string& path, const std::string& key) {
  std::vector<std::string> names;
  for (const auto& [name, node] : table) names.emplace_back(name.str());
  const auto near = nearest_name(key, names);
  return bad_input(fmt::format("the file has no \"{}\"{}", path,
                               near ? fmt::format("; did you mean \"{}\"?", *near) : fmt::format("; there is {}", fmt::join(names, ", "))));
}

}  // namespace

namespace {

/// @returns the error of a path that cannot be parsed: with the path to write, if its blanks are those of a name.
std::string wrong_path(toml::table& root, std::string_view path) {
  std::string written(path);
  std::ranges::replace(written, ' ', '_');
  auto steps = parse_path(written);
  const bool by_name = steps && steps->size() > 1 && root.get_as<toml::array>(steps->front().key) != nullptr;
  if (written == path || !by_name) return "the part before '=' must read table.key";
  const auto table = descend(root, *steps, false);
  return table ? fmt::format("a blank in a name is written as _: write {}", one_line(written, 200)) : table.error().message;
}

/// @returns the error of a value that cannot be parsed.
std::string wrong_value(std::string_view key, std::string_view value, const std::string& option) {
  if (const auto number = number_without_unit(key, value)) return *number;
  const std::size_t comma = value.find_first_of(",;"), equals = value.find('=');
  if (comma != std::string_view::npos && equals != std::string_view::npos && comma < equals && value.find_first_of("[{\"'") > equals)
    return fmt::format("holds a second assignment: give each its own {0}, as in {0} {1}={2} {0} {3}", option, key,
                       one_line(trimmed(value.substr(0, comma)), 60), one_line(trimmed(value.substr(comma + 1)), 60));
  if (comma != std::string_view::npos && value.find_first_not_of("0123456789.,-+eE ") == std::string_view::npos)
    return fmt::format("is no number: write a point for decimals, or [{}] for an array", one_line(value, 60));
  return "the part after '=' is not a TOML value; put text in quotes";
}

}  // namespace

std::string join(const std::string& path, std::string_view key) {
  const std::string name = one_line(key, 200);
  return path.empty() ? name : path + "." + name;
}

std::string place_at(const ParsedFile& parsed, const std::string& path, const toml::source_region& where) {
  for (const std::string& top : parsed.overridden)
    if (lies_under(path, top)) return parsed.option + " " + top;
  if (where.begin.line > 0 && !path.empty()) return fmt::format("{}:{}:{}", parsed.file, where.begin.line, where.begin.column);
  for (const std::string& top : parsed.overridden)
    if (!path.empty() && lies_under(top, path)) return parsed.option + " " + top;
  return parsed.file;
}

Result<toml::table> parse_table(std::string_view text, const std::string& file) {
  if (Status shape = check_toml_shape(text, file); !shape) return shape.error();
  try {
    return toml::parse(text, std::string_view(file));
  } catch (const toml::parse_error& error) {
    const auto begin = error.source().begin;
    return bad_input(with_next_step(one_line(error.description(), 300), text, begin),
                     fmt::format("{}:{}:{}", file, begin.line, begin.column));
  } catch (const std::exception& error) {  // toml++ reports invalid UTF-8 and the like by its own type, memory by std
    return bad_input(one_line(error.what(), 300), file);
  }
}

Status assign(ParsedFile& parsed, const Assignment& assignment) {
  const std::string_view text = assignment.text;
  const std::string place = assignment.option + " " + one_line(text, 120);
  const std::size_t equals = assignment.removes ? text.size() : text.find('=');
  if (equals == std::string_view::npos) return bad_input("must read table.key=value", place);
  if (parsed.assignments.size() >= kMostAssignments)
    return bad_input(fmt::format("is one of more than {} changes of one file", kMostAssignments), place);
  const std::string_view path = trimmed(text.substr(0, equals));
  auto steps = parse_path(path);
  if (steps && steps->size() > kMostKeyParts) return bad_input(fmt::format("names a key of more than {} parts", kMostKeyParts), place);
  if (steps && std::ranges::any_of(*steps, [](const Step& step) { return step.key.size() > kLongestKey; }))
    return bad_input(fmt::format("names a key of more than {} bytes", kLongestKey), place);
  if (!steps || steps->back().index)
    return bad_input(assignment.removes ? "must read table or table.key" : wrong_path(parsed.root, path), place);
  const std::string_view written = assignment.removes ? std::string_view() : trimmed(text.substr(equals + 1));
  const auto value = assignment.removes ? std::optional(toml::table()) : parse_value(written);
  if (!value) return bad_input(wrong_value(path, written, assignment.option), place);
  const auto table = descend(parsed.root, *steps, !assignment.removes);
  if (!table) return bad_input(table.error().message, place);
  if (steps->back().index) return bad_input("must read table.key", place);
  const std::string& key = steps->back().key;
  if (assignment.removes && !(*table)->contains(key)) {
    Error error = absent(**table, text_of(*steps), key);
    return bad_input(error.message, place);
  }
  if (assignment.removes)
    (*table)->erase(key);
  else
    (*table)->insert_or_assign(key, *value->get("v"));
  parsed.assignments.push_back(assignment);
  if (assignment.removes) return {};
  parsed.option = assignment.option;
  parsed.overridden.push_back(text_of(*steps));
  return {};
}

}  // namespace burrhole::toml_wrapper
