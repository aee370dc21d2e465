#include "volumes/read/raw_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <utility>

#include "core/config/toml_messages.h"
#include "volumes/read/number_text.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// A name with a star in place of its last number.
struct Pattern {
  std::string before, after;

  [[nodiscard]] bool fits(const std::string& name) const {
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return false;
    return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(before.size()), name.end() - static_cast<std::ptrdiff_t>(after.size()),
                       is_digit);
  }
};

Pattern pattern_of(const std::string& name) {
  std::size_t end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t start = end;
  while (start > 0 && is_digit(name[start - 1])) --start;
  return {name.substr(0, start), name.substr(end)};
}

std::string name_of(const std::string& path) { return fs::path(path).filename().string(); }

/// @returns a file of the longest numbered row of names; without a row the first that is named as raw voxels are, or the first.
const std::string& likeliest(std::span<const std::string> files) {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  const auto count_of = [&](const std::string& file) -> std::size_t& {
    const Pattern pattern = pattern_of(name_of(file));
    return counts[{pattern.before, pattern.after}];
  };
  for (const std::string& file : files) ++count_of(file);
  const auto most = std::ranges::max_element(files, {}, count_of);  // the first of equals
  if (count_of(*most) > 1) return *most;
  const auto raw = std::ranges::find_if(files, named_as_raw);
  return raw == files.end() ? files.front() : *raw;
}

}  // namespace

std::string raw_template(std::span<const std::string> files) {
  if (files.empty()) return {};
  const std::string name = name_of(likeliest(files));
  const Pattern pattern = pattern_of(name);
  const auto slices = std::ranges::count_if(files, [&](const std::string& file) { return pattern.fits(name_of(file)); });
  const bool stack = slices > 1;
  const std::string where = (fs::path(files.front()).parent_path() / "scan.toml").string();
  return fmt::format(
      "raw voxels are read by a file that describes them: write {} with the lines {} = {}; dims = [I, J, {}]; spacing_mm = "
      "[X, Y, Z]; type = \"int16\"; byte_order = \"little\" (burrhole docs raw), then give that file",
      where, stack ? "files" : "data", toml_string(stack ? pattern.before + "*" + pattern.after : name),
      stack ? std::to_string(slices) : "K");
}

bool named_as_raw(const std::string& path) {
  constexpr std::array<std::string_view, 4> kEndings{".raw", ".bin", ".dat", ".vol"};
  const std::string name = lower(path);
  return std::ranges::any_of(kEndings, [&](std::string_view ending) { return name.ends_with(ending); });
}

}  // namespace burrhole
