// ContactView: the trilinear field, the 0.5 surface, normals on any grid.
#include "contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

/// A bone whose density is f(index), clamped nowhere: f must stay in 0..1.
template <class F>
DenseBone bone_of(const Vec3i& dims, const Affine& bone_from_index, F&& f) {
  DenseBone bone;
  bone.dims = dims;
  bone.bone_from_index = bone_from_index;
  for_each_voxel({Vec3i(0), dims}, [&](const Vec3i& v) { bone.occupancy.push_back(static_cast<float>(f(Vec3(v)))); });
  bone.hardness.assign(bone.occupancy.size(), 0.5f);
  return bone;
}

Affine sheared() {
  Affine map = Affine::scaling(kPitch, Vec3(-0.003, 0.001, 0.002));
  map.linear[0] *= 0.8;
  map.linear[2] = Vec3(0.3, -0.2, 1.1) * kPitch;
  return map;
}

}  // namespace

TEST_CASE("contact view: sample is exact on a trilinear field, in both storages") {
  const auto field = [](const Vec3& p) {
    return 0.1 + 0.02 * p.x + 0.015 * p.y + 0.01 * p.z + 0.001 * p.x * p.y - 0.0005 * p.y * p.z + 0.0001 * p.x * p.y * p.z;
  };
  FeltBone bone(bone_of(Vec3i(12), sheared(), field));
  const ContactView window = bone.view(), vdb = bone.vdb_view();
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3 p = Vec3(5.5) + 5.49 * random_vector(21, n);
    // Eight floats below 1 are each rounded by up to 3e-8, and weighted to a sum of 1.
    CHECK(std::abs(window.sample(p) - field(p)) <= 5e-8);
    CHECK(window.sample(p) == vdb.sample(p));
  }
}

TEST_CASE("contact view: index and world positions are inverse to each other under shear and a moved bone") {
  const FeltBone bone(bone_of(Vec3i(6), sheared(), [](const Vec3&) { return 0.5; }), {random_rotation(22, 0), Vec3(0.3, 0.1, -0.2)});
  const ContactView view = bone.view();
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Vec3 p = 6.0 * random_vector(23, n);
    const Vec3 world = bone.world_from_bone() * (bone.dense().bone_from_index * p);
    // A world position near 0.4 m is rounded by 6e-17 m, which is 2e-13 voxel.
    CHECK(glm::length(view.world_of(p) - world) <= 1e-15);
    CHECK(glm::length(view.index_of(world) - p) <= 1e-11);
  }
}

TEST_CASE("contact view: outward normals of a linear field are its world normal on sheared grids and turned bones") {
  for (std::uint64_t n = 0; n < 20; ++n) {
    const Vec3 normal_bone = glm::normalize(random_vector(24, n));
    const Affine map = sheared();
    const Vec3 middle = map * Vec3(5.5);
    // Falls along the normal by 1 in 12 mm: stays in 0..1 over the grid, and is linear, so central differences are exact.
    const auto field = [&](const Vec3& p) { return 0.5 - glm::dot(normal_bone, map * p - middle) / 0.016; };
    const FeltBone bone(bone_of(Vec3i(12), map, field), {random_rotation(25, n), Vec3(0.1)}, 0.0f);
    const Vec3 expected = bone.world_from_bone().rotate(normal_bone);
    const ContactView view = bone.view();
    const Vec3 normal = view.outward_normal(Vec3(view.gradient(Vec3i(5, 6, 4))));
    // Differences of floats near 0.5 carry 6e-8; the gradient is at least 0.02 a voxel: 3e-6 of it.
    CHECK(glm::length(normal - expected) <= 1e-5);
    // Sabotage: a gradient mapped as if it were a direction leans by degrees.
    const Vec3 naive = -glm::normalize(map.linear * Vec3(view.gradient(Vec3i(5, 6, 4))));
    CHECK(glm::length(bone.world_from_bone().rotate(naive) - expected) > 0.02);
  }
}

TEST_CASE("contact view: leave_bone stops within 0.002 voxel of a plate's surface, level or tilted, moved or not") {
  for (const Vec3& up : {Vec3(0.0, 0.0, 1.0), Vec3(0.18, 0.0, 1.0), Vec3(0.3, 0.35, 1.0), Vec3(1.0, 0.0, 1.0), Vec3(0.6, -0.7, 1.0)}) {
    PhantomSpec spec = small_spec(PhantomKind::plate);
    spec.plate_normal = up;
    const Phantom phantom = phantom_of(spec);
    const FeltBone bone(phantom.bone, {random_rotation(26, 1), Vec3(0.1, 0.2, 0.0)});
    const Pose bone_from_world = bone.world_from_bone().inverse();
    const Vec3 normal = glm::normalize(up);
    for (std::uint64_t n = 0; n < 30; ++n) {
      const Vec3 from = 1e-3 * random_vector(27, n) - normal * (1.5e-3 + 0.3e-3);
      const Vec3 way = glm::normalize(normal + 0.5 * random_vector(28, n));
      const auto surface = bone.view().leave_bone(bone.world_from_bone() * from, bone.world_from_bone().rotate(way), 8e-3);
      REQUIRE(surface);
      const Vec3 at = bone_from_world * surface->position;
      CHECK(std::abs(phantom.truth.signed_distance(at)) <= 0.002 * kPitch);
      // On the way, not beside it.
      CHECK(glm::length(glm::cross(at - from, way)) <= 1e-9);
      CHECK(glm::dot(surface->normal, bone.world_from_bone().rotate(normal)) > 0.999);
      // 2.5 degrees: central differences at the cell's corners reach one voxel on, into the clamp of the phantom's ramp.
    }
  }
}

TEST_CASE("contact view: leave_bone stops within pitch^2 / (4 R) of a sphere's surface") {
  PhantomSpec spec = small_spec(PhantomKind::sphere);
  spec.extent.z = 0.012;  // the whole ball
  const Phantom phantom = phantom_of(spec);
  const FeltBone bone(phantom.bone);
  const double curved = spec.pitch * spec.pitch / (4.0 * spec.sphere_radius);  // of the phantom itself, see phantom.h
  for (std::uint64_t n = 0; n < 100; ++n) {
    const Vec3 way = glm::normalize(random_vector(29, n) + Vec3(0.0, 0.0, 0.8));
    const auto surface = bone.view().leave_bone(Vec3(0.0, 0.0, -spec.sphere_radius) + 1e-3 * random_vector(30, n), way, 8e-3);
    REQUIRE(surface);
    CHECK(std::abs(phantom.truth.signed_distance(surface->position)) <= curved + 0.002 * kPitch);
  }
}

TEST_CASE("contact view: leave_bone finds nothing when the way stays in bone for its reach") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  CHECK_FALSE(bone.view().leave_bone({0.0, 0.0, -2e-3}, {1.0, 0.0, 0.0}, 3e-3));
  CHECK_FALSE(bone.view().leave_bone({0.0, 0.0, -2e-3}, {0.0, 0.0, 1.0}, 1.5e-3));
  CHECK(bone.view().leave_bone({0.0, 0.0, -2e-3}, {0.0, 0.0, 1.0}, 2.25e-3));
}

TEST_CASE("contact view: outside the window nothing is known and density is 0") {
  const FeltBone bone(phantom_of(small_spec(PhantomKind::plate)).bone, {}, 0.08f, VoxelBox{Vec3i(4), Vec3i(14)});
  const ContactView view = bone.view();
  CHECK(view.knows(Vec3i(5)));
  CHECK_FALSE(view.knows(Vec3i(4)));  // no gradient in the outermost layer
  CHECK(view.density(Vec3i(4)) == 0.0f);
  CHECK(view.density(Vec3i(100)) == 0.0f);
  CHECK(view.gradient(Vec3i(-100)) == Vec3f(0.0f));
}
