#include "haptics/device/device_hand.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "haptics/hand/bone_drive.h"
#include "haptics/hand/simulated_hand.h"

using namespace burrhole;

namespace {

constexpr double kTick = 1e-3;  // [s]

/// A device with six degrees of freedom that tells what it is set to and keeps what it was told.
class PuppetDevice final : public HapticDevice {
 public:
  [[nodiscard]] DeviceInfo info() const noexcept override { return {.name = "puppet", .largest_force = 8.0}; }
  [[nodiscard]] DeviceReading read() noexcept override { return reading; }
  void write(const Wrench& on_hand) noexcept override { told = on_hand; }
  DeviceReading reading;
  Wrench told;
};

Vec3 random_vector(std::uint64_t seed, std::uint64_t n) {
  return {uniform11(seed, 3 * n), uniform11(seed, 3 * n + 1), uniform11(seed, 3 * n + 2)};
}
Quat random_turn(std::uint64_t seed, std::uint64_t n) {
  return glm::normalize(Quat(1.5 + uniform11(seed + 100, n), random_vector(seed, n)));
}
/// q v q*, written out: the twin of glm's rotation.
Vec3 turned(const Quat& q, const Vec3& v) {
  const Quat out = q * Quat(0.0, v) * glm::conjugate(q);
  return {out.x, out.y, out.z};
}

SimulatedDevice make(const SimulatedDeviceConfig& config) {
  auto device = SimulatedDevice::create(config, kTick);
  REQUIRE(device.ok());
  return *device;
}
ScriptedDeviceHand scripted(SimulatedDevice& device, const DeviceMap& map, const HandScriptConfig& script, const Pose& approach = {},
                            bool feels = true) {
  auto hand = ScriptedDeviceHand::create(device, map, script, approach, kTick, feels);
  REQUIRE(hand.ok());
  return *hand;
}

/// A wall at height 0 of the approach frame, gone from tick `opens` on.
struct Wall {
  double stiffness = 6000.0;  ///< [N/m]
  std::uint64_t opens = 0;
  Pose world_from_approach{};
  [[nodiscard]] Wrench on_hand(const HandState& state) const {
    const double height = (world_from_approach.inverse() * state.world_from_hand.translation).z;
    const double push = state.tick < opens && height < 0.0 ? -stiffness * height : 0.0;
    return {world_from_approach.rotate({0.0, 0.0, push}), Vec3(0.0)};
  }
};

std::vector<HandState> run(HandSource& hand, const Wall& wall, int ticks) {
  std::vector<HandState> states;
  for (int n = 0; n < ticks; ++n) {
    states.push_back(hand.read());
    hand.apply(wall.on_hand(states.back()));
  }
  return states;
}

}  // namespace

TEST_CASE("DeviceHand: places, velocities and rotations of the grip come out in the world, forces and torques go back, each by its scale") {
  for (std::uint64_t n = 0; n < 50; ++n) {
    CAPTURE(n);
    DeviceMap map;
    map.world_from_device = {random_turn(1, n), 0.2 * random_vector(2, n)};
    map.grip_from_tool = random_turn(3, n);
    map.position_scale = 0.5 + uniform01(4, n);
    map.force_scale = 0.1 + uniform01(5, n);
    PuppetDevice device;
    auto hand = DeviceHand::create(device, map);
    REQUIRE(hand.ok());
    device.reading.device_from_grip = {random_turn(6, n), 0.05 * random_vector(7, n)};
    device.reading.velocity = random_vector(8, n);
    device.reading.buttons = static_cast<std::uint32_t>(n);
    const HandState state = hand->read();
    const Quat& turn = map.world_from_device.rotation;
    const Vec3 place = map.world_from_device.translation + map.position_scale * turned(turn, device.reading.device_from_grip.translation);
    CHECK(glm::length(state.world_from_hand.translation - place) < 1e-15);
    CHECK(glm::length(state.velocity - map.position_scale * turned(turn, device.reading.velocity)) < 1e-14);
    CHECK(hand->buttons() == n);
    CHECK(state.switches == ((n & 2) != 0 ? BoneSwitch::kGrasp : 0));
    CHECK(glm::length(map.device(state.world_from_hand.translation) - device.reading.device_from_grip.translation) < 1e-15);
    const Vec3 along(0.3, -0.4, 1.2);  // of the drill
    const Vec3 in_grip = turned(device.reading.device_from_grip.rotation, turned(map.grip_from_tool, along));
    CHECK(glm::length(state.world_from_hand.rotate(along) - turned(turn, in_grip)) < 1e-14);
    const Wrench on_hand{10.0 * random_vector(9, n), random_vector(10, n)};
    hand->apply(on_hand);
    CHECK(glm::length(turned(turn, device.told.force) - map.force_scale * on_hand.force) < 1e-13);
    CHECK(glm::length(turned(turn, device.told.torque) - map.force_scale * on_hand.torque) < 1e-14);
    // Power at the grip is the world's, by the ratio of the scales: neither turning nor scaling makes energy.
    const double at_grip = glm::dot(device.told.force, device.reading.velocity), in_world = glm::dot(on_hand.force, state.velocity);
    CHECK(std::abs(at_grip - in_world * map.force_scale / map.position_scale) < 1e-13);
  }
}

TEST_CASE(
    "DeviceHand: ticks rise by one, thrust is what the drill exerts along its axis and never attractive, a lost device is reported as "
    "lost") {
  PuppetDevice device;
  auto hand = DeviceHand::create(device, {.force_scale = 0.25});
  REQUIRE(hand.ok());
  for (std::uint64_t n = 0; n < 5; ++n) {
    CHECK(hand->read().tick == n);
    hand->apply({{3.0, 0.0, 28.0}, Vec3(0.0)});
    CHECK(device.told.force == Vec3(0.75, 0.0, 7.0));
  }
  CHECK(hand->read().thrust == 28.0);
  hand->apply({{0.0, 0.0, -5.0}, Vec3(0.0)});
  CHECK(hand->read().thrust == 0.0);
  CHECK(hand->read().flags == 0);
  device.reading.lost = true;
  CHECK(hand->read().flags == kHandLost);
  device.reading.lost = false;
  CHECK(hand->read().flags == 0);
}

TEST_CASE("ScriptedDeviceHand: on a device without limits in the same body it moves as SimulatedHand does, bit for bit") {
  HandConfig config;
  SimulatedDeviceConfig perfect;
  perfect.plant.body = config.dynamics;
  perfect.true_velocity = true;
  SimulatedDevice device = make(perfect);
  ScriptedDeviceHand hand = scripted(device, {}, config);
  auto plain = SimulatedHand::create(config, {}, kTick);
  REQUIRE(plain.ok());
  const Wall wall{.opens = 4000};
  const auto a = run(hand, wall, 9000), b = run(*plain, wall, 9000);
  REQUIRE(b.back().phase == HandPhase::done);
  for (std::size_t n = 0; n < a.size(); ++n) {
    REQUIRE(a[n].world_from_hand.translation == b[n].world_from_hand.translation);
    REQUIRE(a[n].velocity == b[n].velocity);
    REQUIRE(a[n].thrust == b[n].thrust);
    REQUIRE(a[n].phase == b[n].phase);
    REQUIRE(a[n].tick == b[n].tick);
  }
  perfect.plant.body.mass *= 1.001;  // sabotage: another body
  SimulatedDevice heavier = make(perfect);
  ScriptedDeviceHand other = scripted(heavier, {}, config);
  CHECK(run(other, wall, 9000)[5000].world_from_hand.translation != b[5000].world_from_hand.translation);
}

TEST_CASE(
    "ScriptedDeviceHand: neither the device's pose nor its scales change what is done in the world, the grip's body being scaled alike") {
  HandConfig config;
  SimulatedDeviceConfig perfect;
  perfect.plant.body = config.dynamics;
  perfect.true_velocity = true;
  SimulatedDevice reference = make(perfect);
  const Pose approach{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};
  const Wall wall{.opens = 4000, .world_from_approach = approach};
  ScriptedDeviceHand plain = scripted(reference, {approach, 1.0, 1.0}, config, approach);
  DeviceMap map{{rotation_from_z({0.0, 0.8, -0.6}), Vec3(0.01, 0.02, 0.18)}, 2.0, 0.25};
  map.grip_from_tool = glm::conjugate(map.world_from_device.rotation) * approach.rotation;
  // World force over world motion is force_scale * position_scale = 1/2 at the grip.
  perfect.plant.body = {0.5 * config.dynamics.mass, 0.5 * config.dynamics.damping, 0.5 * config.dynamics.stiffness};
  SimulatedDevice device = make(perfect);
  ScriptedDeviceHand hand = scripted(device, map, config, approach);
  const auto a = run(plain, wall, 9000), b = run(hand, wall, 9000);
  double strayed = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    strayed = std::max(strayed, glm::length(a[n].world_from_hand.translation - b[n].world_from_hand.translation));
    REQUIRE(a[n].phase == b[n].phase);
    REQUIRE(std::abs(a[n].thrust - b[n].thrust) < 1e-12);
  }
  CHECK(strayed < 1e-11);  // roundings of places of 0.2 m, 3e-17 m a tick, through a wall that does not amplify them
  CHECK(glm::length(b[10].world_from_hand.rotate({0.0, 0.0, 1.0}) - approach.rotate({0.0, 0.0, 1.0})) < 1e-15);
}

TEST_CASE(
    "ScriptedDeviceHand: on a Falcon in a nominal grip the whole script is gone through with 28 N of real thrust and 8 N at the grip") {
  const HandScriptConfig script;
  const SimulatedDeviceConfig falcon = make_simulated_config(*find_device("falcon").value(), *find_hand("nominal").value());
  SimulatedDevice device = make(falcon);
  DeviceMap map;
  map.force_scale = fitting_force_scale(device.info(), 1.2 * script.push);
  CHECK(map.force_scale == 8.0 / 33.6);
  // At the grip 1430 N/m, under half of the 3353 that a nominal grip allows with one tick of delay.
  const Wall wall{.stiffness = 6000.0, .opens = 5000};
  ScriptedDeviceHand hand = scripted(device, map, script);
  std::vector<HandState> states;
  double shown = 0.0, carried = 0.0;
  for (int n = 0; n < 12000; ++n) {
    states.push_back(hand.read());
    const Wrench on_hand = wall.on_hand(states.back());
    if (states.back().tick == 4900) carried = on_hand.force.z;
    hand.apply(on_hand);
    shown = std::max(shown, glm::length(device.force()));
  }
  for (std::size_t n = 1; n < states.size(); ++n) REQUIRE(static_cast<int>(states[n].phase) >= static_cast<int>(states[n - 1].phase));
  CHECK(states.back().phase == HandPhase::done);
  CHECK(states[4900].phase == HandPhase::lean);
  CHECK(states[4900].thrust == script.push);
  // The wall carries the thrust but for the friction of the grip, in real newtons, and half a step of position.
  CHECK(std::abs(carried - script.push) < falcon.plant.friction / map.force_scale + 0.5 * falcon.quantum * wall.stiffness);
  CHECK(shown <= 8.0);
  // Sabotage: unscaled, the device shows 8 N of 28; the hand goes on into the wall and takes that for a breakthrough.
  SimulatedDevice weak = make(falcon);
  ScriptedDeviceHand unscaled = scripted(weak, {}, script);
  CHECK(run(unscaled, {.stiffness = 6000.0, .opens = 5000}, 4900).back().phase > HandPhase::give_felt);
  CHECK(states[4900].world_from_hand.translation.z > -0.006);
}

TEST_CASE("ScriptedDeviceHand: every hand moves to bone, carries the thrust of the scene onto it and withdraws after breakthrough") {
  const HandConfig arm;
  for (const HandModel& who : hand_models()) {
    CAPTURE(std::string(who.name));
    const SimulatedDeviceConfig held = make_simulated_config(*find_device("falcon").value(), who);
    const DeviceMap map{.force_scale = 8.0 / 33.6};
    MassSpringDamperConfig at_grip = arm.dynamics;
    at_grip.damping *= map.force_scale;
    at_grip.stiffness *= map.force_scale;
    SimulatedDevice device = make(moved_by_arm(held, at_grip));
    ScriptedDeviceHand hand = scripted(device, map, arm);
    const Wall wall{.stiffness = 4000.0, .opens = 6000};
    const auto states = run(hand, wall, 14000);
    CHECK(states[5900].phase == HandPhase::lean);
    CHECK(states[5900].thrust == arm.push);
    const double carried = wall.on_hand(states[5900]).force.z;
    CHECK(std::abs(carried - arm.push) < held.plant.friction / map.force_scale + 0.5 * held.quantum * wall.stiffness);
    CHECK(states.back().phase == HandPhase::done);
    CHECK(std::abs(states.back().world_from_hand.translation.z - arm.standoff) < 0.2 * arm.standoff);
    // A hand with a spring of its own is as it was; the script refuses one that nothing moves.
    const bool has_spring = who.stiffness.value > 0.0;
    CHECK((moved_by_arm(held, at_grip).plant.body.damping == held.plant.body.damping) == has_spring);
    SimulatedDevice alone = make(held);
    CHECK(ScriptedDeviceHand::create(alone, map, arm, {}, kTick).ok() == has_spring);
  }
}

TEST_CASE("ScriptedDeviceHand: numb, the force changes nothing") {
  SimulatedDeviceConfig config;
  config.plant.body = HandConfig{}.dynamics;
  SimulatedDevice first = make(config), second = make(config);
  ScriptedDeviceHand against_wall = scripted(first, {}, {}, {}, false), in_air = scripted(second, {}, {}, {}, false);
  const auto a = run(against_wall, {.opens = 4000}, 3000), b = run(in_air, {.opens = 0}, 3000);
  for (std::size_t n = 0; n < a.size(); ++n) REQUIRE(a[n].world_from_hand.translation == b[n].world_from_hand.translation);
  CHECK(a.back().world_from_hand.translation.z < -0.005);
}

TEST_CASE("DeviceMap: scales that are not above 0, poses that are not finite or not turns are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(check(DeviceMap{}).ok());
  PuppetDevice device;
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    CHECK_FALSE(check(DeviceMap{.position_scale = bad}).ok());
    CHECK(DeviceHand::create(device, {.force_scale = bad}).error().code == ErrorCode::out_of_range);
  }
  CHECK_FALSE(check(DeviceMap{.world_from_device = {Quat(1.0, 0.0, 0.0, 0.0), Vec3(nan, 0.0, 0.0)}}).ok());
  CHECK_FALSE(check(DeviceMap{.world_from_device = {Quat(2.0, 0.0, 0.0, 0.0), Vec3(0.0)}}).ok());
  CHECK_FALSE(check(DeviceMap{.grip_from_tool = Quat(0.0, 0.0, 0.0, nan)}).ok());
  CHECK(fitting_force_scale({.largest_force = 8.0}, 4.0) == 1.0);
  CHECK(fitting_force_scale({.largest_force = 8.0}, 32.0) == 0.25);
  HandScriptConfig script;
  script.feed = -1.0;
  SimulatedDevice simulated = make({});
  CHECK_FALSE(ScriptedDeviceHand::create(simulated, {}, script, {}, kTick).ok());
}
