// read_mesh_scan of volumes/read/scan.h: converts a closed mesh to occupancy.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/units.h"
#include "core/tool/join_rounded.h"
#include "volumes/read/byte_stream.h"
#include "volumes/read/memory_check.h"
#include "volumes/read/mesh_file.h"
#include "volumes/read/mesh_to_occupancy.h"
#include "volumes/read/scan.h"

namespace burrhole {
namespace {

constexpr double kDefaultVoxels = 256.0;  // along the longest side
constexpr double kLeastVoxels = 4.0;      // across the thinnest side: fewer do not resolve the shape
constexpr double kSmallest = 1e-3;        // [m] sizes outside this range result from a wrong unit
constexpr double kLargest = 2.0;          // [m]

struct MeshSize {
  Vec3 size;
  double longest, thinnest;
};

MeshSize size_of(const SurfaceMesh& mesh) {
  Vec3 lo = mesh.positions.front(), hi = lo;
  for (const Vec3& p : mesh.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const Vec3 size = hi - lo;
  return {size, std::max({size.x, size.y, size.z}), std::min({size.x, size.y, size.z})};
}

std::string size_text(const Vec3& size) { return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x * 1e3, size.y * 1e3, size.z * 1e3); }

/// @returns the unit [m] in the header of a mesh that burrhole has exported (volumes/write/mesh_writer.cpp); nothing of other meshes.
std::optional<double> own_unit(const std::string& path) {
  constexpr std::size_t kHeader = 300;  // [bytes]
  const Result<std::vector<std::byte>> head = read_head(path, false, kHeader);
  if (!head) return std::nullopt;
  const std::string_view text(reinterpret_cast<const char*>(head->data()), head->size());
  return text.find("burrhole, bone surface. SPACE=LPS, unit mm") != std::string_view::npos ? std::optional(kMillimetre) : std::nullopt;
}

Status check_options(const ReadOptions& options, const std::string& path) {
  if (!options.unit) return bad_input("mesh files carry no unit of length: give mm, cm, m or in (--unit; unit in a scene)", path);
  if (!std::isfinite(*options.unit) || *options.unit <= 0.0)
    return bad_input(fmt::format("unit = {:g} m must be > 0", *options.unit), path);
  if (options.pitch && (!std::isfinite(*options.pitch) || *options.pitch <= 0.0))
    return bad_input(fmt::format("pitch = {:g} mm must be > 0", *options.pitch * 1e3), path);
  return {};
}

Status check_grid(const MeshSize& mesh, double pitch, std::optional<double> memory, const std::string& path) {
  if (mesh.longest < kSmallest || mesh.longest > kLargest)
    return bad_input(fmt::format("is {} with this unit, and must be {:g} mm to {:g} m long: another --unit?", size_text(mesh.size),
                                 kSmallest * 1e3, kLargest),
                     path);
  if (mesh.thinnest < kLeastVoxels * pitch)
    return bad_input(
        fmt::format("a pitch of {:.3g} mm leaves {:.2g} voxels across the thinnest side of {:.3g} mm, at least {:g} are needed",
                    pitch * 1e3, mesh.thinnest / pitch, mesh.thinnest * 1e3, kLeastVoxels),
        path);
  const Vec3 dims = mesh_grid_dims(mesh.size, pitch);
  const double voxels = dims.x * dims.y * dims.z;
  if (voxels > std::min(kMaxMeshVoxels, kMaxScanVoxels))
    return bad_input(fmt::format("a pitch of {:.3g} mm makes {:.3g} voxels ({:.3g} GB), at most {:.3g} are allowed: take a coarser pitch",
                                 pitch * 1e3, voxels, voxels * 4e-9, std::min(kMaxMeshVoxels, kMaxScanVoxels)),
                     path);
  if (const auto error = memory_error(voxels * sizeof(float), memory))
    return Error{ErrorCode::unavailable, fmt::format("a pitch of {:.3g} mm {}: take a coarser pitch", pitch * 1e3, *error), path};
  return {};
}

}  // namespace

Result<ReadScan> read_mesh_scan(const std::string& path, const ReadOptions& given) {
  ReadOptions options = given;
  if (!options.unit) options.unit = own_unit(path);
  if (const Status usable = check_options(options, path); !usable) return usable.error();
  Result<SurfaceMesh> mesh = read_mesh(path, *options.unit);
  if (!mesh) return mesh.error();
  const RoundingJoin join = join_rounded(*mesh);
  if (const auto error = mesh_error(*mesh)) return bad_input(*error, path);
  const MeshSize size = size_of(*mesh);
  const double pitch = options.pitch.value_or(size.longest / kDefaultVoxels);
  if (const Status fits = check_grid(size, pitch, options.memory, path); !fits) return fits.error();
  Result<Scan> scan = mesh_to_occupancy(*mesh, pitch, [&](double share) { return advance(options, share); });
  if (!scan) return Error{scan.error().code, scan.error().message, path};
  if (options.accept)
    if (Status accepted = options.accept(*scan); !accepted) return accepted.error();
  ReadScan out{std::move(scan).value(), {}};
  out.report.format = mesh_format(path);
  out.report.assumed.push_back("mesh coordinates are patient LPS: +x left, +y back, +z up");
  out.report.assumed.push_back(fmt::format("one unit of the file is {:g} mm{}: the mesh is {}", *options.unit * 1e3,
                                           given.unit ? "" : ", by its header, which burrhole has written", size_text(size.size)));
  if (!options.pitch) out.report.assumed.push_back(fmt::format("pitch {:.4g} mm: longest side / {:g}", pitch * 1e3, kDefaultVoxels));
  if (join.joined > 0) out.report.assumed.push_back(join.text());
  const MeshCheck check = check_mesh(*mesh);
  out.report.assumed.push_back(
      fmt::format("solid within {} closed surface{}, {:.4g} cm3", check.parts, check.parts == 1 ? "" : "s", check.volume * 1e6));
  if (check.degenerate > 0) out.report.skipped.push_back({"triangle without area", check.degenerate});
  return out;
}

}  // namespace burrhole
