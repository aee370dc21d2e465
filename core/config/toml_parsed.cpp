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

constexpr std::size_t kMostAssignments = 1000;  // each is applied again for every later one

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

/// Parses "a.b[2].c" into steps; nothing if the text is not such a path.
std::optional<std::vector<Step>> parse_path(std::string_view path) {
  std::vector<Step> steps;
  std::size_t i = 0;
  while (true) {
    const std::size_t start = i;
    while (i < path.size() && is_bare(path[i])) ++i;
    if (i == start) return std::nullopt;
    steps.push_back({std::string(path.substr(start, i - start)), std::nullopt});
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

/// Makes a step by a name into one by its index. @returns an error if there is no element of that name.
Status resolve(const toml::array& array, const std::string& stopped_at, Step& step) {
  const auto plain = [](std::string name) {
    std::ranges::replace_if(
        name, [](char c) { return c == '_' || c == '-'; }, ' ');
    return name;
  };
  const std::vector<std::string> names = element_names(array);
  for (std::size_t n = 0; n < names.size(); ++n)
    if (!names[n].empty() && plain(names[n]) == plain(step.key)) {
      step = {{}, n};
      return {};
    }
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
    return bad_input(one_line(error.description(), 300), fmt::format("{}:{}:{}", file, begin.line, begin.column));
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
  auto steps = parse_path(trimmed(text.substr(0, equals)));
  if (steps && steps->size() > kMostKeyParts) return bad_input(fmt::format("names a key of more than {} parts", kMostKeyParts), place);
  if (steps && std::ranges::any_of(*steps, [](const Step& step) { return step.key.size() > kLongestKey; }))
    return bad_input(fmt::format("names a key of more than {} bytes", kLongestKey), place);
  if (!steps || steps->back().index)
    return bad_input(assignment.removes ? "must read table or table.key" : "the part before '=' must read table.key", place);
  const auto value = assignment.removes ? std::optional(toml::table()) : parse_value(trimmed(text.substr(equals + 1)));
  if (!value) return bad_input("the part after '=' is not a TOML value; put text in quotes", place);
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
