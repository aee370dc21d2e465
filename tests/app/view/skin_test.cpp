// The skin in pictures: the zero surface of a field as triangles, the opening and its edge.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "app/view/site_window.h"
#include "app/view/skin.h"
#include "app/view/surface_nets.h"

namespace burrhole {
namespace {

constexpr double kRadius = 40e-3, kPitch = 2e-3;
const Vec3 kCentre(3.3e-3, -1.7e-3, 0.4e-3);
const Bounds kBox{Vec3(-50e-3), Vec3(50e-3)};

double ball(const Vec3& p) { return glm::length(p - kCentre) - kRadius; }

/// Edges that do not have one triangle on each side.
std::size_t open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3)
    for (std::size_t m = 0; m < 3; ++m) {
      const std::uint32_t from = mesh.indices[n + m], to = mesh.indices[n + (m + 1) % 3];
      sides[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  std::size_t open = 0;
  for (const auto& [edge, sum] : sides) open += sum != 0 ? 1 : 0;
  return open;
}

double volume_of(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const auto at = [&](std::size_t m) { return Vec3(mesh.positions[mesh.indices[n + m]]); };
    sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  return sum;
}

SkinConfig ball_skin() {
  SkinConfig out;
  out.window = 30e-3;
  out.pitch = kPitch;
  out.body = ball;
  out.box = kBox;
  return out;
}
/// From above, with the entry 5 mm below the top of the ball.
Pose from_above() { return {Quat(1, 0, 0, 0), kCentre + Vec3(0.0, 0.0, kRadius - 5e-3)}; }

}  // namespace

TEST_CASE("surface: the triangles of a ball are closed, on its surface, with its normals and its volume") {
  const TriangleMesh mesh = make_surface_mesh(ball, kBox, kPitch);
  REQUIRE(mesh.indices.size() > 3'000);
  CHECK(open_edges(mesh) == 0);
  // Interpolation along the axes of a lattice adds at most three times h^2 / (8 r) to a distance, and floats 1e-8 m.
  const double sagitta = kPitch * kPitch / (8.0 * kRadius);
  double off = 0.0, turned = 0.0;
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) {
    const Vec3 from = Vec3(mesh.positions[n]) - kCentre;
    off = std::max(off, std::abs(glm::length(from) - kRadius));
    turned = std::max(turned, glm::length(Vec3(mesh.normals[n]) - from / glm::length(from)));
  }
  CHECK(off < 3.0 * sagitta + 1e-7);
  CHECK(turned < 4.0 * kPitch * kPitch / (kRadius * kRadius));  // differences over two cells
  // Corners on the ball, faces up to (edge)^2 / (8 r) inside, edges up to twice the pitch.
  const double whole = 4.0 / 3.0 * std::numbers::pi * kRadius * kRadius * kRadius;
  CHECK(std::abs(volume_of(mesh) / whole - 1.0) < 3.0 * 4.0 * sagitta / kRadius);
  CHECK(volume_of(mesh) > 0.0);  // counter-clockwise from outside
}

TEST_CASE("surface: it is open where the box ends, or the field is not known") {
  const TriangleMesh half = make_surface_mesh(ball, {Vec3(-50e-3), Vec3(50e-3, 50e-3, 0.0)}, kPitch);
  CHECK(open_edges(half) > 50);
  const auto known = [](const Vec3& p) { return p.x > 0.0 ? std::nan("") : ball(p); };
  const TriangleMesh unknown = make_surface_mesh(known, kBox, kPitch);
  CHECK(open_edges(unknown) > 50);
  for (const Vec3f& p : unknown.positions) CHECK(p.x <= 0.0f);
  CHECK(make_surface_mesh([](const Vec3&) { return 1.0; }, kBox, kPitch).indices.empty());
}

TEST_CASE("skin: no triangle lies in the opening, the far side of the head is whole, and the cut edge is on the surface round it") {
  for (const bool round : {true, false}) {
    CAPTURE(round);
    SkinConfig config = ball_skin();
    config.round = round;
    const SkinView skin = make_skin(config, from_above());
    REQUIRE(skin.beyond.size() == skin.shell.positions.size());
    const SiteWindow window{config.window, round};
    int inside = 0, below = 0;
    for (std::size_t n = 0; n < skin.shell.indices.size(); n += 3) {
      Vec3 middle(0.0);
      float most = -1.0f;
      for (std::size_t m = 0; m < 3; ++m) {
        middle += Vec3(skin.shell.positions[skin.shell.indices[n + m]]) / 3.0;
        most = std::max(most, skin.beyond[skin.shell.indices[n + m]]);
      }
      const Vec3 p = from_above().inverse() * middle;
      // What is left of a triangle on the edge is cut off where `beyond` is negative.
      inside += p.z > 0.0 && most < 0.0f;
      below += p.z < -kRadius && window.beyond(p) < 0.0;
    }
    CHECK(inside == 0);
    CHECK(below > 100);
    // The opening of 30 mm in a ball of 80 mm is at a height of 40 - sqrt(40^2 - 15^2) = 2.92 mm below the top where it is round.
    REQUIRE(skin.rim.indices.size() == 120u * 6u);
    for (std::size_t n = 0; n < skin.rim.positions.size(); ++n) {
      const Vec3 p = from_above().inverse() * Vec3(skin.rim.positions[n]);
      CHECK(std::abs(window.beyond(p)) < 1e-6);
      if (skin.depth[n] == 0.0f) CHECK(std::abs(ball(Vec3(skin.rim.positions[n]))) < 1e-6);
      if (round && skin.depth[n] == 0.0f) CHECK(std::abs(p.z - (5e-3 - 2.9188e-3)) < 1e-6);
    }
  }
}

}  // namespace burrhole
