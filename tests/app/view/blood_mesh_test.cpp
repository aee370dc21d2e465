// The picture of blood in a bored cylinder: the pool's area and height, beads on the wall where its pores are, wax in their place.
#include "app/view/blood_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace burrhole;

namespace {

constexpr double kEdge = 0.25e-3, kRadius = 4e-3, kBottom = 4e-3;

/// A block with its top at z = 0; only the bone between -1.5 and -2.5 mm has pores.
SiteBone block(const Vec3& down) {
  SiteBone out{.box = {Vec3i(-26, -26, -26), Vec3i(27, 27, 6)},
               .bone_from_index = Affine::scaling(kEdge, Vec3(0.0, 0.0, 0.5 * kEdge)),
               .down = down};
  for_each_voxel(out.box, [&](const Vec3i& voxel) {
    const double z = (out.bone_from_index * Vec3(voxel)).z;
    out.whole.push_back(z < 0.0 ? 1.0f : 0.0f);
    out.pores.push_back(z < -1.5e-3 && z > -2.5e-3 ? 0.8f : 0.0f);
    out.outside.push_back(z < 0.0 ? 0 : 1);
  });
  out.start = out.whole;
  return out;
}

struct Drawn {
  explicit Drawn(const Vec3& down = {0.0, 0.0, -1.0}) : site(block(down)) {
    std::vector<float> left;
    for_each_voxel(site.box().grown(1), [&](const Vec3i& voxel) {
      const Vec3 p = site.bone().bone_from_index * Vec3(voxel);
      const double depth = std::min(kRadius - std::hypot(p.x, p.y), p.z + kBottom) / kEdge;
      left.push_back(p.z < 0.0 ? static_cast<float>(std::clamp(0.5 - 0.5 * depth, 0.0, 1.0)) : 0.0f);
    });
    site.update(site.box(), left, 0.0, 1e9);
  }
  /// @param share of the hole's volume that is filled.
  [[nodiscard]] AddedMesh mesh(double share, double blood, double wetness) const {
    BloodPicture picture{.removed = {site.removed().begin(), site.removed().end()},
                         .pore_area = {site.pore_area().begin(), site.pore_area().end()},
                         .waxed = {site.waxed().begin(), site.waxed().end()},
                         .level = site.level_of(share * site.capacity()),
                         .blood = blood,
                         .wetness = wetness};
    AddedMesh out;
    append_blood(site.bone(), picture, out);
    CHECK(out.colors.size() == out.vertices.size());
    for (const auto& triangle : out.triangles)
      for (const std::uint32_t n : triangle) REQUIRE(n < out.vertices.size());
    for (const glm::vec3& p : out.vertices) REQUIRE(is_finite(Vec3(p)));
    return out;
  }
  BloodSite site;
};

double area_of(const AddedMesh& mesh, const Vec3& up) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * glm::dot(up, glm::cross(Vec3(mesh.vertices[b] - mesh.vertices[a]), Vec3(mesh.vertices[c] - mesh.vertices[a])));
  return sum;
}

}  // namespace

TEST_CASE("blood mesh: the pool is level, has the area of the hole, and faces up; with its ground it is closed, under any gravity") {
  for (const Vec3& down : {Vec3(0.0, 0.0, -1.0), glm::normalize(Vec3(0.2, -0.1, -1.0))}) {
    const Drawn drawn(down);
    const AddedMesh mesh = drawn.mesh(0.6, 1.0, 0.0);
    REQUIRE_FALSE(mesh.triangles.empty());
    const double level = drawn.site.level_of(0.6 * drawn.site.capacity());
    // The first half of the mesh is the surface, the second the ground of the liquid.
    AddedMesh surface = mesh;
    surface.triangles.resize(mesh.triangles.size() / 2);
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      const double height = -glm::dot(down, Vec3(mesh.vertices[n]));
      CHECK(height < level + 0.35e-3);                                    // the rise at the wall
      if (n < mesh.vertices.size() / 2) CHECK(height > level - 0.07e-3);  // ripples
      CHECK(height > drawn.site.floor() - kEdge);
    }
    // Its edge is where the density is 0.6, 0.05 mm in the bone of a ramp of two voxels.
    const double area = area_of(surface, -down), exact = std::numbers::pi * kRadius * kRadius / std::abs(down.z);
    CHECK(area == doctest::Approx(exact).epsilon(0.04));
    CHECK(std::abs(area_of(mesh, -down)) < 0.01 * exact);  // closed
  }
}

TEST_CASE("blood mesh: thin blood is not drawn; a dry hole has no triangle") {
  const Drawn drawn;
  CHECK(drawn.mesh(0.01, 1.0, 0.0).triangles.empty());  // 0.04 mm deep
  CHECK(drawn.mesh(0.6, 0.05, 0.0).triangles.empty());  // 2.4 mm x 0.05
  CHECK(drawn.mesh(0.6, 0.0, 0.0).triangles.empty());
}

TEST_CASE("blood mesh: beads lie on the wall where its pores are, above the pool; runs go down from them; wax takes their place") {
  Drawn drawn;
  const AddedMesh beads = drawn.mesh(0.0, 0.0, 0.4), runs = drawn.mesh(0.0, 0.0, 0.9);
  REQUIRE_FALSE(beads.triangles.empty());
  const auto lowest = [](const AddedMesh& mesh) {
    double out = 1.0;
    for (const glm::vec3& p : mesh.vertices) out = std::min(out, static_cast<double>(p.z));
    return out;
  };
  for (const glm::vec3& p : beads.vertices) {
    CHECK(std::abs(std::hypot(p.x, p.y) - kRadius) < 1.5 * kEdge);
    CHECK(p.z < -1.5e-3 + 1.5 * kEdge);
    CHECK(p.z > -2.5e-3 - 1.5 * kEdge);
  }
  CHECK(lowest(runs) < -kBottom + 0.8e-3);
  CHECK(runs.triangles.size() > beads.triangles.size());
  // The pool at -1.2 mm covers them.
  const AddedMesh under = drawn.mesh(0.7, 1.0, 0.4);
  CHECK(std::ranges::none_of(under.colors, [](const Rgba8& c) { return c.r > 100; }));
  CHECK(std::ranges::all_of(beads.colors, [](const Rgba8& c) { return c.r > 3 * c.g && c.a > 200; }));
  (void)drawn.site.wax(0.5e-3);
  const AddedMesh waxed = drawn.mesh(0.0, 0.0, 0.0);
  REQUIRE_FALSE(waxed.triangles.empty());
  CHECK(std::ranges::all_of(waxed.colors, [](const Rgba8& c) { return c.g > 150 && c.a < 100; }));
}

TEST_CASE("blood mesh: a film is one layer on the pores, of their area when all is wet, less when it is drier; wax is a thicker one") {
  Drawn drawn;
  // The band of pores, 1 mm wide, without drops and runs: triangles that share no vertex with the first and largest part of the mesh.
  const auto film_of = [&](double wetness) {
    const AddedMesh mesh = drawn.mesh(0.0, 0.0, wetness);
    double area = 0.0;
    std::size_t outwards = 0, all = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 p(mesh.vertices[a]), normal = 0.5 * glm::cross(Vec3(mesh.vertices[b]) - p, Vec3(mesh.vertices[c]) - p);
      if (mesh.colors[a] == mesh.colors[b] && mesh.colors[b] == mesh.colors[c]) continue;  // a drop or a run has one colour
      area += glm::length(normal);
      outwards += glm::dot(normal, Vec3(p.x, p.y, 0.0)) < 0.0 ? 1 : 0;
      ++all;
    }
    // Towards the axis: the film faces the hole; its bumps have slopes below 0.3. Slivers along its edge may be flat by rounding: 1 %.
    CHECK(outwards > all * 99 / 100);
    return area;
  };
  // When all is wet the edge is where there is at most 0.12 + 0.12 of what a face of pores has. Straight at the end of the pores, 0.8 of a voxel, there
  // is half of 0.8: it lies beyond them everywhere, by up to 1.5 voxels on both sides.
  const double band = 2.0 * std::numbers::pi * kRadius * 1e-3, beside = 2.0 * std::numbers::pi * kRadius * 3.0 * kEdge;
  const double dry = film_of(0.02), half = film_of(0.3), wet = film_of(1.0);
  CHECK(wet > band);
  CHECK(wet < band + beside);
  CHECK(half < wet);
  CHECK(dry < half);
  (void)drawn.site.wax(0.5e-3);
  const AddedMesh waxed = drawn.mesh(0.0, 0.0, 0.0);
  double farthest = 0.0, nearest = 1.0;
  for (const glm::vec3& p : waxed.vertices) {
    farthest = std::max(farthest, std::hypot(static_cast<double>(p.x), static_cast<double>(p.y)));
    nearest = std::min(nearest, std::hypot(static_cast<double>(p.x), static_cast<double>(p.y)));
  }
  // Half a voxel over the surface, with bumps of 0.04 mm.
  CHECK(farthest < kRadius + 0.3 * kEdge);
  CHECK(nearest > kRadius - 1.2 * kEdge);
}
