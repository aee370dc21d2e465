// Bone of various shapes under a hand that presses and leaves.
#include "app/lab/stability_parts.h"
#include "core/base/units.h"

namespace burrhole::stability {
namespace {

StabilityCase pressing(std::string name, std::string shows, std::string volume, double depth_mm) {
  StabilityCase out;
  out.name = std::move(name);
  out.shows = std::move(shows);
  out.scene = scene({.volume = std::move(volume)});
  out.tool = ball();
  out.duration = kPressTime;
  out.path = press(depth_mm);
  out.checks = pressed();
  out.sabotage = {.what = "every force comes 15 ticks late", .must_fail = StabilityMeasure::cycle, .late = 15};
  return out;
}

void add_edges(std::vector<StabilityCase>& out) {
  StabilityCase edge = pressing("edge", "A ball on the convex edge of a right angle.",
                                "source = \"phantom:wedge\"\nwedge_deg = 90\nextent_mm = [16, 16, 12]\n", 3.0);
  edge.checks = with(edge.checks, held_back());
  out.push_back(edge);
  StabilityCase wedge = pressing("wedge", "A flat pin across the edge of a wedge of 40 degrees, sharper than any bone of a skull.",
                                 "source = \"phantom:wedge\"\nwedge_deg = 40\nextent_mm = [16, 16, 12]\n", 3.0);
  wedge.tool = pin(4.0, 0.25);
  wedge.checks = with(wedge.checks, held_back());
  out.push_back(wedge);
  StabilityCase corner = pressing("corner", "A ball on the corner of a block, from which it slips.",
                                  "source = \"phantom:block\"\nblock_mm = [12, 12, 7]\nextent_mm = [20, 20, 10]\n", 3.0);
  corner.scene = scene(
      {.volume = "source = \"phantom:block\"\nblock_mm = [12, 12, 7]\nextent_mm = [20, 20, 10]\n", .entry_x_mm = 5.7, .entry_y_mm = 5.5});
  corner.checks = with(corner.checks, held_back());
  out.push_back(corner);
}

/// Tools with a flat face, a tip and a thin edge, pressed where bone reaches them between their shell points.
void add_between_points(std::vector<StabilityCase>& out) {
  const std::string edge = "source = \"phantom:wedge\"\nwedge_deg = 90\nextent_mm = [16, 16, 12]\n";
  const std::string wedge = "source = \"phantom:wedge\"\nwedge_deg = 40\nextent_mm = [16, 16, 12]\n";
  const std::string hole =
      "source = \"phantom:pit\"\nthickness_mm = 7\nhole_depth_mm = 4\nextent_mm = [16, 16, 10]\nhole_radius_mm = 1.2\n";
  const auto add = [&](std::string name, std::string shows, const std::string& volume, std::string tool, double entry_x_mm = 0.0) {
    StabilityCase one = pressing(std::move(name), std::move(shows), volume, 3.0);
    one.scene = scene({.volume = volume, .entry_x_mm = entry_x_mm});
    one.tool = std::move(tool);
    one.checks = with(one.checks, held_back());
    one.sabotage = {.what = "contact knows the tool by its shell points only",
                    .must_fail = StabilityMeasure::penetration,
                    .sets = {},
                    .points_only = true};
    out.push_back(std::move(one));
  };
  add("flat_on_edge", "A flat pin with points 1 mm apart on an edge of bone that passes between them.", edge, pin(5.0, 1.0), 0.25);
  add("cone_on_wedge", "A blunt cone with points 0.8 mm apart on the edge of a wedge of 40 degrees, its tip beside it.", wedge,
      cone(5.0, 2.0, 0.8), 0.35);
  // [N] The cone slides off under 2.4 N, and the measure's normals, from the densities of single cells, are off by 2 degrees on so sharp an edge.
  for (StabilityCheck& check : out.back().checks)
    if (check.measure == StabilityMeasure::attractive_force) check.bound = kAttractiveForce + 2.4 * 0.035;
  StabilityCase ring = pressing("flat_on_rim", "A flat pin with points 1 mm apart beside the rim of a hole.", hole, 3.0);
  add("blade_on_edge", "A thin blade across an edge of bone, its points 0.9 mm apart.", edge, blade(8.0, 0.5, 0.9));
  ring.scene = scene({.volume = hole, .entry_x_mm = 3.0});
  ring.tool = pin(3.0, 1.0);
  ring.path = press(3.0, -1.5);
  ring.start = {-1.5e-3, 0.0, 1e-3};
  ring.checks = with(ring.checks, held_back(kPenetration + 0.25 / (4.0 * 1.2)));
  out.push_back(ring);
}

void add_concave(std::vector<StabilityCase>& out) {
  const auto pit = [](double radius_mm) {
    return "source = \"phantom:pit\"\nthickness_mm = 7\nhole_depth_mm = 4\nextent_mm = [16, 16, 10]\nhole_radius_mm = " +
           std::to_string(radius_mm) + "\n";
  };
  // The origin of the approach is on the floor of the pit, 4 mm below the face of the plate.
  const auto into = [](double depth_mm) {
    return std::vector<Waypoint>{{0.0, {0.0, 0.0, 5e-3}},
                                 {0.5, {0.0, 0.0, -depth_mm * kMillimetre}},
                                 {0.9, {0.5e-3, 0.0, -depth_mm * kMillimetre}},
                                 {1.5, {0.5e-3, 0.0, -depth_mm * kMillimetre}},
                                 {1.8, {0.0, 0.0, 7e-3}}};
  };
  StabilityCase wide =
      pressing("pit_as_wide", "A ball in a round pit exactly as wide: the floor and all of the wall are touched at once.", pit(2.0), 3.0);
  wide.path = into(3.0);
  wide.start = {0.0, 0.0, 5e-3};
  wide.far_side = -1.5e-3;
  wide.checks = with(wide.checks, held_back(kCurved));
  out.push_back(wide);
  StabilityCase narrow = pressing("pit_narrower", "A ball on a round pit narrower than it is: a ring of points is touched.", pit(1.5), 3.0);
  narrow.path = into(-1.0);
  narrow.start = {0.0, 0.0, 5e-3};
  narrow.far_side = -1.5e-3;
  narrow.checks = with(narrow.checks, held_back());
  out.push_back(narrow);
  StabilityCase slot =
      pressing("slot", "A ball in a slot a tenth of a voxel narrower than it is: both sides push, against each other.", plate(), 3.0);
  slot.scene = scene({.volume = plate(), .entry_x_mm = 5.0});
  slot.slot_half_width = 1.9875e-3;
  slot.path = press(3.0, -5.0);
  slot.start = {-5e-3, 0.0, 1e-3};
  slot.far_side = -4e-3;
  slot.checks = with(slot.checks, held_back());
  out.push_back(slot);
}

void add_deep(std::vector<StabilityCase>& out) {
  const std::string thin = "source = \"phantom:plate\"\nextent_mm = [16, 16, 10]\nthickness_mm = 3\n";
  StabilityCase deep = pressing(
      "deep", "The largest force of the device on a plate of 3 mm: beyond its middle the nearest surface is the far side.", thin, 40.0);
  deep.far_side = -1.5e-3;
  // The force limit of the grip bounds the spring there: only properties at the limit are tested.
  deep.checks = with(with(always(), held_back()), {{StabilityMeasure::rest_speed, kRestSpeed, {2.8, 3.0}}});
  deep.duration = 3.0;
  deep.sabotage = {.what = "the force limits of servo and device are off",
                   .must_fail = StabilityMeasure::force,
                   .sets = {"servo.force_N=1000", "device.force_N=1000"}};
  out.push_back(deep);
  StabilityCase embedded =
      pressing("start_embedded", "The run starts with the ball 1 mm under the surface; the hand then leaves.", plate(), 1.0);
  embedded.start = {0.0, 0.0, -1e-3};
  embedded.path = {{0.0, embedded.start}, {0.5, embedded.start}, {1.0, {0.0, 0.0, 3e-3}}};
  embedded.checks = {{StabilityMeasure::not_finite, 0.0},
                     {StabilityMeasure::force, kForceBound},
                     {StabilityMeasure::force_without_bone, 0.0},
                     {StabilityMeasure::rest_speed, kRestSpeed, kLeft}};
  embedded.sabotage = {.what = "zero forces are replaced by the largest force so far",
                       .must_fail = StabilityMeasure::force_without_bone,
                       .does_not_stop = true};
  out.push_back(embedded);
  StabilityCase zero = embedded;
  zero.name = "zero_gradient";
  zero.shows = "The run starts with the whole ball 1 mm under the surface of solid bone, where the density has no gradient.";
  zero.start = {0.0, 0.0, -5e-3};
  zero.scene = scene({.volume = "source = \"phantom:plate\"\nextent_mm = [16, 16, 14]\nthickness_mm = 12\n"});
  zero.path = {{0.0, zero.start}, {0.5, zero.start}, {1.0, {0.0, 0.0, 3e-3}}};
  out.push_back(zero);
}

}  // namespace

void add_shapes(std::vector<StabilityCase>& out) {
  StabilityCase rest = pressing("rest", "A ball comes to rest on a plate and leaves it.", plate(), 3.0);
  rest.far_side = -3.5e-3;
  rest.checks = with(rest.checks, held_back());
  rest.sabotage = {.what = "the sign of the force is flipped", .must_fail = StabilityMeasure::passivity_deficit, .flip = true};
  out.push_back(rest);
  StabilityCase flat = pressing("many_points", "A flat face of 10 mm on a plate: hundreds of points touch at once.",
                                "source = \"phantom:plate\"\nextent_mm = [20, 20, 10]\nthickness_mm = 7\n", 3.0);
  flat.tool = pin(10.0, 0.4);
  flat.far_side = -3.5e-3;
  flat.checks = with(flat.checks, held_back());
  out.push_back(flat);
  add_edges(out);
  add_between_points(out);
  add_concave(out);
  add_deep(out);
  StabilityCase noisy = pressing("noisy", "A ball on bone whose voxels are off by up to 30 %.", plate("noise = 0.3\n"), 3.0);
  noisy.far_side = -3.5e-3;
  noisy.checks = with(noisy.checks, {{StabilityMeasure::far_side, 0.0}});
  out.push_back(noisy);
  StabilityCase away = rest;
  away.name = "far_origin";
  away.shows = "The same plate 10 m away from the world's origin.";
  away.scene = scene({.volume = plate("position_mm = [10000, -10000, 10000]\n")});
  out.push_back(away);
}

}  // namespace burrhole::stability
