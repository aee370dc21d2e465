#include "core/voxel/coarse_distance.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/base/rotation.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

const Vec3i kDims(90, 70, 50);

double unit(Dice& dice) { return 1e-6 * dice.next_below(1'000'001); }

/// A few balls of bone, far from each other, in a grid that is otherwise empty.
DenseBone balls(const Affine& bone_from_index, Dice& dice) {
  DenseBone out;
  out.dims = kDims;
  out.bone_from_index = bone_from_index;
  const VoxelBox all{Vec3i(0), kDims};
  out.occupancy.assign(all.count(), 0.0f);
  for (int ball = 0; ball < 4; ++ball) {
    const Vec3 middle(dice.next_below(90), dice.next_below(70), dice.next_below(50));
    const double radius = 1.0 + dice.next_below(9);
    std::size_t n = 0;
    for_each_voxel(all, [&](const Vec3i& v) {
      if (glm::length(Vec3(v) - middle) < radius) out.occupancy[n] = 1.0f;
      ++n;
    });
  }
  out.hardness = out.occupancy;
  out.labels.assign(all.count(), 0);
  return out;
}

/// Points in index coordinates at which a trilinear sample is above 0: in reach of a voxel of bone on each axis.
std::vector<Vec3> points_in_bone(const DenseBone& bone, Dice& dice) {
  std::vector<Vec3> out;
  std::size_t n = 0;
  for_each_voxel(VoxelBox{Vec3i(0), bone.dims}, [&](const Vec3i& v) {
    const auto off = [&] { return 0.999 * (2.0 * unit(dice) - 1.0); };
    if (bone.occupancy[n++] > 0.0f) out.push_back(Vec3(v) + Vec3(off(), off(), off()));
  });
  return out;
}

double distance_of(const std::vector<Vec3>& bone, const Affine& bone_from_index, const Vec3& index) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& p : bone) least = std::min(least, glm::length(bone_from_index.linear * (p - index)));
  return least;
}

/// @returns whether a point lies in the box round the others.
bool within(const std::vector<Vec3>& points, const Vec3& p) {
  Vec3 lo = points.front(), hi = lo;
  for (const Vec3& q : points) {
    lo = glm::min(lo, q);
    hi = glm::max(hi, q);
  }
  return glm::all(glm::lessThanEqual(lo, p)) && glm::all(glm::lessThanEqual(p, hi));
}

Affine grid_of(const Vec3& edges, double shear) {
  Affine out;
  out.linear = glm::mat3_cast(rotation_of(Vec3(0.4, -0.7, 0.3)));
  for (std::size_t c = 0; c < 3; ++c) out.linear[c] *= edges[c];
  out.linear[2] += shear * out.linear[0];
  return out;
}

}  // namespace

TEST_CASE(
    "coarse distance: it is never above the distance of bone, on any grid, and between bones within two blocks of it on cubic voxels") {
  const double edge = 0.25e-3;
  const Affine grids[] = {grid_of(Vec3(edge), 0.0), grid_of({edge, 2.0 * edge, 3.0 * edge}, 0.0), grid_of(Vec3(edge), 0.3)};
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const Affine& grid : grids) {
      Dice dice{seed};
      const DenseBone dense = balls(grid, dice);
      const auto bone = load_bone(dense);
      const CoarseDistance coarse(*bone);
      CHECK(coarse.bytes() <= CoarseDistance::bytes_for(kDims));
      const std::vector<Vec3> inside = points_in_bone(dense, dice);
      int above = 0, off = 0, free = 0;
      for (int n = 0; n < 400; ++n) {
        // A third of the points lies outside the grid.
        const Vec3 p = Vec3(kDims) * (2.0 * Vec3(unit(dice), unit(dice), unit(dice)) - 0.5);
        const double exact = distance_of(inside, grid, p), bound = coarse.at(p);
        above += bound > exact;
        // Places in two blocks differ by up to two blocks more than the gap between the blocks, on each axis, and by a sample's reach.
        off += &grid == &grids[0] && within(inside, p) && bound < exact - (16.0 + 2.0) * std::sqrt(3.0) * edge;
        free += bound > 0.0;
      }
      CHECK(above == 0);
      CHECK(off == 0);
      CHECK(free > 100);
      for (const Vec3& p : inside) REQUIRE(coarse.at(p) == 0.0);
    }
}

TEST_CASE("coarse distance: without bone everything is free, and a place that is not finite never is") {
  Dice dice{1};
  DenseBone dense = balls(grid_of(Vec3(1e-3), 0.0), dice);
  const CoarseDistance some(*load_bone(dense));
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK(some.at({0.0, value, 0.0}) == 0.0);
  CHECK(some.at(Vec3(1e6)) == doctest::Approx(std::sqrt(3.0) * 1e3).epsilon(0.001));
  std::ranges::fill(dense.occupancy, 0.0f);
  const CoarseDistance none(*load_bone(dense));
  CHECK(none.at(Vec3(3.0)) == std::numeric_limits<double>::infinity());
  CHECK(none.bytes() == 0);
}
