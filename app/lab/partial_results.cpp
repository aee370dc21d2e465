#include "app/lab/partial_results.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "core/base/cpu_model.h"
#include "core/base/input_file.h"
#include "core/base/output_file.h"
#include "core/base/physics_version.h"
#include "core/base/simd.h"

namespace burrhole {
namespace {

constexpr std::size_t kDigits = 16;  // of a hash

void add_text(Hash64& hash, std::string_view text) {
  for (const char c : text) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  hash.add(std::uint64_t{256});  // ends a text
}

/// Size and time of the program's file: another build may draw otherwise, or in another time.
std::string build_text() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  return fmt::format("{} {}", fs::file_size(program, ignored), fs::last_write_time(program, ignored).time_since_epoch().count());
}

std::string hash_of(std::string_view text) {
  Hash64 hash;
  add_text(hash, text);
  return hash.hex();
}

/// @returns the number that a whole word is.
std::optional<double> number_of(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  return !word.empty() && end == word.c_str() + word.size() ? std::optional(value) : std::nullopt;
}

/// @returns key and figures of a line without its end; nothing if it is not whole.
std::optional<std::pair<std::string, std::vector<double>>> read_line(std::string_view line) {
  const std::size_t last = line.rfind(' ');
  if (last == std::string_view::npos || line.substr(last + 1) != hash_of(line.substr(0, last))) return std::nullopt;
  const std::string_view rest = line.substr(0, last);
  std::size_t at = rest.find(' ');
  std::pair<std::string, std::vector<double>> out{std::string(rest.substr(0, at)), {}};
  if (out.first.size() != kDigits) return std::nullopt;
  while (at != std::string_view::npos) {
    const std::size_t end = rest.find(' ', at + 1);
    const auto figure = number_of(std::string(rest.substr(at + 1, end == std::string_view::npos ? end : end - at - 1)));
    if (!figure) return std::nullopt;
    out.second.push_back(*figure);
    at = end;
  }
  return out;
}

}  // namespace

TrialKey::TrialKey() {
  static const std::string machine = cpu_model(), build = build_text();  // from files
  hash_.add(static_cast<std::uint64_t>(kPhysicsVersion));
  add(machine).add(build);
  add(simd_in_use());
}

TrialKey& TrialKey::add(std::string_view text) {
  add_text(hash_, text);
  return *this;
}

TrialKey& TrialKey::add(double value) {
  hash_.add(value);
  return *this;
}

PartialResults::PartialResults(std::string path) : path_(std::move(path)) {
  if (path_.empty()) return;
  const auto read = read_input(path_, kResultsInput);
  const std::string text = read ? *read : std::string();  // none, or none that can be read: all is measured
  in_line_ = !text.empty() && text.back() != '\n';
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (auto line = read_line(std::string_view(text).substr(start, end - start))) results_.insert_or_assign(line->first, line->second);
    start = end + 1;
  }
}

std::optional<std::vector<double>> PartialResults::find(const std::string& key, std::size_t count) const {
  const auto found = results_.find(key);
  return found != results_.end() && found->second.size() == count ? std::optional(found->second) : std::nullopt;
}

Status PartialResults::add(const std::string& key, std::span<const double> figures) {
  if (path_.empty()) return {};
  std::string line = key;
  for (const double figure : figures) {
    char word[64];
    std::snprintf(word, sizeof word, " %a", figure);
    line += word;
  }
  line = fmt::format("{}{} {}\n", in_line_ ? "\n" : "", line, hash_of(line));
  if (Status written = append_to_file(path_, line); !written) return written;  // the file is as it was before
  in_line_ = false;
  results_.insert_or_assign(key, std::vector<double>(figures.begin(), figures.end()));
  return {};
}

}  // namespace burrhole
