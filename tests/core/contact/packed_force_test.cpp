// gradient_plane over packed words against its float form: what densities of 1/255 and gradients of 1/254 may change.
#include "contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

struct Forms {
  FeltBone floats, words;
  explicit Forms(const DenseBone& bone, float dead_zone = 0.08f)
      : floats(bone, {}, dead_zone), words(bone, {}, dead_zone, {}, kWordsOnly) {}
};

Pose pressed(std::uint64_t n, double least, double most) {
  const Pose turn{random_rotation(11, n), Vec3(0.0)};
  const double depth = least + (most - least) * uniform01(12, n);
  return {turn.rotation, Vec3(1e-3, 1e-3, 0.0) * random_vector(13, n) + Vec3(0.0, 0.0, 2e-3 - depth) - turn.rotate(Vec3(0.0, 0.0, 2e-3))};
}

/// Mean difference of the forces over the mean force, of two bones felt by the same model at the same poses.
double difference(const PenaltyModel& model, const ContactView& a, const ContactView& b, double least, double most) {
  double error = 0.0, force = 0.0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    const Vec3 x = evaluated(model, a, pressed(n, least, most)).wrench.force, y = evaluated(model, b, pressed(n, least, most)).wrench.force;
    error += glm::length(x - y);
    force += glm::length(x);
  }
  REQUIRE(force > 1.0);
  return error / force;
}

}  // namespace

TEST_CASE("packed gradient-plane: the force is that of the float form within 1 % on plate, sphere and skull patch") {
  // A gradient of 0.25 to 0.5 a voxel is at least 64 steps: rounding by half a step on two axes turns a normal by at most 0.7/64 = 0.6
  // degrees, which moves the end of a plane 2 voxels away by 0.02 voxel, 1 % of its depth; over hundreds of points most of it averages out.
  constexpr double kBound = 0.01;
  const auto model = model_of(shipped_shell("acosta_liu_round"));
  for (const PhantomKind kind : {PhantomKind::plate, PhantomKind::sphere, PhantomKind::skull_patch}) {
    PhantomSpec spec = small_spec(kind);
    if (kind == PhantomKind::skull_patch) {
      spec.outer_table = 1.5e-3;
      spec.inner_table = 1.0e-3;
    }
    if (kind == PhantomKind::plate) spec.plate_normal = Vec3(0.3, -0.2, 1.0);
    const Forms forms(phantom_of(spec).bone);
    const double found = difference(*model, forms.floats.view(), forms.words.view(), 0.4e-3, 1.6e-3);
    MESSAGE("kind " << static_cast<int>(kind) << ": " << 100.0 * found << " %");
    CHECK(found < kBound);
  }
}

namespace {

/// +-4 % of noise in full voxels that have only full voxels within two of them: the surface itself stays what it was.
DenseBone noisy_inside(const DenseBone& clean) {
  DenseBone out = clean;
  const VoxelBox grid{Vec3i(0), clean.dims};
  for_each_voxel(grid, [&](const Vec3i& v) {
    bool deep = grid.grown(-2).contains(v);
    for_each_voxel({v - 2, v + 3}, [&](const Vec3i& u) { deep = deep && clean.occupancy[grid.offset_of(u)] >= 1.0f; });
    const std::size_t n = grid.offset_of(v);
    if (deep) out.occupancy[n] = static_cast<float>(0.96 + 0.04 * uniform11(17, n));
  });
  return out;
}

/// Of the force deep in noisy bone to that deep in clean bone, both packed.
double noise_error(float dead_zone) {
  const auto model = model_of(shipped_shell("acosta_liu_round"));
  const DenseBone clean = phantom_of(small_spec(PhantomKind::plate)).bone;
  const Forms quiet(clean), loud(noisy_inside(clean), dead_zone);
  return difference(*model, quiet.words.view(), loud.words.view(), 1.2e-3, 2.0e-3);
}

// The planes are the same wherever the walk comes to the same surface voxel: 0.3 % was measured for the law before (docs/performance.md's
// trap of noise), and is what is promised here.
constexpr double kNoiseBound = 0.003;

}  // namespace

TEST_CASE("packed gradient-plane: 4 % of noise inside bone changes the force by under 0.3 % with the dead zone") {
  const double found = noise_error(0.08f);
  MESSAGE("error " << 100.0 * found << " %");
  CHECK(found < kNoiseBound);
}

TEST_CASE("packed gradient-plane: without the dead zone noise takes the force away (sabotage)") {
  const double found = noise_error(0.0f);
  MESSAGE("error " << 100.0 * found << " %");
  CHECK(found > 10.0 * kNoiseBound);
}
