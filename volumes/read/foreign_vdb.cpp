// read_foreign_vdb of volumes/read/scan.h: converts a float grid of another program to occupancy.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "core/voxel/vdb_grids.h"
#include "volumes/read/memory_check.h"
#include "volumes/read/mesh_to_occupancy.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

constexpr int kMargin = 2;          // layers of background around the active voxels
constexpr int kSlab = 8;            // slices per step: the edge of an OpenVDB leaf
constexpr int kFarthest = 1 << 28;  // largest index: differences of two indices fit into an int

/// Occupancy of a voxel of a level set: the ramp of volumes/phantom/phantom.h, 0.5 - d / (2 w). A step along index axis i changes d by
/// |n . column i|, so w, the sum of these, is computed from the neighbours, for any map and unit. The larger of the two steps of an axis is
/// used: the smaller one may cross the middle of a thin wall or the end of the narrow band.
float ramp(const std::vector<float>& d, std::size_t at, std::size_t row, std::size_t slice) {
  double w = 0.0;
  for (const std::size_t step : {std::size_t{1}, row, slice}) {
    const double here = d[at];
    w += std::max(std::abs(here - static_cast<double>(d[at - step])), std::abs(static_cast<double>(d[at + step]) - here));
  }
  const double distance = d[at];
  if (!(w > 0.0)) return distance <= 0.0 ? 1.0f : 0.0f;
  return static_cast<float>(std::clamp(0.5 - distance / (2.0 * w), 0.0, 1.0));
}

struct Conversion {
  std::vector<float> values;
  std::size_t clamped = 0;  ///< fog: values outside 0..1
  std::size_t not_finite = 0;
};

/// Slab by slab, each with one layer of neighbours.
Result<Conversion> convert(const ForeignGrid& foreign, const VoxelBox& box, const ReadOptions& options) {
  Conversion out;
  out.values.reserve(box.count());
  std::vector<float> slab;
  for (int k = box.lo.z; k < box.hi.z; k += kSlab) {
    const VoxelBox part{{box.lo.x, box.lo.y, k}, {box.hi.x, box.hi.y, std::min(k + kSlab, box.hi.z)}};
    const VoxelBox around = part.grown(1);
    slab.resize(around.count());
    foreign.grid.read_box(around, slab);
    const auto row = static_cast<std::size_t>(around.size().x), slice = row * static_cast<std::size_t>(around.size().y);
    for_each_voxel(part, [&](const Vec3i& v) {
      const std::size_t at = around.offset_of(v);
      const float value = slab[at];
      out.not_finite += std::isfinite(value) ? 0 : 1;
      if (!foreign.level_set) out.clamped += value < 0.0f || value > 1.0f ? 1 : 0;
      out.values.push_back(foreign.level_set ? ramp(slab, at, row, slice) : std::clamp(value, 0.0f, 1.0f));
    });
    if (const Status on = advance(options, static_cast<double>(part.hi.z - box.lo.z) / box.size().z); !on) return on.error();
  }
  return out;
}

Status check_box(const VoxelBox& active, std::optional<double> memory) {
  for (std::size_t x = 0; x < 3; ++x)
    if (active.lo[x] < -kFarthest || active.hi[x] > kFarthest) return bad_input("has voxels at indices beyond 2^28");
  const Vec3 size = Vec3(active.grown(kMargin).size());
  const double voxels = size.x * size.y * size.z, most = std::min(kMaxMeshVoxels, kMaxScanVoxels);
  if (voxels > most)
    return bad_input(fmt::format("spans {:g} x {:g} x {:g} voxels ({:.3g} GB), at most {:.3g} are allowed", size.x, size.y, size.z,
                                 voxels * 4e-9, most));
  if (const auto error = memory_error(voxels * sizeof(float), memory))
    return Error{ErrorCode::unavailable, fmt::format("spans {:g} x {:g} x {:g} voxels: {}", size.x, size.y, size.z, *error), {}};
  return {};
}

Status check_background(const ForeignGrid& foreign) {
  const float background = foreign.grid.background();
  if (foreign.level_set && !(background > 0.0f))
    return bad_input(fmt::format("is a level set with a background of {:g}: inside-out", background));
  if (!foreign.level_set && !(std::abs(background) < 0.5f))
    return bad_input(fmt::format("has infinite bone: its background is {:g}", background));
  return {};
}

/// Transform with voxel centres of the box at integers from 0; lengths times the unit.
Affine bone_from_box(const Affine& world_from_index, const VoxelBox& box, double unit) {
  return {world_from_index.linear * unit, (world_from_index * Vec3(box.lo)) * unit};
}

void fill_report(const ForeignGrid& foreign, const Conversion& converted, double unit, ScanReport& report) {
  report.format = "OpenVDB";
  report.assumed.push_back("world coordinates are patient LPS: +x left, +y back, +z up");
  report.assumed.push_back(fmt::format("one unit of the file is {:g} mm", unit * 1e3));
  report.assumed.push_back(fmt::format("grid \"{}\" is a {} of {} active voxels{}", foreign.grid.name(),
                                       foreign.level_set ? "level set" : "fog volume", foreign.active,
                                       foreign.level_set ? "" : "; its values are taken for occupancy"));
  if (converted.clamped > 0) report.assumed.push_back(fmt::format("{} values outside 0..1 are clamped", converted.clamped));
  for (const std::string& name : foreign.other_float) report.skipped.push_back({"another float grid: " + name, 1});
  if (foreign.other_type > 0) report.skipped.push_back({"grid that holds no floats", foreign.other_type});
}

Result<ReadScan> read_checked(const std::string& path, const ReadOptions& options) {
  const Result<ForeignGrid> foreign = read_foreign_grid(path, options.series);
  if (!foreign) return foreign.error();
  const std::string grid = "grid \"" + foreign->grid.name() + "\" ";
  if (const Status usable = check_background(*foreign); !usable) return bad_input(grid + usable.error().message);
  const VoxelBox active = foreign->grid.active_bounds();
  if (const Status fits = check_box(active, options.memory); !fits) return Error{fits.error().code, grid + fits.error().message, {}};
  const VoxelBox box = active.grown(kMargin);
  ReadScan out;
  out.scan.dims = box.size();
  out.scan.bone_from_index = bone_from_box(foreign->world_from_index, box, *options.unit);
  out.scan.quantity = Quantity::occupancy;
  if (const auto error = affine_error(out.scan.bone_from_index)) return bad_input(grid + "with this unit: " + *error);
  if (options.accept)
    if (Status accepted = options.accept(out.scan); !accepted) return accepted.error();
  auto converted = convert(*foreign, box, options);
  if (!converted) return converted.error();
  if (converted->not_finite > 0) return bad_input(grid + fmt::format("holds {} values that are not finite", converted->not_finite));
  fill_report(*foreign, *converted, *options.unit, out.report);
  out.scan.values = std::move(converted->values);
  return out;
}

}  // namespace

Result<ReadScan> read_foreign_vdb(const std::string& path, const ReadOptions& options) {
  if (!options.unit) return bad_input("a .vdb of another program carries no unit of length: give --unit mm, cm, m or in", path);
  if (!std::isfinite(*options.unit) || *options.unit <= 0.0)
    return bad_input(fmt::format("unit = {:g} m must be > 0", *options.unit), path);
  try {
    Result<ReadScan> read = read_checked(path, options);
    if (read) return read;
    return Error{read.error().code, read.error().message, path};
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::unavailable, "no memory for its voxels", path};
  }
}

}  // namespace burrhole
