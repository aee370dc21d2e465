#include "volumes/read/label_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "core/base/bounds.h"
#include "core/base/input_file.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr int kMostLabels = 240;              // numbers from VoxelLabel::first_user on, in a byte
constexpr std::size_t kMostText = 1u << 20u;  // [bytes] of a table, or of a header

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return c == '_' ? ' ' : static_cast<char>(std::tolower(c)); });
  return text;
}

/// Without line ends and control characters, which would break the lines of a report.
std::string printable(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::iscntrl(c) != 0; });
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// @returns the label of a layer that has this name; `none` if there is no such layer.
VoxelLabel layer_of(const std::string& name) {
  static const std::map<std::string, VoxelLabel> layers{{"outer table", VoxelLabel::outer_table},
                                                        {"diploe", VoxelLabel::diploe},
                                                        {"inner table", VoxelLabel::inner_table},
                                                        {"dura", VoxelLabel::dura},
                                                        {"brain", VoxelLabel::brain},
                                                        {"forbidden", VoxelLabel::forbidden}};
  const auto found = layers.find(lower(name));
  return found == layers.end() ? VoxelLabel::none : found->second;
}

std::string size_text(const Vec3i& dims) { return fmt::format("{} x {} x {}", dims.x, dims.y, dims.z); }

/// @returns what differs between the two grids, in words; empty if they are the same.
std::string difference(const Scan& labels, const Scan& scan) {
  constexpr double kSame = 0.05;  // [-] of the shortest edge: headers with few digits differ by less
  if (labels.dims != scan.dims) return fmt::format("has {} voxels, the scan {}", size_text(labels.dims), size_text(scan.dims));
  const Mat3 &a = labels.bone_from_index.linear, &b = scan.bone_from_index.linear;
  double farthest = 0.0, shortest = glm::length(b[0]);
  for (std::size_t axis = 0; axis < 3; ++axis) shortest = std::min(shortest, glm::length(b[axis]));
  for (const Vec3& corner : Bounds{Vec3(0.0), Vec3(scan.dims - 1)}.corners())
    farthest = std::max(farthest, glm::length(labels.bone_from_index * corner - scan.bone_from_index * corner));
  if (farthest <= kSame * shortest) return {};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::abs(glm::length(a[axis]) - glm::length(b[axis])) * scan.dims[axis] > kSame * shortest)
      return fmt::format("has voxels of {:.4g} x {:.4g} x {:.4g} mm, the scan of {:.4g} x {:.4g} x {:.4g} mm",
                         glm::length(a[0]) / kMillimetre, glm::length(a[1]) / kMillimetre, glm::length(a[2]) / kMillimetre,
                         glm::length(b[0]) / kMillimetre, glm::length(b[1]) / kMillimetre, glm::length(b[2]) / kMillimetre);
  return fmt::format("lies elsewhere than the scan: a corner is {:.3g} mm away from that of the scan", farthest / kMillimetre);
}

bool ends_with(const std::string& path, std::string_view ending) { return lower(path).ends_with(ending); }

Result<std::vector<LabelRow>> rows_of(const LabelFiles& files) {
  if (!files.table.empty()) {
    const auto text = read_input(files.table, {"a label description file", kMostText, true});
    if (!text) return text.error();
    return parse_label_table(*text, files.table);
  }
  if (!ends_with(files.volume, ".nrrd") && !ends_with(files.volume, ".nhdr")) return std::vector<LabelRow>();
  std::ifstream file(files.volume, std::ios::binary);  // it was read before
  std::string header(kMostText, '\0');
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  header.resize(static_cast<std::size_t>(file.gcount()));
  return parse_segments(header);
}

}  // namespace

VoxelLabel LabelVolume::at(const Vec3& p_bone) const noexcept {
  const Vec3i v = voxel_of(index_from_bone * p_bone);
  const VoxelBox all{Vec3i(0), dims};
  return all.contains(v) ? static_cast<VoxelLabel>(values[all.offset_of(v)]) : VoxelLabel::none;
}

Result<std::vector<LabelRow>> parse_label_table(const std::string& text, const std::string& path) {
  std::vector<LabelRow> out;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    std::istringstream words(line);
    LabelRow row;
    std::array<int, 3> color{};
    double opacity = 0.0;
    int visible = 0, mesh = 0;
    std::string name;
    const auto refuse = [&](const char* why) {
      return bad_input(std::string(why) + ": IDX R G B A VIS MSH \"LABEL\"", fmt::format("{}:{}", path, number));
    };
    if (!(words >> row.value >> color[0] >> color[1] >> color[2] >> opacity >> visible >> mesh))
      return refuse("is no row of a label table");
    std::getline(words, name);
    const std::size_t open = name.find('"'), close = name.rfind('"');
    if (open == std::string::npos || close <= open) return refuse("has no name in quotes");
    row.name = printable(name.substr(open + 1, close - open - 1));
    for (std::size_t n = 0; n < 3; ++n) {
      if (color[n] < 0 || color[n] > 255) return refuse("has a colour outside 0 to 255");
      row.color[n] = static_cast<std::uint8_t>(color[n]);
    }
    if (std::ranges::any_of(out, [&](const LabelRow& other) { return other.value == row.value; })) return refuse("repeats a number");
    out.push_back(std::move(row));
  }
  return out;
}

std::vector<LabelRow> parse_segments(const std::string& header) {
  struct Segment {
    std::optional<int> value;
    std::string name, color;
  };
  std::map<int, Segment> segments;
  std::istringstream lines(header);
  for (std::string line; std::getline(lines, line) && !line.empty() && line != "\r";) {
    const std::size_t equals = line.find(":=");
    int number = 0, used = 0;
    if (equals == std::string::npos || std::sscanf(line.c_str(), "Segment%d_%n", &number, &used) != 1 || used == 0) continue;
    const std::string field = line.substr(static_cast<std::size_t>(used), equals - static_cast<std::size_t>(used));
    const std::string value = printable(line.substr(equals + 2));
    Segment& segment = segments[number];
    if (field == "LabelValue") segment.value = std::atoi(value.c_str());
    if (field == "Name") segment.name = value;
    if (field == "Color") segment.color = value;
  }
  std::vector<LabelRow> out;
  for (const auto& [number, segment] : segments) {
    LabelRow row{segment.value.value_or(number + 1), segment.name, palette_color(out.size())};
    std::istringstream color(segment.color);
    std::array<double, 3> part{};
    if (color >> part[0] >> part[1] >> part[2])
      for (std::size_t n = 0; n < 3; ++n) row.color[n] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(part[n], 0.0, 1.0)));
    out.push_back(std::move(row));
  }
  return out;
}

Result<LabelVolume> read_label_volume(const LabelFiles& files, const Scan& scan) {
  const auto refuse = [&](const std::string& why) { return bad_input(why, files.volume); };
  ReadOptions options;
  options.by_values = true;
  auto read = read_scan(files.volume, options);
  if (!read) return read.error().place.empty() ? Error{read.error().code, read.error().message, files.volume} : read.error();
  if (const std::string other = difference(read->scan, scan); !other.empty())
    return refuse("label volume " + other + ": export it on the grid of the scan");
  auto rows = rows_of(files);
  if (!rows) return rows.error();
  std::map<int, VoxelLabel> numbers;
  for (const float value : read->scan.values) {
    if (!(value >= 0.0f && value <= 1e6f) || value != std::floor(value))
      return refuse(fmt::format("has the value {:g}: labels are whole numbers of at least 0", value));
    if (value == 0.0f || numbers.contains(static_cast<int>(value))) continue;
    numbers[static_cast<int>(value)] = VoxelLabel::none;
    if (numbers.size() > kMostLabels) return refuse(fmt::format("has more than {} labels: is it a scan?", kMostLabels));
  }
  if (numbers.empty()) return refuse("has no labels: all its voxels are 0");
  LabelVolume out{scan.dims, scan.bone_from_index.inverse(), {}, {}};
  int next = static_cast<int>(VoxelLabel::first_user);
  for (auto& [value, label] : numbers) {
    const auto row = std::ranges::find(*rows, value, &LabelRow::value);
    const std::string name = row == rows->end() || row->name.empty() ? fmt::format("label {}", value) : row->name;
    label = layer_of(name);
    if (label != VoxelLabel::none) continue;
    label = static_cast<VoxelLabel>(next++);
    out.table.push_back({label, name, row == rows->end() ? palette_color(out.table.size()) : row->color});
  }
  out.values.reserve(read->scan.values.size());
  for (const float value : read->scan.values)
    out.values.push_back(value == 0.0f ? std::uint8_t{0} : static_cast<std::uint8_t>(numbers[static_cast<int>(value)]));
  return out;
}

}  // namespace burrhole
