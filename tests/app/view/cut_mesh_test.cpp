// A mesh cut by a plane is closed: its volume and the area of its section have a closed form.
#include "app/view/cut_mesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/tool/make_tool.h"
#include "core/tool/tool_surface.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

void add_box(TriangleMesh& mesh, const Vec3& lo, const Vec3& hi) {
  // Faces by their normals; u x v = normal.
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      Vec3 normal(0.0), corner = high ? hi : lo, u(0.0), v(0.0);
      normal[axis] = high ? 1.0 : -1.0;
      const std::size_t a = (axis + (high ? 1 : 2)) % 3, b = (axis + (high ? 2 : 1)) % 3;
      corner[a] = lo[a];
      corner[b] = lo[b];
      u[a] = hi[a] - lo[a];
      v[b] = hi[b] - lo[b];
      for (const Vec3& p : {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v}) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.emplace_back(p);
        mesh.normals.emplace_back(normal);
      }
    }
}

struct Measure {
  double volume = 0.0, section = 0.0;
  Vec3 area{0.0};
};

/// Volume by the divergence theorem, the area of what faces `normal` in the plane, and the sum of all areas, which is zero of a closed surface.
Measure measure(const TriangleMesh& mesh, const Vec3& normal, double offset) {
  Measure out;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const auto at = [&](std::size_t n) { return Vec3(mesh.positions[mesh.indices[t + n]]); };
    const Vec3 area = 0.5 * glm::cross(at(1) - at(0), at(2) - at(0));
    out.volume += glm::dot(at(0), area) / 3.0;
    out.area += area;
    const Vec3 middle = (at(0) + at(1) + at(2)) / 3.0;
    if (std::abs(glm::dot(middle, normal) - offset) < 1e-7 && glm::dot(area, normal) > 0.0) out.section += glm::dot(area, normal);
  }
  return out;
}

}  // namespace

TEST_CASE("cut mesh: of a box half remains, with the section of the plane") {
  TriangleMesh box;
  add_box(box, Vec3(-2.0, -1.0, -3.0), Vec3(2.0, 1.0, 3.0));
  CHECK(measure(box, Vec3(0, 0, 1), 9.0).volume == doctest::Approx(48.0));
  const Measure half = measure(cut_mesh(box, Vec3(0, -1, 0), 0.25), Vec3(0, -1, 0), 0.25);
  CHECK(half.volume == doctest::Approx(4.0 * 6.0 * 1.25));
  CHECK(half.section == doctest::Approx(24.0));
  CHECK(glm::length(half.area) < 1e-5);
  const Vec3 slant = glm::normalize(Vec3(1.0, 0.0, 1.0));
  const Measure slanted = measure(cut_mesh(box, slant, 0.0), slant, 0.0);
  CHECK(slanted.volume == doctest::Approx(24.0));
  CHECK(slanted.section == doctest::Approx(2.0 * 4.0 * std::numbers::sqrt2));
  CHECK(cut_mesh(box, Vec3(0, 0, 1), -3.5).indices.empty());
  CHECK(cut_mesh(box, Vec3(0, 0, 1), 3.5).indices.size() == box.indices.size());
}

TEST_CASE("cut mesh: surfaces that overlap are filled once, and a tube keeps its bore") {
  TriangleMesh two;
  add_box(two, Vec3(0.0, -1.0, 0.0), Vec3(2.0, 1.0, 2.0));
  add_box(two, Vec3(1.0, -1.0, 1.0), Vec3(3.0, 1.0, 3.0));
  CHECK(measure(cut_mesh(two, Vec3(0, -1, 0), 0.0), Vec3(0, -1, 0), 0.0).section == doctest::Approx(7.0));
  TriangleMesh tube;
  add_box(tube, Vec3(0.0, -1.0, 0.0), Vec3(4.0, 1.0, 4.0));
  TriangleMesh bore;
  add_box(bore, Vec3(1.0, -0.9, 1.0), Vec3(3.0, 0.9, 3.0));
  for (std::size_t t = 0; t < bore.indices.size(); t += 3) std::swap(bore.indices[t], bore.indices[t + 1]);  // faces its cavity
  const auto first = static_cast<std::uint32_t>(tube.positions.size());
  tube.positions.insert(tube.positions.end(), bore.positions.begin(), bore.positions.end());
  tube.normals.insert(tube.normals.end(), bore.normals.begin(), bore.normals.end());
  for (const std::uint32_t at : bore.indices) tube.indices.push_back(first + at);
  CHECK(measure(cut_mesh(tube, Vec3(0, -1, 0), 0.0), Vec3(0, -1, 0), 0.0).section == doctest::Approx(12.0));
}

TEST_CASE("cut mesh: the shipped perforator in section is closed, and half of it") {
  Issues issues;
  const auto tool = load_tool(test::in_source("app/tools/perforator_14_11.toml"), {.erosion_pitch = 0.5e-3}, issues);
  REQUIRE(tool.has_value());
  const TriangleMesh& look = tool->look;
  const Measure whole = measure(look, Vec3(0, 0, 1), 1.0);
  const TriangleMesh cut = cut_mesh(look, Vec3(0, -1, 0), 0.0);
  const Measure half = measure(cut, Vec3(0, -1, 0), 0.0);
  CHECK(std::abs(half.volume / whole.volume - 0.5) < 0.01);
  CHECK(glm::length(half.area) < 1e-3 * half.section);
}

namespace {

/// Area [m^2] of the triangles whose normals have a length.
double area_of_part(const TriangleMesh& mesh, double length) {
  double sum = 0.0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const auto at = [&](std::size_t n) { return Vec3(mesh.positions[mesh.indices[t + n]]); };
    if (std::abs(glm::length(Vec3(mesh.normals[mesh.indices[t]])) - length) < 1e-5)
      sum += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  return sum;
}

}  // namespace

TEST_CASE("cut mesh: a section is split where its parts meet, with the area of each in closed form, in an oblique plane too") {
  TriangleMesh box;
  add_box(box, Vec3(-2.0, -1.0, -3.0), Vec3(2.0, 1.0, 3.0));
  const SectionParts parts{{-1.0}, [](const Vec3& p) { return p.z < -1.0 || (p.x > 0.3 && p.x < 0.7); }};
  for (const Vec3& normal : {Vec3(0.0, -1.0, 0.0), glm::normalize(Vec3(0.0, -1.0, 0.25))}) {
    const double stretch = 1.0 / std::abs(normal.y);  // of lengths along the slope
    const TriangleMesh cut = cut_mesh(box, normal, 0.0, &parts);
    const double cuts = area_of_part(cut, kSectionCuts), body = area_of_part(cut, kSectionBody);
    CHECK(cuts == doctest::Approx((4.0 * 2.0 + 0.4 * 4.0) * stretch).epsilon(1e-5));
    CHECK(body == doctest::Approx((4.0 - 0.4) * 4.0 * stretch).epsilon(1e-5));
    CHECK(measure(cut, normal, 0.0).section == doctest::Approx(cuts + body).epsilon(1e-6));
  }
  const TriangleMesh plain = cut_mesh(box, Vec3(0.0, -1.0, 0.0), 0.0);
  CHECK(area_of_part(plain, kSectionCuts) + area_of_part(plain, kSectionBody) == 0.0);
}

TEST_CASE("cut mesh: the section of a bit shows its cutting regions, of a twist drill the point and its margins") {
  Issues issues;
  const auto tool = load_tool(test::in_source("app/tools/twist_drill_2_5mm.toml"), {.erosion_pitch = 0.25e-3}, issues);
  REQUIRE(tool.has_value());
  const SectionParts parts{tool->surface->region_heights(), [&](const Vec3& p) { return tool->surface->cuts_at(p); }};
  // The solid that it sweeps: a cone of 0.751 mm on a cylinder of 0.5 mm, both 2.5 mm wide, and a body of 1.67 mm up to 40 mm.
  const TriangleMesh cut = cut_mesh(tool->mesh, Vec3(0.0, -1.0, 0.0), 0.0, &parts);
  CHECK(area_of_part(cut, kSectionCuts) == doctest::Approx(2.5e-3 * (0.5 * 0.751e-3 + 0.5e-3)).epsilon(0.01));
  CHECK(area_of_part(cut, kSectionBody) == doctest::Approx(1.67e-3 * 38.749e-3).epsilon(0.01));
}
