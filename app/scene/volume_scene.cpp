#include "app/scene/volume_scene.h"

#include <filesystem>

#include "core/base/portable_math.h"
#include "core/base/units.h"
#include "volumes/read/written_path.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPhantom = "phantom:";

/// Rotation by `angle` [rad] about a coordinate axis, bit for bit equal on every machine.
Quat turn_about(std::size_t axis, double angle) {
  Vec3 v(0.0);
  v[axis] = portable_sin(0.5 * angle);
  return {portable_cos(0.5 * angle), v.x, v.y, v.z};
}

/// @returns the path that `source` names; empty after an error, which is pushed at `source`.
std::string source_path(TableReader& table, const std::string& source, const std::string& scene_file) {
  const auto path = written_path(source, scene_file, "");
  if (!path) {
    table.fault("source", "cannot be found: " + path.error().message + " (or give --set volume.source=PATH)");
    return {};
  }
  std::error_code ignored;
  if (fs::exists(*path, ignored)) return *path;
  table.fault("source", "is not there: tried " + *path + missing_data_note(source) +
                            (fs::path(source).is_absolute() || source.front() == '$' ? std::string() : std::string("; ") + kPathsCount));
  return {};
}

std::vector<HardnessPoint> read_hardness(TableReader& table) {
  std::vector<HardnessPoint> out;
  for (TableReader& row : table.tables(
           "hardness", "points of the piecewise linear map from a scan's value to hardness; without them: from the mass density, for HU")) {
    HardnessPoint point;
    point.value =
        row.number("value", {.fallback = std::nullopt, .min = -1e6, .max = 1e6}, "value of the scan, in HU or the file's own unit");
    point.hardness = row.number("hardness", {.fallback = std::nullopt, .min = 0.0, .max = 1.0}, "relative mineral density at that value");
    if (!out.empty() && point.value <= out.back().value) row.fault("value", "must be larger than the one before");
    row.finish();
    out.push_back(point);
  }
  return out;
}

ScanScene read_scan_keys(TableReader& table, std::string path) {
  ScanScene out;
  out.request.path = std::move(path);
  out.request.read.series =
      table.text("series", "",
                 "series of a DICOM folder by its name in the report of import, or grid of another program's .vdb; empty: a "
                 "series without errors, CT before others, axial before others, then the largest; the grid with most active voxels");
  if (const auto unit =
          table.optional_choice("unit", length_unit_names(), "unit of length of a mesh or another program's .vdb, which carry none"))
    out.request.read.unit = length_unit(*unit);
  BoneOptions& bone = out.request.bone;
  bone.places = {table.place_of("bone_hu"), table.place_of("spacing_mm"), table.place_of("region_mm")};
  const NumberRule value{.fallback = std::nullopt, .min = -1e6, .max = 1e6};
  if (const auto band = table.optional_numbers(
          "bone_hu", 2, value,
          "band of bone: its middle is the surface, and occupancy rises over at least this range, in HU or the file's own "
          "unit; default 250 to 400 HU")) {
    bone.band = {(*band)[0], (*band)[1]};
    if ((*band)[0] >= (*band)[1]) table.fault("bone_hu", "must increase");
  }
  bone.hu_offset =
      table.optional_number("hu_offset", value, "added to every value to convert it to HU; determined from the scan if absent");
  bone.hardness = read_hardness(table);
  bone.spacing = table.optional_number("spacing_mm", {.fallback = std::nullopt, .min = 0.01, .max = 20.0, .to_si = kMillimetre},
                                       "edge of the cubes to which the scan is resampled; absent: no resampling");
  out.request.read.pitch = bone.spacing;
  if (const auto size = table.optional_numbers(
          "region_mm", 3, {.fallback = std::nullopt, .min = 1.0, .max = 1000.0, .to_si = kMillimetre},
          "size of the box around the approach to which the scan is cropped, along the patient's axes; needs spacing_mm")) {
    out.region = Vec3((*size)[0], (*size)[1], (*size)[2]);
    if (!bone.spacing) table.fault("region_mm", "needs spacing_mm: a region is cut out by resampling");
  }
  return out;
}

}  // namespace

const std::vector<std::string>& length_unit_names() {
  static const std::vector<std::string> names{"mm", "cm", "m", "in"};
  return names;
}

double length_unit(const std::string& name) {
  if (name == "cm") return 10.0 * kMillimetre;
  if (name == "m") return 1000.0 * kMillimetre;
  if (name == "in") return 25.4 * kMillimetre;
  return kMillimetre;
}

VolumeScene read_volume(TableReader table, const std::string& scene_file) {
  VolumeScene out;
  out.place = table.place_of("source");
  out.spacing_place = table.has("spacing_mm") ? table.place_of("spacing_mm") : out.place;
  const std::string source = table.text("source", std::nullopt,
                                        "phantom:NAME, a DICOM folder, or a file that \"burrhole import\" reads; relative to the scene's "
                                        "folder, or $NAME/... with an environment variable");
  if (source.starts_with(kPhantom))
    out.phantom = read_phantom(table, std::string_view(source).substr(kPhantom.size()));
  else if (!source.empty())
    out.scan = read_scan_keys(table, source_path(table, source, scene_file));
  const NumberRule length{.fallback = 0.0, .min = -1e5, .max = 1e5, .to_si = kMillimetre};
  const NumberRule angle{.fallback = 0.0, .min = -360.0, .max = 360.0, .to_si = kDegree};
  const Vec3 turn = table.vector("turn_deg", Vec3(0.0), angle, "rotation of the bone about the world's x, then y, then z axis");
  const Quat rotation = turn_about(2, turn.z) * turn_about(1, turn.y) * turn_about(0, turn.x);
  out.world_from_bone = {rotation, table.vector("position_mm", Vec3(0.0), length, "position of the bone frame's origin in the world")};
  out.gradient_dead_zone = table.number("gradient_dead_zone", {.fallback = 0.08, .min = 0.0, .max = 0.49},
                                        "density gradients shorter than this [1/voxel] count as zero");
  if (source.empty() && table.has("source"))
    table.fault("source", "names no volume: phantom:NAME, a folder or a file (burrhole docs scene)");
  if (!source.empty()) table.finish();  // which keys there are depends on the source
  return out;
}

}  // namespace burrhole
