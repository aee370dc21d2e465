// Torque of the contact model `surface` as shipped: levers of a locked tool, and the balance of moments of one that turns on its spring.
#include "surface_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kBall = 1.5e-3;   ///< [m]
constexpr double kLength = 8e-3;   ///< [m] from the tool origin to the ball
constexpr double kTurning = 0.5;   ///< [N m/rad]
constexpr double kDepth = 1.5e-3;  ///< [m] of the hand
constexpr double kFace = 3e-3;     ///< [m] radius of the flat tool

/// Root of a rising function in [0, 1 rad].
template <class F>
double root(F&& f) {
  double lo = 0.0, hi = 1.0;
  for (int n = 0; n < 60; ++n) (f(0.5 * (lo + hi)) > 0.0 ? hi : lo) = 0.5 * (lo + hi);
  return 0.5 * (lo + hi);
}

ConstrainedTool tool_of(const PointShell& shell, double turn_stiffness) {
  ConstrainedToolConfig config = locked();
  config.turn_stiffness = turn_stiffness;
  auto tool = ConstrainedTool::create(config, shell, kFineEdge);
  REQUIRE(tool.ok());
  return std::move(tool).value();
}

/// The flat end of a cylinder, its middle the origin: rings of points, the rim's on both axes.
PointShell face_shell() {
  PointShell shell = shell_of({Vec3(0.0)});
  for (int ring = 1; ring <= 12; ++ring)
    for (int n = 0; n < 8 * ring; ++n) {
      const double angle = 2.0 * 3.14159265358979323846 * n / (8.0 * ring), r = kFace * ring / 12.0;
      shell.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
      shell.inward_normals.emplace_back(0.0, 0.0, 1.0);
      shell.cutting.push_back(1);
    }
  return shell;
}

/// 1 % of the torque, or the force times a twentieth of a voxel of lever (points are that far apart).
bool agree(const Vec3& torque, const Vec3& expected, double force) {
  return glm::length(torque - expected) <= std::max(0.01 * glm::length(expected), force * 0.05 * kFineEdge);
}

}  // namespace

TEST_CASE("surface: a ball off the tool's origin turns it by lever x force, on a level and on a tilted plate") {
  const Vec3 arm(3e-3, 1e-3, -5e-3);
  const PointShell shell = ball_shell(kBall, 60000, arm);
  for (const Vec3& up : {Vec3(0.0, 0.0, 1.0), Vec3(0.37, -0.22, 1.0)}) {
    PhantomSpec spec = spec_of(PhantomKind::plate);
    spec.plate_normal = up;
    const ShippedBone bone(phantom_of(spec));
    const Vec3 normal = glm::normalize(up);
    ConstrainedTool tool = tool_of(shell, std::numeric_limits<double>::infinity());
    const Vec3 start = normal * (kBall + 0.3e-3) - arm;
    const Vec3 force = settled_force(tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), start}, -normal * (kDepth + 0.3e-3));
    const Vec3 expected = glm::cross(arm - normal * kBall, kStiffness * kDepth * normal);
    CHECK(agree(tool.state().on_hand.torque, expected, glm::length(force)));
    // Sabotage: a lever that ends half a radius beside the touch (along the normal it would turn as much), or none.
    const Vec3 aside = glm::normalize(glm::cross(normal, arm)) * (0.5 * kBall);
    CHECK_FALSE(
        agree(tool.state().on_hand.torque, glm::cross(arm - normal * kBall + aside, kStiffness * kDepth * normal), glm::length(force)));
    CHECK_FALSE(agree(Vec3(0.0), expected, glm::length(force)));
  }
}

TEST_CASE("surface: a lever on its spring turns until the moments balance") {
  const PointShell shell = ball_shell(kBall, 60000, Vec3(kLength, 0.0, 0.0));
  const ShippedBone bone(phantom_of(spec_of(PhantomKind::plate)));
  ConstrainedTool tool = tool_of(shell, kTurning);
  const Vec3 start(-kLength, 0.0, kBall + 0.3e-3);
  (void)settled_force(tool, bone.view(), {Quat(1.0, 0.0, 0.0, 0.0), start}, Vec3(0.0, 0.0, -kDepth - 0.3e-3));
  for (int tick = 0; tick < 300; ++tick)
    (void)tool.step(bone.view(), {{Quat(1.0, 0.0, 0.0, 0.0), start - Vec3(0.0, 0.0, kDepth + 0.3e-3)}, Vec3(0.0)}, kTick);
  // K_r phi = a cos(phi) K (depth - a sin(phi)): the ball's end goes up as it turns.
  const auto force_at = [](double phi) { return kStiffness * (kDepth - kLength * std::sin(phi)); };
  const double phi = root([&](double p) { return kTurning * p - kLength * std::cos(p) * force_at(p); });
  REQUIRE(phi > 2.0 * kDegree);  // or little would be shown
  const ConstrainedToolState& state = tool.state();
  CHECK(std::abs(glm::length(state.on_hand.force) - force_at(phi)) <= std::max(0.01 * force_at(phi), kStiffness * 0.1 * kFineEdge));
  CHECK(agree(state.on_hand.torque, Vec3(0.0, -kTurning * phi, 0.0), force_at(phi)));
  const double turned =
      2.0 *
      std::asin(glm::length(Vec3(state.world_from_tool.rotation.x, state.world_from_tool.rotation.y, state.world_from_tool.rotation.z)));
  CHECK(std::abs(turned - phi) <= 0.01 * phi);
  CHECK_FALSE(agree(state.on_hand.torque, Vec3(0.0, -0.95 * kTurning * phi, 0.0), force_at(phi)));  // a spring a twentieth softer
}

TEST_CASE("surface: a flat face lies flat until the moment of its spring exceeds thrust x radius, then stands on its rim") {
  const PointShell shell = face_shell();
  const ShippedBone bone(phantom_of(spec_of(PhantomKind::plate)));
  const double thrust = kStiffness * kDepth;  // of a face that lies flat
  for (const double share : {0.0, 0.4, 0.8, 1.5, 2.5}) {
    CAPTURE(share);
    const double tilt = share * thrust * kFace / kTurning;  // [rad] of the hand; 1: just about to lift
    ConstrainedTool tool = tool_of(shell, kTurning);
    const Quat turned = glm::angleAxis(tilt, Vec3(0.0, 1.0, 0.0));
    const Vec3 start(0.0, 0.0, 1e-3);
    (void)settled_force(tool, bone.view(), {turned, start}, Vec3(0.0, 0.0, -kDepth - 1e-3));
    for (int tick = 0; tick < 300; ++tick) (void)tool.step(bone.view(), {{turned, Vec3(0.0, 0.0, -kDepth)}, Vec3(0.0)}, kTick);
    const ConstrainedToolState& state = tool.state();
    // The face's angle: 0, or where K_r (tilt - angle) = r cos(angle) K (depth + r sin(angle)).
    const auto force_at = [](double angle) { return kStiffness * (kDepth + kFace * std::sin(angle)); };
    const double angle = share <= 1.0 ? 0.0 : root([&](double a) { return kFace * std::cos(a) * force_at(a) - kTurning * (tilt - a); });
    const Quat& q = state.world_from_tool.rotation;
    // A tenth of a voxel over the face.
    CHECK(std::abs(2.0 * std::asin(q.y) - angle) <= std::max(0.01 * angle, 0.1 * kFineEdge / (2.0 * kFace)));
    CHECK(std::abs(glm::length(state.on_hand.force) - force_at(angle)) <= std::max(0.01 * force_at(angle), kStiffness * 0.1 * kFineEdge));
    CHECK(agree(state.on_hand.torque, Vec3(0.0, -kTurning * (tilt - angle), 0.0), thrust));
  }
}
