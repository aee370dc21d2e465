#include <limits>

#include "app/lab/frontier.h"

namespace burrhole {
namespace {

using enum MultiRateScheme;

// Limits of exact sampled systems in whole N/m, computed from each row by scripts/frontier_known; own derivation, shown there.
constexpr KnownLimit kKnown[] = {
    {.name = "b 0.5", .damping = 0.5, .stiffness = 1001},
    {.name = "b 2", .damping = 2, .stiffness = 4013},
    {.name = "b 5", .stiffness = 10084},
    {.name = "b 5, a tick late", .latency_ticks = 1, .stiffness = 3379},
    {.name = "b 5, two ticks late", .latency_ticks = 2, .stiffness = 2042},
    {.name = "b 5, device a tick late", .delay = 1, .stiffness = 3379},
    {.name = "m 0.05, a tick late", .mass = 0.05, .latency_ticks = 1, .stiffness = 3423},
    {.name = "in a hand", .mass = 0.25, .spring = 300, .stiffness = 10034},
    {.name = "in a hand, a tick late", .mass = 0.25, .spring = 300, .latency_ticks = 1, .stiffness = 3353},
    {.name = "500 Hz", .servo_hz = 500, .stiffness = 5085},
    {.name = "10 kHz", .servo_hz = 10000, .stiffness = 100083},
    {.name = "B 0", .damping = 1, .stiffness = 2003},
    {.name = "B 1", .damping = 1, .coupling_damping = 1, .stiffness = 3967},
    {.name = "B 2", .damping = 1, .coupling_damping = 2, .stiffness = 5892},
    {.name = "B 5", .damping = 1, .coupling_damping = 5, .stiffness = 11437},
    {.name = "B 10", .damping = 1, .coupling_damping = 10, .stiffness = 19948},
    {.name = "B 20", .damping = 1, .coupling_damping = 20, .stiffness = 34457},
    {.name = "held 2", .contact_ticks = 2, .stiffness = 5085},
    {.name = "held 5", .contact_ticks = 5, .stiffness = 2087},
    {.name = "held 10", .contact_ticks = 10, .stiffness = 1090},
    {.name = "held 20", .contact_ticks = 20, .stiffness = 598},
    {.name = "held 50", .contact_ticks = 50, .stiffness = 322},
    {.name = "held 2, late", .contact_ticks = 2, .latency_ticks = 2, .stiffness = 1712},
    {.name = "held 5, late", .contact_ticks = 5, .latency_ticks = 5, .stiffness = 710},
    {.name = "held 10, late", .contact_ticks = 10, .latency_ticks = 10, .stiffness = 373},
    {.name = "held 20, late", .contact_ticks = 20, .latency_ticks = 20, .stiffness = 201},
    {.name = "linear 2", .contact_ticks = 2, .scheme = linear, .stiffness = 3406},
    {.name = "linear 5", .contact_ticks = 5, .scheme = linear, .stiffness = 1175},
    {.name = "linear 10", .contact_ticks = 10, .scheme = linear, .stiffness = 585},
    {.name = "linear 20", .contact_ticks = 20, .scheme = linear, .stiffness = 309},
    {.name = "linear 50", .contact_ticks = 50, .scheme = linear, .stiffness = 141},
    {.name = "linear 2, late", .contact_ticks = 2, .latency_ticks = 2, .scheme = linear, .stiffness = 1474},
    {.name = "linear 5, late", .contact_ticks = 5, .latency_ticks = 5, .scheme = linear, .stiffness = 569},
    {.name = "linear 10, late", .contact_ticks = 10, .latency_ticks = 10, .scheme = linear, .stiffness = 295},
    {.name = "linear 20, late", .contact_ticks = 20, .latency_ticks = 20, .scheme = linear, .stiffness = 158},
    {.name = "held 10, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 10, .stiffness = 1045},
    {.name = "held 20, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 20, .stiffness = 558},
    {.name = "held 50, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 50, .stiffness = 314},
    {.name = "linear 10, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 10, .scheme = linear, .stiffness = 566},
    {.name = "linear 20, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 20, .scheme = linear, .stiffness = 311},
    {.name = "linear 50, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 50, .scheme = linear, .stiffness = 216},
    {.name = "gradient 10", .contact_ticks = 10, .scheme = gradient, .stiffness = 10084},
    {.name = "gradient 50", .contact_ticks = 50, .scheme = gradient, .stiffness = 10084},
    {.name = "planes 1", .scheme = planes, .stiffness = 10084},
    {.name = "planes 10", .contact_ticks = 10, .scheme = planes, .stiffness = 10084},
    {.name = "planes 50", .contact_ticks = 50, .scheme = planes, .stiffness = 10084},
    {.name = "planes 50, a period late", .contact_ticks = 50, .latency_ticks = 50, .scheme = planes, .stiffness = 10084},
    {.name = "planes 50, in a hand", .mass = 0.25, .spring = 300, .contact_ticks = 50, .scheme = planes, .stiffness = 10034},
    {.name = "generic, no hand", .damping = 0.5, .delay = 1, .scheme = planes, .stiffness = 334},
    {.name = "generic, light", .mass = 0.15, .damping = 1, .delay = 1, .scheme = planes, .stiffness = 668},
    {.name = "generic, nominal", .mass = 0.25, .spring = 300, .delay = 1, .scheme = planes, .stiffness = 3353},
    {.name = "generic, firm", .mass = 0.7, .damping = 10.5, .spring = 1000, .delay = 1, .scheme = planes, .stiffness = 7033},
};

}  // namespace

std::span<const KnownLimit> known_limits() noexcept { return kKnown; }

FrontierLoopConfig loop_of(const KnownLimit& known) {
  FrontierLoopConfig out;
  out.device.plant.body = {known.mass, known.damping, known.spring};
  out.device.delay = known.delay;
  out.device.velocity_time = 0.0;
  out.servo_hz = known.servo_hz;
  out.contact_ticks = known.contact_ticks;
  out.latency_ticks = known.latency_ticks;
  out.scheme = known.scheme;
  out.coupling_damping = known.coupling_damping;
  return out;
}

SampledWall wall_of(const FrontierLoopConfig& config) {
  const MassSpringDamperConfig& body = config.device.plant.body;
  return {.mass = body.mass,
          .damping = body.damping,
          .hand_stiffness = body.stiffness,
          .period = 1.0 / config.servo_hz,
          .delay = config.device.delay,
          .contact_ticks = config.contact_ticks,
          .latency_ticks = config.latency(),
          .scheme = config.scheme,
          .wall_damping = config.coupling_damping,
          .velocity_time = config.device.velocity_time,
          .true_velocity = config.device.true_velocity};
}

}  // namespace burrhole
