#include "core/voxel/label_table.h"

#include <fmt/format.h>

#include <sstream>

namespace burrhole {
namespace {

constexpr std::string_view kLabel = "label ";
constexpr std::size_t kColorWidth = 8;  // " #rrggbb"

/// @returns the number of decimal or hexadecimal digits; -1 if there are others, or none.
int number_of(std::string_view text, int base) {
  if (text.empty() || text.size() > 6) return -1;
  int out = 0;
  for (const char c : text) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : base;
    if (digit >= base) return -1;
    out = out * base + digit;
  }
  return out;
}

}  // namespace

std::string note_of(const NamedLabel& label) {
  return fmt::format("{}{} #{:02x}{:02x}{:02x} {}", kLabel, static_cast<int>(label.label), label.color[0], label.color[1], label.color[2],
                     label.name);
}

LabelTable labels_of(const std::string& notes) {
  LabelTable out;
  std::istringstream lines(notes);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(kLabel)) continue;
    const std::string_view rest = std::string_view(line).substr(kLabel.size());
    const std::size_t space = rest.find(' ');
    if (space == std::string_view::npos || rest.size() <= space + kColorWidth + 1 || rest[space + 1] != '#') continue;
    const int number = number_of(rest.substr(0, space), 10), color = number_of(rest.substr(space + 2, 6), 16);
    if (number < static_cast<int>(VoxelLabel::first_user) || number > 255 || color < 0 || rest[space + kColorWidth] != ' ') continue;
    const auto part = [&](int shift) { return static_cast<std::uint8_t>((color >> shift) & 255); };
    out.push_back({static_cast<VoxelLabel>(number), std::string(rest.substr(space + kColorWidth + 1)), {part(16), part(8), part(0)}});
  }
  return out;
}

std::string label_name(VoxelLabel label, const LabelTable& table) {
  switch (label) {
    case VoxelLabel::bone:
      return "bone";
    case VoxelLabel::outer_table:
      return "outer table";
    case VoxelLabel::diploe:
      return "diploe";
    case VoxelLabel::inner_table:
      return "inner table";
    default:
      break;
  }
  for (const NamedLabel& one : table)
    if (one.label == label) return one.name;
  return {};
}

LabelColor palette_color(std::size_t n) noexcept {
  // Colours that differ for most eyes.   Source [Wong11] Nature Methods 8:441.
  constexpr std::array<LabelColor, 7> kColors{LabelColor{230, 159, 0},  LabelColor{86, 180, 233}, LabelColor{0, 158, 115},
                                              LabelColor{240, 228, 66}, LabelColor{0, 114, 178},  LabelColor{213, 94, 0},
                                              LabelColor{204, 121, 167}};
  return kColors[n % kColors.size()];
}

}  // namespace burrhole
