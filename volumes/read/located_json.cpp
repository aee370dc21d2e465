#include "volumes/read/located_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

namespace burrhole {
namespace {

constexpr std::size_t kDeepest = 64;

/// Hands the parser one byte after the other, and counts them.
class CountingIterator {
 public:
  // NOLINTBEGIN(readability-identifier-naming): names of the standard library
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  // NOLINTEND(readability-identifier-naming)

  CountingIterator(const char* at, const char** seen) : at_(at), seen_(seen) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    ++at_;
    if (seen_ != nullptr) *seen_ = at_;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  const char** seen_;
};

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E'; }

/// Builds the values from the parser's events. The parser reads at most one byte beyond a value.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, std::string name) : text_(text), name_(std::move(name)), seen_(text.data()) {}

  [[nodiscard]] const char** seen() noexcept { return &seen_; }
  [[nodiscard]] JsonValue& root() noexcept { return root_; }
  [[nodiscard]] const Error& error() const noexcept { return error_; }

  bool null() override { return add({.at = read() - 4}); }
  bool boolean(bool value) override { return add({.kind = JsonValue::Kind::boolean, .boolean = value, .at = read() - (value ? 4 : 5)}); }
  bool number_integer(number_integer_t value) override { return add_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return add_number(value); }
  bool string(string_t& value) override { return add({.kind = JsonValue::Kind::text, .text = std::move(value), .at = start_of_text()}); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*count*/) override { return open(JsonValue::Kind::object); }
  bool key(string_t& value) override {
    key_ = std::move(value);
    return true;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t /*count*/) override { return open(JsonValue::Kind::list); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t position, const std::string& /*token*/, const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ...; last read: ...": the place is given apart.
    std::string message = error.what();
    message = message.substr(std::min(message.find("] ") + 2, message.size()));
    if (const std::size_t place = message.find("column "); place != std::string::npos)
      message = message.substr(std::min(message.find(": ", place) + 2, message.size()));
    if (const std::size_t last = message.find("; last read"); last != std::string::npos) message.resize(last);
    return fail("is not JSON: " + message, position > 0 ? position - 1 : 0);
  }

 private:
  [[nodiscard]] std::size_t read() const noexcept { return static_cast<std::size_t>(seen_ - text_.data()); }
  bool fail(const std::string& message, std::size_t at) {
    error_ = bad_input(message, place_in(text_, at, name_));
    return false;
  }
  /// Where the text that ends with the byte read last begins: at a quote with an even number of backslashes before it.
  [[nodiscard]] std::size_t start_of_text() const noexcept {
    for (std::size_t at = read() - 1; at > 0;) {
      --at;
      if (text_[at] != '"') continue;
      std::size_t slashes = 0;
      while (slashes < at && text_[at - 1 - slashes] == '\\') ++slashes;
      if (slashes % 2 == 0) return at;
    }
    return 0;
  }
  bool add_number(double value) {
    std::size_t at = read();
    if (at > 0 && !is_of_number(text_[at - 1])) --at;
    while (at > 0 && is_of_number(text_[at - 1])) --at;
    return add({.kind = JsonValue::Kind::number, .number = value, .at = at});
  }
  bool add(JsonValue value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return true;
    }
    JsonValue& parent = *open_.back();
    if (parent.kind == JsonValue::Kind::object) parent.names.push_back(std::move(key_));
    parent.items.push_back(std::move(value));
    return true;
  }
  bool open(JsonValue::Kind kind) {
    if (open_.size() >= kDeepest) return fail(fmt::format("is nested deeper than {} levels", kDeepest), read() - 1);
    add({.kind = kind, .at = read() - 1});
    // A parent's list of items does not grow while one of them is open, so the pointer stays valid.
    open_.push_back(open_.empty() ? &root_ : &open_.back()->items.back());
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  std::string name_;
  const char* seen_;
  JsonValue root_;
  std::vector<JsonValue*> open_;
  std::string key_;
  Error error_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view name) const noexcept {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &items[static_cast<std::size_t>(found - names.begin())];
}

std::string place_in(std::string_view text, std::size_t at, const std::string& name) {
  const std::string_view before = text.substr(0, std::min(at, text.size()));
  const std::size_t line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t start = before.rfind('\n');
  return fmt::format("{}:{}:{}", name, line, before.size() - (start == std::string_view::npos ? 0 : start + 1) + 1);
}

Result<JsonValue> parse_json(std::string_view text, const std::string& name) {
  Builder builder(text, name);
  const CountingIterator first(text.data(), builder.seen()), last(text.data() + text.size(), nullptr);
  if (!nlohmann::json::sax_parse(first, last, &builder)) return builder.error();
  return std::move(builder.root());
}

}  // namespace burrhole
