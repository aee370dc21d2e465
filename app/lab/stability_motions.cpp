// The hand, or bone, moves along during contact.
#include <fmt/format.h>

#include "app/lab/stability_parts.h"
#include "core/base/units.h"

namespace burrhole::stability {
namespace {

/// Down at x = -3 mm, to +3 mm in a second, back in another, and up. @param slope height lost per length along x.
std::vector<Waypoint> there_and_back(double slope) {
  const auto at = [&](double x_mm, double z_mm) { return Vec3(x_mm, 0.0, z_mm - slope * x_mm) * kMillimetre; };
  return {{0.0, at(-3, 1)}, {0.4, at(-3, -3)}, {0.8, at(-3, -3)}, {1.8, at(3, -3)}, {2.0, at(3, -3)}, {3.0, at(-3, -3)}, {3.4, at(-3, 3)}};
}
// The hand starts with a step of velocity, which its damper dissipates in 0.1 s: five times that.
constexpr TimeSpan kThere{1.3, 1.8}, kBack{2.5, 3.0};

StabilityCase sliding(std::string name, std::string shows, std::string volume, double slope) {
  StabilityCase out;
  out.name = std::move(name);
  out.shows = std::move(shows);
  out.scene = scene({.volume = std::move(volume), .exact = true});
  out.tool = ball();
  out.duration = 3.8;
  out.path = there_and_back(slope);
  out.start = out.path.front().at;
  out.checks = with(always(), {{StabilityMeasure::force_step, kSlideStep, kThere},
                               {StabilityMeasure::force_step, kSlideStep, kBack},
                               {StabilityMeasure::drag, kDrag, kThere},
                               {StabilityMeasure::drag, kDrag, kBack},
                               {StabilityMeasure::lateral_force, kSlideStep, {0.9, 3.0}},
                               {StabilityMeasure::attractive_force, kAttractiveForce, {3.0, 3.8}},
                               {StabilityMeasure::rest_speed, kRestSpeed, {3.7, 3.8}},
                               {StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained}});
  out.sabotage = {.what = "the force is turned by 10 degrees", .must_fail = StabilityMeasure::drag, .turned = 10.0 * kDegree};
  return out;
}

void add_slides(std::vector<StabilityCase>& out) {
  const std::string level = "source = \"phantom:plate\"\nextent_mm = [20, 16, 10]\nthickness_mm = 7\n";
  StabilityCase flat = sliding("slide_flat", "A ball slides over a level plate, there and back.", level, 0.0);
  flat.checks.push_back({StabilityMeasure::ripple, kRipple, kThere});
  flat.checks.push_back({StabilityMeasure::ripple, kRipple, kBack});
  flat.sabotage = {.what = "every force comes 15 ticks late", .must_fail = StabilityMeasure::ripple, .late = 15};
  out.push_back(flat);
  // tan 25 degrees
  StabilityCase tilted = sliding(
      "slide_tilted", "The same down and up a plate tilted by 25 degrees: across voxels.",
      "source = \"phantom:plate\"\nextent_mm = [22, 16, 20]\nabove_mm = 7\nthickness_mm = 7\nplate_normal = [0.4226183, 0, 0.9063078]\n",
      0.4663077);
  tilted.checks.push_back({StabilityMeasure::ripple, kRipple, kThere});
  tilted.checks.push_back({StabilityMeasure::ripple, kRipple, kBack});
  tilted.sabotage = flat.sabotage;
  out.push_back(tilted);
  out.push_back(sliding("slide_curved", "The same over a ball of bone of 15 mm.",
                        "source = \"phantom:sphere\"\nradius_mm = 15\nextent_mm = [32, 32, 16]\n", 0.0));
}

void add_strokes(std::vector<StabilityCase>& out) {
  constexpr double kLimit = 0.125;  // [m/s] voxel edge over two ticks: at most half a voxel per tick
  for (const double times : {0.5, 1.0, 2.0, 10.0}) {
    StabilityCase stroke;
    stroke.name = fmt::format("stroke_{:g}x", times);
    stroke.shows = fmt::format("The tool hits the plate at {:g} mm/s, {:g} voxel per tick.", times * kLimit / kMillimetre, 0.5 * times);
    stroke.scene = scene({.volume = plate()});
    stroke.tool = ball();
    stroke.start = {0.0, 0.0, 2e-3};
    stroke.start_velocity = {0.0, 0.0, -times * kLimit};
    stroke.path = {{0.0, {0.0, 0.0, 0.5e-3}}};
    stroke.far_side = -3.5e-3;
    stroke.duration = 1.5;
    stroke.checks = with(with(always(), held_back()),
                         {{StabilityMeasure::attractive_force, kAttractiveForce}, {StabilityMeasure::rest_speed, kRestSpeed, {1.3, 1.5}}});
    stroke.sabotage = {.what = "the sign of the force is flipped", .must_fail = StabilityMeasure::attractive_force, .flip = true};
    out.push_back(stroke);
  }
}

/// The tool comes from 60 mm away, far outside the window.
void add_arrivals(std::vector<StabilityCase>& out) {
  struct Arrival {
    int rate_hz;
    double speed;  // [m/s]
  };
  for (const Arrival& a : {Arrival{1000, 1.0}, {100, 0.5}, {50, 0.2}, {20, 0.2}}) {
    StabilityCase arrival;
    arrival.name = fmt::format("arrival_{}_hz", a.rate_hz);
    arrival.shows = fmt::format("The tool comes from 60 mm away at {:g} mm/s; contact at {} Hz.", a.speed / kMillimetre, a.rate_hz);
    arrival.scene = scene({.volume = plate()});
    arrival.tool = ball();
    arrival.rate_hz = a.rate_hz;
    arrival.start = {0.0, 0.0, 60e-3};
    arrival.start_velocity = {0.0, 0.0, -a.speed};
    const double there = 61e-3 / a.speed;
    arrival.path = {{0.0, arrival.start}, {there, {0.0, 0.0, -1e-3}}};
    arrival.far_side = -3.5e-3;
    arrival.duration = there + 1.5;
    arrival.checks = with({{StabilityMeasure::not_finite, 0.0},
                           {StabilityMeasure::force, kForceBound},
                           {StabilityMeasure::force_without_bone, 0.0},
                           {StabilityMeasure::rest_speed, kRestSpeed, {arrival.duration - 0.2, arrival.duration}}},
                          held_back());
    // Slower contact finds the hand millimetres inside bone: the energy of the spring is then the hand's, by the delay and not by the loop.
    if (a.rate_hz == 1000) arrival.checks.push_back({StabilityMeasure::passivity_deficit, kEnergy});
    arrival.sabotage = {
        .what = "contact knows bone in the window only", .must_fail = StabilityMeasure::force_without_bone, .only_window = true};
    out.push_back(arrival);
  }
}

}  // namespace

void add_motions(std::vector<StabilityCase>& out) {
  add_slides(out);
  add_strokes(out);
  add_arrivals(out);
  StabilityCase moved;
  moved.name = "moved_bone";
  moved.shows = "Bone is swung by 1 mm and turned by 6 degrees once a second while the hand rests on it.";
  moved.scene = scene({.volume = plate()});
  moved.tool = ball();
  moved.path = press(3.0);
  moved.swing = 1e-3;
  moved.turn = 0.1;
  moved.duration = kPressTime;
  moved.checks = with(always(), {{StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained},
                                 {StabilityMeasure::attractive_force, kAttractiveForce},
                                 {StabilityMeasure::force_step, kDeviceStep, {0.8, 1.5}},
                                 {StabilityMeasure::rest_speed, kRestSpeed, kLeft}});
  moved.sabotage = {.what = "contact is not evaluated after the first touch",
                    .must_fail = StabilityMeasure::penetration,
                    .sets = {"servo.soft_stop_s=60"},
                    .dead_contact = true};
  out.push_back(moved);
  StabilityCase chip;
  chip.name = "loose_chip";
  chip.shows = "A chip of bone of 6 mm that is free except for a drag of 20 N s/m is pushed away by the tool.";
  chip.scene = scene({.volume = "source = \"phantom:block\"\nblock_mm = [6, 6, 3]\nextent_mm = [12, 12, 8]\n"});
  chip.tool = ball();
  chip.path = press(3.0);
  chip.duration = kPressTime;
  chip.loose_drag = 20.0;
  chip.checks = with(always(), {{StabilityMeasure::penetration, kPenetration, {}, ForModels::constrained},
                                {StabilityMeasure::attractive_force, kAttractiveForce},
                                {StabilityMeasure::rest_speed, kRestSpeed, kLeft}});
  chip.sabotage = {.what = "zero forces are replaced by the largest force so far",
                   .must_fail = StabilityMeasure::force_without_bone,
                   .does_not_stop = true};
  out.push_back(chip);
}

}  // namespace burrhole::stability
