// Flakes of chips: closed, outward, with the volume of their bone, within the ball of their particle, and the same in every picture.

#include "app/view/debris_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace burrhole::test {
namespace {

double volume_of(const AddedMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += glm::dot(Vec3(mesh.vertices[t[0]]), glm::cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]))) / 6.0;
  return sum;
}

AddedMesh mesh_of(const std::vector<ShownDebris>& particles) {
  AddedMesh out;
  append_debris(particles, glm::vec3(0.0f, 0.0f, -1.0f), out);
  return out;
}

}  // namespace

TEST_CASE(
    "debris mesh: flakes are closed and outward and have their part of the volume of the bone, lying or flying; of mist a small part") {
  for (const bool settled : {true, false}) {
    const AddedMesh mesh = mesh_of({{.volume = 0.05e-9f, .radius = 0.3e-3f, .number = 7, .settled = settled}});
    CHECK(mesh.triangles.size() == 4 * kMostFlakesOfOne);
    CHECK(mesh.vertices.size() == mesh.colors.size());
    // Sums of floats: 6e-8 of the distance of a corner, up to 1 mm, is 1e-6 of a flake of 0.06 mm; its volume has three such factors.
    CHECK(volume_of(mesh) == doctest::Approx(kFlakeVolume * 0.05e-9).epsilon(1e-5));
    // The centres are in the ball; a flake reaches its own size beyond it.
    double farthest = 0.0;
    for (const glm::vec3& v : mesh.vertices) farthest = std::max(farthest, static_cast<double>(glm::length(v)));
    CHECK(farthest < (settled ? 1.5 : kFlyingSpread) * 0.3e-3 + 1e-3);
  }
  const AddedMesh mist = mesh_of({{.volume = 0.005e-9f, .radius = 0.1e-3f, .number = 7, .is_mist = true}});
  CHECK(volume_of(mist) > 0.0);
  CHECK(volume_of(mist) < 0.05 * 0.005e-9);
  CHECK(mesh_of({}).triangles.empty());
}

TEST_CASE(
    "debris mesh: many particles have fewer flakes each, with the same volume; a particle has the same flakes wherever it is in the list") {
  std::vector<ShownDebris> particles;
  for (std::uint32_t n = 0; n < kMostFlakes; ++n)
    particles.push_back(
        {.position = glm::vec3(1e-3f * static_cast<float>(n % 5)), .volume = 1e-11f, .radius = 1e-4f, .number = n, .settled = true});
  const AddedMesh mesh = mesh_of(particles);
  CHECK(mesh.triangles.size() == 4 * particles.size());
  std::ranges::reverse(particles);
  const AddedMesh turned = mesh_of(particles);
  CHECK(mesh.vertices.front() == turned.vertices[turned.vertices.size() - 4]);
}

TEST_CASE("debris mesh: a picture's source says whether the next picture differs") {
  auto site = DebrisSite::create({Vec3(-2e-3), Vec3(2e-3)}, Affine::scaling(1e-3, Vec3(0.0)), {Vec3i(0), Vec3i(0)}, 0.5e-3, Vec3(0, 0, -1));
  REQUIRE(site);
  auto field = DebrisField::create({}, std::move(*site));
  REQUIRE(field);
  DebrisPicture picture(*field);
  CHECK(picture.copy_for_picture(false));
  CHECK_FALSE(picture.copy_for_picture(false));
  field->step({.dt = 1e-3, .removed = 1e-9, .bit = {.radius = 0.5e-3, .height = 0.5e-3}});
  CHECK(picture.copy_for_picture(false));
  AddedMesh mesh;
  picture.append_mesh(mesh);
  CHECK(mesh.triangles.size() == 4 * kMostFlakesOfOne * field->particles().size());
}

}  // namespace burrhole::test
