#include "core/tool/mesh_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/base/portable_math.h"
#include "core/base/units.h"
#include "core/tool/tool_spec.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxAcross = 50.0 * kMillimetre;   // from the axis, as for regions
constexpr double kLeastAcross = 0.1 * kMillimetre;  // from the axis: no bone drill is that thin
constexpr double kMaxHeight = 200.0 * kMillimetre;
constexpr double kTipTolerance = 0.01 * kMillimetre;  // rounding or facets may move the tip by this much; far below a voxel
constexpr double kMaxLength_mm = 1000.0;

struct CosSin {
  double cos, sin;
};

/// Right angles are exact, so that a rotated file has no rounding error.
CosSin cos_sin(double degrees) {
  const double quarters = degrees / 90.0;
  if (quarters == std::floor(quarters)) {
    constexpr CosSin kExact[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    return kExact[static_cast<std::size_t>(quarters - 4.0 * std::floor(quarters / 4.0))];
  }
  return {portable_cos(degrees * kDegree), portable_sin(degrees * kDegree)};
}

/// Rotation about x, then y, then z.
Mat3 turned(const Vec3& degrees) {
  const CosSin x = cos_sin(degrees.x), y = cos_sin(degrees.y), z = cos_sin(degrees.z);
  const Mat3 about_x(1, 0, 0, 0, x.cos, x.sin, 0, -x.sin, x.cos);  // columns
  const Mat3 about_y(y.cos, 0, -y.sin, 0, 1, 0, y.sin, 0, y.cos);
  const Mat3 about_z(z.cos, z.sin, 0, -z.sin, z.cos, 0, 0, 0, 1);
  return about_z * about_y * about_x;
}

void read_cutting(TableReader& table, MeshToolSpec& spec) {
  spec.erosion_factor = table.number("erosion_factor", {.min = 0.0, .max = 100.0},
                                     "removal rate x per revolution: k revolutions leave exp(-k x) of bone of hardness 1; 0: does not cut");
  const std::vector<double> range = table.numbers("cutting_range_mm", std::vector<double>{0.0, kMaxHeight / kMillimetre}, 2,
                                                  {.min = 0.0, .max = kMaxHeight / kMillimetre, .to_si = kMillimetre},
                                                  "lowest and highest height above the tip at which the tool cuts");
  spec.cut_from = range[0];
  spec.cut_to = range[1];
  if (!(spec.cut_from < spec.cut_to)) table.fault("cutting_range_mm", "must rise from its first height to its second");
}

void read_frame(TableReader& table, MeshToolSpec& spec) {
  spec.unit = table.number("unit_mm", {.fallback = 1.0, .min = 0.0, .max = 1000.0, .min_open = true, .to_si = kMillimetre},
                           "length of one unit of the file");
  spec.turn = turned(table.vector("turn_deg", Vec3(0.0), {.min = -360.0, .max = 360.0},
                                  "rotation about the fixed axes x, then y, then z, before shift_mm"));
  spec.shift = table.vector("shift_mm", Vec3(0.0), {.min = -kMaxLength_mm, .max = kMaxLength_mm, .to_si = kMillimetre},
                            "translation after turn_deg, which places the tip at the origin");
}

std::optional<std::string> size_error(const Vec3& lo, const Vec3& hi) {
  const double across = std::max({-lo.x, hi.x, -lo.y, hi.y});
  const auto mm = [](double length) { return length / kMillimetre; };
  if (across > kMaxAcross || hi.z - lo.z > kMaxHeight)
    return fmt::format(
        "reaches {:.4g} mm from the axis and is {:.4g} mm high, at most {:g} and {:g} are allowed: another unit_mm or shift_mm?",
        mm(across), mm(hi.z - lo.z), mm(kMaxAcross), mm(kMaxHeight));
  if (across < kLeastAcross)
    return fmt::format(
        "reaches {:.4g} mm from the axis, at least {:g} is needed: a file in metres needs unit_mm = 1000, one in inches 25.4", mm(across),
        mm(kLeastAcross));
  if (std::abs(lo.z) > kTipTolerance)
    return fmt::format("has its lowest point at z = {:.4g} mm and must stand on z = 0: the tip is the origin (shift_mm, turn_deg)",
                       mm(lo.z));
  if (lo.x > 0.0 || hi.x < 0.0 || lo.y > 0.0 || hi.y < 0.0)
    return fmt::format("lies beside the axis, at x = {:.4g} to {:.4g} mm and y = {:.4g} to {:.4g} mm (shift_mm, turn_deg)", mm(lo.x),
                       mm(hi.x), mm(lo.y), mm(hi.y));
  return std::nullopt;
}

}  // namespace

bool has_tool_mesh(const TomlDocument& document) {
  Issues ignored;
  return document.root(ignored).has("mesh");
}

std::optional<MeshToolSpec> read_mesh_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log) {
  const std::size_t before = issues.size();
  TableReader root = document.root(issues, log);
  MeshToolSpec spec;
  spec.name = fs::path(document.file_name()).stem().string();
  spec.title = root.text("title", std::nullopt, "what the tool is, one line");
  spec.teeth = read_teeth(root, spec.teeth, "");
  if (root.has("region")) root.fault("region", "cannot stand beside [mesh]: a tool is either regions or one surface");
  if (root.has("shell")) root.fault("shell", "cannot stand beside [mesh]: give mesh.pitch_mm");
  if (auto table = root.table("mesh", "the tool as a closed surface from a mesh file")) {
    spec.file = table->text("file", std::nullopt, "STL, OBJ or PLY file; a relative path starts at the folder of the tool file");
    spec.path = (fs::path(document.file_name()).parent_path() / spec.file).string();
    spec.file_place = table->place_of("file");
    spec.pitch = table->number("pitch_mm", {.min = 0.01, .max = 20.0, .to_si = kMillimetre}, "largest gap between shell points");
    read_frame(*table, spec);
    read_cutting(*table, spec);
    table->finish();
  }
  root.finish();
  return issues.size() == before ? std::optional<MeshToolSpec>(std::move(spec)) : std::nullopt;
}

Result<SurfaceMesh> place_tool_mesh(const MeshToolSpec& spec, SurfaceMesh mesh) {
  if (auto error = mesh_error(mesh)) return bad_input("is not a solid, " + *error);
  Vec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (Vec3& p : mesh.positions) {
    p = spec.turn * p + spec.shift;
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  if (auto error = size_error(lo, hi)) return bad_input(*error);
  return mesh;
}

}  // namespace burrhole
