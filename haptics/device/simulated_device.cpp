#include "haptics/device/simulated_device.h"

#include <cmath>

namespace burrhole {

SimulatedDeviceConfig make_simulated_config(const DeviceModel& device, const HandModel& hand) noexcept {
  SimulatedDeviceConfig out;
  out.name = device.name;
  out.plant = {body_of(device, hand), device.friction.value};
  out.quantum = device.quantum.value;
  out.largest_force = device.largest_force.value;
  out.workspace_radius = device.workspace_radius.value;
  out.delay = 1;
  return out;
}

SimulatedDeviceConfig moved_by_arm(SimulatedDeviceConfig device, const MassSpringDamperConfig& arm) noexcept {
  MassSpringDamperConfig& body = device.plant.body;
  if (body.stiffness > 0.0) return device;
  body.stiffness = arm.stiffness;
  body.damping += arm.damping;
  return device;
}

SimulatedDevice::SimulatedDevice(const SimulatedDeviceConfig& config, double period, const Plant& plant)
    : config_(config), period_(period), plant_(plant) {
  place(Vec3(0.0));
}

Result<SimulatedDevice> SimulatedDevice::create(const SimulatedDeviceConfig& config, double period) {
  const auto refused = [](const char* what) { return Error{ErrorCode::out_of_range, what, {}}; };
  if (!(std::isfinite(config.quantum) && config.quantum >= 0.0)) return refused("the position step must be finite and at least 0");
  if (!(config.largest_force > 0.0)) return refused("the largest force must be above 0");
  if (!(std::isfinite(config.workspace_radius) && config.workspace_radius > 0.0)) return refused("the workspace radius must be above 0");
  if (config.delay < 0 || config.delay > kMaxReadingDelay) return refused("the delay must be 0 to 31 ticks");
  if (!(std::isfinite(config.velocity_time) && config.velocity_time >= 0.0))
    return refused("the time of the velocity's filter must be finite and at least 0");
  auto plant = Plant::create(config.plant, period);
  if (!plant) return plant.error();
  return SimulatedDevice(config, period, *plant);
}

DeviceInfo SimulatedDevice::info() const noexcept {
  return {.name = config_.name, .largest_force = config_.largest_force, .workspace_radius = config_.workspace_radius, .simulated = true};
}

void SimulatedDevice::place(const Vec3& position, const Vec3& velocity) noexcept {
  grip_ = {position, velocity};
  goal_ = {position, Vec3(0.0)};
  samples_.fill({reported(position), Vec3(0.0)});
  last_.device_from_grip.translation = reported(position);
  last_.velocity = Vec3(0.0);
}

void SimulatedDevice::set_lost(bool lost) noexcept {
  if (lost && !lost_) last_ = read();
  lost_ = lost;
}

DeviceReading SimulatedDevice::read() noexcept {
  if (lost_) {
    last_.lost = true;
    return last_;
  }
  const Sample& due = samples_[(newest_ + samples_.size() - static_cast<std::size_t>(config_.delay)) % samples_.size()];
  DeviceReading reading;
  reading.device_from_grip.translation = due.position;
  reading.velocity = due.velocity;
  reading.buttons = buttons_;
  return reading;
}

Vec3 SimulatedDevice::shown(const Vec3& force) const noexcept {
  if (!is_finite(force) || lost_) return Vec3(0.0);
  const double magnitude = std::hypot(force.x, force.y, force.z);  // does not overflow unless a component does
  return magnitude > config_.largest_force ? force * (config_.largest_force / magnitude) : force;
}

void SimulatedDevice::write(const Wrench& on_hand) noexcept {
  force_ = shown(on_hand.force);
  plant_.step(grip_, {force_ + goal_.thrust, goal_.rest});
  sample();
}

Vec3 SimulatedDevice::reported(const Vec3& position) const noexcept {
  if (config_.quantum == 0.0) return position;
  return glm::floor(position / config_.quantum + 0.5) * config_.quantum;
}

void SimulatedDevice::sample() noexcept {
  const Sample& before = samples_[newest_];
  const Vec3 position = reported(grip_.position);
  const Vec3 difference = (position - before.position) / period_;
  const Vec3 filtered = before.velocity + (difference - before.velocity) * (period_ / (period_ + config_.velocity_time));
  newest_ = (newest_ + 1) % samples_.size();
  samples_[newest_] = {position, config_.true_velocity ? grip_.velocity : filtered};
}

}  // namespace burrhole
