#include <algorithm>
#include <array>
#include <utility>

#include "core/config/toml_parsed.h"

namespace burrhole::toml_wrapper {
namespace {

using Steps = std::vector<std::string_view>;

Steps steps_of(std::string_view path) {
  Steps steps;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    steps.push_back(path.substr(0, dot));
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return steps;
}

/// The table at all steps except the last; created if absent and `make` is set. Null if it is absent or is not a table.
toml::table* table_of(toml::table& root, std::span<const std::string_view> steps, bool make) {
  toml::table* table = &root;
  for (const std::string_view step : steps.first(steps.size() - 1)) {
    toml::node* node = table->get(step);
    if (node == nullptr && make) node = &table->insert(step, toml::table{}).first->second;
    table = node == nullptr ? nullptr : node->as_table();
    if (table == nullptr) return nullptr;
  }
  return table;
}

void convert(toml::node& node, const RenamedKey& entry);

/// Converts the value of a key; an integer times a factor becomes a node of another type.
void convert_key(toml::table& table, std::string_view key, const RenamedKey& entry) {
  const auto integer = table.get(key)->value_exact<std::int64_t>();
  if (integer && entry.factor != 1.0)
    table.insert_or_assign(key, static_cast<double>(*integer) * entry.factor);
  else
    convert(*table.get(key), entry);
}

/// Converts a value that keeps its type; others stay.
void convert(toml::node& node, const RenamedKey& entry) {
  if (toml::value<double>* number = node.as_floating_point(); number != nullptr && entry.factor != 1.0) *number = **number * entry.factor;
  if (toml::value<std::string>* text = node.as_string(); text != nullptr) {
    const auto word = std::ranges::find(entry.words, std::string_view(text->get()), &RenamedWord::old_word);
    if (word != entry.words.end()) *text = std::string(word->new_word);
  }
  if (toml::array* array = node.as_array(); array != nullptr) {
    for (std::size_t n = 0; n < array->size(); ++n) {
      const auto integer = (*array)[n].value_exact<std::int64_t>();
      if (integer && entry.factor != 1.0)
        array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(n), static_cast<double>(*integer) * entry.factor);
      else
        convert((*array)[n], entry);
    }
  }
}

/// Moves what stands at `from` to `to`, both below `root`.
void move_key(toml::table& root, std::span<const std::string_view> from, std::span<const std::string_view> to, const RenamedKey& entry,
              std::vector<Renaming>& done) {
  if (from.size() > 1 && (to.empty() || (to.size() > 1 && from.front() == to.front()))) {
    const auto rest = to.empty() ? to : to.subspan(1);
    const bool elements = from.front().ends_with("[]");
    toml::node* node = root.get(elements ? from.front().substr(0, from.front().size() - 2) : from.front());
    if (node == nullptr) return;
    if (toml::table* sub = node->as_table(); sub != nullptr && !elements) move_key(*sub, from.subspan(1), rest, entry, done);
    if (toml::array* array = node->as_array(); array != nullptr && elements)
      for (toml::node& element : *array)
        if (element.is_table()) move_key(*element.as_table(), from.subspan(1), rest, entry, done);
    return;
  }
  toml::table* source = table_of(root, from, false);
  if (source == nullptr || !source->contains(from.back())) return;
  Renaming renaming{std::string(entry.old_path), std::string(entry.new_path), false};
  if (!to.empty()) {
    toml::table* target = table_of(root, to, true);
    renaming.dropped = target == nullptr || target->contains(to.back());
    if (!renaming.dropped) {
      convert_key(*source, from.back(), entry);
      const toml::key key(to.back(), toml::source_region(source->find(from.back())->first.source()));
      target->insert_or_assign(key, std::move(*source->get(from.back())));
    }
  }
  source->erase(from.back());
  done.push_back(std::move(renaming));
}

}  // namespace

std::vector<Renaming> rename(toml::table& root, RenamedKeys table) {
  std::vector<Renaming> done;
  for (const RenamedKey& entry : table) {
    const Steps from = steps_of(entry.old_path), to = steps_of(entry.new_path);
    if (!from.empty()) move_key(root, from, to, entry, done);
  }
  return done;
}

}  // namespace burrhole::toml_wrapper
