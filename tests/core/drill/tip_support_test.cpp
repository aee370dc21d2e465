// The share of the thrust that the inner tip of a stepped bit carries: closed forms for bone of simple shape.

#include "core/drill/tip_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/voxel/box_parts.h"
#include "tests/core/drill/drill_cases.h"
#include "tests/core/drill/step_tool.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kVoxel = 0.25e-3;                                                  // [m]
constexpr double kInner = 4.0 * std::numbers::pi, kOuter = 5.0 * std::numbers::pi;  // [mm^2] faces of the step tool

/// Bone where `solid` says, of a hardness by place; places [m] from the tip of upright(), +z up.
Voxmap bone_of(const std::function<bool(const Vec3&)>& solid, const std::function<float(const Vec3&)>& hardness) {
  DenseBone dense;
  dense.dims = Vec3i(48, 48, 40);
  dense.bone_from_index = Affine::scaling(kVoxel, Vec3(0.0));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const Vec3 p = (Vec3(v) - Vec3(24.0, 24.0, 20.0)) * kVoxel;
    dense.occupancy.push_back(solid(p) ? 1.0f : 0.0f);
    dense.hardness.push_back(hardness(p));
  });
  return voxmap_of(dense);
}
Affine upright() { return upright_pose(kVoxel, Vec3(24.0, 24.0, 20.0)); }
float full(const Vec3&) { return 1.0f; }
double radius(const Vec3& p) { return std::hypot(p.x, p.y); }
/// Bone up to both faces: a pilot hole of the tip's depth.
bool whole(const Vec3& p) { return p.z <= 0.0 || (radius(p) > 2.05e-3 && p.z <= 1.5e-3); }
/// A hole wider than the tip by more than a voxel, so that no place of the tip is beside bone.
constexpr double kHole = 2.3e-3;                                     // [m]
constexpr double kOuterPart = std::numbers::pi * (9.0 - 2.3 * 2.3);  // [mm^2] of the ledge beside it
constexpr double kBetween = std::numbers::pi * (2.3 * 2.3 - 4.0);    // [mm^2]
bool ledge(const Vec3& p) { return radius(p) > kHole && p.z <= 1.5e-3; }

}  // namespace

TEST_CASE("tip support: all of the tip on bone carries area over factor, by the law of the receding face") {
  const Tool tool = step_tool({});
  const TipSupport support(tool, regions_of_step(tool), kVoxel);
  CHECK(support.tip_area() == doctest::Approx(kInner * 1e-6).epsilon(0.03));  // one place per voxel: the rim is a step of a voxel of 16
  const TipLoad load = support.measure(bone_of(whole, full).window(), upright(), 0.0, 0.0f);
  const double exact = kInner / 0.05 / (kInner / 0.05 + kOuter / 0.25);
  CHECK(load.supported == 1.0);
  // Places at the rim of 2 mm are a voxel wide: the ring loses or gains up to 2 pi 2 mm x 0.1 mm of 16 mm^2 beside the wall, 8 %, of a share of 0.2.
  CHECK(load.share == doctest::Approx(exact).epsilon(0.02));
  // Sabotage: by area alone the tip would carry less than half.
  CHECK(std::abs(kInner / (kInner + kOuter) - load.share) > 0.3);
}

TEST_CASE("tip support: a tip over a hole carries nothing, half a hole half of it; without bone there is no load") {
  const Tool tool = step_tool({});
  const TipSupport support(tool, regions_of_step(tool), kVoxel);
  const auto measure = [&](const std::function<bool(const Vec3&)>& solid) {
    return support.measure(bone_of(solid, full).window(), upright(), 0.0, 0.0f);
  };
  const TipLoad through = measure(ledge), air = measure([](const Vec3&) { return false; });
  CHECK(through.supported == 0.0);
  CHECK(through.share == 0.0);
  CHECK(air.supported == 0.0);
  CHECK(air.share == 0.0);
  const TipLoad half = measure([](const Vec3& p) { return whole(p) && p.x < 0.0; });
  CHECK(half.supported == doctest::Approx(0.5).epsilon(0.1));  // a row of places of 16
  const TipLoad pillar = measure([](const Vec3& p) { return ledge(p) || (p.z <= 0.0 && radius(p) < 1e-3); });
  const double tip = std::numbers::pi / 0.05, ring = kOuterPart / 0.25;
  CHECK(pillar.supported == doctest::Approx(0.25).epsilon(0.15));
  CHECK(pillar.share == doctest::Approx(tip / (tip + ring)).epsilon(0.08));
}

TEST_CASE("tip support: soft bone under the tip carries less than hard bone under the ledge, and none below the soft limit") {
  const Tool tool = step_tool({});
  const TipSupport support(tool, regions_of_step(tool), kVoxel);
  const auto hardness = [](const Vec3& p) { return radius(p) < kHole ? 0.2f : 1.0f; };
  const Voxmap bone = bone_of(whole, hardness);
  const TipLoad load = support.measure(bone.window(), upright(), 0.0, 0.0f);
  const double tip = kInner / 0.05 * 0.2, ring = (kOuterPart + 0.2 * kBetween) / 0.25;
  CHECK(load.share == doctest::Approx(tip / (tip + ring)).epsilon(0.08));
  CHECK(load.supported == 1.0);
  CHECK(support.measure(bone.window(), upright(), 0.0, 0.21f).supported == 0.0);
  CHECK(support.measure(bone.window(), upright(), 0.0, 0.19f).supported == 1.0);
}

TEST_CASE("tip support: bone counts up to half a voxel ahead and the engaged depth behind, and not outside the window") {
  const Tool tool = step_tool({});
  const TipSupport support(tool, regions_of_step(tool), kVoxel);
  const auto plate = [](const Vec3& p) { return p.z <= 0.0 && p.z > -1.4e-3; };  // its faces lie half a voxel beyond its voxels
  const Voxmap bone = bone_of(plate, full);
  const auto at = [&](double voxels, double engaged) {
    return support.measure(bone.window(), moved(upright(), Vec3(0.0, 0.0, voxels)), engaged, 0.0f).supported;
  };
  CHECK(at(0.9, 0.0) == 1.0);
  CHECK(at(1.1, 0.0) == 0.0);
  CHECK(at(-5.4, 0.0) == 1.0);
  CHECK(at(-6.0, 0.0) == 0.0);           // through the plate
  CHECK(at(-6.0, 1.0 * kVoxel) == 1.0);  // it still cuts what it is engaged in
  CHECK(at(-30.0, 0.0) == 0.0);
  CHECK(at(1e6, 0.0) == 0.0);
  CHECK(at(std::nan(""), 0.0) == 0.0);
}
