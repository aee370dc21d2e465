// Wet bone in pictures: the disc that a ball cuts from a face, a shaft that stays dry below the tip; colours darker than dry bone; nothing without
// flow. A tip that is displaced, and a ball of another radius, are noticed.
#include "app/view/saline_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burrhole::test {
namespace {

constexpr double kEdge = 0.25e-3, kReach = 5e-3, kLift = 0.25 * kEdge, kRipple = 8e-5;  // [m]
constexpr Rgba8 kDry{200, 180, 160, 10};

/// Bone below z = 0, with a shaft of 2 mm radius along z through all of it.
float with_shaft(const Vec3& p) { return p.z < 0.0 && std::hypot(p.x, p.y) > 2e-3 ? 1.0f : 0.0f; }
float whole(const Vec3& p) { return p.z < 0.0 ? 1.0f : 0.0f; }

template <class Bone>
SalinePicture make(const Affine& frame, const Bone& bone) {
  const VoxelBox box{Vec3i(-32), Vec3i(32)};
  std::vector<float> density;
  for_each_voxel(box, [&](const Vec3i& voxel) { density.push_back(bone(frame * Vec3(voxel))); });
  SalinePicture out(box, std::vector<Rgba8>(box.count(), kDry), frame);
  out.set_bone(box, density);
  return out;
}

AddedMesh mesh_of(SalinePicture& picture) {
  (void)picture.copy_for_picture(false);
  AddedMesh out;
  picture.append_mesh(out);
  REQUIRE(out.colors.size() == out.vertices.size());
  return out;
}

double area_of(const AddedMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * static_cast<double>(glm::length(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a])));
  return sum;
}

/// Farthest vertex beyond the sphere of the reach, and how far the edge stays inside it [m].
struct Fit {
  double beyond = -1.0, within = -1.0;
};
Fit fit_of(const AddedMesh& mesh, const Vec3& tip, double reach) {
  Fit out;
  std::array<double, 36> edge{};  // farthest distance in each direction
  for (const glm::vec3& v : mesh.vertices) {
    const Vec3 way = Vec3(v) - tip;
    out.beyond = std::max(out.beyond, glm::length(way) - reach);
    const auto sector = static_cast<std::size_t>((std::atan2(way.y, way.x) / (2.0 * std::numbers::pi) + 0.5) * 35.999);
    edge[sector] = std::max(edge[sector], glm::length(way));
  }
  for (const double far : edge) out.within = std::max(out.within, reach - far);
  return out;
}

}  // namespace

TEST_CASE("saline mesh: on a level face it is the disc within reach of the tip, whole, in mirrored frames too") {
  // The face is at z = 0, half a voxel over the last centres.
  for (const Affine& frame :
       {Affine::scaling(kEdge, Vec3(0.0, 0.0, 0.5 * kEdge)),
        Affine{Mat3(Vec3(-kEdge, 0.0, 0.0), Vec3(0.0, kEdge, 0.0), Vec3(0.0, 0.0, kEdge)), Vec3(0.0, 0.0, 0.5 * kEdge)}}) {
    SalinePicture picture = make(frame, whole);
    const Vec3 tip(0.4e-3, -0.3e-3, -1e-3);
    picture.set_film({.tip = tip, .reach = kReach, .below = kEdge});
    const AddedMesh mesh = mesh_of(picture);
    REQUIRE(mesh.triangles.size() > 1000);
    // The lifted face is 1.0625 mm over the tip. Edges are cut straight, which is exact to a voxel^2 / (8 R). Ripples rise by up to 0.08 mm
    // and stretch the area by the mean of their squared slope over 2: 2 waves of 0.02 mm x 3000 / m with factors of 1.2 to 1.4, 0.4 %.
    const double over = 1e-3 + kLift, exact = std::numbers::pi * (kReach * kReach - over * over);
    CHECK(std::abs(area_of(mesh) / exact - 1.0) < 0.015);
    const double slack = kRipple + kEdge * kEdge / (8.0 * kReach) + 1e-6;
    const Fit fit = fit_of(mesh, tip, kReach);
    CHECK(fit.beyond < slack);
    CHECK(fit.within < slack);
    for (const glm::vec3& p : mesh.vertices) {
      CHECK(p.z > kLift - 1e-6);
      CHECK(p.z < kLift + kRipple + 1e-6);
    }
    std::size_t glints = 0;
    for (const Rgba8& color : mesh.colors) {
      CHECK(color.a == 255);
      glints += color.r < kDry.r && color.g < kDry.g && color.b < kDry.b ? 0 : 1;
    }
    CHECK(glints > 0);
    CHECK(glints < mesh.colors.size() / 5);
    for (const auto& [a, b, c] : mesh.triangles)
      CHECK(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]).z >= 0.0f);
    // The sabotage: a tip a millimetre aside, a reach of 10 % less.
    CHECK(fit_of(mesh, tip + Vec3(1e-3, 0.0, 0.0), kReach).beyond > slack);
    CHECK(fit_of(mesh, tip, 0.9 * kReach).beyond > slack);
  }
}

TEST_CASE("saline mesh: the wall of a hole is wet above the tip and dry below it") {
  SalinePicture picture = make(Affine::scaling(kEdge, Vec3(0.0, 0.0, 0.5 * kEdge)), with_shaft);
  for (const double depth : {1.5e-3, 3e-3}) {
    picture.set_film({.tip = {0.0, 0.0, -depth}, .reach = kReach, .below = kEdge});
    const AddedMesh mesh = mesh_of(picture);
    double lowest = 1.0;
    for (const glm::vec3& p : mesh.vertices) lowest = std::min(lowest, static_cast<double>(p.z));
    CHECK(lowest > -depth - kEdge - kRipple);
    CHECK(lowest < -depth - kEdge + kRipple);
  }
}

TEST_CASE("saline mesh: without flow there is nothing; a picture changes with the tip, with bone that is wet, and when the flow stops") {
  SalinePicture picture = make(Affine::scaling(kEdge, Vec3(0.0)), whole);
  CHECK(picture.copy_for_picture(false));  // the first
  CHECK_FALSE(picture.copy_for_picture(false));
  CHECK(mesh_of(picture).triangles.empty());
  picture.set_film({.reach = kReach, .below = kEdge});
  CHECK(picture.copy_for_picture(false));
  CHECK_FALSE(picture.copy_for_picture(false));
  picture.set_film({.tip = {1e-3, 0.0, 0.0}, .reach = kReach, .below = kEdge});
  CHECK(picture.copy_for_picture(false));
  picture.set_film({.tip = {1.01e-3, 0.0, 0.0}, .reach = kReach, .below = kEdge});  // too little to be seen, but not for an exact copy
  CHECK_FALSE(picture.copy_for_picture(false));
  CHECK(picture.copy_for_picture(true));
  CHECK_FALSE(picture.copy_for_picture(true));
  const VoxelBox gone{Vec3i(-4), Vec3i(4)};
  picture.set_bone(gone, std::vector<float>(gone.count(), 0.0f));
  CHECK(picture.copy_for_picture(false));
  picture.set_film({});
  CHECK(picture.copy_for_picture(false));
  CHECK(mesh_of(picture).triangles.empty());
  // A tip far from the bone wets nothing.
  picture.set_film({.tip = {0.0, 0.0, 1.0}, .reach = kReach, .below = kEdge});
  CHECK(mesh_of(picture).triangles.empty());
}

}  // namespace burrhole::test
