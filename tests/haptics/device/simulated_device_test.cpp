#include "haptics/device/simulated_device.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/base/random.h"
#include "haptics/device/device_guard.h"

using namespace burrhole;

namespace {

constexpr double kTick = 1e-3;  // [s]

SimulatedDevice make(const SimulatedDeviceConfig& config) {
  auto device = SimulatedDevice::create(config, kTick);
  REQUIRE(device.ok());
  return *device;
}

Wrench push(double x, double y = 0.0, double z = 0.0) { return {{x, y, z}, Vec3(0.0)}; }

}  // namespace

TEST_CASE("SimulatedDevice: it reports the nearest multiple of its step; its true motion is not quantised") {
  SimulatedDeviceConfig config;
  config.quantum = 0.05e-3;
  SimulatedDevice stepped = make(config), plain = make({});
  std::size_t off_grid = 0;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const Wrench force = push(uniform11(1, n), uniform11(2, n), uniform11(3, n));
    stepped.write(force);
    plain.write(force);
    REQUIRE(stepped.grip().position == plain.grip().position);
    const Vec3 told = stepped.read().device_from_grip.translation, is = stepped.grip().position;
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = told[axis] / config.quantum;
      REQUIRE(std::abs(steps - std::round(steps)) < 1e-9);
      REQUIRE(std::abs(told[axis] - is[axis]) <= 0.5 * config.quantum * (1.0 + 1e-9));
      if (std::abs(told[axis] - is[axis]) > 0.4 * config.quantum) ++off_grid;
    }
  }
  CHECK(off_grid > 100);  // all of the half step is used
  CHECK(plain.read().device_from_grip.translation == plain.grip().position);
}

TEST_CASE("SimulatedDevice: a reading is late by exactly its delay, position and velocity alike") {
  for (const int delay : {0, 1, 2, 7, kMaxReadingDelay}) {
    CAPTURE(delay);
    SimulatedDeviceConfig late_config;
    late_config.delay = delay;
    SimulatedDevice late = make(late_config), prompt = make({});
    std::vector<DeviceReading> past;
    for (std::uint64_t n = 0; n < 200; ++n) {
      past.push_back(prompt.read());
      const DeviceReading reading = late.read();
      const DeviceReading& due = past[n < static_cast<std::uint64_t>(delay) ? 0 : n - static_cast<std::uint64_t>(delay)];
      REQUIRE(reading.device_from_grip.translation == due.device_from_grip.translation);
      REQUIRE(reading.velocity == due.velocity);
      const Wrench force = push(uniform11(1, n));
      late.write(force);
      prompt.write(force);
    }
  }
}

TEST_CASE("SimulatedDevice: force is limited in magnitude, direction kept, and what is not finite is no force") {
  SimulatedDeviceConfig config;
  config.largest_force = 8.0;
  SimulatedDevice device = make(config);
  CHECK(device.shown({3.0, -4.0, 1.0}) == Vec3(3.0, -4.0, 1.0));
  const Vec3 force(30.0, -40.0, 12.0);
  CHECK(std::abs(glm::length(device.shown(force)) - 8.0) < 1e-14);
  CHECK(glm::length(glm::cross(device.shown(force), force)) < 1e-12);
  CHECK(std::abs(glm::length(device.shown({1e200, 1e200, 0.0})) - 8.0) < 1e-14);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    device.write(push(0.0, bad));
    CHECK(device.force() == Vec3(0.0));
    CHECK(is_finite(device.grip().position));
  }
  device.write(push(100.0));
  CHECK(device.force() == Vec3(8.0, 0.0, 0.0));
}

TEST_CASE(
    "SimulatedDevice: its velocity follows a steady motion, one step of position shows as the stated speed, and the plain difference as "
    "more") {
  for (const double time : {0.0, 2e-3, 10e-3}) {
    CAPTURE(time);
    SimulatedDeviceConfig config;
    config.plant.body = {0.1, 0.0, 0.0};
    config.velocity_time = time;
    SimulatedDevice steady = make(config);
    steady.write(push(10.0));  // 0.1 m/s from then on
    for (int n = 0; n < 200; ++n) steady.write({});
    CHECK(std::abs(steady.read().velocity.x - 0.1) < 1e-6);  // exp(-200 ticks / 10 ms) and less
    config.quantum = 0.05e-3;
    SimulatedDevice creeping = make(config);
    creeping.write(push(0.1));  // 1 mm/s: a step every 50 ticks
    double largest = 0.0;
    for (int n = 0; n < 400; ++n) {
      creeping.write({});
      largest = std::max(largest, creeping.read().velocity.x);
    }
    // Of the step before, 50 ticks ago, exp(-50 ms / 10 ms) = 0.7 % is left.
    CHECK(std::abs(largest * (kTick + time) / config.quantum - 1.0) < 0.02);
  }
  SimulatedDeviceConfig config;
  config.true_velocity = true;
  config.quantum = 0.05e-3;
  SimulatedDevice knowing = make(config);
  knowing.write(push(1.0));
  CHECK(knowing.read().velocity == knowing.grip().velocity);
}

TEST_CASE("SimulatedDevice: the hand's spring acts towards its rest point and its thrust counts beyond the device's limit") {
  SimulatedDeviceConfig config;
  config.plant.body = {0.25, 5.0, 300.0};
  config.largest_force = 8.0;
  SimulatedDevice device = make(config);
  device.set_goal({{0.01, 0.0, -0.02}, {0.0, 0.0, -12.0}});
  for (int n = 0; n < 5000; ++n) device.write(push(0.0, 0.0, 20.0));  // 8 N of them shown
  CHECK(std::abs(device.grip().position.x - 0.01) < 1e-12);
  CHECK(std::abs(device.grip().position.z - (-0.02 - 4.0 / 300.0)) < 1e-12);
  device.place({0.0, 0.03, 0.0});
  CHECK(device.read().device_from_grip.translation == Vec3(0.0, 0.03, 0.0));
  for (int n = 0; n < 100; ++n) device.write({});
  CHECK(glm::length(device.grip().position - Vec3(0.0, 0.03, 0.0)) < 3e-14);  // its own rest: the flow is exact to 1e-12
}

TEST_CASE("SimulatedDevice: a lost device repeats its last report without force, and recovers") {
  SimulatedDevice device = make({});
  for (int n = 0; n < 10; ++n) device.write(push(1.0));
  const DeviceReading before = device.read();
  device.set_lost(true);
  for (int n = 0; n < 10; ++n) {
    device.write(push(1.0));
    CHECK(device.force() == Vec3(0.0));
    CHECK(device.read().lost);
    CHECK(device.read().device_from_grip.translation == before.device_from_grip.translation);
  }
  device.set_lost(false);
  device.set_buttons(5);
  CHECK_FALSE(device.read().lost);
  CHECK(device.read().buttons == 5);
  CHECK(device.read().device_from_grip.translation == device.grip().position);
}

TEST_CASE("make_simulated_config: device and hand by name, one tick late, with friction, step and limit") {
  const auto device = find_device("touch");
  const auto hand = find_hand("firm");
  REQUIRE(device.ok());
  REQUIRE(hand.ok());
  const SimulatedDeviceConfig config = make_simulated_config(**device, **hand);
  CHECK(config.plant.body.mass == 0.645);
  CHECK(config.plant.body.stiffness == 1000.0);
  CHECK(config.plant.friction == 0.26);
  CHECK(config.quantum == doctest::Approx(0.055e-3));
  CHECK(config.delay == 1);
  const DeviceInfo info = make(config).info();
  CHECK(info.name == "touch");
  CHECK(info.largest_force == 3.3);
  CHECK(info.workspace_radius == 0.075);
  CHECK(info.simulated);
  for (const DeviceModel& one : device_models())
    for (const HandModel& who : hand_models())
      for (const double period : {1.0 / 6000.0, 1e-3, 2e-3}) CHECK(SimulatedDevice::create(make_simulated_config(one, who), period).ok());
}

TEST_CASE("SimulatedDevice: create refuses what is out of range") {
  const auto refuses = [](auto change) {
    SimulatedDeviceConfig config;
    change(config);
    const auto device = SimulatedDevice::create(config, kTick);
    return !device.ok() && device.error().code == ErrorCode::out_of_range;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(refuses([](SimulatedDeviceConfig&) {}));
  for (const double bad : {-1.0, nan}) {
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.quantum = bad; }));
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.largest_force = bad; }));
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.workspace_radius = bad; }));
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.velocity_time = bad; }));
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.plant.friction = bad; }));
    CHECK(refuses([&](SimulatedDeviceConfig& c) { c.plant.body.mass = bad; }));
  }
  CHECK(refuses([](SimulatedDeviceConfig& c) { c.largest_force = 0.0; }));
  CHECK(refuses([](SimulatedDeviceConfig& c) { c.delay = -1; }));
  CHECK(refuses([](SimulatedDeviceConfig& c) { c.delay = kMaxReadingDelay + 1; }));
}

namespace {

/// Keeps what it was told beyond its own life.
struct Told {
  std::vector<Vec3> forces;
  bool closed = false;
  std::size_t before_closing = 0;
};
class ListeningDevice final : public HapticDevice {
 public:
  explicit ListeningDevice(Told& told) : told_(&told) {}
  ~ListeningDevice() override {
    told_->closed = true;
    told_->before_closing = told_->forces.size();
  }
  [[nodiscard]] DeviceInfo info() const noexcept override { return {}; }
  [[nodiscard]] DeviceReading read() noexcept override { return {}; }
  void write(const Wrench& on_hand) noexcept override { told_->forces.push_back(on_hand.force); }

 private:
  Told* told_;
};

bool silent(const Told& told) {
  return told.closed && !told.forces.empty() && told.forces.back() == Vec3(0.0) && told.before_closing == told.forces.size();
}

}  // namespace

TEST_CASE("DeviceGuard: the last command to a device before it is closed is zero force, whether the scope returns or throws") {
  Told returned, thrown, unguarded;
  {
    const DeviceGuard guard(std::make_unique<ListeningDevice>(returned));
    guard->write(push(5.0));
  }
  CHECK(silent(returned));
  try {
    const DeviceGuard guard(std::make_unique<ListeningDevice>(thrown));
    guard->write(push(5.0));
    throw std::runtime_error("in the middle of a push");
  } catch (const std::runtime_error&) {
  }
  CHECK(silent(thrown));
  {
    const auto sabotage = std::make_unique<ListeningDevice>(unguarded);
    sabotage->write(push(5.0));
  }
  CHECK_FALSE(silent(unguarded));
}

TEST_CASE("DeviceGuard: moved, it speaks once, for the one who holds the device; assigned over, the old device is silenced first") {
  Told first, second;
  {
    DeviceGuard a(std::make_unique<ListeningDevice>(first));
    DeviceGuard b(std::move(a));
    CHECK_FALSE(first.closed);
    b->write(push(1.0));
    b = DeviceGuard(std::make_unique<ListeningDevice>(second));
    CHECK(silent(first));
    (*b).write(push(2.0));
  }
  CHECK(first.forces.size() == 2);
  CHECK(silent(second));
}
