// Disturbances of the loop, its clocks and its device.
#include <fmt/format.h>

#include "app/lab/stability_parts.h"
#include "core/base/units.h"
#include "haptics/servo/servo_step.h"

namespace burrhole::stability {
namespace {

StabilityCase resting(std::string name, std::string shows) {
  StabilityCase out;
  out.name = std::move(name);
  out.shows = std::move(shows);
  out.scene = scene({.volume = plate()});
  out.tool = ball();
  out.duration = kPressTime;
  out.path = press(3.0);
  out.checks = with(pressed(), {{StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained}});
  return out;
}

void add_clocks(std::vector<StabilityCase>& out) {
  for (const int rate : {1000, 200, 100, 50, 20}) {
    StabilityCase slow = resting(fmt::format("contact_{}_hz", rate), fmt::format("Contact at {} Hz, servo at 1 kHz.", rate));
    slow.rate_hz = rate;
    slow.sabotage = {.what = "every force comes 15 ticks late", .must_fail = StabilityMeasure::cycle, .late = 15};
    if (rate <= 50)
      slow.sabotage = {.what = "forces are constant between two contact evaluations",
                       .must_fail = StabilityMeasure::cycle,
                       .sets = {"servo.multirate=\"hold\""}};
    out.push_back(slow);
  }
  StabilityCase stalled =
      resting("contact_stalled", "Contact is not evaluated for 200 ms while the hand rests on bone, and again while it leaves.");
  stalled.trouble.contact_stalls = {{0.8, 1.0}, {1.45, 1.9}};
  // Three contact periods, at least 10 ms, until it is detected; 50 ms until the force is zero.
  stalled.checks = {{StabilityMeasure::not_finite, 0.0},
                    {StabilityMeasure::force, kForceBound},
                    {StabilityMeasure::passivity_deficit, kLifted},
                    {StabilityMeasure::force_without_bone, 60.0},
                    {StabilityMeasure::rest_speed, kLiftSpeed, {1.0, 1.45}},
                    {StabilityMeasure::attractive_force, kAttractiveForce, {1.5, kPressTime}},
                    {StabilityMeasure::ticks_missed, 0.0, {0.812, 0.998}, ForModels::all, kServoContactStale},
                    {StabilityMeasure::cycle, kCycle, {1.3, 1.45}},
                    {StabilityMeasure::rest_speed, kRestSpeed, kLeft},
                    {StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained}};
  stalled.sabotage = {.what = "the force stays constant and does not fade",
                      .must_fail = StabilityMeasure::force_without_bone,
                      .sets = {"servo.multirate=\"hold\"", "servo.soft_stop_s=60"}};
  out.push_back(stalled);
  StabilityCase jitter = resting("servo_jitter", "A servo tick takes one or two milliseconds, by chance.");
  jitter.trouble.servo_jitter = 1;
  jitter.sabotage = {.what = "every force comes 15 ticks late", .must_fail = StabilityMeasure::cycle, .late = 15};
  out.push_back(jitter);
  StabilityCase pauses = resting("servo_stalls", "The servo stalls for 20 ms five times a second; the device keeps its last force.");
  pauses.trouble.servo_stall_every = 0.2;
  pauses.sabotage = jitter.sabotage;
  out.push_back(pauses);
}

void add_devices(std::vector<StabilityCase>& out) {
  StabilityCase teleport = resting("teleport", "The device's position jumps 20 mm into bone, and 25 mm out again.");
  teleport.trouble.teleports = {{0.8, {0.0, 0.0, -20e-3}}, {1.2, {0.0, 0.0, 5e-3}}};
  teleport.far_side = -3.5e-3;
  teleport.checks = {{StabilityMeasure::not_finite, 0.0},
                     {StabilityMeasure::force, kForceBound},
                     {StabilityMeasure::force_without_bone, 0.0},
                     {StabilityMeasure::passivity_deficit, kLifted},
                     {StabilityMeasure::attractive_force, kAttractiveForce},
                     {StabilityMeasure::rest_speed, kRestSpeed, kLeft}};
  teleport.checks = with(teleport.checks, held_back());
  teleport.sabotage = {
      .what = "a jump is treated as a motion", .must_fail = StabilityMeasure::passivity_deficit, .sets = {"servo.jump_m_per_s=0"}};
  out.push_back(teleport);
  StabilityCase number = resting("device_nan", "The device reports a NaN position for 10 ms; the user resets after 200 ms.");
  number.trouble.hand_not_number = TimeSpan{0.6, 0.61};
  number.trouble.reset_at = 0.8;
  const TimeSpan settled{1.35, 1.5};
  number.checks = {{StabilityMeasure::not_finite, 0.0},
                   {StabilityMeasure::force, kForceBound},
                   {StabilityMeasure::force_without_bone, 0.0},
                   {StabilityMeasure::passivity_deficit, kLifted},
                   {StabilityMeasure::rest_speed, kLiftSpeed, {0.8, 1.5}},
                   {StabilityMeasure::cycle, kCycle, settled},
                   {StabilityMeasure::ripple, kRipple, settled},
                   {StabilityMeasure::attractive_force, kAttractiveForce, {1.5, kPressTime}},
                   {StabilityMeasure::rest_speed, kRestSpeed, kLeft},
                   {StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained},
                   {StabilityMeasure::force_in_fault, 0.0, {}, ForModels::all, kServoLatched},
                   {StabilityMeasure::ticks_missed, 0.0, {0.6, 0.61}, ForModels::all, kServoHandNotFinite},
                   {StabilityMeasure::ticks_missed, 0.0, {0.6, 0.799}, ForModels::all, kServoLatched}};
  number.sabotage = {
      .what = "zero forces are replaced by the largest force so far", .must_fail = StabilityMeasure::force_in_fault, .does_not_stop = true};
  out.push_back(number);
  StabilityCase infinite = number;
  infinite.name = "device_infinite";
  infinite.shows = "The device reports an infinite velocity for 10 ms; the user resets after 200 ms.";
  infinite.trouble.hand_infinite = infinite.trouble.hand_not_number;
  infinite.trouble.hand_not_number.reset();
  out.push_back(infinite);
}

}  // namespace

void add_troubles(std::vector<StabilityCase>& out, bool long_runs) {
  add_clocks(out);
  add_devices(out);
  StabilityCase endless =
      resting("million_ticks", "A ball of under 100 points rests on a plate for a million ticks (ten million with --long).");
  endless.tool = ball(0.85);
  endless.ticks = long_runs ? 10'000'000 : 1'000'000;
  endless.path = {{0.0, {0.0, 0.0, 1e-3}}, {0.5, {0.0, 0.0, -3e-3}}};
  const TimeSpan settled{1.5, std::numeric_limits<double>::infinity()};
  endless.checks = with(always(), {{StabilityMeasure::cycle, kCycle, settled}, {StabilityMeasure::ripple, kRipple, settled}});
  endless.checks = with(endless.checks, {{StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained}});
  out.push_back(endless);
}

}  // namespace burrhole::stability
