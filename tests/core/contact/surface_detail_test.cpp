// What is felt is the trilinear 0.5 surface, noise and drilled dents included: the model `surface` as shipped against brute force, and
// against the true swept shape of a drill.
#include <cstdio>

#include "core/tool/cutting_field.h"
#include "surface_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kBall = 1.5e-3;  ///< [m] of the tool that feels

/// [m] from a point in air to the 0.5 surface, by rays through a cone about `towards`: no distance field, no record.
double nearest_by_rays(const ShippedBone& bone, const Vec3& from, const Vec3& towards) {
  const Mat3 axes = glm::mat3_cast(rotation_from_z(towards));
  double least = 1e9;
  constexpr int kRays = 3000;  // in a cone of 35 degrees: 0.02 rad apart, 0.06 voxel aside at most, which is 0.0003 of distance
  for (int n = 0; n < kRays; ++n) {
    const double c = 1.0 - (1.0 - 0.82) * (n + 0.5) / kRays, s = std::sqrt(1.0 - c * c), turn = 2.399963229728653 * n;
    const Vec3 way = axes * Vec3(s * std::cos(turn), s * std::sin(turn), c);
    double in = 0.0;
    for (double at = 0.8 * kBall; at < std::min(least, 1.4 * kBall); at += 0.1 * kFineEdge)
      if (bone.density(from + way * at) >= 0.5) {
        in = at;
        break;
      }
    if (in == 0.0) continue;
    double out = in - 0.1 * kFineEdge;
    for (int k = 0; k < 20; ++k) (bone.density(from + way * (0.5 * (in + out))) >= 0.5 ? in : out) = 0.5 * (in + out);
    least = std::min(least, 0.5 * (in + out));
  }
  return least;
}

/// [voxel] how far a ball at rest stands off the surface, negative inside, worst of some places.
double worst_offset(const PhantomSpec& spec, std::uint64_t seed,
                    const std::function<double(const ShippedBone&, const Vec3&, const Vec3&)>& nearest) {
  const ShippedBone bone(phantom_of(spec));
  auto tool = ConstrainedTool::create(locked(), ball_shell(kBall, 30000), kFineEdge);
  REQUIRE(tool.ok());
  const Vec3 normal = glm::normalize(spec.plate_normal);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 25; ++n) {
    const Vec3 u = 2e-3 * random_vector(seed, n), place = u - normal * glm::dot(u, normal);
    (void)settled_force(*tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), place + normal * (kBall + 0.5e-3)}, -normal * 1.5e-3);
    const double off = (nearest(bone, tool->state().world_from_tool.translation, -normal) - kBall) / kFineEdge;
    if (std::abs(off) > std::abs(worst)) worst = off;
  }
  return worst;
}

/// A cutting ball, or the flat end of a cylinder, its tip the origin, as the drill has it; as high as wide.
struct Cutter {
  double radius;
  ErosionPoints points;
  std::shared_ptr<const CuttingField> field;
  explicit Cutter(double r, bool flat = false) : radius(r) {
    const auto off = [r, flat](const Vec3& p) {
      if (!flat) return glm::length(p - Vec3(0.0, 0.0, r)) - r;
      const double aside = std::hypot(p.x, p.y) - r, along = std::abs(p.z - r) - r;
      return std::min(0.0, std::max(aside, along)) + std::hypot(std::max(0.0, aside), std::max(0.0, along));
    };
    points.pitch = 0.5 * kFineEdge;
    const int reach = static_cast<int>(2.0 * r / points.pitch) + 1;
    for_each_voxel({Vec3i(-reach), Vec3i(reach + 1)}, [&](const Vec3i& v) {
      const Vec3 p = points.pitch * Vec3(v) + Vec3(0.0, 0.0, r);
      if (off(p) > 0.0) return;
      points.positions.push_back(p);
      points.factors.push_back(0.1f);
    });
    auto made = make_cutting_field(
        {Vec3(-r, -r, 0.0), Vec3(r, r, 2.0 * r)}, off, [](const Vec3&) { return 0.1; }, cutting_field_size(kFineEdge, r));
    REQUIRE(made.ok());
    field = std::make_shared<const CuttingField>(std::move(made).value());
  }
};

}  // namespace

TEST_CASE("surface: on noisy bone the felt surface is the trilinear one of the same noise, to a tenth of a voxel") {
  std::printf("felt surface off the trilinear one, worst of 25 places [voxel]:\n");
  for (const Vec3& up : {Vec3(0.0, 0.0, 1.0), Vec3(0.37, -0.22, 1.0)})
    for (const double noise : {0.0, 0.04}) {
      PhantomSpec spec = spec_of(PhantomKind::plate);
      spec.plate_normal = up;
      spec.noise = noise;
      const double worst = worst_offset(spec, 3, nearest_by_rays);
      std::printf("  %s, noise %.2f: %.4f\n", up.x == 0.0 ? "level " : "tilted", noise, worst);
      CHECK(std::abs(worst) < 0.1);
    }
  // Sabotage: judged by the smooth plate's closed form, coarser noise (15 %) is seen.
  PhantomSpec spec = spec_of(PhantomKind::plate);
  spec.noise = 0.15;
  CHECK(std::abs(worst_offset(spec, 3, [](const ShippedBone&, const Vec3& centre, const Vec3&) { return centre.z; })) > 0.1);
}

TEST_CASE("surface: in a dent that a drill left, the ball rests on the true swept shape and is pushed back along it") {
  constexpr double kSpin = 1000.0 / 60.0;  ///< [rev/s]
  const Cutter cutter(2.5e-3);
  ShippedBone bone(phantom_of(spec_of(PhantomKind::plate)));
  auto erosion = Erosion::create({.law = ErosionLaw::rate, .subvoxel = true}, cutter.points, cutter.field);
  REQUIRE(erosion.ok());
  // Down by 1.2 mm in steps of a fifth of a voxel; then it dwells: 0.1 x 16.7 rev/s takes e^-1.3 of what is covered a second.
  const Vec3 aside(0.07e-3, -0.11e-3, 0.0);
  const auto at = [&](double depth) { return Pose{Quat(1.0, 0.0, 0.0, 0.0), aside - Vec3(0.0, 0.0, depth)}; };
  constexpr double kDown = 1.2e-3;
  for (double depth = 0.0; depth < kDown - 1e-9; depth += 0.05e-3) (void)bone.drill(*erosion, at(depth), at(depth + 0.05e-3), kSpin, 1.0);
  for (int n = 0; n < 20; ++n) (void)bone.drill(*erosion, at(kDown), at(kDown), kSpin, 1.0);

  const Vec3 middle = aside + Vec3(0.0, 0.0, cutter.radius - kDown);  // of the swept ball: bone is where a point is further from it
  auto tool = ConstrainedTool::create(locked(), ball_shell(kBall, 120000), kFineEdge);
  REQUIRE(tool.ok());
  double size = 0.0, degrees = 0.0, off_truth = 0.0, off_felt = 0.0;
  for (std::uint64_t n = 0; n < 30; ++n) {
    // Within 30 degrees of straight down, well inside the dent's rim at 61; the hand 0.5 or 2 mm past where the ball touches, 2.5 or 10 N.
    const double lean = 30.0 * kDegree * uniform01(9, 2 * n), turn = 6.3 * uniform01(9, 2 * n + 1);
    const Vec3 way(std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), -std::cos(lean));
    const double deep = n % 2 == 0 ? 0.5e-3 : 2e-3;
    const Vec3 force = settled_force(*tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), middle}, way * (cutter.radius - kBall + deep));
    const Vec3 centre = tool->state().world_from_tool.translation;
    const double expected = kStiffness * deep;
    size = std::max(size, std::abs(glm::length(force) - expected) / std::max(0.01 * expected, kStiffness * 0.1 * kFineEdge));
    degrees = std::max(degrees, degrees_between(force, -way));
    off_truth = std::max(off_truth, std::abs(glm::length(centre - middle) - (cutter.radius - kBall)) / kFineEdge);
    off_felt = std::max(off_felt, std::abs(nearest_by_rays(bone, centre, glm::normalize(centre - middle)) - kBall) / kFineEdge);
  }
  std::printf("drilled dent: force %.3f of what is allowed, %.2f degrees; off the swept shape %.3f, off the 0.5 surface %.3f voxel\n", size,
              degrees, off_truth, off_felt);
  CHECK(size <= 1.0);
  CHECK(off_truth <= 0.1);
  CHECK(off_felt <= 0.1);
  // The ball rolls by the way of (10 - 6) voxels only, and its point of touch wanders by a dozen degrees with a twentieth of a voxel of the
  // wall: by that point's own normal the force was 5.0 degrees off (conforming_normal.h).
  CHECK(degrees <= 0.5);
  // Sabotage: bone that was not drilled to the end feels otherwise.
  ShippedBone whole(phantom_of(spec_of(PhantomKind::plate)));
  (void)whole.drill(*erosion, at(0.0), at(0.8e-3), kSpin, 1.0);
  const Vec3 force = settled_force(*tool, whole.view(), {Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, 3e-3)},
                                   Vec3(0.0, 0.0, -kDown - 0.5e-3 - (3e-3 - kBall)));
  CHECK(glm::length(force - Vec3(0.0, 0.0, kStiffness * 0.5e-3)) > kStiffness * 0.1 * kFineEdge);
}

TEST_CASE("surface: on a flat floor that a drill left, the ball rests on the floor and is pushed back across it") {
  constexpr double kSpin = 1000.0 / 60.0;  ///< [rev/s]
  const Cutter cutter(2.5e-3, true);
  for (const double tilt : {0.0, 7.0}) {
    CAPTURE(tilt);
    const Quat turn = turn_about_x(tilt * kDegree);
    const Vec3 up = turn * Vec3(0.0, 0.0, 1.0);
    ShippedBone bone(phantom_of(spec_of(PhantomKind::plate)));
    auto erosion = Erosion::create({.law = ErosionLaw::rate, .subvoxel = true}, cutter.points, cutter.field);
    REQUIRE(erosion.ok());
    const auto at = [&](double depth) { return Pose{turn, Vec3(0.03e-3, 0.05e-3, 0.0) - up * depth}; };
    constexpr double kDown = 1.13e-3;  // off the grid
    for (double depth = 0.0; depth < kDown - 1e-9; depth += kDown / 20.0)
      (void)bone.drill(*erosion, at(depth), at(depth + kDown / 20.0), kSpin, 1.0);
    for (int n = 0; n < 20; ++n) (void)bone.drill(*erosion, at(kDown), at(kDown), kSpin, 1.0);
    auto tool = ConstrainedTool::create(locked(), ball_shell(kBall, 60000), kFineEdge);
    REQUIRE(tool.ok());
    double degrees = 0.0, off_truth = 0.0;
    for (std::uint64_t n = 0; n < 20; ++n) {
      // Up to 0.5 mm aside: the wall is 2.5 mm from the axis, and so a voxel and more from the ball.
      const Vec3 aside = turn * Vec3(0.5e-3 * uniform11(12, 2 * n), 0.5e-3 * uniform11(12, 2 * n + 1), 0.0);
      const Vec3 start = at(kDown).translation + aside + up * (kBall + 0.3e-3);
      const double deep = n % 2 == 0 ? 0.5e-3 : 2e-3;
      const Vec3 force = settled_force(*tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), start}, -up * (0.3e-3 + deep));
      degrees = std::max(degrees, degrees_between(force, up));
      const double height = glm::dot(tool->state().world_from_tool.translation - at(kDown).translation, up);
      off_truth = std::max(off_truth, std::abs(height - kBall) / kFineEdge);
    }
    std::printf("drilled floor, %.0f degrees: force %.2f degrees, off the floor %.3f voxel\n", tilt, degrees, off_truth);
    CHECK(degrees <= 0.5);
    CHECK(off_truth <= 0.1);
    // Sabotage: a force along the axis of a bit that leaned a degree more.
    CHECK(degrees_between(turn_about_x(kDegree) * up, up) > 0.5);
  }
}
