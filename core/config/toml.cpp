#include "core/config/toml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include "core/base/input_file.h"
#include "core/config/key_log.h"
#include "core/config/toml_messages.h"
#include "core/config/toml_parsed.h"

namespace burrhole {

using namespace toml_wrapper;

namespace {

constexpr std::size_t kLongestText = 4096;  // [bytes] of a value: as long as a path of Linux may be

/// A value as messages print it, without what it holds.
std::string element_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return '"' + one_line(text->get(), 60) + '"';
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* real = node.as_floating_point()) return number_text(real->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (node.is_table()) return "{table}";
  return node.is_array() ? "[array]" : "a date or time";
}

/// The same, with up to four elements of an array.
std::string value_text(const toml::node& node) {
  const toml::array* array = node.as_array();
  if (array == nullptr) return element_text(node);
  constexpr std::size_t kMost = 4;  // elements that are shown
  std::string out;
  for (std::size_t i = 0; i < std::min(array->size(), kMost); ++i) out += (i > 0 ? ", " : "") + element_text(*array->get(i));
  return "[" + out + (array->size() > kMost ? ", ...]" : "]");
}

std::optional<double> as_number(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  return std::nullopt;
}

}  // namespace

// ---- TableReader ----

struct TableReader::State {
  std::shared_ptr<const ParsedFile> parsed;
  const toml::table* table = nullptr;
  std::string path;  ///< dotted, array elements as name[0]
  std::string place;
  Issues* issues = nullptr;
  KeyLog* log = nullptr;                       ///< usually none
  RenamedKeys renamed;                         ///< for the messages about unknown keys
  std::vector<std::string> asked;              ///< names in the order of the requests: the known keys
  std::set<std::string, std::less<>> named;    ///< keys that already have an issue about their name
  std::set<std::string, std::less<>> refused;  ///< keys whose text was no text, or none that is read: what follows from that is no issue
  std::map<std::string, std::shared_ptr<State>, std::less<>> children;

  const toml::node* ask(std::string_view key) {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.emplace_back(key);
    return table->get(key);
  }
  /// As ask(); also writes the record to the log if there is one.
  template <typename MakeInfo>
  const toml::node* read(std::string_view key, const MakeInfo& make_info) {
    const toml::node* node = ask(key);
    if (log != nullptr) note(key, node, make_info());
    return node;
  }
  void note(std::string_view key, const toml::node* node, KeyInfo info);
  std::string place_of(std::string_view key) const {
    const auto it = table->find(key);
    return it == table->end() ? place : place_at(*parsed, join(path, key), it->first.source());
  }
  void push(ErrorCode code, std::string message, std::string where) { issues->push_back({code, std::move(message), std::move(where)}); }
  /// Pushes "tool.radius_mm = -5 must ...", at the key.
  void refuse(std::string_view key, const toml::node& node, const std::string& what, ErrorCode code = ErrorCode::bad_input) {
    push(code, fmt::format("{} = {} {}", join(path, key), value_text(node), what), place_of(key));
  }
  void missing(std::string_view key, std::string_view about);
  std::optional<double> checked(const toml::node& node, const NumberRule& rule, const std::string& name, const std::string& where);
  std::shared_ptr<State> child(const std::string& name, const toml::table& sub, const std::string& where);
  [[nodiscard]] std::string in_a_table(const std::string& key) const;
  void unknown(const std::string& key, const toml::node& node);
};

void TableReader::State::note(std::string_view key, const toml::node* node, KeyInfo info) {
  info.table = without_indices(path);
  info.key = key;
  info.unit = info.kind == KeyKind::table || info.kind == KeyKind::tables ? std::string() : unit_of(key);
  info.present = node != nullptr;
  if (node != nullptr && node->is_string()) info.word = node->as_string()->get();
  log->note(std::move(info));
}

void TableReader::State::missing(std::string_view key, std::string_view about) {
  const auto bare = without_unit(key);
  if (bare && table->contains(*bare)) {
    push(ErrorCode::bad_input, fmt::format("{} lacks its unit: write \"{}\"", join(path, *bare), key), place_of(*bare));
    named.emplace(*bare);
    return;
  }
  const std::string why = about.empty() ? std::string() : fmt::format(" ({})", about);
  push(ErrorCode::bad_input, fmt::format("{} is missing{}", join(path, key), why), place);
}

/// @returns the number as written if it obeys the rule; pushes an issue otherwise.
std::optional<double> TableReader::State::checked(const toml::node& node, const NumberRule& rule, const std::string& name,
                                                  const std::string& where) {
  const auto refuse_with = [&](ErrorCode code, const std::string& what) {
    push(code, fmt::format("{} = {} {}", name, value_text(node), what), where);
    return std::nullopt;
  };
  const auto written = as_number(node);
  if (!written) {
    const auto* text = node.as_string();
    const auto instead = text != nullptr ? number_without_unit(name, text->get()) : std::nullopt;
    return refuse_with(ErrorCode::bad_input, instead ? "must be a number: " + *instead : "must be a number");
  }
  if (!std::isfinite(*written)) return refuse_with(ErrorCode::out_of_range, "must be a finite number");
  if (!within(*written, rule)) return refuse_with(ErrorCode::out_of_range, range_text(rule));
  return written;
}

std::shared_ptr<TableReader::State> TableReader::State::child(const std::string& name, const toml::table& sub, const std::string& where) {
  auto& slot = children[name];
  if (!slot) {
    slot = std::make_shared<State>();
    slot->parsed = parsed;
    slot->table = &sub;
    slot->path = name;
    slot->place = where;
    slot->issues = issues;
    slot->log = log;
    slot->renamed = renamed;
  }
  return slot;
}

/// @returns the path of a key in a table that was read from this one: the key itself, or with its unit; empty if there is none.
std::string TableReader::State::in_a_table(const std::string& key) const {
  for (const auto& [name, child] : children) {
    if (std::find(child->asked.begin(), child->asked.end(), key) != child->asked.end()) return join(name, key);
    if (const auto full = with_unit(key, child->asked)) return join(name, *full);
  }
  return {};
}

void TableReader::State::unknown(const std::string& key, const toml::node& node) {
  if (const auto full = with_unit(key, asked); full && find_renamed(renamed, without_indices(join(path, key))) == nullptr) {
    push(ErrorCode::bad_input, fmt::format("{} lacks its unit: write \"{}\"", join(path, key), *full), place_of(key));
    return;
  }
  const auto near = nearest_name(key, asked);
  const RenamedKey* now = find_renamed(renamed, without_indices(join(path, key)));
  std::string message;
  if (now != nullptr) {
    message = join(path, key);
    if (now->new_path.empty())
      message += " is no longer read: remove it";
    else
      message += fmt::format(" is now {}", now->new_path);
    if (now->factor != 1.0) message += fmt::format(", {} times the value", number_text(now->factor));
  } else if (node.is_table() || node.is_array_of_tables()) {
    message = fmt::format("unknown table [{}]", join(path, key));
    if (near) message += fmt::format("; did you mean [{}]?", join(path, *near));
  } else {
    message = fmt::format("unknown key \"{}\"", one_line(key));
    if (!path.empty()) message += fmt::format(" in [{}]", path);
    const std::string elsewhere = path.empty() ? in_a_table(key) : std::string();
    if (!elsewhere.empty())
      message += fmt::format("; did you mean \"{}\"?", elsewhere);
    else if (near)
      message += fmt::format("; did you mean \"{}\"?", *near);
  }
  push(ErrorCode::bad_input, message, place_of(key));
}

TableReader::TableReader(std::shared_ptr<State> state) : state_(std::move(state)) {}

bool TableReader::has(std::string_view key) const { return state_->ask(key) != nullptr; }
std::string TableReader::name() const { return state_->path; }
std::string TableReader::place() const { return state_->place; }
std::string TableReader::place_of(std::string_view key) const { return state_->place_of(key); }

double TableReader::number(std::string_view key, const NumberRule& rule, std::string_view about) {
  const toml::node* node = state_->read(key, [&] { return number_key(rule, about); });
  if (node == nullptr && !rule.fallback) state_->missing(key, about);
  if (node == nullptr) return (rule.fallback ? *rule.fallback : value_inside(rule)) * rule.to_si;
  const auto written = state_->checked(*node, rule, join(state_->path, key), place_of(key));
  return (written ? *written : value_inside(rule)) * rule.to_si;
}

std::int64_t TableReader::integer(std::string_view key, std::optional<std::int64_t> fallback, std::int64_t min, std::int64_t max,
                                  std::string_view about) {
  const toml::node* node = state_->read(key, [&] { return integer_key(fallback, min, max, about); });
  const std::int64_t instead = fallback.value_or(min);
  if (node == nullptr) {
    if (!fallback) state_->missing(key, about);
    return instead;
  }
  const auto* whole = node->as_integer();
  if (whole != nullptr && whole->get() >= min && whole->get() <= max) return whole->get();
  if (whole == nullptr)
    state_->refuse(key, *node, "must be a whole number");
  else
    state_->refuse(key, *node, fmt::format("must be a whole number in [{}, {}]", min, max), ErrorCode::out_of_range);
  return instead;
}

bool TableReader::boolean(std::string_view key, bool fallback, std::string_view about) {
  const toml::node* node = state_->read(key, [&] { return boolean_key(fallback, about); });
  if (node == nullptr) return fallback;
  if (const auto* flag = node->as_boolean()) return flag->get();
  state_->refuse(key, *node, "must be true or false");
  return fallback;
}

std::string TableReader::text(std::string_view key, std::optional<std::string> fallback, std::string_view about) {
  const toml::node* node = state_->read(key, [&] { return text_key(fallback, about); });
  if (node != nullptr) {
    const auto* text = node->as_string();
    if (text != nullptr && text->get().size() <= kLongestText && text->get().find('\0') == std::string::npos) return text->get();
    state_->refused.emplace(key);
    if (text == nullptr) {
      state_->refuse(key, *node, "must be text in quotes");
    } else if (text->get().size() > kLongestText) {
      state_->refuse(key, *node, fmt::format("has {} bytes, at most {} are read", text->get().size(), kLongestText));
    } else {
      state_->refuse(key, *node, "contains a byte 0, where programs end a text");
    }
  } else if (!fallback) {
    state_->missing(key, about);
  }
  return fallback.value_or("");
}

std::string TableReader::choice(std::string_view key, std::optional<std::string> fallback, const std::vector<std::string>& allowed,
                                std::string_view about, const std::vector<std::string>& later) {
  const std::string instead = fallback ? *fallback : allowed.empty() ? std::string() : allowed.front();
  const toml::node* node = state_->read(key, [&] { return choice_key(fallback, allowed, later, about); });
  if (node == nullptr) {
    if (!fallback) state_->missing(key, about);
    return instead;
  }
  // A choice between numbers may be written as a number.
  const auto* text = node->as_string();
  const auto* number = node->as_integer();
  const std::string word = text != nullptr ? text->get() : number != nullptr ? std::to_string(number->get()) : std::string();
  if (std::find(allowed.begin(), allowed.end(), word) != allowed.end()) return word;
  if (std::find(later.begin(), later.end(), word) != later.end()) {
    state_->refuse(key, *node, fmt::format("is not in this version; it knows \"{}\"", fmt::join(allowed, "\", \"")));
    return instead;
  }
  std::string what = fmt::format("must be one of \"{}\"", fmt::join(allowed, "\", \""));
  if (const auto near = nearest_name(word, allowed)) what += fmt::format("; did you mean \"{}\"?", *near);
  state_->refuse(key, *node, what);
  return instead;
}

std::vector<double> TableReader::numbers(std::string_view key, std::optional<std::vector<double>> fallback, std::size_t count,
                                         const NumberRule& rule, std::string_view about) {
  std::vector<double> values = fallback.value_or(std::vector<double>(count, value_inside(rule)));
  const toml::node* node = state_->read(key, [&] { return numbers_key(fallback, count, rule, about); });
  if (node == nullptr) {
    if (!fallback) state_->missing(key, about);
  } else if (const toml::array* array = node->as_array(); array != nullptr && array->size() == count) {
    values.resize(count, value_inside(rule));
    for (std::size_t i = 0; i < count; ++i) {
      const std::string name = fmt::format("{}[{}]", join(state_->path, key), i);
      const auto written = state_->checked(*array->get(i), rule, name, place_at(*state_->parsed, name, array->get(i)->source()));
      if (written) values[i] = *written;
    }
  } else {
    state_->refuse(key, *node, fmt::format("must be an array of {} numbers", count));
  }
  for (double& value : values) value *= rule.to_si;
  return values;
}

Vec3 TableReader::vector(std::string_view key, std::optional<Vec3> fallback, const NumberRule& rule, std::string_view about) {
  std::optional<std::vector<double>> three;
  if (fallback) three = {fallback->x, fallback->y, fallback->z};
  const std::vector<double> v = numbers(key, three, 3, rule, about);
  return {v[0], v[1], v[2]};
}

namespace {
KeyInfo without_default(KeyInfo info) {
  info.fallback = kNoDefault;
  return info;
}
}  // namespace

std::optional<double> TableReader::optional_number(std::string_view key, const NumberRule& rule, std::string_view about) {
  if (state_->read(key, [&] { return without_default(number_key(rule, about)); }) == nullptr) return std::nullopt;
  return number(key, rule, about);
}

std::optional<std::vector<double>> TableReader::optional_numbers(std::string_view key, std::size_t count, const NumberRule& rule,
                                                                 std::string_view about) {
  if (state_->read(key, [&] { return without_default(numbers_key(std::nullopt, count, rule, about)); }) == nullptr) return std::nullopt;
  return numbers(key, std::nullopt, count, rule, about);
}

std::optional<std::string> TableReader::optional_choice(std::string_view key, const std::vector<std::string>& allowed,
                                                        std::string_view about) {
  if (state_->read(key, [&] { return without_default(choice_key(std::nullopt, allowed, {}, about)); }) == nullptr) return std::nullopt;
  return choice(key, std::nullopt, allowed, about);
}

std::optional<TableReader> TableReader::table(std::string_view key, std::string_view about) {
  const toml::node* node = state_->read(key, [&] { return table_key(KeyKind::table, about); });
  if (node == nullptr) return std::nullopt;
  const toml::table* sub = node->as_table();
  const std::string path = join(state_->path, key);
  if (sub == nullptr) {
    state_->refuse(key, *node, fmt::format("must be a table: [{}]", path));
    return std::nullopt;
  }
  return TableReader(state_->child(path, *sub, place_of(key)));
}

std::vector<TableReader> TableReader::tables(std::string_view key, std::string_view about) {
  std::vector<TableReader> readers;
  const toml::node* node = state_->read(key, [&] { return table_key(KeyKind::tables, about); });
  if (node == nullptr) return readers;
  const toml::array* array = node->as_array();
  const std::string path = join(state_->path, key);
  if (array == nullptr || (!array->empty() && !array->is_array_of_tables())) {
    state_->refuse(key, *node, fmt::format("must be an array of tables: [[{}]]", path));
    return readers;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string element = fmt::format("{}[{}]", path, i);
    const toml::table& sub = *array->get(i)->as_table();
    readers.push_back(TableReader(state_->child(element, sub, place_at(*state_->parsed, element, sub.source()))));
  }
  return readers;
}

std::vector<std::string> TableReader::keys() const {
  using Entry = std::tuple<std::uint32_t, std::uint32_t, std::string>;
  std::vector<Entry> entries;
  for (const auto& [key, node] : *state_->table) {
    const auto begin = key.source().begin;  // a key from an assignment has no line and is sorted last
    entries.emplace_back(begin.line > 0 ? begin.line : ~std::uint32_t{0}, begin.column, std::string(key.str()));
  }
  std::sort(entries.begin(), entries.end());
  std::vector<std::string> names;
  for (Entry& entry : entries) names.push_back(std::move(std::get<2>(entry)));
  return names;
}

void TableReader::fault(std::string_view key, const std::string& message) {
  if (state_->refused.contains(key)) return;
  const toml::node* node = state_->ask(key);
  const bool quote = node != nullptr && !node->is_table() && !node->is_array();
  const std::string value = quote ? " = " + value_text(*node) : std::string();
  state_->push(ErrorCode::bad_input, fmt::format("{}{} {}", join(state_->path, key), value, message), place_of(key));
}

void TableReader::finish() {
  for (const std::string& key : keys()) {
    const bool known = std::find(state_->asked.begin(), state_->asked.end(), key) != state_->asked.end();
    if (!known && state_->named.insert(key).second) state_->unknown(key, *state_->table->get(key));
  }
}

// ---- TomlDocument ----

struct TomlDocument::State {
  std::shared_ptr<const ParsedFile> parsed;
  RenamedKeys renamed = renamed_keys();
  std::size_t parses = 1;
};

TomlDocument::TomlDocument(std::shared_ptr<State> state) : state_(std::move(state)) {}

Result<TomlDocument> TomlDocument::load(const std::string& path) {
  const Result<std::string> text = read_input(path, kTomlInput);
  if (!text) return text.error();
  return parse(text.value(), path);
}

Result<TomlDocument> TomlDocument::parse(std::string_view text, const std::string& file_name) {
  Result<toml::table> root = parse_table(text, file_name);
  if (!root) return root.error();
  auto parsed = std::make_shared<ParsedFile>(ParsedFile{file_name, std::string(text), {}, {}, {}, {}, std::move(root).value()});
  return TomlDocument(std::make_shared<State>(State{std::move(parsed), renamed_keys(), 1}));
}

/// The same text with the same changes, afresh: copying a toml::table drops its line numbers, and readers or other documents may share it.
static Result<std::shared_ptr<ParsedFile>> parse_again(const ParsedFile& old) {
  Result<toml::table> root = parse_table(old.text, old.file);
  if (!root) return root.error();
  auto next = std::make_shared<ParsedFile>(ParsedFile{old.file, old.text, {}, {}, {}, old.renames, std::move(root).value()});
  auto renames = old.renames.begin();
  for (std::size_t n = 0; n <= old.assignments.size(); ++n) {
    for (; renames != old.renames.end() && renames->first == n; ++renames) static_cast<void>(rename(next->root, renames->second));
    if (n == old.assignments.size()) break;
    if (Status status = assign(*next, old.assignments[n]); !status) return status.error();
  }
  return next;
}
Issues TomlDocument::apply(const std::vector<TomlChange>& changes) {
  if (changes.empty()) return {};
  auto next = parse_again(*state_->parsed);
  if (!next) return {next.error()};
  Issues issues;
  for (const TomlChange& one : changes)
    if (Status status = assign(**next, {one.text, one.option, one.removes}); !status) issues.push_back(status.error());
  if (issues.empty()) state_ = std::make_shared<State>(State{*next, state_->renamed, state_->parses + 1});
  return issues;
}
Status TomlDocument::set(std::string_view assignment, const std::string& option) {
  const Issues issues = apply({{std::string(assignment), option, false}});
  return issues.empty() ? Status() : Status(issues.front());
}
Status TomlDocument::unset(std::string_view path, const std::string& option) {
  const Issues issues = apply({{std::string(path), option, true}});
  return issues.empty() ? Status() : Status(issues.front());
}
std::size_t TomlDocument::parses() const noexcept { return state_->parses; }
std::vector<std::string> TomlDocument::changes() const {
  std::vector<std::string> out;
  for (const Assignment& one : state_->parsed->assignments) out.push_back((one.removes ? "unset " : "") + one.text);
  return out;
}
std::vector<Renaming> TomlDocument::rename(RenamedKeys table) {
  auto next = parse_again(*state_->parsed);
  if (!next) return {};  // it was parsed before
  (*next)->renames.emplace_back((*next)->assignments.size(), table);
  std::vector<Renaming> done = toml_wrapper::rename((*next)->root, table);
  state_ = std::make_shared<State>(State{*next, state_->renamed, state_->parses + 1});
  return done;
}
void TomlDocument::report_renamed(RenamedKeys table) { state_ = std::make_shared<State>(State{state_->parsed, table, state_->parses}); }
TableReader TomlDocument::root(Issues& issues, KeyLog* log) const {
  auto state = std::make_shared<TableReader::State>();
  state->parsed = state_->parsed;
  state->table = &state_->parsed->root;
  state->place = state_->parsed->file;
  state->issues = &issues;
  state->log = log;
  state->renamed = state_->renamed;
  return TableReader(std::move(state));
}

const std::string& TomlDocument::file_name() const { return state_->parsed->file; }

std::string TomlDocument::to_text() const {
  std::ostringstream out;
  out << toml::toml_formatter(state_->parsed->root) << '\n';
  return std::move(out).str();
}

}  // namespace burrhole
