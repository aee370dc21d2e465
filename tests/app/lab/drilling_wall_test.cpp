// Roughness of a wall of known shape: a phantom with a hole, and one whose hole is rippled on purpose.

#include <doctest/doctest.h>

#include <cmath>

#include "app/lab/drilling_wall.h"
#include "core/measure/approach.h"
#include "volumes/phantom/phantom.h"

using namespace burrhole;

namespace {

constexpr double kRadius = 2e-3, kEdge = 0.2e-3;  // [m]

/// A plate with a hole along z whose radius is kRadius + ripple * cos(6 azimuth), at `centre` [m].
Voxmap holed(double ripple, const Vec3& centre) {
  PhantomSpec spec;
  spec.kind = PhantomKind::plate;
  spec.pitch = kEdge;
  spec.extent = Vec3(8e-3, 8e-3, 6e-3);
  spec.above = 1e-3;
  spec.thickness = 4e-3;
  auto phantom = make_phantom(spec);
  REQUIRE(phantom.ok());
  DenseBone& bone = phantom->bone;
  for_each_voxel({Vec3i(0), bone.dims}, [&](const Vec3i& v) {
    const Vec3 p = bone.bone_from_index * Vec3(v) - centre;
    const double wall = kRadius + ripple * std::cos(6.0 * std::atan2(p.y, p.x));
    const auto at = static_cast<std::size_t>((v.z * bone.dims.y + v.y) * bone.dims.x + v.x);
    const double density = std::clamp(0.5 + (std::hypot(p.x, p.y) - wall) / (2.0 * kEdge), 0.0, 1.0);
    bone.occupancy[at] = std::min(bone.occupancy[at], static_cast<float>(density));
  });
  auto model = BoneModel::create(bone);
  REQUIRE(model.ok());
  auto voxmap = Voxmap::create(*model, {});
  REQUIRE(voxmap.ok());
  return std::move(voxmap).value();
}

Approach down_the_axis() {
  Approach out;
  out.thickness = 4e-3;
  return out;
}

constexpr WallBand kBand{1e-3, 3e-3, kRadius};

}  // namespace

TEST_CASE("wall roughness: a round hole is smooth, wherever its axis is, to a hundredth of a voxel") {
  for (const Vec3& centre : {Vec3(0.0), Vec3(0.13e-3, -0.07e-3, 0.0)}) {
    const auto rough = wall_roughness(holed(0.0, centre), down_the_axis(), kBand);
    REQUIRE(rough);
    // Linear interpolation of distances to a cylinder: an error of edge^2 / (8 R) at most, varying over the wall.
    CHECK(*rough < kEdge * kEdge / (8.0 * kRadius));
  }
}

TEST_CASE("wall roughness: a ripple of amplitude a has a / sqrt 2") {
  const auto rough = wall_roughness(holed(0.1e-3, Vec3(0.0)), down_the_axis(), kBand);
  REQUIRE(rough);
  CHECK(*rough == doctest::Approx(0.1e-3 / std::sqrt(2.0)).epsilon(0.05));
}

TEST_CASE("wall roughness: a hole that does not reach the band has no wall") {
  CHECK(!wall_roughness(holed(0.0, Vec3(0.0)), down_the_axis(), {-3e-3, -2e-3, kRadius}));
}
