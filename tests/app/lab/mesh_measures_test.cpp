// The measures of a mesh against bodies of which every figure is known, each with a twin that is wrong in one place.
#include "app/lab/mesh_measures.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "app/lab/mesh_bodies.h"

using namespace burrhole;

namespace {

/// A ball of triangles: an octahedron, each triangle cut into four `times` times, corners on the sphere.
SurfaceMesh make_sphere(double radius, int times) {
  SurfaceMesh out;
  out.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  out.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(out.positions.size()));
      if (fresh) out.positions.push_back(glm::normalize(out.positions[a] + out.positions[b]));
      return place->second;
    };
    std::vector<std::uint32_t> finer;
    for (std::size_t t = 0; t < out.indices.size(); t += 3) {
      const std::uint32_t a = out.indices[t], b = out.indices[t + 1], c = out.indices[t + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    out.indices = finer;
  }
  for (Vec3& p : out.positions) p *= radius;
  return out;
}

KnownSurface ball_of(double radius) {
  return {.value = [radius](const Vec3& p) { return glm::length(p) - radius; },
          .is_distance = true,
          .bounds = {Vec3(-radius - 2.0), Vec3(radius + 2.0)}};
}

/// The same surface by a function that is no distance.
KnownSurface level_of_ball(double radius) {
  KnownSurface out = ball_of(radius);
  out.value = [radius](const Vec3& p) { return std::tanh(0.01 * (glm::dot(p, p) - radius * radius)); };
  out.is_distance = false;
  return out;
}

SurfaceMesh cube() {
  SurfaceMesh out;
  for (unsigned n = 0; n < 8; ++n) out.positions.emplace_back(2.0 * Vec3(cell_corner(n)));
  out.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return out;
}

}  // namespace

TEST_CASE("mesh measures: a cube has its volume and right angles halved, and no hole") {
  const MeshShape shape = measure_mesh_shape(cube());
  CHECK(shape.triangles == 12);
  CHECK(shape.border_edges == 0);
  CHECK(shape.non_manifold_edges == 0);
  CHECK(std::abs(shape.volume - 8.0) < 1e-12);
  CHECK(std::abs(shape.least_angle_deg - 45.0) < 1e-9);
  CHECK(shape.below_20_percent == 0.0);
}

TEST_CASE("mesh measures: sabotage of the cube shows in the figure that it changes") {
  SurfaceMesh open = cube();
  open.indices.resize(open.indices.size() - 3);
  CHECK(measure_mesh_shape(open).border_edges == 3);
  SurfaceMesh fin = cube();  // a triangle on an edge of two others
  fin.positions.emplace_back(1.0, -1.0, -1.0);
  fin.indices.insert(fin.indices.end(), {0, 1, 8});
  CHECK(measure_mesh_shape(fin).non_manifold_edges == 1);
  SurfaceMesh tall = cube();  // angles of 1 : 10 in the eight triangles of the sides
  for (Vec3& p : tall.positions) p.z *= 10.0;
  CHECK(std::abs(measure_mesh_shape(tall).least_angle_deg - std::atan(0.1) * 180.0 / std::numbers::pi) < 1e-9);
  CHECK(std::abs(measure_mesh_shape(tall).below_20_percent - 100.0 * 8.0 / 12.0) < 1e-9);
  SurfaceMesh turned = cube();
  for (std::size_t n = 0; n < turned.indices.size(); n += 3) std::swap(turned.indices[n], turned.indices[n + 1]);
  CHECK(std::abs(measure_mesh_shape(turned).volume + 8.0) < 1e-12);
}

TEST_CASE("mesh measures: a point is at its distance from a triangle above it, beside an edge and beyond a corner") {
  const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 3, 0)};
  CHECK(std::abs(distance_to_triangle({1, 1, -2}, corners) - 2.0) < 1e-12);
  CHECK(std::abs(distance_to_triangle({2, -3, 4}, corners) - 5.0) < 1e-12);
  CHECK(std::abs(distance_to_triangle({-2, -1, 2}, corners) - 3.0) < 1e-12);
  CHECK(std::abs(distance_to_triangle({4, 3, 0}, corners) - 12.0 / 5.0) < 1e-12);                     // from the long side
  CHECK(std::abs(distance_to_triangle({1, 2, 0}, {Vec3(0), Vec3(0), Vec3(4, 0, 0)}) - 2.0) < 1e-12);  // no area
}

TEST_CASE("mesh measures: a sphere a quarter of a voxel off is a quarter of a voxel away, in both directions and by both truths") {
  constexpr double kRadius = 9.0;
  const SurfaceMesh mesh = make_sphere(kRadius + 0.25, 5);
  // Edges of up to 0.07 radius: the middle of a triangle lies (0.07 / sqrt(3))^2 / 2 of the radius lower, 0.008 voxel.
  constexpr double kChord = 0.015;
  for (const KnownSurface& surface : {ball_of(kRadius), level_of_ball(kRadius)}) {
    const std::vector<KnownPoint> points = sample_surface(surface);
    for (const MeshDistance& d : {distance_to_surface(mesh, surface, points), distance_to_mesh(points, mesh)}) {
      CHECK(std::abs(d.mean - 0.25) < kChord);
      CHECK(std::abs(d.p99 - 0.25) < kChord);
      CHECK(std::abs(d.most - 0.25) < kChord);
    }
  }
}

TEST_CASE("mesh measures: one corner that is moved shows in the largest distance, and a missing part only from the surface") {
  const KnownSurface surface = ball_of(9.0);
  const std::vector<KnownPoint> points = sample_surface(surface);
  SurfaceMesh spike = make_sphere(9.0, 4);
  spike.positions[4] *= 12.0 / 9.0;
  CHECK(std::abs(distance_to_surface(spike, surface, points).most - 3.0) < 1e-9);
  CHECK(distance_to_surface(spike, surface, points).p99 < 0.1);
  SurfaceMesh half;  // the upper hemisphere
  const SurfaceMesh whole = make_sphere(9.0, 4);
  half.positions = whole.positions;
  for (std::size_t n = 0; n < whole.indices.size(); n += 3) {
    const auto* t = &whole.indices[n];
    if (whole.positions[t[0]].z + whole.positions[t[1]].z + whole.positions[t[2]].z < 0.0) continue;
    half.indices.insert(half.indices.end(), t, t + 3);
  }
  CHECK(distance_to_surface(half, surface, points).most < 0.05);
  // From the lower pole to the rim; the nearest line is half a diagonal of the lines' square from the pole at most, 0.36 voxel, at 45 degrees.
  CHECK(std::abs(distance_to_mesh(points, half).most - 9.0 * std::sqrt(2.0)) < 0.25);
}

TEST_CASE("mesh measures: points of a surface lie on it and stand for equal areas, and lines find its volume") {
  constexpr double kRadius = 9.0;
  for (const KnownSurface& surface : {ball_of(kRadius), level_of_ball(kRadius)}) {
    const std::vector<KnownPoint> points = sample_surface(surface);
    double weight = 0.0, caps = 0.0;
    for (const KnownPoint& point : points) {
      CHECK(std::abs(glm::length(point.at) - kRadius) < 1e-7);
      CHECK(glm::dot(point.normal, point.at) / kRadius > 0.999999);
      weight += point.weight;
      if (std::abs(point.at.z) > 0.5 * kRadius) caps += point.weight;
    }
    // Archimedes: area goes with height. Lines half a voxel apart miss a percent where the surface runs along them.
    CHECK(std::abs(caps / weight - 0.5) < 0.01);
    CHECK(std::abs(weight * kLinePitch * kLinePitch / (4.0 * std::numbers::pi * kRadius * kRadius) - 1.0) < 0.01);
    CHECK(std::abs(volume_of(surface) / (4.0 / 3.0 * std::numbers::pi * kRadius * kRadius * kRadius) - 1.0) < 2e-4);
  }
}

TEST_CASE("mesh bodies: the volume is that of the closed form, and before differs from after in the changed box only") {
  for (const std::string& name : mesh_body_names()) {
    CAPTURE(name);
    const auto body = make_mesh_body(name);
    REQUIRE(body.ok());
    CHECK(std::abs(volume_of(body->surface) / body->volume - 1.0) < 1e-3);
    std::size_t changed = 0, outside = 0;
    for_each_voxel(body->box, [&](const Vec3i& v) {
      const std::size_t n = body->box.offset_of(v);
      if (body->before[n] == body->after[n]) return;
      ++changed;
      if (!body->changed.contains(v)) ++outside;
      CHECK(body->before[n] > body->after[n]);
    });
    CHECK(changed > 300);
    CHECK(outside == 0);
  }
  CHECK(!make_mesh_body("cube").ok());
}

TEST_CASE("mesh bodies: the distance to the slab is that of the nearest of many points of its surface") {
  const auto body = make_mesh_body("slab");
  REQUIRE(body.ok());
  const std::vector<KnownPoint> points = sample_surface(body->surface);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(3, -4, 12), Vec3(20, 5, 1), Vec3(-9, 9, -14), Vec3(26, 2, 14), Vec3(1, 12, 4)}) {
    double nearest = 1e30;
    for (const KnownPoint& point : points) nearest = std::min(nearest, glm::length(p - point.at));
    CHECK(std::abs(std::abs(body->surface.value(p)) - nearest) < 0.25);  // half of the lines' pitch
  }
}

TEST_CASE("mesh models: the middle is the same for all sizes, so that an update does the same work") {
  MeshModel small = make_mesh_model(64), large = make_mesh_model(96);
  CHECK(small.box_before == large.box_before);
  CHECK(small.box_after == large.box_after);
  CHECK(small.box_before != small.box_after);
  const std::vector<float> before = small.density;
  small.set_after();
  CHECK(small.density != before);
  small.set_before();
  CHECK(small.density == before);
}
