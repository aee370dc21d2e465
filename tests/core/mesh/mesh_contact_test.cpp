// The contact model `mesh` against closed forms: planes, a ball, an edge, a thin wall; its work on closed paths; flags and frames.
#include <algorithm>
#include <limits>

#include "core/base/units.h"
#include "core/mesh/mesh_contact.h"
#include "core/mesh/mesh_patch.h"
#include "tests/core/contact/contact_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kK = 2000.0;  ///< [N/m] the default stiffness
// [m] Of a plane, on which the 0.5 level is exact (phantom.h): a corner is found to 1e-6 voxel = 5e-10 m and stored as a float of up to
// 0.03 m, 2e-9 m. Over the lowest height of a triangle, 0.08 mm at 9.5 degrees, that tilts the plane by up to 7e-5 rad, and a point is
// within half a millimetre of its corner.
constexpr double kCorner = 3e-9, kTilt = 7e-5, kDepth = kCorner + kTilt * 0.5e-3;

const ContactFields kFields{.density = true, .gradient = false, .words = false, .records = {}, .triangles = make_mesh_patch};

FeltBone meshed(const PhantomSpec& spec, const Pose& world_from_bone = {}) {
  return FeltBone(phantom_of(spec).bone, world_from_bone, 0.08f, {}, kFields);
}

std::unique_ptr<PenaltyModel> mesh_of(const PointShell& shell, const MeshContactConfig& config = {}) {
  auto model = MeshContact::create(config, shell);
  REQUIRE(model.ok());
  return std::move(model).value();
}

PointShell point() { return shell_of({Vec3(0.0)}); }

Pose at(const Vec3& place) { return {{}, place}; }

bool near(const Vec3& a, const Vec3& b, double tolerance) { return glm::length(a - b) <= tolerance; }

}  // namespace

TEST_CASE("mesh contact: on a plane of any tilt the force is k x depth along its normal") {
  for (const double degrees : {0.0, 10.0, 25.0, 37.0, 45.0}) {
    CAPTURE(degrees);
    PhantomSpec spec = small_spec(PhantomKind::plate);
    const Vec3 normal(std::sin(degrees * kDegree), 0.0, std::cos(degrees * kDegree));
    spec.plate_normal = normal;
    const FeltBone bone = meshed(spec);
    const auto model = mesh_of(point());
    for (std::uint64_t n = 0; n < 200; ++n) {
      const double depth = 0.8e-3 * (1.0 + uniform11(4, n)) + 0.01e-3;  // to 1.6 mm of 4
      const Vec3 along = Vec3(normal.z, 0.0, -normal.x) * (1.5e-3 * uniform11(5, 2 * n)) + Vec3(0.0, 1.5e-3 * uniform11(5, 2 * n + 1), 0.0);
      const ContactResult in = evaluated(*model, bone.view(), at(along - depth * normal));
      REQUIRE(in.contacts.size() == 1);
      CHECK(std::abs(in.contacts[0].depth - depth) <= kDepth);
      CHECK(near(in.wrench.force, kK * depth * normal, kK * (kDepth + depth * kTilt)));
      CHECK(in.deepest == in.contacts[0].depth);
      CHECK(in.flags == 0);
      CHECK(evaluated(*model, bone.view(), at(along + (kDepth + 1e-9) * normal)).touching == 0);
    }
  }
}

TEST_CASE("mesh contact: on a ball of bone depth and normal are off by the chords of the triangles at most") {
  // The 0.5 level lies within h^2 / (4 R) of the ball (phantom.h). Corners are on it; a triangle of circumradius r lies up to r^2 / (2 R)
  // below, and its normal is off by up to r / R. A triangle on centres has at most 0.87 voxels. Offsets move its corners along normals that
  // differ, and by up to half a diagonal, 0.87: 1.3 voxels is room for both.
  constexpr double kCircle = 1.3 * kPitch;
  const PhantomSpec spec = small_spec(PhantomKind::sphere);
  const double radius = spec.sphere_radius;
  const FeltBone bone = meshed(spec);
  const auto model = mesh_of(point());
  const double level = kPitch * kPitch / (4.0 * radius), chord = kCircle * kCircle / (2.0 * radius), lean = kCircle / radius;
  std::size_t compared = 0;
  for (std::uint64_t n = 0; n < 600; ++n) {
    const Vec3 out = glm::normalize(random_vector(7, n) + Vec3(0.0, 0.0, 0.5));
    if (out.z < 0.3) continue;  // the grid ends 1 mm below the centre, and bone with it
    const Vec3 centre(0.0, 0.0, -radius);
    const double depth = 0.7e-3 * (1.0 + uniform11(8, n));
    const Vec3 place = centre + (radius - depth) * out;
    const double off = level + chord + depth * (1.0 - std::cos(lean));
    const ContactResult result = evaluated(*model, bone.view(), at(place));
    CHECK(evaluated(*model, bone.view(), at(centre + (radius + level + 1e-9) * out)).touching == 0);
    if (depth <= level + chord) continue;
    REQUIRE(result.touching == 1);
    CHECK(std::abs(result.deepest - depth) <= off);
    CHECK(glm::dot(result.contacts[0].normal, out) >= std::cos(lean));
    ++compared;
  }
  CHECK(compared > 300);
}

TEST_CASE("mesh contact: beside an edge of bone the nearer face pushes, and at it a point loses what the 0.5 level is rounded by") {
  const PhantomSpec spec = small_spec(PhantomKind::wedge);  // of a right angle, along y, symmetric about z
  const FeltBone bone = meshed(spec);
  const auto model = mesh_of(point());
  const Vec3 left = glm::normalize(Vec3(-1.0, 0.0, 1.0)), right = glm::normalize(Vec3(1.0, 0.0, 1.0));
  for (std::uint64_t n = 0; n < 200; ++n) {
    const double y = 2e-3 * uniform11(9, 3 * n), depth = 0.4e-3 * (1.0 + uniform11(9, 3 * n + 1)) + 1e-5;
    const double along = 1.8e-3 + 0.5e-3 * uniform11(9, 3 * n + 2);  // from the edge down the face, at least 2.6 voxels
    for (const Vec3& normal : {left, right}) {
      const Vec3 down(normal.x, 0.0, -normal.z);  // of the face
      const ContactResult result = evaluated(*model, bone.view(), at(along * down - depth * normal + Vec3(0.0, y, 0.0)));
      REQUIRE(result.contacts.size() == 1);
      CHECK(near(result.wrench.force, kK * depth * normal, kK * (kDepth + depth * kTilt)));
    }
    // Under the edge both faces are equally near. No face lies outside the wedge, and the rounding takes less than the diagonal of a voxel.
    const double below = 1.2e-3 * (1.0 + 0.5 * uniform11(10, n)), face = below * std::sqrt(0.5);
    const ContactResult under = evaluated(*model, bone.view(), at({0.0, y, -below}));
    REQUIRE(under.contacts.size() == 1);
    CHECK(under.deepest <= face + kDepth);
    CHECK(under.deepest >= face - std::sqrt(3.0) * kPitch);
    CHECK(under.contacts[0].normal.z > 0.6);  // of a face, or between: 0.71
    CHECK(std::abs(under.contacts[0].normal.y) < 0.1);
  }
}

TEST_CASE("mesh contact: a ball of points on a plate is pushed by its deepest point, an average by the mean of all") {
  const FeltBone bone = meshed(small_spec(PhantomKind::plate));
  const PointShell ball = shipped_shell("acosta_liu_round");
  double lowest = 0.0;
  for (const Vec3& p : ball.positions) lowest = std::min(lowest, p.z);
  const auto deepest = mesh_of(ball), average = mesh_of(ball, {.stacking = MeshStacking::average});
  for (const double tip : {0.1e-3, 0.4e-3, 0.9e-3}) {
    CAPTURE(tip);
    const Pose pose = at({0.13e-3, -0.21e-3, -lowest - tip});
    double sum = 0.0;
    std::size_t inside = 0;
    for (const Vec3& p : ball.positions) {
      const double depth = -(pose * p).z;
      if (std::abs(depth) < kDepth) continue;  // either side is right
      if (depth < 0.0) continue;
      sum += depth;
      ++inside;
    }
    const ContactResult one = evaluated(*deepest, bone.view(), pose), all = evaluated(*average, bone.view(), pose);
    CHECK(near(one.wrench.force, Vec3(0.0, 0.0, kK * tip), kK * (kDepth + tip * kTilt)));
    CHECK(one.contacts.size() == 1);
    CHECK(one.touching == 1);
    CHECK(all.touching == inside);
    CHECK(all.contacts.size() == inside);
    CHECK(near(all.wrench.force, Vec3(0.0, 0.0, kK * sum / static_cast<double>(inside)), kK * (kDepth + tip * kTilt)));
    // Lateral torques of a ring of points cancel up to the points' own asymmetry; force and lever of one point are exact.
    CHECK(near(one.wrench.torque, glm::cross(one.contacts[0].position - pose.translation, one.wrench.force), 1e-15));
    // The reported slope is that of a plane.
    CHECK(std::abs(one.force_gradient[2][2] + kK) <= kK * 1e-3);
    CHECK(std::abs(all.force_gradient[2][2] + kK) <= kK * 1e-3);
  }
}

TEST_CASE("mesh contact: the deepest of a shell is that of its points one by one, in any order") {
  for (const PhantomKind kind : {PhantomKind::sphere, PhantomKind::wedge, PhantomKind::pit}) {
    CAPTURE(static_cast<int>(kind));
    const FeltBone bone = meshed(small_spec(kind));
    const PointShell ball = shipped_shell("acosta_liu_round");
    PointShell backwards = ball;
    std::ranges::reverse(backwards.positions);
    std::ranges::reverse(backwards.inward_normals);
    const auto model = mesh_of(ball), other = mesh_of(backwards), single = mesh_of(point());
    const auto average = mesh_of(ball, {.stacking = MeshStacking::average});
    int touched = 0;
    for (std::uint64_t n = 0; n < 40; ++n) {
      const Pose pose{random_rotation(12, n), Vec3(0.0, 0.0, 1e-3) + 2e-3 * random_vector(13, n)};
      double deepest = 0.0;
      std::size_t inside = 0;
      for (const Vec3& p : ball.positions) {
        const ContactResult alone = evaluated(*single, bone.view(), at(pose * p));
        deepest = std::max(deepest, alone.deepest);
        inside += alone.touching;
      }
      touched += inside > 0 ? 1 : 0;
      // A pose that is applied to a point in two ways is off by roundings of 1e-18 m.
      CHECK(std::abs(evaluated(*model, bone.view(), pose).deepest - deepest) <= 1e-15);
      CHECK(std::abs(evaluated(*other, bone.view(), pose).deepest - deepest) <= 1e-15);
      CHECK(evaluated(*average, bone.view(), pose).touching == inside);
    }
    CHECK(touched > 10);
  }
}

TEST_CASE("mesh contact: in a thin wall the nearer side pushes, and past the middle that is the far side") {
  PhantomSpec spec = small_spec(PhantomKind::plate);
  spec.pitch = 0.25e-3;
  spec.thickness = 1e-3;  // four voxels
  const FeltBone bone = meshed(spec);
  const auto model = mesh_of(point());
  for (std::uint64_t n = 0; n < 100; ++n) {
    const Vec3 aside(2e-3 * uniform11(11, 2 * n), 2e-3 * uniform11(11, 2 * n + 1), 0.0);
    for (const double depth : {0.1e-3, 0.3e-3, 0.45e-3, 0.55e-3, 0.7e-3, 0.9e-3}) {
      const Vec3 expected(0.0, 0.0, depth < 0.5e-3 ? kK * depth : -kK * (1e-3 - depth));
      CHECK(near(evaluated(*model, bone.view(), at(aside - Vec3(0.0, 0.0, depth))).wrench.force, expected, kK * (kDepth + 1e-3 * kTilt)));
    }
    CHECK(evaluated(*model, bone.view(), at(aside - Vec3(0.0, 0.0, 1e-3 + 2.0 * kDepth))).touching == 0);
  }
}

namespace {

/// Work [J] of the force along a closed path of straight steps, by the trapezoidal rule, and a bound of its error: half the change of the
/// force over a step, times the step.
struct LoopWork {
  double work = 0.0, error = 0.0, most = 0.0;  // [J], [J], [J] the largest sum on the way
};

LoopWork work_on(const PenaltyModel& model, const ContactView& bone, const std::vector<Vec3>& stops, double step, double turned = 0.0) {
  LoopWork out;
  const auto force_at = [&](const Vec3& place) {
    const Vec3 force = evaluated(model, bone, at(place)).wrench.force;
    return glm::angleAxis(turned, Vec3(0.0, 1.0, 0.0)) * force;
  };
  for (std::size_t n = 0; n < stops.size(); ++n) {
    const Vec3 &from = stops[n], &to = stops[(n + 1) % stops.size()];
    const int steps = static_cast<int>(std::ceil(glm::length(to - from) / step));
    Vec3 last = force_at(from);
    for (int m = 1; m <= steps; ++m) {
      const Vec3 way = (to - from) / static_cast<double>(steps);
      const Vec3 now = force_at(from + way * static_cast<double>(m));
      out.work += 0.5 * glm::dot(last + now, way);
      out.error += 0.5 * glm::length(now - last) * glm::length(way);
      out.most = std::max(out.most, std::abs(out.work));
      last = now;
    }
  }
  return out;
}

}  // namespace

TEST_CASE("mesh contact: slow closed paths through bone take and give no work, on faces, edges, curves and in a pit") {
  // The depth of a point is continuous, and the force its falling slope: a potential. Averages have none: their share jumps.
  constexpr double kStep = 4e-6;
  for (const PhantomKind kind : {PhantomKind::plate, PhantomKind::sphere, PhantomKind::wedge, PhantomKind::pit}) {
    CAPTURE(static_cast<int>(kind));
    const FeltBone bone = meshed(small_spec(kind));
    const auto model = mesh_of(kind == PhantomKind::pit ? shipped_shell("acosta_liu_round") : point());
    int judged = 0;
    for (std::uint64_t n = 0; n < 6; ++n) {
      std::vector<Vec3> stops{{0.0, 0.0, 1.5e-3}};
      for (std::uint64_t m = 0; m < 4; ++m) stops.push_back(1e-3 * random_vector(20 + n, m) - Vec3(0.0, 0.0, 1.3e-3));
      const LoopWork loop = work_on(*model, bone.view(), stops, kStep);
      CHECK(std::abs(loop.work) <= loop.error);
      if (loop.error > 0.2 * loop.most) continue;  // hardly in bone
      ++judged;
      // A force that is turned by 10 degrees is found.
      if (kind == PhantomKind::plate) CHECK(std::abs(work_on(*model, bone.view(), stops, kStep, 0.17).work) > loop.error);
    }
    CHECK(judged >= 3);
  }
}

TEST_CASE("mesh contact: a moved and turned bone gives the same wrench, turned with it") {
  const PhantomSpec spec = small_spec(PhantomKind::wedge);
  const Pose moved{random_rotation(3, 1), Vec3(0.2, -0.1, 0.05)};
  const FeltBone still = meshed(spec), turned = meshed(spec, moved);
  for (const MeshStacking stacking : {MeshStacking::deepest, MeshStacking::average}) {
    const auto model = mesh_of(shipped_shell("acosta_liu_round"), {.stacking = stacking});
    for (std::uint64_t n = 0; n < 20; ++n) {
      const Pose pose{random_rotation(5, n), Vec3(0.0, 0.0, -1e-3) + 1e-3 * random_vector(6, n)};
      const ContactResult a = evaluated(*model, still.view(), pose), b = evaluated(*model, turned.view(), moved * pose);
      REQUIRE(a.touching == b.touching);
      REQUIRE(a.contacts.size() == b.contacts.size());
      // Positions of 0.2 m carry 3e-17 m of rounding: 1e-13 N; room for a walk of sums.
      CHECK(near(moved.rotate(a.wrench.force), b.wrench.force, 1e-10));
      CHECK(near(moved.rotate(a.wrench.torque), b.wrench.torque, 1e-12));
    }
  }
}

TEST_CASE("mesh contact: apart from bone, outside the window and at a pose that is not finite there is no force") {
  const FeltBone bone = meshed(small_spec(PhantomKind::plate));
  const auto model = mesh_of(shell_of({Vec3(0.0), Vec3(1e-3, 0.0, 0.0)}));
  ContactResult out = evaluated(*model, bone.view(), at({0.0, 0.0, -0.5e-3}));
  REQUIRE(out.touching == 1);
  model->evaluate(bone.view(), at({0.0, 0.0, 1e-3}), out);  // what was in `out` goes
  CHECK(out.contacts.empty());
  CHECK(out.wrench.force == Vec3(0.0));
  CHECK(out.force_gradient == Mat3(0.0));
  CHECK(out.touching == 0);
  CHECK(out.flags == 0);
  for (const double far : {1e3, 1e9, -1e9, 1e300, -1e300})
    CHECK(evaluated(*model, bone.view(), at({far, 0.0, -0.5e-3})).flags == kContactOutsideWindow);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ContactResult lost = evaluated(*model, bone.view(), at({0.0, nan, 0.0}));
  CHECK(lost.flags == kContactNotFinite);
  CHECK(lost.wrench.force == Vec3(0.0));
}

TEST_CASE("mesh contact: where the window ends inside bone there is no surface, and a window in bone alone says so") {
  const DenseBone dense = phantom_of(small_spec(PhantomKind::plate)).bone;  // 24 x 24 x 16 voxels, bone below z = 0, 8 thick
  const auto model = mesh_of(point());
  // The plate goes on beyond this window: the nearest side is still above.
  const FeltBone part(dense, {}, 0.08f, VoxelBox{Vec3i(6, 6, 0), Vec3i(18, 18, 16)}, kFields);
  for (const double x : {-1.4e-3, 0.0, 1.4e-3}) {
    const ContactResult result = evaluated(*model, part.view(), at({x, 0.0, -1.2e-3}));
    CHECK(near(result.wrench.force, Vec3(0.0, 0.0, kK * 1.2e-3), kK * (kDepth + 1.2e-3 * kTilt) + 1e-3 * kK * 1.2e-3));
    CHECK(result.flags == 0);
  }
  DenseBone solid = dense;
  for (float& occupancy : solid.occupancy) occupancy = 1.0f;
  const FeltBone inner(solid, {}, 0.08f, VoxelBox{Vec3i(4), Vec3i(12)}, kFields);
  const ContactResult lost = evaluated(*model, inner.view(), at(inner.view().world_of(Vec3(8.0))));
  CHECK(lost.flags == kContactNoSurface);
  CHECK(lost.wrench.force == Vec3(0.0));
}

TEST_CASE("mesh contact: without triangles in the copy nothing is known, and create refuses what it could not compute with") {
  const FeltBone plain(phantom_of(small_spec(PhantomKind::plate)).bone);
  CHECK(plain.view().triangles() == nullptr);  // a copy for another model holds none
  CHECK(evaluated(*mesh_of(point()), plain.view(), at({0.0, 0.0, -0.5e-3})).flags == kContactOutsideWindow);
  const auto code = [](const MeshContactConfig& config, const PointShell& shell) {
    const auto model = MeshContact::create(config, shell);
    return !model.ok() && model.error().code == ErrorCode::out_of_range;
  };
  CHECK_FALSE(code({}, point()));
  CHECK(code({.stiffness = 0.0}, point()));
  CHECK(code({.stiffness = std::numeric_limits<double>::quiet_NaN()}, point()));
  CHECK(code({}, PointShell{}));
}
