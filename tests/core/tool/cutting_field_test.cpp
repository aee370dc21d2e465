#include "core/tool/cutting_field.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "core/base/bounds.h"
#include "core/base/random.h"
#include "core/tool/erosion_points.h"
#include "core/tool/make_tool.h"
#include "tests/support/plain_trilinear.h"
#include "tests/support/sanitized.h"

using namespace burrhole;

namespace {

constexpr double kVoxel = 0.25e-3;

ToolSpec spec_of(const std::string& regions) {
  const auto document = TomlDocument::parse("title = \"Bit\"\n[shell]\npitch_mm = 0.4\n" + regions, "bit.toml");
  REQUIRE(document.ok());
  Issues issues;
  auto spec = read_tool_spec(*document, issues);
  REQUIRE_MESSAGE(spec.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*spec);
}

double between(const CuttingField& field, const std::vector<float>& values, const Vec3& p) {
  Vec3 q = (p - field.origin) / field.pitch;
  if (field.revolved) q = Vec3(std::hypot(q.x, q.y), 0.0, q.z);
  const VoxelBox box{Vec3i(0), field.dims};
  return test::plain_trilinear(glm::clamp(q, Vec3(0.0), Vec3(field.dims - 1)),
                               [&](const Vec3i& v) { return values[box.offset_of(glm::min(v, box.hi - 1))]; });
}

/// Share of places within a box round the tool where the field's sign is not that of what cuts, those within `skin` of its surface left
/// out.
double wrong(const ToolSpec& spec, const CuttingField& field, double skin) {
  int bad = 0;
  for (std::uint64_t n = 0; n < 20000; ++n) {
    const Vec3 u(uniform01(7, 3 * n), uniform01(7, 3 * n + 1), uniform01(7, 3 * n + 2));
    Vec3 p = field.origin + field.pitch * u * Vec3(field.dims - 1);
    if (field.revolved) p = Vec3(p.x * std::cos(6.3 * u.y), p.x * std::sin(6.3 * u.y), p.z);
    const double d = between(field, field.distance, p);
    if (std::abs(d) > skin) bad += (d < 0.0) != (erosion_factor_at(spec, p) > 0.0) ? 1 : 0;
  }
  return bad / 20000.0;
}

const std::string kBall = "[[region]]\nshape = \"sphere\"\nz_mm = 0\ndiameter_mm = 4\nerosion_factor = 0.1\n";
const std::string kShaft = "[[region]]\nshape = \"cylinder\"\nz_mm = 3.5\nheight_mm = 4\ndiameter_mm = 2\nerosion_factor = 0\n";

}  // namespace

TEST_CASE("cutting field: distances to a ball are the closed form's within the pitch's bound, without bias") {
  const CuttingFieldSize size = cutting_field_size(kVoxel, 2e-3);
  const auto field = make_cutting_field(spec_of(kBall), size);
  REQUIRE(field.ok());
  double worst = 0.0, mean = 0.0;
  for (std::uint64_t n = 0; n < 5000; ++n) {
    const Vec3 way = glm::normalize(Vec3(uniform11(3, 3 * n), uniform11(3, 3 * n + 1), uniform11(3, 3 * n + 2)));
    const double d = between(*field, field->distance, Vec3(0.0, 0.0, 2e-3) + 2e-3 * way);
    worst = std::max(worst, std::abs(d));
    mean += d / 5000.0;
  }
  MESSAGE("surface of a 4 mm ball off by " << worst / kVoxel << " voxel at worst, " << mean / kVoxel << " on average");
  CHECK(worst < 0.006 * kVoxel);            // pitch^2 (2 / R) / 8 = 0.005 voxel, the outline's chords 128 a half circle
  CHECK(std::abs(mean) < 0.0005 * kVoxel);  // a tenth of it
}

TEST_CASE("cutting field: its sign is what cuts, with passive regions, passive faces and bores") {
  const std::string tube =
      "[[region]]\nshape = \"tube\"\nz_mm = 0\nheight_mm = 2\ndiameter_mm = 8\ninner_diameter_mm = 6\nerosion_factor = 0.1\n";
  const std::string weak =
      "[[region]]\nshape = \"cylinder\"\nz_mm = 0\nheight_mm = 5\ndiameter_mm = 4\nerosion_factor = 0.1\nbottom_factor = 0\nskin_mm = 1\n";
  std::vector<std::string> shapes{weak, kBall, kBall + kShaft, kShaft + kBall, tube};
  if (test::kSanitized) shapes.resize(1);
  for (const std::string& regions : shapes) {
    const ToolSpec spec = spec_of(regions);
    const auto field = make_cutting_field(spec, cutting_field_size(kVoxel, 1e-3));
    REQUIRE(field.ok());
    CHECK(wrong(spec, *field, 0.1 * kVoxel) < 0.002);  // sharp edges are rounded
    CHECK(field->bounds.lo.z >= 0.0);
  }
}

TEST_CASE("cutting field: factors go on outside as they are at the surface, and nothing that cuts makes nothing") {
  const auto field = make_cutting_field(spec_of(kBall + "axis_factor = 0.2\n"), cutting_field_size(kVoxel, 2e-3));
  REQUIRE(field.ok());
  for (const double r : {0.5e-3, 1.5e-3, 1.9e-3})
    CHECK(std::abs(between(*field, field->factor, Vec3(r, 0.0, 2e-3)) - 0.1 * (0.2 + 0.8 * std::max(0.0, r - 0.25e-3) / 1.75e-3)) <
          0.006);  // a kink at the core
  CHECK(std::abs(between(*field, field->factor, Vec3(2.3e-3, 0.0, 2e-3)) - 0.1) < 0.01);
  CHECK(make_cutting_field(spec_of("[[region]]\nshape = \"sphere\"\nz_mm = 0\ndiameter_mm = 4\nerosion_factor = 0\n"),
                           cutting_field_size(kVoxel, 2e-3))
            ->empty());
}

TEST_CASE("cutting field: a closed surface has the distances of the solid that it bounds, between its cutting heights") {
  // A box of 4 x 3 x 5 mm on its tip, which cuts from 1 to 4 mm.
  SurfaceMesh mesh;
  for (const Vec3& corner : Bounds{{-2e-3, -1.5e-3, 0.0}, {2e-3, 1.5e-3, 5e-3}}.corners()) mesh.positions.push_back(corner);
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  REQUIRE_FALSE(mesh_error(mesh).has_value());
  MeshToolSpec spec;
  spec.erosion_factor = 0.1;
  spec.cut_from = 1e-3;
  spec.cut_to = 4e-3;
  const auto field = make_mesh_cutting_field(spec, mesh, cutting_field_size(kVoxel, 1.5e-3));
  REQUIRE(field.ok());
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 5000; ++n) {
    const Vec3 u(uniform11(5, 3 * n), uniform11(5, 3 * n + 1), uniform01(5, 3 * n + 2));
    const Vec3 p = u * Vec3(2.4e-3, 1.9e-3, 4.5e-3);
    const double d = std::max({std::abs(p.x) - 2e-3, std::abs(p.y) - 1.5e-3, 1e-3 - p.z, p.z - 4e-3});
    // Beside edges the maximum is not the distance, and interpolation rounds them and where two faces are equally near.
    const Vec3 faces(std::abs(std::abs(p.x) - 2e-3), std::abs(std::abs(p.y) - 1.5e-3),
                     std::min(std::abs(p.z - 1e-3), std::abs(p.z - 4e-3)));
    const double second = faces.x + faces.y + faces.z - std::min({faces.x, faces.y, faces.z}) - std::max({faces.x, faces.y, faces.z});
    if (second < 3.0 * field->pitch || std::abs(d) > 0.1e-3) continue;
    worst = std::max(worst, std::abs(between(*field, field->distance, p) - d));
  }
  CHECK(worst < 1e-7);  // flat faces are interpolated exactly: float rounding
  spec.erosion_factor = 0.0;
  CHECK(make_mesh_cutting_field(spec, mesh, cutting_field_size(kVoxel, 1.5e-3))->empty());
}

TEST_CASE("cutting field: a tool has one when asked, and sizes out of range are refused") {
  const auto document = TomlDocument::parse("title = \"Bit\"\n[shell]\npitch_mm = 0.4\n" + kBall, "bit.toml");
  Issues issues;
  CHECK(make_tool(*document, {}, issues)->cutting == nullptr);
  const auto tool = make_tool(*document, {.cutting_voxel = kVoxel}, issues);
  REQUIRE(tool.has_value());
  REQUIRE(tool->cutting != nullptr);
  CHECK(tool->cutting->pitch <= 0.5 * kVoxel);
  for (const CuttingFieldSize& size : {CuttingFieldSize{0.0, 1e-3}, {-1.0, 1e-3}, {std::nan(""), 1e-3}, {1e-4, -1.0}, {1e-8, 1e-3}})
    CHECK_FALSE(make_cutting_field(spec_of(kBall), size).ok());
}
