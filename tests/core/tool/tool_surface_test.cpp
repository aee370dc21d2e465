#include "core/tool/tool_surface.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/base/units.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "core/tool/tool_spec.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/shipped_spec.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

const char* const kShipped[] = {"acorn_burr_7_5mm",    "acosta_liu_perforator", "acosta_liu_round", "craniotome_2_3mm",
                                "matchstick_burr_3mm", "perforator_14_11",      "round_burr_2mm",   "round_burr_4mm",
                                "sagittal_saw_12mm",   "trephine_12mm",         "twist_drill_2_5mm"};

Vec3 random_point(std::uint64_t n) {
  return {10e-3 * uniform11(3, 3 * n), 10e-3 * uniform11(3, 3 * n + 1), 10e-3 + 12e-3 * uniform11(3, 3 * n + 2)};
}

}  // namespace

TEST_CASE("tool surface: the nearest place is as far as the outline's distance says, and lies on the surface, for every shipped bit") {
  for (const std::string name : kShipped) {
    CAPTURE(name);
    const ToolSpec spec = test::shipped_spec(name);
    const std::vector<Solid> solids = spec.solids();
    const ToolSurface surface(spec);
    // The outline's distance is of 128 chords an arc: accurate to 1e-4 of the radius.
    constexpr double kAllowed = 1e-4 * 4e-3;
    double worst = 0.0, off_surface = 0.0;
    std::size_t outside = 0;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      const Vec3 p = random_point(n);
      const double distance = signed_distance(solids, spec.outline, p);
      const auto at = surface.nearest(p);
      if (std::abs(distance) > 1e-6) CHECK(at.has_value() == (distance > 0.0));
      if (!at) continue;
      ++outside;
      worst = std::max(worst, std::abs(glm::length(p - *at) - distance));
      off_surface = std::max(off_surface, std::abs(signed_distance(solids, spec.outline, *at)));
    }
    CHECK(outside > 500);
    CHECK(worst < kAllowed);
    CHECK(off_surface < kAllowed);
    // Sabotage: a surface whose solids are 10 um higher is seen.
    ToolSpec moved = spec;
    for (RegionSpec& region : moved.regions) region.solid.z_low += 10e-6, region.solid.z_high += 10e-6;
    const ToolSurface higher(moved);
    double seen = 0.0;
    for (std::uint64_t n = 0; n < 300; ++n)
      if (const auto at = higher.nearest(random_point(n)))
        seen = std::max(seen, std::abs(glm::length(random_point(n) - *at) - signed_distance(solids, spec.outline, random_point(n))));
    CHECK(seen > kAllowed);
  }
}

TEST_CASE("tool surface: points of the shell lie on one face or on a convex edge, with the normals of the outline") {
  for (const std::string name : kShipped) {
    CAPTURE(name);
    Issues issues;
    const auto tool = load_tool(test::in_source("app/tools/") + name + ".toml", {.erosion_pitch = 1e-3}, issues);
    REQUIRE(tool);
    std::size_t faces = 0, edges = 0;
    for (std::size_t n = 0; n < tool->shell.size(); ++n) {
      const Vec3 outward = -tool->shell.inward_normals[n];
      const ToolFaces found = tool->surface->faces_at(tool->shell.positions[n]);
      CHECK(found.cell_radius > 0.0);
      if (found.count == 1) {
        ++faces;
        CHECK(glm::dot(found.face[0].outward, outward) > 0.98);  // where two faces meet almost smoothly the shell has their mean
      } else if (found.count == 2) {
        ++edges;
        const Vec3 mean = glm::normalize(found.face[0].outward + found.face[1].outward);
        CHECK(glm::dot(mean, outward) > 0.999);
      }
    }
    CHECK(faces + edges > tool->shell.size() * 4 / 5);   // corners, and hollow joints such as those of shank and head, have none
    CHECK((edges > 0) == (name != "acosta_liu_round"));  // a ball without a shank
  }
}

TEST_CASE("tool surface: no place is farther from the shell than the radius of its cell") {
  for (const std::string name : kShipped) {
    CAPTURE(name);
    Issues issues;
    const auto tool = load_tool(test::in_source("app/tools/") + name + ".toml", {.erosion_pitch = 1e-3}, issues);
    REQUIRE(tool);
    double worst = 0.0;
    for (std::uint64_t n = 0; n < 400; ++n) {
      const auto at = tool->surface->nearest(random_point(n));
      if (!at) continue;
      double least = 1.0, radius = 0.0;
      for (std::size_t k = 0; k < tool->shell.size(); ++k)
        if (const double d = glm::length(tool->shell.positions[k] - *at); d < least) {
          least = d;
          radius = tool->surface->faces_at(tool->shell.positions[k]).cell_radius;
        }
      worst = std::max(worst, least / radius);
    }
    CHECK(worst <= 1.0);
    CHECK(worst > 0.3);  // or the radius would be far too wide
  }
}

TEST_CASE("tool surface: a mesh gives the same places as a plain search of its triangles, and nothing inside") {
  const Vec3 centre(0.0, 0.0, 3e-3);
  const SurfaceMesh mesh = test::sphere_mesh(centre, 3e-3, 3);
  MeshToolSpec spec;
  spec.pitch = 0.3e-3;
  const ToolSurface surface(spec, mesh);
  for (std::uint64_t n = 0; n < 500; ++n) {
    const Vec3 p = random_point(n);
    const auto at = surface.nearest(p);
    const double out = glm::length(p - centre) - 3e-3;
    if (out < -0.05e-3) CHECK_FALSE(at.has_value());
    if (out < 0.0) continue;
    REQUIRE(at.has_value());
    // 1280 triangles: edges of 0.5 mm, so the middle of one is (0.5 mm / sqrt 3)^2 / (2 x 3 mm) = 14 um inside the sphere.
    CHECK(std::abs(glm::length(p - *at) - out) < 14e-6);
    CHECK(std::abs(glm::length(*at - centre) - 3e-3) < 14e-6);
    double plain = 1.0;
    for (const Vec3& v : mesh.positions) plain = std::min(plain, glm::length(p - v));
    CHECK(glm::length(p - *at) <= plain * (1.0 + 1e-12));
  }
}
