#include "app/engine/volume_scene.h"

#include <filesystem>

#include "core/base/portable_math.h"
#include "core/base/units.h"
#include "volumes/read/written_path.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPhantom = "phantom:";

/// Rotation by `angle` about a coordinate axis, with the same bits on every machine.
Quat turn_about(std::size_t axis, double angle) {
  Vec3 v(0.0);
  v[axis] = portable_sin(0.5 * angle);
  return {portable_cos(0.5 * angle), v.x, v.y, v.z};
}

/// Where `source` leads. Faults at `source`; then empty.
std::string source_path(TableReader& table, const std::string& source, const std::string& scene_file) {
  const auto path = written_path(source, scene_file, "");
  if (!path) {
    table.fault("source", "cannot be found: " + path.error().message + " (or give --set volume.source=PATH)");
    return {};
  }
  std::error_code ignored;
  if (fs::exists(*path, ignored)) return *path;
  table.fault("source", "is not there: " + *path);
  return {};
}

std::vector<HardnessPoint> read_hardness(TableReader& table) {
  std::vector<HardnessPoint> out;
  for (TableReader& row : table.tables("hardness", "corners of a table from value to hardness; absent: by CT density")) {
    HardnessPoint point;
    point.value = row.number("value", {.fallback = std::nullopt, .min = -1e6, .max = 1e6}, "in HU, or the file's own unit");
    point.hardness = row.number("hardness", {.fallback = std::nullopt, .min = 0.0, .max = 1.0}, "relative mineral density there");
    if (!out.empty() && point.value <= out.back().value) row.fault("value", "must be larger than the one before");
    row.finish();
    out.push_back(point);
  }
  return out;
}

ScanScene read_scan_keys(TableReader& table, std::string path) {
  ScanScene out;
  out.request.path = std::move(path);
  out.request.read.series = table.text("series", "", "series of a DICOM folder by its number, or grid of another program's .vdb");
  if (table.has("unit"))
    out.request.read.unit = length_unit(table.choice("unit", std::nullopt, length_unit_names(), "of a mesh's lengths"));
  BoneOptions& bone = out.request.bone;
  if (table.has("bone_hu")) {
    const auto band = table.numbers("bone_hu", std::nullopt, 2, {.min = -1e6, .max = 1e6},
                                    "values between which voxels become bone, HU or the file's own unit; absent: 250, 400 HU");
    if (band[0] >= band[1])
      table.fault("bone_hu", "must increase");
    else
      bone.band = {band[0], band[1]};
  }
  if (table.has("hu_offset"))
    bone.hu_offset =
        table.number("hu_offset", {.fallback = std::nullopt, .min = -1e5, .max = 1e5}, "added to every value; absent: found out");
  bone.hardness = read_hardness(table);
  const NumberRule pitch{.fallback = std::nullopt, .min = 0.01, .max = 20.0, .to_si = kMillimetre};
  if (table.has("spacing_mm")) {
    bone.spacing = table.number("spacing_mm", pitch, "edge of the cubes the scan is resampled to; absent: its voxels as they are");
    out.request.read.pitch = bone.spacing;
  }
  if (table.has("region_mm")) {
    const NumberRule edge{.fallback = std::nullopt, .min = 1.0, .max = 1000.0, .to_si = kMillimetre};
    out.region = table.vector("region_mm", std::nullopt, edge, "size of the box round the approach that is kept; needs spacing_mm");
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
  const std::string source = table.text(
      "source", std::nullopt, "phantom:NAME; a DICOM folder or file; a NIfTI, NRRD, MetaImage, mesh or .vdb file; a raw volume's .toml");
  if (source.starts_with(kPhantom))
    out.phantom = read_phantom(table, std::string_view(source).substr(kPhantom.size()));
  else if (!source.empty())
    out.scan = read_scan_keys(table, source_path(table, source, scene_file));
  const NumberRule length{.fallback = 0.0, .min = -1e5, .max = 1e5, .to_si = kMillimetre};
  const NumberRule angle{.fallback = 0.0, .min = -360.0, .max = 360.0, .to_si = kDegree};
  const Vec3 turn = table.vector("turn_deg", Vec3(0.0), angle, "turn of the bone about x, then y, then z");
  const Quat rotation = turn_about(2, turn.z) * turn_about(1, turn.y) * turn_about(0, turn.x);
  out.world_from_bone = {rotation, table.vector("position_mm", Vec3(0.0), length, "shift of the bone in the world")};
  out.gradient_dead_zone = table.number("gradient_dead_zone", {.fallback = 0.08, .min = 0.0, .max = 0.49},
                                        "density gradients shorter than this [1/voxel] count as zero");
  table.finish();
  return out;
}

}  // namespace burrhole
