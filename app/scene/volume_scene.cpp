#include "app/scene/volume_scene.h"

#include <filesystem>

#include "core/base/portable_math.h"
#include "core/base/units.h"
#include "volumes/read/skull_segment.h"
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

/// The keys of layers = "segment".
std::shared_ptr<const SegmentOptions> read_segment(TableReader& table) {
  const bool wanted = table.choice("layers", "none", {"none", "segment"},
                                   "segment: outer table, diploe and inner table are found in the scan, which must be in HU, and labelled; "
                                   "none: its bone has one label") == "segment";
  if (!wanted) return nullptr;
  SegmentOptions out;
  const auto length = [&](std::string_view key, double fallback, double most, std::string_view about) {
    return table.number(key, {.fallback = fallback / kMillimetre, .min = 0.1, .max = most, .to_si = kMillimetre}, about);
  };
  out.air = table.number("air_hu", {.fallback = out.air, .min = -1000.0, .max = 0.0},
                         "values below are air: half way from air to fat (assumption)");
  out.least_dip =
      table.number("least_dip", {.fallback = out.least_dip, .min = 0.0, .max = 0.9},
                   "least drop of the values from the tables to diploe, as a share of the height of the lesser table above soft tissue; "
                   "with less, a place has no layers (assumption)");
  out.least_table = length("least_table_mm", out.least_table, 5.0, "least thickness of a table (assumption)");
  out.smoothing = length("smoothing_mm", out.smoothing, 20.0,
                         "standard deviation of the averages along the surface: of normals, values and borders (assumption)");
  out.dura = length("dura_mm", out.dura, 3.0, "thickness of dura, which the scan does not show; 0.3 to 0.8 mm are usual");
  out.blur = table.optional_number("blur_mm", {.fallback = std::nullopt, .min = 0.1, .max = 3.0, .to_si = kMillimetre},
                                   "blur of the scanner, standard deviation; absent: from the outer edge of the bone, place by place");
  return std::make_shared<const SegmentOptions>(out);
}

/// @returns the path of a file that a key names, empty without the key or after an error.
std::string file_of(TableReader& table, std::string_view key, const std::string& name, const std::string& scene_file) {
  if (name.empty()) {
    if (table.has(key)) table.fault(key, "is empty: name a file, or leave the key out");
    return {};
  }
  const auto path = written_path(name, scene_file, "");
  std::error_code ignored;
  if (path && fs::is_regular_file(*path, ignored)) return *path;
  table.fault(key, path ? "is not there: tried " + *path + "; " + kPathsCount : "cannot be found: " + path.error().message);
  return {};
}

LabelFiles read_label_files(TableReader& table, const std::string& scene_file) {
  LabelFiles out;
  out.volume = file_of(
      table, "labels",
      table.text("labels", "",
                 "label volume on the grid of the scan, in any format that import reads; its labels replace the others. A .seg.nrrd "
                 "of 3D Slicer has names and colours"),
      scene_file);
  out.table = file_of(table, "label_table",
                      table.text("label_table", "", "names and colours of these labels: a label description file of ITK-SNAP"), scene_file);
  if (table.has("label_table") && !table.has("labels")) table.fault("label_table", "needs labels: the volume whose labels it names");
  return out;
}

ScanScene read_scan_keys(TableReader& table, std::string path, const std::string& scene_file) {
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
  bone.places = {table.place_of("bone_hu"), table.place_of("spacing_mm"), table.place_of("region_mm"),
                 table.has("labels") ? table.place_of("labels") : std::string(),
                 table.has("label_table") ? table.place_of("label_table") : std::string()};
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
  bone.segment = read_segment(table);
  bone.label_files = read_label_files(table, scene_file);
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
    out.scan = read_scan_keys(table, source_path(table, source, scene_file), scene_file);
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
