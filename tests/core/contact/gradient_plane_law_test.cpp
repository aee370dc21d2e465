// gradient_plane against closed forms: one point, averages, torque, figure 5, gradient of the force, faults.
#include <limits>

#include "contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kK = 2000.0;  ///< [N/m] the default stiffness
// Products of doubles near 1 N: a dozen roundings.
constexpr double kExact = 1e-12;

/// A box of full voxels lo..hi (both included) in an empty grid of 16^3, pitch 0.5 mm; index 0 at the origin.
DenseBone full_box(const Vec3i& lo, const Vec3i& hi) {
  DenseBone bone;
  bone.dims = Vec3i(16);
  bone.bone_from_index = Affine::scaling(kPitch, Vec3(0.0));
  bone.occupancy.assign(16 * 16 * 16, 0.0f);
  for_each_voxel({lo, hi + 1}, [&](const Vec3i& v) { bone.occupancy[VoxelBox{Vec3i(0), bone.dims}.offset_of(v)] = 1.0f; });
  bone.hardness = bone.occupancy;
  return bone;
}

/// One contact of a point at an index position with its tool vector.
ContactResult touch(const FeltBone& bone, const Vec3& index, const Vec3& inward) {
  const Vec3 position = bone.dense().bone_from_index * index;
  return evaluated(*model_of(shell_of({position}, inward)), bone.view());
}

bool near(const Vec3& a, const Vec3& b, double tolerance) { return glm::length(a - b) <= tolerance; }

}  // namespace

TEST_CASE("gradient-plane: one point over a level plate is pushed by k d along the normal, d measured to the facet") {
  // 3 mm of air at 0.5 mm: facets lie on z = 0. With 3.15 mm the layer whose centre is at -0.1 mm is full and ends at +0.15 mm.
  for (const auto& [above, facet] : {std::pair{3.0e-3, 0.0}, {3.15e-3, 0.15e-3}}) {
    PhantomSpec spec = small_spec(PhantomKind::plate);
    spec.above = above;
    const FeltBone bone = felt(spec);
    const auto model = model_of(shell_of({Vec3(0.0)}));
    for (const double depth : {0.05e-3, 0.2e-3, 0.7e-3, 1.4e-3}) {
      CAPTURE(depth);
      const ContactResult result = evaluated(*model, bone.view(), {{}, Vec3(0.11e-3, -0.23e-3, -depth)});
      REQUIRE(result.contacts.size() == 1);
      CHECK(near(result.wrench.force, Vec3(0.0, 0.0, kK * (depth + facet)), kExact));
      CHECK(near(result.wrench.torque, Vec3(0.0), kExact));
      CHECK(result.flags == 0);
    }
  }
}

TEST_CASE("gradient-plane: the resultant is the average over colliding points, those at d = 0 included") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const double depth = 0.6e-3;
  // One point at depth, and three more 0.2 mm under the surface: k (0.6 + 3 * 0.2) / 4.
  const auto model =
      model_of(shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.4e-3), Vec3(0.0, 1e-3, 0.4e-3), Vec3(-1e-3, 0.0, 0.4e-3), Vec3(0.0, 0.0, 2e-3)}));
  const ContactResult result = evaluated(*model, bone.view(), {{}, Vec3(0.0, 0.0, -depth)});
  REQUIRE(result.contacts.size() == 4);  // the fifth is in air and has no part
  CHECK(near(result.wrench.force, Vec3(0.0, 0.0, kK * 0.3e-3), kExact));

  // An edge voxel's plane runs through its centre, so a point in its outer half collides at d = 0 and still counts.
  const FeltBone box(full_box(Vec3i(4), Vec3i(11)));
  const Vec3 deep(4.1, 8.0, 10.6), shallow(4.0, 6.0, 11.2);
  const double alone = touch(box, deep, Vec3(0.0, 0.0, 1.0)).contacts.at(0).depth;
  REQUIRE(alone > 0.05e-3);
  const ContactResult both = evaluated(*model_of(shell_of({kPitch * deep, kPitch * shallow})), box.view());
  REQUIRE(both.contacts.size() == 2);
  CHECK(both.contacts[1].depth == 0.0);
  CHECK(std::abs(glm::length(both.wrench.force) - 0.5 * kK * alone) <= kExact);
}

TEST_CASE("gradient-plane: the average loses force when shallow points join, as the paper's law does") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = model_of(shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.5e-3), Vec3(-1e-3, 0.0, 0.5e-3), Vec3(0.0, 1e-3, 0.5e-3)}));
  const auto force = [&](double depth) { return evaluated(*model, bone.view(), {{}, Vec3(0.0, 0.0, -depth)}).wrench.force.z; };
  CHECK(std::abs(force(0.49e-3) - kK * 0.49e-3) <= kExact);
  CHECK(std::abs(force(0.51e-3) - kK * (0.51e-3 + 3 * 0.01e-3) / 4.0) <= kExact);  // deeper, and a quarter of the force
}

TEST_CASE("gradient-plane: torque is the arm from the tool origin across the force") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = model_of(shell_of({Vec3(2e-3, -1e-3, 0.0), Vec3(-1e-3, 0.5e-3, 0.1e-3)}));
  const ContactResult result = evaluated(*model, bone.view(), {{}, Vec3(0.3e-3, 0.2e-3, -0.4e-3)});
  const double f1 = 0.5 * kK * 0.4e-3, f2 = 0.5 * kK * 0.3e-3;  // along z
  // (x, y, .) x (0, 0, f) = (y f, -x f, 0)
  CHECK(near(result.wrench.torque, Vec3(-1e-3 * f1 + 0.5e-3 * f2, -2e-3 * f1 + 1e-3 * f2, 0.0), kExact));
}

TEST_CASE("gradient-plane: the plane lies on the facet when exactly one of six is exposed, through the centre otherwise") {
  const FeltBone bone(full_box(Vec3i(4), Vec3i(11)));
  const auto plane_voxel = [&](const Vec3& index, const Vec3& inward) {
    const ContactResult result = touch(bone, index, inward);
    REQUIRE(result.contacts.size() == 1);
    return result.contacts[0].plane_point / kPitch;
  };
  const double exact = 1e-9;  // [voxel]
  const Vec3 up(0.0, 0.0, 1.0);
  CHECK(near(plane_voxel({8.0, 8.0, 10.9}, up), Vec3(8.0, 8.0, 11.5), exact));                                     // face, top
  CHECK(near(plane_voxel({8.0, 8.0, 4.1}, -up), Vec3(8.0, 8.0, 3.5), exact));                                      // face, bottom
  CHECK(near(plane_voxel({11.1, 7.0, 8.0}, {1.0, 0.0, 0.0}), Vec3(11.5, 7.0, 8.0), exact));                        // face, side
  CHECK(near(plane_voxel({8.0, 10.9, 10.9}, glm::normalize(Vec3(0.0, 1.0, 1.0))), Vec3(8.0, 11.0, 11.0), exact));  // edge: two exposed
  CHECK(near(plane_voxel({10.9, 10.9, 10.9}, glm::normalize(Vec3(1.0))), Vec3(11.0), exact));                      // corner: three exposed
  const FeltBone sheet(full_box({4, 4, 8}, {11, 11, 8}));  // one voxel: two facets, opposite
  CHECK(near(touch(sheet, {8.0, 8.0, 8.1}, up).contacts.at(0).plane_point / kPitch, Vec3(8.0, 8.0, 8.0), exact));
}

TEST_CASE("gradient-plane: force gradient is the slope of the force where the contacts stay the same") {
  PhantomSpec spec = small_spec(PhantomKind::plate);
  spec.plate_normal = Vec3(0.4, 0.1, 1.0);
  const FeltBone bone = felt(spec);
  const auto model = model_of(shipped_shell("acosta_liu_round"));
  int compared = 0;
  for (std::uint64_t n = 0; n < 40; ++n) {
    const Pose pose{random_rotation(7, n), Vec3(0.0, 0.0, -0.5e-3) + 1e-3 * random_vector(8, n)};
    const ContactResult here = evaluated(*model, bone.view(), pose);
    if (here.contacts.empty()) continue;
    Mat3 slope(0.0);
    bool same = true;
    const double h = 1e-8;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 step(0.0);
      step[axis] = h;
      const ContactResult more = evaluated(*model, bone.view(), {pose.rotation, pose.translation + step});
      const ContactResult less = evaluated(*model, bone.view(), {pose.rotation, pose.translation - step});
      for (const ContactResult* moved : {&more, &less}) {
        same = same && moved->contacts.size() == here.contacts.size();
        for (std::size_t i = 0; same && i < here.contacts.size(); ++i)
          same = moved->contacts[i].plane_point == here.contacts[i].plane_point &&
                 (moved->contacts[i].depth > 0.0) == (here.contacts[i].depth > 0.0);
      }
      slope[axis] = (more.wrench.force - less.wrench.force) / (2.0 * h);
    }
    if (!same) continue;
    ++compared;
    // The law is linear between changes: only cancellation is left, 1e-16 N / 1e-8 m = 1e-8 N/m, with room.
    for (int axis = 0; axis < 3; ++axis) CHECK(near(slope[axis], here.force_gradient[axis], 1e-5));
  }
  CHECK(compared >= 20);
}

TEST_CASE("gradient-plane: apart from bone there is no force, no contact, no flag") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = model_of(shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.0)}));
  ContactResult out = evaluated(*model, bone.view(), {{}, Vec3(0.0, 0.0, -0.5e-3)});
  REQUIRE(out.contacts.size() == 2);
  model->evaluate(bone.view(), {{}, Vec3(0.0, 0.0, 1e-3)}, out);  // what was in `out` goes
  CHECK(out.contacts.empty());
  CHECK(out.wrench.force == Vec3(0.0));
  CHECK(out.wrench.torque == Vec3(0.0));
  CHECK(out.force_gradient == Mat3(0.0));
  CHECK(out.flags == 0);
}

TEST_CASE("gradient-plane: a pose that is not finite gives zero and says so") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = model_of(shell_of({Vec3(1e-3, 0.0, 0.0)}));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Pose& pose : {Pose{{}, Vec3(0.0, nan, 0.0)}, Pose{{}, Vec3(0.0, 0.0, -inf)}, Pose{Quat(nan, 0.0, 0.0, 0.0), Vec3(0.0)},
                           Pose{Quat(1.0, 0.0, inf, 0.0), Vec3(0.0)}}) {
    const ContactResult result = evaluated(*model, bone.view(), pose);
    CHECK(result.flags == kContactNotFinite);
    CHECK(result.wrench.force == Vec3(0.0));
    CHECK(result.contacts.empty());
  }
}

TEST_CASE("gradient-plane: points outside the window are flagged and left out, at any distance") {
  const DenseBone dense = phantom_of(small_spec(PhantomKind::plate)).bone;
  const FeltBone bone(dense, {}, 0.08f, VoxelBox{Vec3i(4), Vec3i(20, 20, 16)});
  const auto model = model_of(shell_of({Vec3(0.0), Vec3(5e-3, 0.0, 0.0)}));
  const ContactResult result = evaluated(*model, bone.view(), {{}, Vec3(0.0, 0.0, -0.5e-3)});
  CHECK(result.flags == kContactOutsideWindow);
  CHECK(result.contacts.size() == 1);
  CHECK(near(result.wrench.force, Vec3(0.0, 0.0, kK * 0.5e-3), kExact));  // the average is over what is known
  // A device that reports nonsense: beyond what an index can hold.
  for (const double far : {1e3, 1e9, -1e9, 1e300, -1e300})
    CHECK(evaluated(*model, bone.view(), {{}, Vec3(far, 0.0, -0.5e-3)}).flags == kContactOutsideWindow);
}

TEST_CASE("gradient-plane: a walk that meets its limit is flagged and gives no force") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto flags_at = [&](double depth, const GradientPlaneConfig& config) {
    const ContactResult result = evaluated(*model_of(shell_of({Vec3(0.0)}), config), bone.view(), {{}, Vec3(0.0, 0.0, -depth)});
    CHECK(result.contacts.empty() == (result.flags != 0));
    if (result.flags != 0) CHECK(result.wrench.force == Vec3(0.0));
    return result.flags;
  };
  GradientPlaneConfig march, ascent;
  march.max_march = 1;
  ascent.max_ascent = 1;
  CHECK(flags_at(1.9e-3, {}) == 0);  // mid-plate, no gradient there
  CHECK(flags_at(1.9e-3, march) == kContactNoSurface);
  CHECK(flags_at(0.2e-3, ascent) == 0);  // in the surface voxel: one step leaves bone
  CHECK(flags_at(0.7e-3, ascent) == kContactNoSurface);
}

TEST_CASE("gradient-plane: a surface voxel without gradient is flagged and the tool vector stands in") {
  const FeltBone sheet(full_box({4, 4, 8}, {11, 11, 8}));  // density 0 1 0: the central difference in the middle is zero
  const Vec3 inward = glm::normalize(Vec3(0.1, 0.0, 1.0));
  const ContactResult result = touch(sheet, {8.0, 8.0, 7.9}, inward);
  REQUIRE(result.contacts.size() == 1);
  CHECK(result.flags == kContactZeroGradient);
  CHECK(near(result.contacts[0].normal, inward, kExact));
  CHECK(std::abs(result.contacts[0].depth - 0.1 * kPitch * inward.z) <= kExact);
}

TEST_CASE("gradient-plane: a moved and turned bone gives the same wrench, turned with it") {
  const PhantomSpec spec = small_spec(PhantomKind::wedge);
  const Pose moved{random_rotation(3, 1), Vec3(0.2, -0.1, 0.05)};
  const FeltBone still = felt(spec), turned(phantom_of(spec).bone, moved);
  const auto model = model_of(shipped_shell("acosta_liu_round"));
  for (std::uint64_t n = 0; n < 20; ++n) {
    const Pose pose{random_rotation(5, n), Vec3(0.0, 0.0, -1e-3) + 1e-3 * random_vector(6, n)};
    const ContactResult a = evaluated(*model, still.view(), pose), b = evaluated(*model, turned.view(), moved * pose);
    REQUIRE(a.contacts.size() == b.contacts.size());
    // Positions of 0.2 m carry 3e-17 m of rounding: 1e-13 N; room for a walk of sums.
    CHECK(near(moved.rotate(a.wrench.force), b.wrench.force, 1e-10));
    CHECK(near(moved.rotate(a.wrench.torque), b.wrench.torque, 1e-12));
  }
}

TEST_CASE("gradient-plane: create refuses what it could not compute with") {
  const PointShell good = shell_of({Vec3(0.0)});
  const auto code = [](const GradientPlaneConfig& config, const PointShell& shell) {
    const auto model = GradientPlane::create(config, shell);
    return !model.ok() && model.error().code == ErrorCode::out_of_range;
  };
  CHECK_FALSE(code({}, good));
  CHECK(code({.stiffness = 0.0}, good));
  CHECK(code({.stiffness = std::numeric_limits<double>::quiet_NaN()}, good));
  CHECK(code({.max_march = 0}, good));
  CHECK(code({.max_ascent = 0}, good));
  CHECK(code({}, PointShell{}));
  PointShell uneven = good;
  uneven.inward_normals.clear();
  CHECK(code({}, uneven));
}
