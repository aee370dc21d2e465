// Two regions of a tool with a speed each: against one speed, against a tool that lacks a region, and against time for speed.

#include "core/drill/region_spin.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "core/tool/make_tool.h"
#include "core/tool/tool_surface.h"
#include "core/voxel/box_parts.h"
#include "tests/core/drill/drill_cases.h"
#include "tests/core/drill/step_tool.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kVoxel = 0.25e-3, kSpin = 1000.0 / 60.0;  // [m], [rev/s]

/// The inner drill 2 mm deep in bone, the outer one half a millimetre.
Affine buried() { return upright_pose(kVoxel, Vec3(24.1, 23.9, 8.2)); }
Voxmap block() {
  DenseBone dense;
  dense.dims = Vec3i(48, 48, 36);
  dense.bone_from_index = Affine::scaling(kVoxel, Vec3(0.0));
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    dense.occupancy.push_back(v.z <= 16 ? 1.0f : 0.0f);
    dense.hardness.push_back(0.8f);
  });
  return voxmap_of(dense);
}

struct Speeds {
  double inner = 1.0, outer = 1.0;
};

/// Dwells in a block. @returns the voxmap.
Voxmap dwell(const Tool& tool, const ErosionConfig& config, const Speeds& speeds, double seconds, double* mass = nullptr) {
  Voxmap voxmap = block();
  RegionSpins regions(tool, regions_of_step(tool));
  auto erosion = Erosion::create(config, tool.erosion, regions.field());
  REQUIRE(erosion.ok());
  regions.set(speeds.inner, speeds.outer, *erosion);
  double removed = 0.0;
  for (int n = 0; n < 10; ++n) {
    const ErosionOutcome outcome = erosion->step(voxmap, {buried(), buried()}, CuttingLoad{.spin = kSpin, .force = 10.0}, seconds / 10.0);
    voxmap.commit(outcome.changed);
    removed += outcome.removed_mass;
  }
  if (mass != nullptr) *mass = removed;
  return voxmap;
}

const ErosionConfig kFaces{.subvoxel = true}, kPoints{}, kGather{.form = ErosionForm::gather};
ErosionConfig updates() { return {.law = ErosionLaw::per_update}; }
ErosionConfig energy(bool subvoxel) { return {.law = ErosionLaw::energy, .subvoxel = subvoxel}; }

}  // namespace

TEST_CASE("region spin: both at full speed remove what one speed removes, bit for bit, also after other speeds") {
  const Tool tool = step_tool({.voxel = kVoxel});
  for (const ErosionConfig& config : {kFaces, kPoints, kGather, updates(), energy(true), energy(false)}) {
    Voxmap one = block();
    auto plain = Erosion::create(config, tool.erosion, tool.cutting);
    REQUIRE(plain.ok());
    for (int n = 0; n < 10; ++n)
      one.commit(plain->step(one, {buried(), buried()}, CuttingLoad{.spin = kSpin, .force = 10.0}, 0.01).changed);
    Voxmap two = block();
    RegionSpins regions(tool, regions_of_step(tool));
    auto split = Erosion::create(config, tool.erosion, regions.field());
    REQUIRE(split.ok());
    regions.set(0.3, 0.7, *split);
    regions.set(1.0, 1.0, *split);
    for (int n = 0; n < 10; ++n)
      two.commit(split->step(two, {buried(), buried()}, CuttingLoad{.spin = kSpin, .force = 10.0}, 0.01).changed);
    CHECK(one.hash() == two.hash());
    CHECK(one.hash() != block().hash());
  }
}

TEST_CASE("region spin: a drill that stands removes nothing: as a tool without that region") {
  const Tool tool = step_tool({.voxel = kVoxel});
  const Tool only_outer = step_tool({.voxel = kVoxel, .inner_factor = 0.0});
  const Tool only_inner = step_tool({.voxel = kVoxel, .outer_factor = 0.0});
  for (const ErosionConfig& config : {kPoints, updates()}) {
    double standing = 0.0, lacking = 0.0, both = 0.0;
    CHECK(dwell(tool, config, {.inner = 0.0}, 0.2, &standing).hash() == dwell(only_outer, config, {}, 0.2, &lacking).hash());
    CHECK(standing == doctest::Approx(lacking).epsilon(1e-12));
    CHECK(dwell(tool, config, {.outer = 0.0}, 0.2, &standing).hash() == dwell(only_inner, config, {}, 0.2, &lacking).hash());
    (void)dwell(tool, config, {}, 0.2, &both);
    CHECK(both > 1.2 * standing);  // the sabotage: a speed for all would remove this
  }
  for (const ErosionConfig& config : {kFaces, kPoints, energy(true), energy(false)}) {
    double none = 1.0;
    CHECK(dwell(tool, config, {.inner = 0.0, .outer = 0.0}, 0.2, &none).hash() == block().hash());
    CHECK(none == 0.0);
  }
}

TEST_CASE("region spin: half the speed of a drill for twice the time removes as much") {
  const Tool tool = step_tool({.voxel = kVoxel});
  for (const ErosionConfig& config : {kFaces, kPoints, kGather}) {
    for (const Speeds& full : {Speeds{1.0, 0.0}, Speeds{0.0, 1.0}, Speeds{1.0, 0.5}}) {
      double once = 0.0, twice = 0.0;
      (void)dwell(tool, config, full, 0.1, &once);
      (void)dwell(tool, config, {0.5 * full.inner, 0.5 * full.outer}, 0.2, &twice);
      CHECK(once > 0.0);
      CHECK(twice == doctest::Approx(once).epsilon(1e-6));  // factors are floats
    }
  }
}
