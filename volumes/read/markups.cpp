#include "volumes/read/markups.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/input_file.h"
#include "core/base/units.h"
#include "volumes/read/located_json.h"
#include "volumes/read/number_text.h"

namespace burrhole {
namespace {

constexpr double kFarthest = 1e5 * kMillimetre;  ///< [m] of a coordinate, as of entry_mm
constexpr double kShortest = 0.1 * kMillimetre;  ///< [m] of a line: its direction is needed
constexpr double kMicrometre = 1e-3 * kMillimetre;

struct Point {
  std::string label;
  Vec3 position{0.0};  ///< [m] LPS
  std::size_t at = 0;  ///< offset in the text
};

/// A file under its name, for errors with places.
struct File {
  std::string_view text;
  const std::string& name;

  [[nodiscard]] Error fail(std::size_t at, const std::string& message) const { return bad_input(message, place_in(text, at, name)); }
};

/// @returns -1 for RAS, whose x and y run the other way, and 1 for LPS.
std::optional<double> sign_of_system(std::string_view system) {
  if (system == "LPS" || system == "1") return 1.0;
  if (system == "RAS" || system == "0") return -1.0;
  return std::nullopt;
}

Vec3 in_lps(const Vec3& written, double sign, double unit) { return Vec3(sign * written.x, sign * written.y, written.z) * unit; }

std::optional<std::size_t> labelled(const std::vector<Point>& points, std::string_view label) {
  for (std::size_t n = 0; n < points.size(); ++n)
    if (lower(trimmed(points[n].label)) == label) return n;
  return std::nullopt;
}

Result<PlannedLine> line_of(const File& file, const std::vector<Point>& points, std::size_t at) {
  auto entry = labelled(points, "entry"), target = labelled(points, "target");
  if (points.size() == 2) {
    if (!entry) entry = target ? 1 - *target : 0;
    if (!target) target = 1 - *entry;
  }
  if (!entry || !target)
    return file.fail(at, fmt::format("has {} point{}: a plan has two, entry and target, or two that are labelled so", points.size(),
                                     points.size() == 1 ? "" : "s"));
  const PlannedLine line{points[*entry].position, points[*target].position};
  for (const Point& point : points)
    for (std::size_t n = 0; n < 3; ++n)
      if (!(std::abs(point.position[n]) <= kFarthest)) return file.fail(point.at, "a coordinate is beyond 1e5 mm");
  if (glm::length(line.target - line.entry) < kShortest)
    return file.fail(points[*target].at, "entry and target are less than 0.1 mm apart: they have no direction");
  return line;
}

Result<double> unit_of(const File& file, const JsonValue& markup) {
  const JsonValue* unit = markup.find("coordinateUnits");
  if (unit == nullptr) return kMillimetre;
  const JsonValue* word = unit->kind == JsonValue::Kind::list && !unit->items.empty() ? &unit->items.front() : unit;
  if (word->text == "mm") return kMillimetre;
  if (word->text == "um") return kMicrometre;
  return file.fail(unit->at, "coordinateUnits must be \"mm\" or \"um\"");
}

Result<double> system_of(const File& file, const JsonValue& markup) {
  const JsonValue* system = markup.find("coordinateSystem");
  if (system == nullptr) return 1.0;  // the schema's default
  if (const auto sign = system->kind == JsonValue::Kind::text ? sign_of_system(system->text) : std::nullopt) return *sign;
  return file.fail(system->at, "coordinateSystem must be \"LPS\" or \"RAS\"");
}

Result<Vec3> position_of(const File& file, const JsonValue& point) {
  const JsonValue* position = point.find("position");
  if (position == nullptr) return file.fail(point.at, "a control point without a position");
  Vec3 out(0.0);
  const bool three = position->kind == JsonValue::Kind::list && position->items.size() == 3;
  for (std::size_t n = 0; three && n < 3; ++n) {
    if (position->items[n].kind != JsonValue::Kind::number) return file.fail(position->items[n].at, "position must be three numbers");
    out[n] = position->items[n].number;
  }
  if (!three) return file.fail(position->at, "position must be three numbers");
  return out;
}

/// A point that was not placed yet has the status "undefined" or "preview".
bool is_placed(const JsonValue& point) {
  const JsonValue* status = point.find("positionStatus");
  return status == nullptr || status->text == "defined";
}

Result<std::vector<Point>> points_of(const File& file, const JsonValue& markup, const JsonValue& list) {
  const auto sign = system_of(file, markup);
  if (!sign) return sign.error();
  const auto unit = unit_of(file, markup);
  if (!unit) return unit.error();
  std::vector<Point> out;
  for (const JsonValue& item : list.items) {
    if (item.kind != JsonValue::Kind::object) return file.fail(item.at, "a control point must be an object");
    if (!is_placed(item)) continue;
    const auto position = position_of(file, item);
    if (!position) return position.error();
    const JsonValue* label = item.find("label");
    out.push_back({label != nullptr ? label->text : std::string(), in_lps(*position, *sign, *unit), item.at});
  }
  return out;
}

std::string type_of(const JsonValue& markup) {
  const JsonValue* type = markup.find("type");
  return type != nullptr ? type->text : std::string();
}

/// @returns the one markup of the file, or of several the one line.
Result<const JsonValue*> choose_markup(const File& file, const JsonValue& root) {
  const JsonValue* list = root.find("markups");
  if (list == nullptr || list->kind != JsonValue::Kind::list)
    return file.fail(root.at, "is no markups file of 3D Slicer: it has no list \"markups\"");
  const auto is_line = [](const JsonValue& markup) { return type_of(markup) == "Line"; };
  const auto lines = std::count_if(list->items.begin(), list->items.end(), is_line);
  if (lines == 1) return &*std::find_if(list->items.begin(), list->items.end(), is_line);
  if (list->items.size() != 1)
    return file.fail(list->at, fmt::format("has {} markups, {} of them lines: save the planned line alone", list->items.size(), lines));
  const JsonValue& only = list->items.front();
  if (type_of(only) != "Fiducial")
    return file.fail(only.at, "is a markup of another type: a plan is a \"Line\", or a \"Fiducial\" list of points");
  return &only;
}

/// Fields of one line, and where each begins; a field may be quoted, with "" for a quote in it.
struct Field {
  std::string text;
  std::size_t at = 0;  ///< [bytes] from the start of the line
};

std::vector<Field> split_fields(std::string_view line) {
  std::vector<Field> out(1);
  bool quoted = false;
  for (std::size_t n = 0; n < line.size(); ++n) {
    const char c = line[n];
    if (c == '"' && quoted && n + 1 < line.size() && line[n + 1] == '"')
      out.back().text += line[++n];
    else if (c == '"' && (quoted || out.back().text.empty()))
      quoted = !quoted;
    else if (c == ',' && !quoted)
      out.push_back({{}, n + 1});
    else
      out.back().text += c;
  }
  return out;
}

/// Which fields hold what; a comment line "columns = id,x,y,z,..." changes it.
struct Columns {
  std::array<std::size_t, 3> axes{1, 2, 3};
  std::size_t label = 11;
};

Columns columns_of(std::string_view names) {
  Columns out;
  const std::vector<Field> fields = split_fields(names);
  for (std::size_t n = 0; n < fields.size(); ++n) {
    const std::string_view name = trimmed(fields[n].text);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (name == std::string_view("xyz").substr(axis, 1)) out.axes[axis] = n;
    if (name == "label") out.label = n;
  }
  return out;
}

/// @returns what follows "# KEY =" in a comment.
std::optional<std::string_view> value_in_comment(std::string_view line, std::string_view key) {
  line = trimmed(line.substr(1));
  if (!line.starts_with(key)) return std::nullopt;
  line = trimmed(line.substr(key.size()));
  return line.starts_with('=') ? std::optional(trimmed(line.substr(1))) : std::nullopt;
}

Result<Point> point_of(const File& file, std::string_view line, const Columns& columns, double sign) {
  const auto start = static_cast<std::size_t>(line.data() - file.text.data());
  const std::vector<Field> fields = split_fields(line);
  Vec3 written(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns.axes[axis] >= fields.size())
      return file.fail(start, fmt::format("has {} fields: a point needs id, x, y and z, separated by commas", fields.size()));
    const Field& field = fields[columns.axes[axis]];
    const auto number = number_of(trimmed(field.text));
    if (!number || !std::isfinite(*number)) return file.fail(start + field.at, fmt::format("{} is not a number", "xyz"[axis]));
    written[axis] = *number;
  }
  return Point{columns.label < fields.size() ? fields[columns.label].text : std::string(), in_lps(written, sign, kMillimetre), start};
}

}  // namespace

Result<PlannedLine> parse_markups_json(std::string_view text, const std::string& name) {
  const File file{text, name};
  const auto root = parse_json(text, name);
  if (!root) return root.error();
  const auto markup = choose_markup(file, *root);
  if (!markup) return markup.error();
  const JsonValue* list = (*markup)->find("controlPoints");
  if (list == nullptr || list->kind != JsonValue::Kind::list) return file.fail((*markup)->at, "the markup has no list \"controlPoints\"");
  const auto points = points_of(file, **markup, *list);
  if (!points) return points.error();
  return line_of(file, *points, list->at);
}

Result<PlannedLine> parse_markups_fcsv(std::string_view text, const std::string& name) {
  const File file{text, name};
  Columns columns;
  double sign = -1.0;
  std::vector<Point> points;
  std::string_view rest = text;
  while (const auto line = take_line(rest)) {
    if (trimmed(*line).empty()) continue;
    if (!line->starts_with('#')) {
      auto point = point_of(file, *line, columns, sign);
      if (!point) return point.error();
      points.push_back(std::move(point).value());
      continue;
    }
    if (const auto names = value_in_comment(*line, "columns")) columns = columns_of(*names);
    const auto system = value_in_comment(*line, "CoordinateSystem");
    if (!system) continue;
    const auto found = sign_of_system(*system);
    if (!found) return file.fail(static_cast<std::size_t>(system->data() - text.data()), "CoordinateSystem must be LPS (1) or RAS (0)");
    sign = *found;
  }
  return line_of(file, points, 0);
}

Result<PlannedLine> read_planned_line(const std::string& path) {
  const std::string ending = lower(path);
  const bool json = ending.ends_with(".json");
  if (!json && !ending.ends_with(".fcsv")) return bad_input("must end in .mrk.json or .fcsv", path);
  const auto text = read_input(path, kMarkupsInput);
  if (!text) return text.error();
  return json ? parse_markups_json(*text, path) : parse_markups_fcsv(*text, path);
}

}  // namespace burrhole
