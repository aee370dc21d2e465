// The contact model `surface` as shipped (voxmap, published records, constrained tool) against the closed form of the phantoms: the force
// on a tool at rest is K times the smallest translation that takes it out of the bone.
#include <cstdio>

#include "surface_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

/// A ball tool 1 mm above a place of the surface, brought into bone by the hand.
struct Press {
  Vec3 place{0.0};   ///< [m] of the ball's lowest point at contact
  Vec3 normal{0.0};  ///< there
};

struct Site {
  std::string name;
  PhantomSpec spec;
  std::vector<Press> presses;
};

Press press_at(const Truth& truth, const Vec3& near) {
  Vec3 p = near;
  for (int n = 0; n < 20; ++n) p -= truth.normal(p) * truth.signed_distance(p);
  return {p, truth.normal(p + 1e-6 * truth.normal(p))};
}

constexpr std::uint64_t kSeed = 5;

std::vector<Site> sites() {
  std::vector<Site> all;
  const auto add = [&](const std::string& name, const PhantomSpec& spec, double across, double least_x = 0.0) {
    Site site{name, spec, {}};
    const Truth truth(spec);
    for (std::uint64_t n = 0; n < 40; ++n) {
      const Vec3 u = random_vector(kSeed, n);
      Vec3 near(across * u.x, across * u.y, 0.0);
      if (least_x > 0.0)
        near = Vec3((n % 2 == 0 ? 1.0 : -1.0) * (least_x + across * std::abs(u.x)), across * u.y, -least_x - across * std::abs(u.x));
      site.presses.push_back(press_at(truth, near));
    }
    all.push_back(std::move(site));
  };
  add("level plate", spec_of(PhantomKind::plate), 2e-3);
  PhantomSpec tilted = spec_of(PhantomKind::plate);
  tilted.plate_normal = Vec3(0.37, -0.22, 1.0);
  add("tilted plate", tilted, 2e-3);
  tilted.plate_normal = Vec3(0.8, 0.35, 1.0);
  add("steep plate", tilted, 1e-3);
  PhantomSpec sphere = spec_of(PhantomKind::sphere);
  sphere.sphere_radius = 5e-3;
  add("sphere", sphere, 3e-3);
  PhantomSpec wedge = spec_of(PhantomKind::wedge);
  wedge.wedge_angle = 90.0 * kDegree;
  add("wedge, over 2 voxels from its edge", wedge, 2e-3, 2.0 * kFineEdge * std::sqrt(0.5) * 1.05);
  PhantomSpec patch = spec_of(PhantomKind::skull_patch);
  patch.curvature = 0.05;
  add("skull patch", patch, 3e-3);
  return all;
}

/// How far off the force is.
struct Misfit {
  double share = 0.0;    ///< of what is allowed: the larger of 1 % and K x 0.1 voxel
  double degrees = 0.0;  ///< of direction
};

Misfit misfit(const Vec3& force, const Vec3& expected) {
  const double allowed = std::max(0.01 * glm::length(expected), kStiffness * 0.1 * kFineEdge);
  return {glm::length(force - expected) / allowed, degrees_between(force, expected)};
}

constexpr double kBall = 2e-3;  ///< [m]

/// [m] closed form of the smallest translation of a ball out of convex bone: along the normal of the point nearest to its centre.
Vec3 way_out(const Truth& truth, const Vec3& centre) {
  const SurfaceDistance near = truth.nearest(centre);
  return near.normal * (kBall - near.signed_distance);
}

}  // namespace

TEST_CASE("surface: the force on a ball is K times the smallest translation, in size and direction, on every convex shape") {
  // Points 0.02 mm apart. On a ball of 5 mm a point is 0.01 mm from where a true ball would touch; pressed 2 mm deep that turns the force
  // by 0.01 / (5 - 2) rad, 0.2 degrees: a coarser shell would be measured, not the model.
  const PointShell shell = ball_shell(kBall, 120000);
  std::printf(
      "force of a ball against the closed form: shape, share of what is allowed (1 %% or K x 0.1 voxel), degrees: median, largest\n");
  for (const Site& site : sites()) {
    CAPTURE(site.name);
    const Phantom phantom = phantom_of(site.spec);
    const ShippedBone bone(phantom);
    auto tool = ConstrainedTool::create(locked(), shell, kFineEdge);
    REQUIRE(tool.ok());
    std::vector<double> share, degrees;
    for (std::size_t n = 0; n < site.presses.size(); ++n) {
      const Press& press = site.presses[n];
      const double depth = n % 2 == 0 ? 0.4e-3 : 2e-3;  // 2 and 10 N
      const Vec3 start = press.place + press.normal * (kBall + 0.3e-3);
      const Vec3 force = settled_force(*tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), start}, -press.normal * (depth + 0.3e-3));
      const Misfit off = misfit(force, kStiffness * way_out(phantom.truth, press.place + press.normal * (kBall - depth)));
      share.push_back(off.share);
      degrees.push_back(off.degrees);
      CHECK(off.share <= 1.0);
      CHECK(off.degrees <= 0.5);
    }
    std::sort(share.begin(), share.end());
    std::sort(degrees.begin(), degrees.end());
    std::printf("%-36s %6.3f %6.3f   %6.3f %6.3f\n", site.name.c_str(), share[share.size() / 2], share.back(), degrees[degrees.size() / 2],
                degrees.back());
  }
}

TEST_CASE("surface: the same check detects bone that is a fifth of a voxel off, and one that is a degree off (sabotage)") {
  const PointShell shell = ball_shell(kBall, 20000);
  const Site site = sites().front();
  const Phantom phantom = phantom_of(site.spec);
  const Press& press = site.presses.front();
  auto tool = ConstrainedTool::create(locked(), shell, kFineEdge);
  REQUIRE(tool.ok());
  const Vec3 start = press.place + press.normal * (kBall + 0.3e-3), way = -press.normal * 0.7e-3;
  const auto off = [&](const Pose& world_from_bone) {
    const Vec3 force = settled_force(*tool, ShippedBone(phantom, world_from_bone).view(), {Quat(1.0, 0.0, 0.0, 0.0), start}, way);
    return misfit(force, kStiffness * way_out(phantom.truth, start + way));
  };
  CHECK(off({}).share < 1.0);
  CHECK(off({Quat(1.0, 0.0, 0.0, 0.0), press.normal * (0.2 * kFineEdge)}).share > 1.0);
  CHECK(off({turn_about_x(1.0 * kDegree), Vec3(0.0)}).degrees > 0.5);
}
