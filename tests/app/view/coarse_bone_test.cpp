// A bone at coarser voxels, against weighted sums over the bone's own voxels.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "app/view/coarse_bone.h"
#include "tests/support/drill_scene.h"
#include "tests/support/plain_trilinear.h"

namespace burrhole::test {
namespace {

/// Weight of a voxel at distance d on one axis.
double tent(int d, int factor) { return std::max(0.0, 1.0 - std::abs(d) / static_cast<double>(factor)) / factor; }

double plain_mean(const Vec3i& coarse, int factor, const std::function<double(const Vec3i&)>& value) {
  double sum = 0.0;
  for_each_voxel({factor * coarse - factor, factor * coarse + factor + 1}, [&](const Vec3i& v) {
    const Vec3i d = v - factor * coarse;
    sum += tent(d.x, factor) * tent(d.y, factor) * tent(d.z, factor) * value(v);
  });
  return sum;
}

/// Drilled to the middle, so that blocks and window differ from the bone as loaded.
DrillRun drilled_patch() { return DrillRun(SmallScene{.volume = kSkullPatchKeys, .sets = {"duration_s=1.5", "hand.push_N=40"}}); }

// Sums of up to 7^3 floats at most 1 in three passes: each rounding is at most 6e-8, 21 of them add up to 1.3e-6.
constexpr double kRounding = 2e-6;

}  // namespace

TEST_CASE("coarse bone: fields as loaded are the weighted means; a voxel beyond the bone adds nothing") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys});
  const BoneModel& bone = *loaded.bone;
  for (const int factor : {2, 3, 4}) {
    const auto coarse = CoarseBone::create(bone, factor);
    REQUIRE(coarse);
    const BoneModel& made = coarse->loaded();
    // Voxel (0, 0, 0) of both lies at the same place.
    CHECK(glm::length(made.bone_from_index() * Vec3(1, 2, 3) - bone.bone_from_index() * (static_cast<double>(factor) * Vec3(1, 2, 3))) <
          1e-12);
    double worst = 0.0, worst_hardness = 0.0;
    int labels = 0;
    std::vector<float> hardness(made.bounds().count()), soft(hardness.size());
    made.read_hardness(made.bounds(), hardness);
    made.read_soft(made.bounds(), soft);
    for_each_voxel(made.bounds(), [&](const Vec3i& v) {
      if ((v.x + v.y) % 3 != 0) return;  // a third of them, for speed
      const std::size_t n = made.bounds().offset_of(v);
      const auto occupancy = [&](const Vec3i& at) { return static_cast<double>(bone.occupancy(at)); };
      const auto read = [&](auto member, const Vec3i& at) {
        float value = 0.0f;
        (bone.*member)({at, at + 1}, {&value, 1});
        return static_cast<double>(value);
      };
      const double share = plain_mean(v, factor, occupancy);
      const double mineral = plain_mean(v, factor, [&](const Vec3i& at) { return occupancy(at) * read(&BoneModel::read_hardness, at); });
      const double tissue = plain_mean(v, factor, [&](const Vec3i& at) { return read(&BoneModel::read_soft, at); });
      worst = std::max({worst, std::abs(share - static_cast<double>(made.occupancy(v))), std::abs(tissue - static_cast<double>(soft[n]))});
      if (share > 0.01) worst_hardness = std::max(worst_hardness, std::abs(mineral / share - static_cast<double>(hardness[n])));
      const VoxelLabel own = bone.label(factor * v);
      if (own != VoxelLabel::none) {
        ++labels;
        REQUIRE(made.label(v) == own);
      }
    });
    CHECK(worst < kRounding);
    CHECK(worst_hardness < 100.0 * 2.0 * kRounding);  // the quotient of two such means, of which the smaller is above 0.01
    CHECK(labels > 100);
  }
}

TEST_CASE("coarse bone: present density is the mean of the present density, in any parts; where nothing was drilled it is that as loaded") {
  DrillRun run = drilled_patch();
  run.run();
  const Voxmap& voxmap = run.simulation().voxmap();
  const auto coarse = CoarseBone::create(voxmap.bone(), 3);
  REQUIRE(coarse);
  const VoxelBox all = coarse->loaded().bounds().grown(1);
  std::vector<float> whole(all.count()), loaded(all.count());
  coarse->read_density(voxmap, all, whole);
  coarse->loaded().read_occupancy(all, loaded);
  const VoxelBox fine = voxmap.bone().bounds().grown(9);
  std::vector<float> density(fine.count());
  voxmap.read_density(fine, density);
  double worst = 0.0, removed = 0.0;
  for_each_voxel(all, [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    const double mean = plain_mean(v, 3, [&](const Vec3i& at) { return static_cast<double>(density[fine.offset_of(at)]); });
    worst = std::max(worst, std::abs(mean - static_cast<double>(whole[n])));
    removed = std::max(removed, static_cast<double>(loaded[n] - whole[n]));
    float one = -1.0f;
    coarse->read_density(voxmap, {v, v + 1}, {&one, 1});
    REQUIRE(one == whole[n]);
  });
  CHECK(worst < kRounding);
  CHECK(removed > 0.5);  // a hole
}

TEST_CASE("coarse bone: which coarse voxels depend on a box") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys});
  for (const int factor : {2, 3, 5}) {
    const auto coarse = CoarseBone::create(*loaded.bone, factor);
    REQUIRE(coarse);
    for (int lo = -3; lo < 12; ++lo)
      for (int size = 1; size < 8; ++size) {
        const VoxelBox found = coarse->coarse_of({Vec3i(lo), Vec3i(lo + size)});
        for (int c = -10; c < 20; ++c) {
          bool depends = false;
          for (int v = lo; v < lo + size; ++v) depends = depends || tent(v - factor * c, factor) > 0.0;
          REQUIRE(depends == (c >= found.lo.x && c < found.hi.x));
        }
      }
  }
}

TEST_CASE("coarse bone: the surface of an oblique plate stays where it is") {
  // The weights are symmetric, and the ramp of occupancy is linear as far as they reach: a mean over +-factor voxels of a ramp of 1.6 voxels
  // either way is not, so the bound is that of a ramp clamped at both ends, which is symmetric about the surface: 0.
  const LoadedScene loaded = load_small({.volume = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [12.0, 12.0, 10.0]
above_mm = 3.0
thickness_mm = 5.0
plate_normal = [0.2, 0.1, 1.0]
)"});
  const auto coarse = CoarseBone::create(*loaded.bone, 3);
  REQUIRE(coarse);
  const BoneModel& made = coarse->loaded();
  const Vec3 normal = glm::normalize(Vec3(0.2, 0.1, 1.0));
  double worst = 0.0;
  for (int n = 0; n < 100; ++n) {
    const Vec3 foot(1e-4 * (n % 10 * 4 - 18), 1e-4 * (n / 10 * 4 - 18), 0.0);
    const Vec3 on_plate = foot - normal * glm::dot(foot, normal);
    double inside = -1.5e-3, outside = 1.5e-3;
    for (int m = 0; m < 40; ++m) {
      const double middle = 0.5 * (inside + outside);
      const Vec3 index = made.bone_from_index().inverse() * (on_plate + middle * normal);
      (plain_trilinear(index, [&](const Vec3i& v) { return made.occupancy(v); }) >= 0.5 ? inside : outside) = middle;
    }
    worst = std::max(worst, std::abs(inside));
  }
  // Trilinear interpolation of a profile that is not linear between coarse voxels: at most an eighth of its second difference, which for
  // this profile is at most 0.25 of density a coarse voxel^2 over a slope of about 0.5 a coarse voxel: 0.06 coarse voxels.
  CHECK(worst < 0.06 * 0.75e-3);
}

}  // namespace burrhole::test
