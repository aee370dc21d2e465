// A displacement through keyframes: exact at the keyframes, with velocities that are the derivative of its poses.

#include "core/base/pose_path.h"

#include <doctest/doctest.h>

#include <numbers>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;

PosePath path_of(std::vector<PoseKey> keys) {
  auto path = PosePath::create(std::move(keys));
  REQUIRE(path.ok());
  return std::move(path).value();
}

/// [rad] between two rotations.
double angle_between(const Quat& a, const Quat& b) { return glm::length(rotation_vector(a * glm::conjugate(b))); }

TEST_CASE("pose path: at a keyframe the displacement is that of the keyframe, before the first and after the last it stays") {
  const PosePath path = path_of({{1.0, {1e-3, 0.0, 0.0}, {0.0, 0.0, 2.0}, 0.5}, {3.0, {0.0, 2e-3, 0.0}, {1.0, 0.0, 0.0}, 1.0}});
  for (const double t : {-1.0, 0.0, 1.0}) {
    CHECK(glm::length(path.at(t).translation - Vec3(1e-3, 0.0, 0.0)) < 1e-15);
    CHECK(angle_between(path.at(t).rotation, rotation_of({0.0, 0.0, 0.5})) < 1e-12);
  }
  for (const double t : {3.0, 9.0}) {
    CHECK(glm::length(path.at(t).translation - Vec3(0.0, 2e-3, 0.0)) < 1e-15);
    CHECK(angle_between(path.at(t).rotation, rotation_of({1.0, 0.0, 0.0})) < 1e-12);
    CHECK(path.at(t).angular_velocity == Vec3(0.0));
  }
  CHECK(PosePath().at(1.0).translation == Vec3(0.0));
}

TEST_CASE("pose path: between two keyframes with one axis it turns by the whole difference, several turns included") {
  const PosePath path = path_of({{0.0, {}, {0.0, 1.0, 0.0}, 0.0}, {4.0, {}, {0.0, 3.0, 0.0}, 6.0 * kPi}});
  for (const double t : {0.1, 1.0, 2.3, 3.9}) {
    CHECK(angle_between(path.at(t).rotation, rotation_of({0.0, 1.5 * kPi * t, 0.0})) < 1e-12);
    CHECK(glm::length(path.at(t).angular_velocity - Vec3(0.0, 1.5 * kPi, 0.0)) < 1e-12);
  }
}

TEST_CASE("pose path: both velocities are the derivative of the displacement, between keyframes with any axes") {
  const PosePath path = path_of(
      {{0.0, {1e-3, 0.0, 4e-3}, {1.0, 2.0, 0.0}, 0.7}, {2.0, {-3e-3, 5e-3, 0.0}, {0.0, 1.0, -1.0}, 1.9}, {2.5, {}, {0.0, 1.0, -1.0}, 9.0}});
  constexpr double kStep = 1e-4;  // [s] the motion is uniform between keyframes, so a central difference has rounding errors only
  for (const double t : {0.3, 1.1, 1.99, 2.2, 2.4}) {
    const Displacement before = path.at(t - kStep), after = path.at(t + kStep), now = path.at(t);
    CHECK(glm::length((after.translation - before.translation) / (2.0 * kStep) - now.velocity) < 1e-11);
    CHECK(glm::length(rotation_vector(after.rotation * glm::conjugate(before.rotation)) / (2.0 * kStep) - now.angular_velocity) < 1e-9);
  }
}

TEST_CASE("pose path: keyframes out of order, without an axis or not finite are refused") {
  CHECK_FALSE(PosePath::create({{1.0}, {1.0}}).ok());
  CHECK_FALSE(PosePath::create({{.time = 0.0, .axis = Vec3(0.0)}}).ok());
  CHECK_FALSE(PosePath::create({{.time = 0.0, .angle = std::nan("")}}).ok());
  CHECK(PosePath::create({{1.0}, {1.5}}).ok());
}

}  // namespace
}  // namespace burrhole
