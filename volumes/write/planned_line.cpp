#include "volumes/write/planned_line.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/output_file.h"
#include "volumes/read/number_text.h"
#include "volumes/write/image_writer.h"

namespace burrhole {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#";

const char* name_of(MarkupsFrame frame) { return frame == MarkupsFrame::lps ? "LPS" : "RAS"; }

/// @returns a point in mm, in the frame of the file.
Vec3 in_frame(const Vec3& lps, MarkupsFrame frame) {
  const double sign = frame == MarkupsFrame::lps ? 1.0 : -1.0;
  // + 0.0: no negative zero in the text
  return {sign * exact_millimetres(lps.x) + 0.0, sign * exact_millimetres(lps.y) + 0.0, exact_millimetres(lps.z)};
}

Json control_point(const char* id, const char* label, const Vec3& mm) {
  return {{"id", id},        {"label", label},     {"position", {mm.x, mm.y, mm.z}}, {"selected", true},
          {"locked", false}, {"visibility", true}, {"positionStatus", "defined"}};
}

}  // namespace

std::string markups_json(const PlannedLine& line, MarkupsFrame frame) {
  const Json points =
      Json::array({control_point("1", "entry", in_frame(line.entry, frame)), control_point("2", "target", in_frame(line.target, frame))});
  const Json markup{{"type", "Line"},         {"coordinateSystem", name_of(frame)}, {"coordinateUnits", "mm"},
                    {"locked", false},        {"fixedNumberOfControlPoints", true}, {"labelFormat", "%N-%d"},
                    {"controlPoints", points}};
  return Json{{"@schema", kSchema}, {"markups", Json::array({markup})}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string markups_fcsv(const PlannedLine& line, MarkupsFrame frame) {
  std::string out = fmt::format(
      "# Markups fiducial file version = 5.0\n# CoordinateSystem = {}\n"
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n",
      name_of(frame));
  int id = 0;
  for (const auto& [label, point] : {std::pair{"entry", line.entry}, std::pair{"target", line.target}}) {
    const Vec3 mm = in_frame(point, frame);
    out += fmt::format("{},{},{},{},0,0,0,1,1,1,0,{},,\n", ++id, mm.x, mm.y, mm.z, label);
  }
  return out;
}

bool is_markups_path(const std::string& path) {
  const std::string name = lower(path);
  return name.ends_with(".mrk.json") || name.ends_with(".fcsv");
}

Status write_planned_line(const std::string& path, const PlannedLine& line) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  Status written = file->write(lower(path).ends_with(".fcsv") ? markups_fcsv(line) : markups_json(line));
  if (!written) return written;
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

}  // namespace burrhole
