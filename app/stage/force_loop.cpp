#include "app/stage/force_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

// At its limit a loop never comes to rest; at 0.8 of it a swing decays.
constexpr double kOfLimit = 0.8;
// A damper acts on differences of quantised positions, and contact that opens cuts it off: the linear limit is too high for it. Loops were
// measured to swing at 0.6 of it and not at 0.5 (docs/servo.md).
constexpr double kOfDampingLimit = 0.5;

/// @returns the value rounded down to two digits.
double rounded_down(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::floor(value / unit * (1.0 + 1e-12)) * unit;
}

/// Four digits or more, never an exponent.
std::string figure(double value) { return value < 1000.0 ? fmt::format("{:.4g}", value) : fmt::format("{:.0f}", value); }

/// A key of the scene that changes the loop.
struct LoopKey {
  LoopQuantity quantity;
  const char* name;
  double present;  // as in the scene
  double part;     // of its limit that is proposed
};

struct Settings {
  std::string over;  // "KEY = 1 is over its limit of 0.5", of the first key that helps
  std::string text;  // "KEY = 0.4 or OTHER = 3"
};
Settings stable_settings(const ForceLoop& loop, const Needs& needs) {
  const LoopKey keys[] = {{&ForceLoop::stiffness, "contact.coupling_N_per_m", loop.stiffness, kOfLimit},
                          {&ForceLoop::damping, "contact.coupling_N_s_per_m", loop.damping, kOfDampingLimit},
                          {&ForceLoop::gain, "device.force_scale", needs.force_scale, kOfLimit}};
  const std::string at_scale = needs.through_device ? fmt::format(" at device.force_scale {:.3g}", needs.force_scale) : "";
  Settings out;
  for (const LoopKey& key : keys) {
    const bool scale = key.quantity == &ForceLoop::gain;
    const double part = scale && !needs.through_device ? 0.0 : limit_below(loop, key.quantity) / (loop.*key.quantity);
    if (!(part > 0.0)) continue;
    const double setting = rounded_down(key.part * part * key.present);
    ForceLoop changed = loop;
    changed.*key.quantity *= setting / key.present;
    if (!is_stable(changed)) continue;
    if (out.over.empty())
      out.over = fmt::format("{} = {}{} is over its limit of {}", key.name, figure(key.present), scale ? "" : at_scale,
                             figure(part * key.present));
    out.text += fmt::format("{}{} = {}", out.text.empty() ? "" : " or ", key.name, figure(setting));
  }
  return out;
}

}  // namespace

ForceLoop force_loop(const StageConfig& config, const Needs& needs) {
  ForceLoop out = needs.grip;
  if (!needs.through_device) {
    out.body = config.hand.dynamics;
    if (config.feed_hand) out.body = {.mass = config.feed_hand->mass, .damping = config.feed_hand->damping, .stiffness = 0.0};
    out.true_velocity = true;
  }
  const int contact_hz = needs.contact_hz > 0 ? needs.contact_hz : config.servo_hz;
  out.period = 1.0 / config.servo_hz;
  out.contact_ticks = std::max(1, config.servo_hz / contact_hz);
  out.latency_ticks = needs.latency_ticks >= 0 ? needs.latency_ticks : out.contact_ticks;
  out.scheme = needs.servo.multi_rate.scheme;
  out.stiffness = needs.coupling_stiffness;
  out.damping = needs.coupling_damping;
  return out;
}

std::optional<std::string> loop_warning(const StageConfig& config, const Needs& needs) {
  if (!needs.feels || !needs.holds_back || !config.hand.feels) return std::nullopt;
  if (config.feed_hand && !config.feed_hand->push) return std::nullopt;  // no force moves it
  const ForceLoop loop = force_loop(config, needs);
  if (is_stable(loop)) return std::nullopt;
  const Settings settings = stable_settings(loop, needs);
  const char* of = needs.through_device ? "[device] the loop of device, hand and coupling is unstable"
                                        : "[contact] the loop of hand and coupling is unstable";
  if (settings.over.empty())
    return fmt::format("{}: no smaller contact.coupling_N_per_m or contact.coupling_N_s_per_m alone makes it stable", of);
  return fmt::format("{}: {}; with {} it is stable", of, settings.over, settings.text);
}

SwingConfig swing_config(const StageConfig& config, const Needs& needs) {
  constexpr double kNoticed = 0.1;  // [-] just noticeable difference of a force of 2 to 5 N (docs/stability.md)
  constexpr double kLongest = 0.2;  // [s] from turn to turn, 2.5 Hz: loops of a hand swing at more than 5 Hz
  if (!needs.feels || !config.hand.feels) return {.force = 0.0};
  const ForceLoop loop = force_loop(config, needs);
  const double push = config.hand.push;
  // A reading that alternates by a step makes the force alternate by twice the force of a step. A change of half the push counts anyway.
  const double step = needs.position_step * (loop.stiffness + loop.damping / (loop.period + loop.velocity_time));
  return {.force = std::max({kNoticed * push, config.hand.contact_force, std::min(2.0 * step, 0.5 * push)}), .longest = kLongest};
}

EnergyObserverConfig energy_config(const StageConfig& config, const Needs& needs) {
  EnergyObserverConfig out = needs.servo.energy;
  if (!needs.through_device) return out;
  out.delay = needs.grip.reading_delay;
  // In the world a force is that at the grip over force_scale, and a velocity that of the grip times position_scale.
  out.damping = config.relied_on.value_or(needs.grip.body.damping / needs.grip.gain);
  if (config.energy_tolerance || !config.hand.feels || !(needs.coupling_stiffness > 0.0)) return out;
  // The wall may return what its coupling stores, which is not counted while the soft start presses it: at twice the push, the overshoot
  // of a force that is applied at once. Readings add an error of a step.
  const double force = std::min(2.0 * config.hand.push, needs.servo.largest_force);
  out.tolerance = force * (0.5 * force / needs.coupling_stiffness + needs.position_step);
  return out;
}

}  // namespace burrhole
