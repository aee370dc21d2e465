#include "core/config/toml_shape.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/input_file.h"

namespace burrhole {
namespace {

/// Follows brackets, strings, comments and keys; values are passed over.
class Scan {
 public:
  Scan(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  Status run() {
    while (at_ < text_.size()) {
      if (Status step = this->step(); !step) return step;
    }
    return {};
  }

 private:
  [[nodiscard]] Error refuse(const std::string& message) const {
    const std::string_view before = text_.substr(0, at_);
    const std::size_t start = before.rfind('\n') + 1;  // npos + 1 is 0
    return bad_input(message, fmt::format("{}:{}:{}", file_, 1 + std::count(before.begin(), before.end(), '\n'), at_ - start + 1));
  }
  void start_key() noexcept {
    in_key_ = true;
    parts_ = 1;
    part_bytes_ = 0;
  }
  Status add_to_key(std::size_t bytes) {
    part_bytes_ += bytes;
    if (part_bytes_ > kLongestKey) return refuse(fmt::format("a key is longer than {} bytes", kLongestKey));
    return {};
  }
  /// Goes behind the string that starts here. A string of one line ends with its line at the latest, which toml++ refuses.
  void skip_string() noexcept {
    const char quote = text_[at_];
    const bool many = text_.substr(at_, 3) == std::string(3, quote);
    at_ += many ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\\' && quote == '"') {
        ++at_;
      } else if (!many && (c == quote || c == '\n')) {
        at_ += c == quote ? 1 : 0;
        return;
      } else if (many && c == quote && text_.substr(at_, 3) == std::string(3, quote)) {
        at_ += 3;
        for (int more = 0; more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) ++at_;  // quotes at the end of the content
        return;
      }
    }
    at_ = std::min(at_, text_.size());
  }
  Status open(char bracket) {
    open_ += bracket;
    if (open_.size() > kMostNested) return refuse(fmt::format("arrays and inline tables are nested deeper than {} levels", kMostNested));
    ++at_;
    if (bracket == '{') start_key();
    return {};
  }
  void close() noexcept {
    if (!open_.empty()) open_.pop_back();
    in_key_ = false;
    ++at_;
  }
  Status header() {
    if (++tables_ > kMostTables) return refuse(fmt::format("has more than {} tables", kMostTables));
    while (at_ < text_.size() && text_[at_] == '[') ++at_;
    start_key();
    fresh_ = false;
    return {};
  }
  Status key_step(char c) {
    if (c == '[' && fresh_ && open_.empty()) return header();
    if (c == '=' || c == '}') {
      in_key_ = false;
      if (c == '}')
        close();
      else
        ++at_;
      return {};
    }
    fresh_ = false;
    if (c == '"' || c == '\'') {
      const std::size_t start = at_;
      skip_string();
      return add_to_key(at_ - start);
    }
    if (c == '.') {
      part_bytes_ = 0;
      if (++parts_ > kMostKeyParts) return refuse(fmt::format("a key has more than {} parts", kMostKeyParts));
    } else if (Status added = add_to_key(1); !added) {
      return added;
    }
    ++at_;
    return {};
  }
  Status step() {
    const char c = text_[at_];
    if (c == '\n') {
      ++at_;
      if (open_.empty()) {
        fresh_ = true;
        start_key();
      }
      return {};
    }
    if (c == ' ' || c == '\t' || c == '\r') {
      ++at_;
      return {};
    }
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
      return {};
    }
    if (in_key_) return key_step(c);
    if (c == '"' || c == '\'') {
      skip_string();
      return {};
    }
    if (c == '[' || c == '{') return open(c);
    if (c == ']' || c == '}') {
      close();
      return {};
    }
    ++at_;
    if (c == ',' && !open_.empty() && open_.back() == '{') start_key();
    return {};
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0, parts_ = 1, part_bytes_ = 0, tables_ = 0;
  std::string open_;    ///< the brackets that are open
  bool in_key_ = true;  ///< before the '=' of a key, or in the name of a table
  bool fresh_ = true;   ///< nothing of the line was read yet
};

}  // namespace

Status check_toml_shape(std::string_view text, const std::string& file) {
  if (text.size() > kMostTomlBytes) return bad_input(fmt::format("has more than {} bytes of TOML", kMostTomlBytes), file);
  if (Status whole = check_no_zero_byte(text, file); !whole) return whole;
  return Scan(text, file).run();
}

}  // namespace burrhole
