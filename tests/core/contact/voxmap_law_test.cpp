// voxmap_contact against closed forms: one point, the staircase, stacking, gradient of the force, faults.
#include <limits>

#include "contact_support.h"
#include "core/base/units.h"
#include "core/contact/voxmap_contact.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kK = 2000.0;  ///< [N/m] the default stiffness
// Products of doubles near 1 N: a dozen roundings.
constexpr double kExact = 1e-12;

std::unique_ptr<PenaltyModel> voxmap_of(const PointShell& shell, const VoxmapContactConfig& config = {}) {
  auto model = VoxmapContact::create(config, shell);
  REQUIRE(model.ok());
  return std::move(model).value();
}

bool near(const Vec3& a, const Vec3& b, double tolerance) { return glm::length(a - b) <= tolerance; }

Pose at(double x, double y, double z) { return {{}, Vec3(x, y, z)}; }

/// `count` points on a level face of 0.1 mm steps.
PointShell level_face(int count) {
  std::vector<Vec3> positions;
  for (int n = 0; n < count; ++n) positions.push_back(Vec3(n % 8, n / 8, 0.0) * 1e-4);
  return shell_of(std::move(positions));
}

/// Two points whose tool vectors are a right angle apart, and whose depths under their planes differ.
PointShell right_angle() {
  PointShell shell = shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.1e-3)});
  shell.inward_normals = {Vec3(0.6, 0.0, 0.8), Vec3(-0.8, 0.0, 0.6)};
  return shell;
}

}  // namespace

TEST_CASE("voxmap: over a level plate the plane lies half a voxel under the surface, in the point's own layer or the first") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));  // facets on z = 0, -s, -2 s ..
  const auto own = voxmap_of(shell_of({Vec3(0.0)}));
  const auto surface = voxmap_of(shell_of({Vec3(0.0)}), {.plane_voxel = PlaneVoxel::surface});
  for (const double depth : {0.1e-3, 0.2e-3, 0.3e-3, 0.45e-3, 0.55e-3, 0.9e-3, 1.4e-3}) {
    CAPTURE(depth);
    const Pose pose = at(0.11e-3, -0.23e-3, -depth);
    const double into_layer = depth - kPitch * std::floor(depth / kPitch);
    const ContactResult sawtooth = evaluated(*own, bone.view(), pose), whole = evaluated(*surface, bone.view(), pose);
    REQUIRE(sawtooth.contacts.size() == 1);  // collides, though above its plane in the outer half of a layer
    CHECK(near(sawtooth.wrench.force, Vec3(0.0, 0.0, kK * std::max(0.0, into_layer - kPitch / 2)), kExact));
    CHECK(near(whole.wrench.force, Vec3(0.0, 0.0, kK * std::max(0.0, depth - kPitch / 2)), kExact));
    CHECK(sawtooth.flags == 0);
    CHECK(whole.flags == 0);
  }
}

TEST_CASE("voxmap: a point whose tool vector leans slides over a staircase of s sin(lean) even on a level plate") {
  // [AcostaLiu07] figure 4. Between boundaries force falls along the way by k N_x a metre, at each boundary it jumps back by k s N_x.
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  for (const double lean : {0.0, 10.0, 30.0}) {
    CAPTURE(lean);
    const Vec3 normal(std::sin(lean * kDegree), 0.0, std::cos(lean * kDegree));
    const auto model = voxmap_of(shell_of({Vec3(0.0)}, normal));
    const auto length = [&](double x) { return glm::dot(evaluated(*model, bone.view(), at(x, 0.1e-3, -0.45e-3)).wrench.force, normal); };
    const double step = 10e-6;
    int jumps = 0;
    for (int n = 0; n < 300; ++n) {
      const double from = (n - 150.5) * step, change = length(from + step) - length(from);
      // Voxel faces at multiples of s: the grid is centred, 24 voxels across.
      const bool crosses = std::floor((from + step) / kPitch) != std::floor(from / kPitch);
      jumps += crosses ? 1 : 0;
      const double expected = kK * normal.x * ((crosses ? kPitch : 0.0) - step);
      // The depth must stay positive for the closed form: 0.2 mm cos - 0.25 mm sin > 0 up to 38 degrees.
      CHECK(std::abs(change - expected) <= kExact);
    }
    CHECK(jumps == 6);
  }
}

TEST_CASE("voxmap: on a tilted plate depth falls short by up to s (1 + |N|_1) and is cut to half a diagonal in the own voxel") {
  // Own derivation. The voxel that holds the plane is solid, so its centre lies e >= 0 under the true plane, and d = y - e. Along the tool
  // vector N the point q of the last solid voxel has a successor s further whose voxel's centre is in air; centres are within s |N|_1 / 2
  // of points of their voxel along N: e < s (1 + |N|_1). In the own voxel d = (centre - P_h) . N <= s |N|_1 / 2 for the same reason.
  for (const double degrees : {5.0, 15.0, 25.0, 35.0, 45.0}) {
    CAPTURE(degrees);
    PhantomSpec spec = small_spec(PhantomKind::plate);
    const Vec3 normal(std::sin(degrees * kDegree), 0.0, std::cos(degrees * kDegree));
    spec.plate_normal = normal;
    const FeltBone bone = felt(spec);
    const auto own = voxmap_of(shell_of({Vec3(0.0)}, normal));
    const auto surface = voxmap_of(shell_of({Vec3(0.0)}, normal), {.plane_voxel = PlaneVoxel::surface});
    const double across = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    double least = 1.0, most = -1.0;
    for (std::uint64_t n = 0; n < 400; ++n) {
      const double depth = 1.3e-3;
      const Vec3 along = Vec3(normal.z, 0.0, -normal.x) * (1e-3 * uniform11(5, 2 * n)) + Vec3(0.0, 1e-3 * uniform11(5, 2 * n + 1), 0.0);
      const Pose pose{{}, along - depth * normal};
      const ContactResult walked = evaluated(*surface, bone.view(), pose), looked = evaluated(*own, bone.view(), pose);
      REQUIRE(walked.contacts.size() == 1);
      REQUIRE(looked.contacts.size() == 1);
      CHECK(looked.contacts[0].depth <= 0.5 * kPitch * across + 1e-15);
      least = std::min(least, (depth - walked.contacts[0].depth) / kPitch);
      most = std::max(most, (depth - walked.contacts[0].depth) / kPitch);
    }
    // Density is a float: a centre on the plane may count as solid from 1e-7 voxels above it.
    CHECK(least >= -1e-6);
    CHECK(most < 1.0 + across);
    CHECK(most - least > 0.3);  // the staircase is there, on one flat plate; the 2 mm at 5 degrees pass 0.35 voxel of it
  }
}

TEST_CASE("voxmap: a flat face of n points gives n k d, min(n, 10) k d, k d and k d") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const double d = 0.2e-3;  // 0.45 mm under the surface, half a voxel of it lost
  for (const int n : {1, 4, 10, 11, 40}) {
    CAPTURE(n);
    const auto force = [&](Stacking stacking) {
      return evaluated(*voxmap_of(level_face(n), {.stacking = stacking}), bone.view(), at(0.0, 0.0, -d - kPitch / 2)).wrench.force;
    };
    // Up to 40 N: roundings grow with it.
    CHECK(near(force(Stacking::sum), Vec3(0.0, 0.0, n * kK * d), 40 * kExact));
    CHECK(near(force(Stacking::sum_limited), Vec3(0.0, 0.0, std::min(n, 10) * kK * d), 40 * kExact));
    CHECK(near(force(Stacking::average), Vec3(0.0, 0.0, kK * d), 40 * kExact));
    CHECK(near(force(Stacking::deepest), Vec3(0.0, 0.0, kK * d), 40 * kExact));
  }
}

TEST_CASE(
    "voxmap: a point that joins at depth 0 takes nothing from a sum, under the noticeable 10 % from a limited one, more from an average") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const double d = 0.2e-3;
  for (const int n : {1, 2, 9, 10, 11, 40}) {
    CAPTURE(n);
    PointShell joined = level_face(n + 1);
    joined.positions.back().z += d;  // on the plane through the centres of its layer
    const auto lost = [&](Stacking stacking) {
      const auto force = [&](const PointShell& shell) {
        return evaluated(*voxmap_of(shell, {.stacking = stacking}), bone.view(), at(0.0, 0.0, -d - kPitch / 2)).wrench.force.z;
      };
      return 1.0 - force(joined) / force(level_face(n));
    };
    // Shares of forces of up to 40 N, which are exact to 40 kExact.
    CHECK(std::abs(lost(Stacking::sum)) <= 40 * kExact);
    CHECK(std::abs(lost(Stacking::sum_limited) - (n < 10 ? 0.0 : 1.0 / (n + 1))) <= 40 * kExact);
    CHECK(lost(Stacking::sum_limited) < 0.1);
    CHECK(std::abs(lost(Stacking::average) - 1.0 / (n + 1)) <= 40 * kExact);
  }
}

TEST_CASE("voxmap: the deepest point sets the length, all of them the direction and the line of action") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  // Own voxels: centres at (0.25, 0.25, -0.25) and (1.25, 0.25, -0.25) mm. Points at (0.2, 0.2, -0.45) and (1.2, 0.2, -0.35) mm.
  const Pose pose = at(0.2e-3, 0.2e-3, -0.45e-3);
  const ContactResult result = evaluated(*voxmap_of(right_angle(), {.stacking = Stacking::deepest}), bone.view(), pose);
  REQUIRE(result.contacts.size() == 2);
  const double d1 = 0.6 * 0.05e-3 + 0.8 * 0.2e-3, d2 = -0.8 * 0.05e-3 + 0.6 * 0.1e-3;
  CHECK(std::abs(result.contacts[0].depth - d1) <= 1e-15);
  CHECK(std::abs(result.contacts[1].depth - d2) <= 1e-15);
  // At a right angle the sum has length sqrt(d1^2 + d2^2) and the longer projection on it is d1^2 over that.
  const Vec3 sum = d1 * Vec3(0.6, 0.0, 0.8) + d2 * Vec3(-0.8, 0.0, 0.6);
  const double scale = kK * d1 * d1 / (d1 * d1 + d2 * d2);
  CHECK(near(result.wrench.force, scale * sum, kExact));
  CHECK(near(result.wrench.torque, scale * glm::cross(Vec3(1e-3, 0.0, 0.1e-3), d2 * Vec3(-0.8, 0.0, 0.6)), kExact * 1e-3));
}

TEST_CASE("voxmap: points that cancel leave no direction and no force") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  PointShell shell = shell_of({Vec3(0.0), Vec3(0.0)});
  // In one voxel with opposite vectors one of the two is above its plane: two voxels and two planes are needed.
  shell.positions = {Vec3(0.2e-3, 0.0, 0.0), Vec3(-0.2e-3, 0.0, 0.0)};
  shell.inward_normals = {Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0)};
  for (const Stacking stacking : {Stacking::sum, Stacking::sum_limited, Stacking::average, Stacking::deepest}) {
    const ContactResult result = evaluated(*voxmap_of(shell, {.stacking = stacking}), bone.view(), at(0.0, 0.0, -0.45e-3));
    REQUIRE(result.contacts.size() == 2);
    CHECK(result.contacts[0].depth > 0.04e-3);
    CHECK(near(result.wrench.force, Vec3(0.0), kExact));
    CHECK(near(result.wrench.torque, Vec3(0.0), kExact));
  }
}

TEST_CASE("voxmap: force gradient is the slope of the force where the contacts stay the same, for every stacking") {
  PhantomSpec spec = small_spec(PhantomKind::plate);
  spec.plate_normal = Vec3(0.4, 0.1, 1.0);
  const FeltBone bone = felt(spec);
  for (const Stacking stacking : {Stacking::sum, Stacking::sum_limited, Stacking::average, Stacking::deepest}) {
    CAPTURE(static_cast<int>(stacking));
    const auto model = voxmap_of(shipped_shell("acosta_liu_round"), {.stacking = stacking, .plane_voxel = PlaneVoxel::surface});
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
      // Cancellation: 1e-14 N over 1e-8 m; `deepest` is not linear, its third derivative k/d^2 leaves k (h/d)^2 with d near 0.1 mm.
      for (int axis = 0; axis < 3; ++axis) CHECK(near(slope[axis], here.force_gradient[axis], 1e-4));
    }
    CHECK(compared >= 20);
  }
}

TEST_CASE("voxmap: in paper mode any density is solid, otherwise half") {
  DenseBone dense;
  dense.dims = Vec3i(5);
  dense.bone_from_index = Affine::scaling(kPitch, Vec3(0.0));
  dense.occupancy.assign(125, 0.0f);
  dense.occupancy[VoxelBox{Vec3i(0), dense.dims}.offset_of({2, 2, 2})] = 0.25f;
  dense.hardness = dense.occupancy;
  const FeltBone bone(dense);
  const PointShell shell = shell_of({kPitch * Vec3(2.0, 2.0, 1.7)});
  CHECK(evaluated(*voxmap_of(shell), bone.view()).contacts.empty());
  const ContactResult paper = evaluated(*voxmap_of(shell, {.paper_mode = true}), bone.view());
  CHECK(near(paper.wrench.force, Vec3(0.0, 0.0, kK * 0.3 * kPitch), kExact));
}

TEST_CASE("voxmap: apart from bone there is no force, no contact, no flag") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = voxmap_of(shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.0)}));
  ContactResult out = evaluated(*model, bone.view(), at(0.0, 0.0, -0.45e-3));
  REQUIRE(out.contacts.size() == 2);
  model->evaluate(bone.view(), at(0.0, 0.0, 1e-3), out);  // what was in `out` goes
  CHECK(out.contacts.empty());
  CHECK(out.wrench.force == Vec3(0.0));
  CHECK(out.wrench.torque == Vec3(0.0));
  CHECK(out.force_gradient == Mat3(0.0));
  CHECK(out.flags == 0);
}

TEST_CASE("voxmap: a pose that is not finite gives zero and says so") {
  const FeltBone bone = felt(small_spec(PhantomKind::plate));
  const auto model = voxmap_of(shell_of({Vec3(1e-3, 0.0, 0.0)}));
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Pose& pose :
       {at(0.0, nan, 0.0), at(0.0, 0.0, -inf), Pose{Quat(nan, 0.0, 0.0, 0.0), Vec3(0.0)}, Pose{Quat(1.0, 0.0, inf, 0.0), Vec3(0.0)}}) {
    const ContactResult result = evaluated(*model, bone.view(), pose);
    CHECK(result.flags == kContactNotFinite);
    CHECK(result.wrench.force == Vec3(0.0));
    CHECK(result.contacts.empty());
  }
}

TEST_CASE("voxmap: points and marches that leave the window are flagged and left out, at any distance") {
  const DenseBone dense = phantom_of(small_spec(PhantomKind::plate)).bone;
  const FeltBone bone(dense, {}, 0.08f, VoxelBox{Vec3i(4), Vec3i(20, 20, 16)});
  const auto model = voxmap_of(shell_of({Vec3(0.0), Vec3(5e-3, 0.0, 0.0)}));
  const ContactResult result = evaluated(*model, bone.view(), at(0.0, 0.0, -0.45e-3));
  CHECK(result.flags == kContactOutsideWindow);
  REQUIRE(result.contacts.size() == 1);
  CHECK(result.contacts[0].point == 0);
  for (const double far : {1.0, 1e6, 1e12, 1e300}) {
    CAPTURE(far);
    const ContactResult away = evaluated(*model, bone.view(), at(0.0, far, 0.0));
    CHECK(away.flags == kContactOutsideWindow);
    CHECK(away.contacts.empty());
  }
  // Sideways through the plate the march reaches the window's end before any air, or first its own bound.
  for (const auto& [march, flag] : {std::pair{64, kContactOutsideWindow}, {3, kContactNoSurface}}) {
    const auto sideways = voxmap_of(shell_of({Vec3(0.0)}, Vec3(1.0, 0.0, 0.0)), {.plane_voxel = PlaneVoxel::surface, .max_march = march});
    const ContactResult lost = evaluated(*sideways, bone.view(), at(0.0, 0.0, -0.75e-3));
    CHECK(lost.flags == static_cast<std::uint32_t>(flag));
    CHECK(lost.contacts.empty());
  }
}

TEST_CASE("voxmap: create refuses what it could not use") {
  const auto refused = [](const VoxmapContactConfig& config, const PointShell& shell) {
    return !VoxmapContact::create(config, shell).ok();
  };
  const PointShell shell = shell_of({Vec3(0.0)});
  CHECK_FALSE(refused({}, shell));
  CHECK(refused({.stiffness = 0.0}, shell));
  CHECK(refused({.stiffness = std::numeric_limits<double>::infinity()}, shell));
  CHECK(refused({.max_march = 0}, shell));
  CHECK(refused({}, PointShell{}));
  PointShell torn = shell;
  torn.inward_normals.clear();
  CHECK(refused({}, torn));
}
