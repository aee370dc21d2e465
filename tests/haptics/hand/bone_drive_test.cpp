// A bone that is moved by keyframes, by switches and by the hand: its velocities are the derivative of its poses, and a hand that grasps it
// moves it rigidly.

#include "haptics/hand/bone_drive.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

const Quat kUpright(1.0, 0.0, 0.0, 0.0);
constexpr double kPeriod = 1e-3;  // [s]
const BoneDriveConfig kConfig{.pivot = {3e-3, -2e-3, 7e-3}, .axes = rotation_of({0.3, 0.0, 0.9}), .speed = 0.03, .turn_rate = 0.6};

PosePath turning() {
  auto path = PosePath::create({{0.0, {}, {1.0, 0.0, 2.0}, 0.0}, {0.4, {4e-3, 0.0, 1e-3}, {1.0, 0.0, 2.0}, 1.1}});
  REQUIRE(path.ok());
  return std::move(path).value();
}

/// A hand on a helix that also turns.
HandState hand_at(std::uint64_t tick, std::uint32_t switches = 0) {
  const double t = static_cast<double>(tick) * kPeriod;
  HandState out;
  out.world_from_hand = {rotation_of(Vec3(0.0, 2.0, 1.0) * t), Vec3(5e-3 * std::cos(3.0 * t), 5e-3 * std::sin(3.0 * t), 0.01 * t)};
  out.velocity = Vec3(-15e-3 * std::sin(3.0 * t), 15e-3 * std::cos(3.0 * t), 0.01);
  out.angular_velocity = Vec3(0.0, 2.0, 1.0);
  out.switches = switches;
  out.tick = tick;
  return out;
}

double distance(const Pose& a, const Pose& b) {
  const Pose d = a * b.inverse();
  return std::max(glm::length(d.translation), 0.01 * glm::length(rotation_vector(d.rotation)));
}

std::uint32_t switches_at(std::uint64_t tick) {
  if (tick < 60) return BoneSwitch::bit(0) | BoneSwitch::bit(7);
  if (tick < 120) return BoneSwitch::bit(3) | BoneSwitch::bit(10);
  if (tick < 220) return BoneSwitch::kGrasp;
  return tick < 260 ? BoneSwitch::bit(5) : 0u;
}

TEST_CASE("bone drive: velocity and angular velocity are the derivative of the pose, by keyframes, switches and hand") {
  BoneDrive drive(kConfig, turning());
  std::vector<BoneMotion> motions;
  for (std::uint64_t tick = 0; tick < 390; ++tick) motions.push_back(drive.move(hand_at(tick, switches_at(tick))));
  int checked = 0;
  for (std::uint64_t tick = 1; tick + 1 < motions.size(); tick += 7) {
    if (switches_at(tick - 1) != switches_at(tick) || switches_at(tick + 1) != switches_at(tick)) continue;
    const Pose &before = motions[tick - 1].world_from_rest, &now = motions[tick].world_from_rest,
               &after = motions[tick + 1].world_from_rest;
    // The central difference of a point at distance r from an axis of rate w is off by r w^3 dt^2 / 6: here 25 mm, 3.4 rad/s, 1.6e-7 m/s;
    // of the hand's helix by 2e-8 m/s.
    for (const Vec3& p : {Vec3(0.0), Vec3(0.01, 0.0, 0.0), Vec3(0.0, -0.01, 0.01)}) {
      const Vec3 q = now.inverse() * p;
      CHECK(glm::length((after * q - before * q) / (2.0 * kPeriod) - motions[tick].velocity_at(p)) < 2e-7);
    }
    ++checked;
  }
  CHECK(checked > 40);
}

TEST_CASE("bone drive: a hand that grasps the bone moves it rigidly, from where it is to where it is released") {
  BoneDrive drive(kConfig, turning());
  Pose before = drive.move(hand_at(0)).world_from_rest, held;
  for (std::uint64_t tick = 1; tick < 390; ++tick) {
    const HandState hand = hand_at(tick, switches_at(tick));
    const Pose now = drive.move(hand).world_from_rest;
    CHECK(distance(now, before) < 1e-4);  // no jump: in a tick the hand moves by 0.02 mm, and turns the bone by 2.3 mrad
    const Pose hand_from_bone = hand.world_from_hand.inverse() * now;
    if (tick == 120) held = hand_from_bone;
    if (tick > 120 && tick < 220) CHECK(distance(hand_from_bone, held) < 1e-12);
    before = now;
  }
}

TEST_CASE("bone drive: a switch moves the bone along one of its axes, at the speed of the scene") {
  for (int direction = 0; direction < BoneSwitch::kDirections; ++direction) {
    BoneDrive drive(kConfig, {});
    BoneMotion now;
    for (std::uint64_t tick = 0; tick <= 250; ++tick) now = drive.move(hand_at(tick, BoneSwitch::bit(direction)));
    Vec3 axis(0.0);
    axis[direction / 2 % 3] = direction % 2 == 0 ? 0.25 : -0.25;  // [s] times the sign
    axis = kConfig.axes * axis;
    const Pose expected = direction < 6 ? Pose{kUpright, axis * kConfig.speed}
                                        : Pose{kUpright, kConfig.pivot} * Pose{rotation_of(axis * kConfig.turn_rate), -Vec3(0.0)} *
                                              Pose{kUpright, -kConfig.pivot};
    CHECK(distance(now.world_from_rest, expected) < 1e-12);
  }
}

TEST_CASE("bone drive: the same readings of the hand give the same bits, and skipped ticks the same time") {
  const auto run = [](std::uint64_t every) {
    BoneDrive drive(kConfig, turning());
    BoneMotion now;
    for (std::uint64_t tick = 0; tick <= 360; tick += every) now = drive.move(hand_at(tick, switches_at(tick)));
    return now.world_from_rest;
  };
  const Pose once = run(1), again = run(1);
  CHECK(std::memcmp(&once, &again, sizeof(Pose)) == 0);
  CHECK(distance(run(1), run(20)) < 2e-3);  // switches are read every 20 ms: 0.6 mm and 12 mrad each of the changes at most
}

}  // namespace
}  // namespace burrhole
