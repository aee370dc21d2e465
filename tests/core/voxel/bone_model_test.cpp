#include "core/voxel/bone_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// @returns true when create() refuses the bone after `spoil`, as bad input and with a message.
template <class F>
bool refuses(F&& spoil) {
  DenseBone dense = random_bone({6, 5, 4}, 1);
  dense.soft.assign(dense.occupancy.size(), 0.0f);
  spoil(dense);
  const auto bone = BoneModel::create(dense);
  return !bone.ok() && bone.error().code == ErrorCode::bad_input && !bone.error().message.empty();
}

}  // namespace

TEST_CASE("BoneModel: holds the dense fields bit for bit, and nothing outside the grid") {
  DenseBone dense = random_bone({13, 9, 17}, 2);
  dense.soft = dense.hardness;
  const auto bone = load_bone(dense);
  const VoxelBox around = bone->bounds().grown(3);
  std::vector<float> occupancy(around.count()), hardness(around.count()), soft(around.count()), labels(around.count());
  bone->read_occupancy(around, occupancy);
  bone->read_hardness(around, hardness);
  bone->read_soft(around, soft);
  bone->read_labels(around, labels);
  std::size_t n = 0, inside = 0, bone_voxels = 0;
  for_each_voxel(around, [&](const Vec3i& v) {
    const bool in = glm::all(glm::greaterThanEqual(v, Vec3i(0))) && glm::all(glm::lessThan(v, dense.dims));
    REQUIRE(occupancy[n] == (in ? dense.occupancy[inside] : 0.0f));
    REQUIRE(hardness[n] == (in ? dense.hardness[inside] : 0.0f));
    REQUIRE(soft[n] == (in ? dense.soft[inside] : 0.0f));
    REQUIRE(labels[n] == (in ? static_cast<float>(dense.labels[inside]) : 0.0f));
    REQUIRE(bone->occupancy(v) == occupancy[n]);
    REQUIRE(static_cast<float>(bone->label(v)) == labels[n]);
    bone_voxels += occupancy[n] >= 0.5f ? 1 : 0;
    inside += in ? 1 : 0;
    ++n;
  });
  CHECK(inside == dense.occupancy.size());
  CHECK(bone->bone_voxels() == bone_voxels);
  CHECK(bone->bytes() > 0);
}

TEST_CASE("BoneModel: create refuses fields whose sizes disagree with the dims") {
  CHECK(refuses([](DenseBone& d) { d.occupancy.pop_back(); }));
  CHECK(refuses([](DenseBone& d) { d.hardness.push_back(0.5f); }));
  CHECK(refuses([](DenseBone& d) { d.soft.pop_back(); }));
  CHECK(refuses([](DenseBone& d) { d.labels.pop_back(); }));
  CHECK(refuses([](DenseBone& d) { d.dims = {6, 5, 5}; }));
  CHECK(refuses([](DenseBone& d) { d.occupancy.clear(); }));
  CHECK(refuses([](DenseBone& d) { d.dims = {0, 5, 4}; }));
  CHECK(refuses([](DenseBone& d) { d.dims = {-6, -5, 4}; }));
  CHECK_FALSE(refuses([](DenseBone& d) { d.labels.clear(); }));
  CHECK_FALSE(refuses([](DenseBone&) {}));
}

TEST_CASE("BoneModel: create refuses values that are not finite or outside 0..1") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity, -1e-6f, 1.0001f}) {
    CAPTURE(bad);
    CHECK(refuses([bad](DenseBone& d) { d.occupancy.back() = bad; }));
    CHECK(refuses([bad](DenseBone& d) { d.hardness.front() = bad; }));
    CHECK(refuses([bad](DenseBone& d) { d.soft[7] = bad; }));
  }
}

TEST_CASE("BoneModel: create refuses a voxel-to-bone map that is singular, nearly singular or not finite, and keeps a good one") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(refuses([](DenseBone& d) { d.bone_from_index.linear = Mat3(0.0); }));
  CHECK(refuses([](DenseBone& d) { d.bone_from_index.linear[2] = d.bone_from_index.linear[0]; }));
  // Coplanar edges whose determinant is a rounding error instead of 0.
  for (std::uint64_t n = 0; n < 50; ++n) {
    const auto edge = [n](std::uint64_t k) { return 1e-3 * Vec3(uniform11(n, 3 * k), uniform11(n, 3 * k + 1), uniform11(n, 3 * k + 2)); };
    REQUIRE(refuses([&](DenseBone& d) { d.bone_from_index.linear = Mat3(edge(0), edge(1), 0.3 * edge(0) + 0.7 * edge(1)); }));
  }
  CHECK(refuses([nan](DenseBone& d) { d.bone_from_index.linear[1].x = nan; }));
  CHECK(refuses([nan](DenseBone& d) { d.bone_from_index.offset.y = nan; }));
  // A left-handed map and a strong shear are real.
  CHECK_FALSE(refuses([](DenseBone& d) { d.bone_from_index.linear[0] = -d.bone_from_index.linear[0]; }));
  CHECK_FALSE(refuses([](DenseBone& d) { d.bone_from_index.linear[2] += 3.0 * d.bone_from_index.linear[0]; }));
}
