// [device]: a simulated force device between hand and drill.

#include <fmt/format.h>

#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "haptics/device/device_config.h"
#include "haptics/device/device_hand.h"
#include "haptics/device/device_model.h"

namespace burrhole {
namespace {

/// @returns the force at the grip over the force in the world [-].
double force_scale_of(const DeviceConfig& device, const StageConfig& stage) {
  if (device.force_scale) return *device.force_scale;
  return fitting_force_scale({.name = device.config.name, .largest_force = device.config.largest_force}, stage.hand.push);
}

class DeviceEffect final : public Effect {
 public:
  DeviceEffect(std::unique_ptr<SimulatedDevice> device, ScriptedDeviceHand hand) : device_(std::move(device)), hand_(std::move(hand)) {}
  HandSource& hand() noexcept { return hand_; }
  Status bind(StepGraph&) override { return {}; }  // no steps: the servo reads and drives the hand
  /// Reports the force that the device renders at the time of the call, after a live run the remaining force.
  void report(Figures& out) const override { out.add("shown_force_N", glm::length(device_->force())); }

 private:
  std::unique_ptr<SimulatedDevice> device_;
  ScriptedDeviceHand hand_;
};

/// The effect of a run with a hand source from outside, such as a replay: no device is created.
class NoDevice final : public Effect {
 public:
  Status bind(StepGraph&) override { return {}; }
};

class DevicePlan final : public ConfigPlan<DevicePlan, DeviceConfig> {
 public:
  DevicePlan(TableReader& table, const StageConfig& stage, Issues& issues) {
    if (stage.feed_hand || stage.goal_hand)
      issues.push_back(
          bad_input(fmt::format("[device] has no effect on hand.kind = \"{}\", only on \"script\"", stage.feed_hand ? "feed" : "mouse"),
                    table.place()));
    DeviceConfig& out = config_;
    const std::string name = table.text("name", "generic", "simulated device; \"burrhole devices\" lists them");
    out.hand = table.text("hand", out.hand, "hand on the device: none, light, nominal, firm or arm");
    const auto model = find_device(name);
    const auto holder = find_hand(out.hand);
    if (!model) issues.push_back(bad_input(model.error().message, table.place_of("name")));
    if (!holder) issues.push_back(bad_input(holder.error().message, table.place_of("hand")));
    if (model && holder) out.config = make_simulated_config(**model, **holder);
    SimulatedDeviceConfig& c = out.config;
    out.position_scale =
        table.number("position_scale", above_zero(out.position_scale, 1.0, 100.0), "displacement of the drill over that of the grip");
    out.force_scale = table.optional_number(
        "force_scale", above_zero(1.0, 1.0, 1.0),
        "force at the grip over force on the drill; absent: 1 or, if push_N exceeds the largest force of the device, the "
        "largest force over push_N");
    auto& body = c.plant.body;
    body.mass = table.number("mass_kg", above_zero(body.mass, 1.0, 10.0), "mass of device and hand");
    body.damping = table.number("damping_N_s_per_m", at_least_zero(body.damping, 1.0, 1e4), "damping of device and hand");
    body.stiffness = table.number("stiffness_N_per_m", at_least_zero(body.stiffness, 1.0, 1e5),
                                  "stiffness of the hand; 0: the arm of [hand] moves the grip");
    c.plant.friction = table.number("friction_N", at_least_zero(c.plant.friction, 1.0, 10.0), "Coulomb friction on each axis");
    c.quantum =
        table.number("step_mm", at_least_zero(c.quantum / kMillimetre, kMillimetre, 10.0), "quantum of the measured position, at the grip");
    c.largest_force = table.number("force_N", above_zero(c.largest_force, 1.0, 1e3), "largest force that the device renders at its grip");
    c.delay = static_cast<int>(table.integer("delay_ticks", c.delay, 0, kMaxReadingDelay, "delay of the measured position"));
  }

  void add_needs(const StageConfig& stage, Needs& needs) const override {
    needs.through_device = true;
    needs.force_scale = force_scale_of(config_, stage);
    const SimulatedDeviceConfig& c = config_.config;
    needs.grip.body = moved_by_arm(c, arm_at_grip(stage, needs)).plant.body;
    needs.grip.reading_delay = c.delay;
    needs.grip.true_velocity = c.true_velocity;
    needs.grip.velocity_time = c.velocity_time;
    needs.grip.gain = config_.position_scale * needs.force_scale;
    needs.position_step = c.quantum * config_.position_scale;
    // Cap at what the device renders: slew limit and energy balance would otherwise use a force that does not act.
    needs.servo.largest_force = std::min(needs.servo.largest_force, config_.config.largest_force / needs.force_scale);
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "device",
            .clock = Clock::servo,
            .step = "simulated force device and the hand on it, integrated exactly over a tick",
            .needs = "force",
            .gives = "hand motion",
            .detail = fmt::format("{} in a {} hand, at most {:.3g} N, {:.3g} kg, {:.0f} um steps, {} ticks late, forces times {:.3g}",
                                  config_.config.name, config_.hand, config_.config.largest_force, config_.config.plant.body.mass,
                                  config_.config.quantum * 1e6, config_.config.delay, context.needs.force_scale),
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = sizeof(SimulatedDevice)};
  }

  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    const Needs& needs = context.needs;
    if (!needs.feels) {
      out.push_back("[device] without [contact]: no force acts, so the device renders none");
      return;
    }
    const double most_felt = config_.config.largest_force / needs.force_scale, push = context.config.hand.push;
    if (most_felt < push * (1.0 - 1e-9))
      out.push_back(fmt::format(
          "[device] {} renders at most {:.3g} N of hand.push_N = {:g} at device.force_scale = {:.3g}: bone cannot hold the hand; "
          "set device.force_scale to {:.2g} or less, or omit it",
          config_.config.name, most_felt, push, needs.force_scale, config_.config.largest_force / push - 0.005));
    if (needs.force_scale < 1.0)
      out.push_back(
          fmt::format("[device] {} cannot render {:.0f} N: forces at the grip are {:.3g} times those on the drill; figures and "
                      "records refer to the drill",
                      config_.config.name, context.config.hand.push, needs.force_scale));
    if (!(needs.coupling_stiffness > 0.0)) return;  // a penalty model without a coupling: its stiffness depends on the points in contact
    const auto model = find_device(config_.config.name);
    if (!model || (*model)->library_stiffness.provenance == Provenance::absent) return;
    const double most = (*model)->library_stiffness.value;
    const double shown = needs.coupling_stiffness * config_.position_scale * needs.force_scale;
    if (shown > most)
      out.push_back(fmt::format("[device] contact.coupling_N_per_m = {:.0f} is {:.0f} N/m at the grip of {}, whose library allows {:.0f}",
                                needs.coupling_stiffness, shown, config_.config.name, most));
  }

  /// @returns the arm of [hand] as the grip is moved by it.
  MassSpringDamperConfig arm_at_grip(const StageConfig& stage, const Needs& needs) const {
    const MassSpringDamperConfig& arm = stage.hand.dynamics;
    const double scale = needs.force_scale * config_.position_scale;
    return {.mass = arm.mass * scale, .damping = arm.damping * scale, .stiffness = arm.stiffness * scale};
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    if (stage.outside().hand != nullptr) return std::unique_ptr<Effect>(std::make_unique<NoDevice>());
    auto created = SimulatedDevice::create(moved_by_arm(config_.config, arm_at_grip(stage.config, stage.needs)), stage.period);
    if (!created) return created.error();
    auto device = std::make_unique<SimulatedDevice>(std::move(created).value());
    const DeviceMap map{
        .world_from_device = stage.world_from_approach(), .position_scale = config_.position_scale, .force_scale = stage.needs.force_scale};
    auto hand = ScriptedDeviceHand::create(*device, map, hand_config(stage.config, stage.needs, *stage.tool, stage.voxel_edge()),
                                           stage.world_from_approach(), stage.period, stage.config.hand.feels);
    if (!hand) return hand.error();
    auto effect = std::make_unique<DeviceEffect>(std::move(device), std::move(hand).value());
    stage.offer_hand(effect->hand());
    return std::unique_ptr<Effect>(std::move(effect));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues& issues) {
  return std::make_unique<DevicePlan>(table, stage, issues);
}

}  // namespace

EffectEntry device_effect() {
  return {"device",
          "simulated force device between hand and drill; without it the hand holds the drill directly",
          read,
          {},
          {.figures = {{"breakthrough_s"}, {"peak_force_N"}, {"reached_mm"}}}};
}

}  // namespace burrhole
