#include "core/config/toml_parsed.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

#include "core/config/toml_messages.h"

namespace burrhole::toml_wrapper {
namespace {

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
  const bool wordlike = (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z') || std::strchr("_./~", first) != nullptr;
  if (!wordlike || value.find_first_of("\"'[]{}=#,") != std::string_view::npos || one_line(value, value.size()) != value)
    return std::nullopt;
  toml::table word;
  word.insert("v", std::string(value));
  return word;
}

/// Walks to the table that holds the last key and creates missing tables; nullptr and `stopped_at` if a value of another type is in the
/// path.
toml::table* descend(toml::table& root, const std::vector<Step>& steps, std::string& stopped_at) {
  toml::table* table = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    stopped_at += (stopped_at.empty() ? "" : ".") + steps[i].key;
    toml::node* node = table->get(steps[i].key);
    if (node == nullptr && !steps[i + 1].index) node = &table->insert(steps[i].key, toml::table{}).first->second;
    if (node != nullptr && steps[i + 1].index) {
      const std::size_t index = *steps[++i].index;
      stopped_at += fmt::format("[{}]", index);
      toml::array* array = node->as_array();
      node = array != nullptr && index < array->size() ? array->get(index) : nullptr;
    }
    table = node != nullptr ? node->as_table() : nullptr;
    if (table == nullptr) return nullptr;
  }
  return table;
}

}  // namespace

std::string join(const std::string& path, std::string_view key) {
  const std::string name = one_line(key, 200);
  return path.empty() ? name : path + "." + name;
}

std::string place_at(const ParsedFile& parsed, const std::string& path, const toml::source_region& where) {
  for (const std::string& top : parsed.overridden)
    if (lies_under(path, top)) return "--set " + top;
  if (where.begin.line > 0 && !path.empty()) return fmt::format("{}:{}:{}", parsed.file, where.begin.line, where.begin.column);
  for (const std::string& top : parsed.overridden)
    if (!path.empty() && lies_under(top, path)) return "--set " + top;
  return parsed.file;
}

Result<std::string> read_text(const std::string& path) {
  const auto failed = [&] { return bad_input(std::string("cannot be read: ") + std::strerror(errno), path); };
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return failed();
  std::string text;
  char block[16384];
  for (std::size_t n = 0; (n = std::fread(block, 1, sizeof block, file)) > 0;) text.append(block, n);
  const bool bad = std::ferror(file) != 0;
  const Error error = bad ? failed() : Error{};
  std::fclose(file);
  if (bad) return error;
  return text;
}

Result<toml::table> parse_table(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, std::string_view(file));
  } catch (const toml::parse_error& error) {
    const auto begin = error.source().begin;
    return bad_input(one_line(error.description(), 300), fmt::format("{}:{}:{}", file, begin.line, begin.column));
  } catch (const std::exception& error) {  // toml++ reports invalid UTF-8 and the like by its own type, memory by std
    return bad_input(one_line(error.what(), 300), file);
  }
}

Status assign(ParsedFile& parsed, std::string_view assignment) {
  const std::string place = "--set " + one_line(assignment, 120);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) return bad_input("must read table.key=value", place);
  const std::string path(trimmed(assignment.substr(0, equals)));
  const auto steps = parse_path(path);
  if (!steps || steps->back().index) return bad_input("the part before '=' must read table.key", place);
  auto value = parse_value(trimmed(assignment.substr(equals + 1)));
  if (!value) return bad_input("the part after '=' is not a TOML value; put text in quotes", place);
  std::string stopped_at;
  toml::table* table = descend(parsed.root, *steps, stopped_at);
  if (table == nullptr) return bad_input(fmt::format("\"{}\" is not a table", stopped_at), place);
  table->insert_or_assign(steps->back().key, std::move(*value->get("v")));
  parsed.assignments.emplace_back(assignment);
  parsed.overridden.push_back(path);
  return {};
}

}  // namespace burrhole::toml_wrapper
