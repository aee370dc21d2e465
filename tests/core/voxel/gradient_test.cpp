#include "core/voxel/gradient.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/contact/contact_view.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const VoxelBox kBox{{-2, 1, 3}, {6, 8, 11}};

template <class F>
std::vector<float> field(const VoxelBox& box, F&& f) {
  std::vector<float> density;
  for_each_voxel(box, [&](const Vec3i& v) { density.push_back(static_cast<float>(f(Vec3(v)))); });
  return density;
}

Vec3 direction(std::uint64_t seed) {
  const Vec3 v(uniform11(seed, 0), uniform11(seed, 1), uniform11(seed, 2));
  return glm::normalize(v + Vec3(0.0, 0.0, 1.2));
}

Affine oblique(std::uint64_t seed) {
  Affine a;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r)
      a.linear[c][r] = 1e-3 * (0.35 * uniform11(seed + 50, 3 * c + r) + (c == r ? 0.3 + 0.3 * static_cast<double>(c) : 0.0));
  a.offset = Vec3(0.01, -0.02, 0.03);
  return a;
}

/// Bone whose occupancy is linear in bone coordinates, 0.5 in the middle, rising by 0.4 over 5 voxels against `outward`.
DenseBone ramp(const Affine& bone_from_index, const Vec3& outward) {
  DenseBone dense = random_bone({9, 9, 9}, 1);
  dense.bone_from_index = bone_from_index;
  const double steepest = 0.4 / (5.0 * bone_from_index.longest_edge() * std::sqrt(3.0));
  const Vec3 middle = bone_from_index * Vec3(4.0);
  dense.occupancy =
      field({Vec3i(0), dense.dims}, [&](const Vec3& v) { return 0.5 - steepest * glm::dot(bone_from_index * v - middle, outward); });
  return dense;
}

}  // namespace

TEST_CASE("gradient: a linear ramp has its slopes as gradient everywhere, exactly where they are dyadic") {
  const Vec3 slope(0.0625, -0.03125, 0.015625);
  const auto density = field(kBox, [&](const Vec3& v) { return 0.5 + glm::dot(slope, v); });
  std::vector<Vec3f> gradient(kBox.count(), Vec3f(9.0f));
  update_gradient({kBox, density}, kBox.grown(-1), 0.0f, kBox, gradient);
  for_each_voxel(kBox, [&](const Vec3i& v) {
    const bool target = kBox.grown(-1).contains(v);
    REQUIRE(gradient[kBox.offset_of(v)] == (target ? Vec3f(slope) : Vec3f(9.0f)));
  });
}

TEST_CASE("gradient: the dead zone drops lengths below its value and keeps its value itself") {
  const auto density = field(kBox, [](const Vec3& v) { return 0.5 + 0.03125 * v.x + 0.0 * v.y; });
  std::vector<Vec3f> gradient(kBox.count());
  const auto middle = [&] { return gradient[kBox.offset_of({2, 4, 6})]; };
  update_gradient({kBox, density}, kBox.grown(-1), 0.03125f, kBox, gradient);
  CHECK(middle() == Vec3f(0.03125f, 0.0f, 0.0f));
  update_gradient({kBox, density}, kBox.grown(-1), std::nextafter(0.03125f, 1.0f), kBox, gradient);
  CHECK(middle() == Vec3f(0.0f));
  update_gradient({kBox, density}, kBox.grown(-1), std::nextafter(0.03125f, 0.0f), kBox, gradient);
  CHECK(middle() == Vec3f(0.03125f, 0.0f, 0.0f));
}

TEST_CASE("gradient: an empty target writes nothing") {
  const auto density = field(kBox, [](const Vec3& v) { return 0.05 * v.z; });
  std::vector<Vec3f> gradient(kBox.count(), Vec3f(7.0f));
  update_gradient({kBox, density}, {}, 0.0f, kBox, gradient);
  for (const Vec3f& g : gradient) REQUIRE(g == Vec3f(7.0f));
}

TEST_CASE("gradient: the outward normal of a plane in sheared, anisotropic and turned voxels is the plane's own") {
  double worst = 0.0, least_sabotaged = 10.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    const Affine bone_from_index = oblique(seed);
    const Vec3 outward = direction(seed);
    Voxmap voxmap = make_voxmap(load_bone(ramp(bone_from_index, outward)), 0.0f);
    REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
    ContactWindowPublisher publisher(voxmap);
    publisher.publish(voxmap);
    const Pose world_from_bone{rotation_from_z(direction(seed + 500)), Vec3(0.1, 0.2, -0.3)};
    const ContactView view(publisher.exchange().latest(), bone_from_index, world_from_bone);
    const Vec3 expected = world_from_bone.rotate(outward);
    const Vec3 gradient = Vec3(view.gradient({4, 4, 4}));
    worst = std::max(worst, glm::length(view.outward_normal(gradient) - expected));
    // Sabotage: the gradient mapped like a direction instead of a covector.
    const Vec3 wrong = -glm::normalize(world_from_bone.rotate(bone_from_index.linear * gradient));
    least_sabotaged = std::min(least_sabotaged, glm::length(wrong - expected));
  }
  MESSAGE("largest error of the normal " << worst << ", least of the sabotaged map " << least_sabotaged);
  // Densities round to 2^-25 in float, slopes are at least 0.005 a voxel along the least edge: 6e-6 a component,
  // a few of them through the map.
  CHECK(worst < 3e-5);
  CHECK(least_sabotaged > 1e-2);
}

TEST_CASE("gradient: no gradient, no normal") {
  const DenseBone dense = random_bone({6, 6, 6}, 1);
  Voxmap voxmap = make_voxmap(load_bone(dense));
  REQUIRE(voxmap.place_window(voxmap.bone().bounds()).ok());
  ContactWindowPublisher publisher(voxmap);
  publisher.publish(voxmap);
  const ContactView view(publisher.exchange().latest(), dense.bone_from_index, Pose{});
  CHECK(view.outward_normal(Vec3(0.0)) == Vec3(0.0));
}
