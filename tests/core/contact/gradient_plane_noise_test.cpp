// gradient_plane in noisy bone: the dead zone of the stored gradient keeps the walk straight.
#include "contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

/// Mean over poses of |force in noisy bone - force in clean bone| over the mean force in clean bone.
double force_error(float dead_zone) {
  PhantomSpec clean = small_spec(PhantomKind::plate), noisy = clean;
  noisy.noise = 0.04;
  const FeltBone quiet(phantom_of(clean).bone, {}, dead_zone), loud(phantom_of(noisy).bone, {}, dead_zone);
  const auto model = model_of(shipped_shell("acosta_liu_round"));
  double error = 0.0, force = 0.0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    // 1.2 to 2.0 mm deep: beyond the two voxels over which the phantom's density ramps, where only noise has a gradient.
    const Pose pose{random_rotation(11, n), Vec3(0.0)};
    const Vec3 centre = pose.rotate(Vec3(0.0, 0.0, 2e-3));
    const double depth = 1.2e-3 + 0.8e-3 * uniform01(12, n);
    const Vec3 tip = Vec3(1e-3, 1e-3, 0.0) * random_vector(13, n) + Vec3(0.0, 0.0, 2e-3 - depth) - centre;
    const Vec3 truth = evaluated(*model, quiet.view(), {pose.rotation, tip}).wrench.force;
    const Vec3 felt = evaluated(*model, loud.view(), {pose.rotation, tip}).wrench.force;
    error += glm::length(felt - truth);
    force += glm::length(truth);
  }
  return error / force;
}

// +-4 % of noise shifts the 0.5 level by up to 0.08 voxel (0.08 / 0.5 of the ramp's half width of a voxel, less the mean's 0.02), which
// is 3 % of two voxels of depth, and turns a normal by up to atan(0.02 sqrt(2) / 0.25) = 6 degrees: cos leaves 0.6 %, and the sideways
// parts average out. A voxel whose density crosses 0.5 by noise may move one plane by a facet. 5 % holds all of it.
constexpr double kBound = 0.05;

}  // namespace

TEST_CASE("gradient-plane: 4 % of noise changes the force by under 5 % with the dead zone") { CHECK(force_error(0.08f) < kBound); }

TEST_CASE("gradient-plane: without the dead zone noise takes the force away (sabotage)") { CHECK(force_error(0.0f) > kBound); }
