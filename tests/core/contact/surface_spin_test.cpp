// A spinning tool on bone that is not cut meanwhile: engaged by F / K_cut, pushed back, never on the far side; a thin blade in its own
// slot.
#include <cstdio>

#include "stroke_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

/// [m] least move along `way` (unit) after which no point is deeper than `level` [m] in bone, at most `most`.
double way_out_of(const PointShell& shell, const Pose& pose, const Truth& truth, const Vec3& way, double level, double most) {
  const auto deep = [&](double s) { return deepest_of(shell, {pose.rotation, pose.translation + way * s}, truth) * kFine > level; };
  double in = 0.0, out = 0.0;
  while (out < most && deep(out)) {
    in = out;
    out += 0.02 * kFine;
  }
  for (int n = 0; n < 20; ++n) (deep(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
  return out;
}

struct Pressed {
  double force = 0.0;                       ///< [N]
  double expected = 0.0, true_depth = 0.0;  ///< [m] F / K_cut and the truth, along the force; in a pit along its axis
  bool crossed = false, points_back = true;
};

/// The spinning hand comes down the stroke's way at 0.1 m/s to `push` beyond first contact, and rests.
Pressed press(const Bench& bench, const ConstrainedToolConfig& config, double push) {
  ConstrainedTool tool = bench.tool(config);
  const SurfaceView view = bench.view();
  const Vec3 along = bench.stroke.along;
  double touch = 0.0;
  while (deepest_of(bench.shell, {Quat(1.0, 0.0, 0.0, 0.0), bench.stroke.from + along * touch}, bench.phantom.truth) < 0.0)
    touch += 0.01e-3;
  const double length = touch + push / config.coupling_stiffness;
  Pressed out;
  Vec3 before = bench.stroke.from + Vec3(0.0, 0.0, kBallRadius);
  for (int tick = 0; tick < 200; ++tick) {
    const double gone = std::min(length, tick * 0.1e-3);
    const ConstrainedToolState& state =
        tool.step(view, {{Quat(1.0, 0.0, 0.0, 0.0), bench.stroke.from + along * gone}, gone < length ? along * 0.1 : Vec3(0.0)}, kPeriod,
                  {.spinning = true});
    const Vec3 centre = state.world_from_tool * Vec3(0.0, 0.0, kBallRadius), moved = centre - before;
    if (glm::length(moved) > 0.0)
      if (const auto entry = bench.phantom.truth.entry_distance(before, moved)) out.crossed = out.crossed || *entry < glm::length(moved);
    before = centre;
    if (glm::length(state.on_hand.force) > 0.1) out.points_back = out.points_back && glm::dot(state.on_hand.force, along) < 0.0;
  }
  const ConstrainedToolState& state = tool.state();
  out.force = glm::length(state.on_hand.force);
  out.expected = out.force / config.cutting_stiffness;
  if (bench.stroke.spec.kind == PhantomKind::pit) {
    // Walls are held off by the clearance of the cutting points, so the way out along a slanting force is longer; the floor tells.
    out.expected = state.on_hand.force.z / config.cutting_stiffness;
    out.true_depth = -bench.stroke.spec.hole_depth - state.world_from_tool.translation.z;
  } else {
    out.true_depth = way_out_of(bench.shell, state.world_from_tool, bench.phantom.truth, state.on_hand.force / out.force, 0.0, 4e-3);
  }
  return out;
}

constexpr double kBlade = 0.6e-3;      ///< [m] thickness of the blade
constexpr double kSlotFloor = 1.5e-3;  ///< [m] under the outer face

/// A block of bone with a slot along x, open to the ends of the grid; its floor level.
DenseBone slotted_bone(double width) {
  constexpr double kPitch = 0.15e-3;
  DenseBone bone;
  bone.dims = Vec3i(100, 24, 50);
  bone.bone_from_index = Affine::scaling(kPitch, Vec3(-49.5, -11.5, -35.0) * kPitch);
  for_each_voxel({Vec3i(0), bone.dims}, [&](const Vec3i& v) {
    const Vec3 p = bone.bone_from_index * Vec3(v);
    // Signed distances of half-spaces along axes: the 0.5 level of this ramp is exact away from edges.
    const double slot = std::max(std::abs(p.y) - 0.5 * width, -kSlotFloor - p.z);
    const double distance = std::max(p.z, -slot);
    bone.occupancy.push_back(static_cast<float>(std::clamp(0.5 - distance / (2.0 * kPitch), 0.0, 1.0)));
    bone.hardness.push_back(bone.occupancy.back() > 0.0f ? 0.8f : 0.0f);
    bone.labels.push_back(static_cast<std::uint8_t>(distance < 0.0 ? VoxelLabel::bone : VoxelLabel::none));
  });
  return bone;
}

/// The shipped saw's lowest part.
PointShell blade_shell() {
  const PointShell whole = shipped_shell("sagittal_saw_12mm");
  PointShell shell;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    if (whole.positions[n].z > 4e-3) continue;
    shell.positions.push_back(whole.positions[n]);
    shell.inward_normals.push_back(whole.inward_normals[n]);
    shell.cutting.push_back(whole.cutting[n]);
  }
  return shell;
}

}  // namespace

TEST_CASE("surface: a thin blade in a slot of its own width is let down by F / K_cut at most, walls or no walls") {
  std::printf("blade of 0.6 mm in a slot: width [mm], hand aside [mm], force down [N], F / K_cut and depth under the floor [mm]\n");
  const PointShell shell = blade_shell();
  for (const double width : {0.56e-3, 0.6e-3, 0.64e-3, 1.5e-3}) {
    CAPTURE(width);
    const ShippedBone bone(slotted_bone(width));
    for (const double aside : {0.0, 0.2e-3}) {
      CAPTURE(aside);
      const auto depth_with = [&](double cutting_stiffness, double& force) {
        ConstrainedToolConfig config;
        config.cutting_stiffness = cutting_stiffness;
        auto tool = ConstrainedTool::create(config, shell, bone.edge());
        REQUIRE(tool.ok());
        tool->place({Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.3e-3 - kSlotFloor)});
        for (int tick = 0; tick < 400; ++tick)
          (void)tool->step(bone.view(), {{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, aside, -kSlotFloor - 4e-3)}, Vec3(0.0)}, kPeriod,
                           {.spinning = true});
        force = tool->state().on_hand.force.z;
        return -kSlotFloor - tool->state().world_from_tool.translation.z;
      };
      double force = 0.0;
      const double depth = depth_with(100e3, force);
      std::printf("  %.2f  %.1f  %6.2f  %.4f %.4f\n", 1e3 * width, 1e3 * aside, force, 1e3 * force / 100e3, 1e3 * depth);
      CHECK(force > 15.0);  // 20 N, less the engagement's give
      // Not by more than F / K_cut, which opposed walls that pinch the blade must not raise; and by less only by what the corner between
      // wall and floor, felt rounded, holds under the blade's rim: half a voxel where the walls are near, nothing where they are not.
      const double least = width < 1e-3 ? 0.5 * bone.edge() : 0.1 * bone.edge();
      const auto let_down = [&](double f, double d) { return d <= 1.1 * f / 100e3 && d >= f / 100e3 - least; };
      CHECK(let_down(force, depth));
      // Sabotage: a tool that engages further, as when opposed walls add to it, is told.
      double less = 0.0;
      const double deeper = depth_with(40e3, less);
      CHECK_FALSE(let_down(less, deeper));
    }
  }
}

TEST_CASE("surface: spinning on uncut bone it is engaged by F / K_cut, pushed back and never on the far side, whatever the shape") {
  std::printf("spinning on uncut bone: shape, push [N], force [N], engaged F / K_cut and true way out [mm]\n");
  for (const Stroke& stroke : every_stroke()) {
    CAPTURE(stroke.name);
    for (const Records records : kBoth) {
      CAPTURE(name_of(records));
      const Bench bench(stroke, records);
      for (const double push : {10.0, 20.0, 40.0}) {
        CAPTURE(push);
        ConstrainedToolConfig config;
        config.cutting_stiffness = 50e3;  // 0.2 to 0.8 mm
        const Pressed seen = press(bench, config, push);
        std::printf("%-30s %-15s %3.0f %6.2f  %.4f %.4f%s\n", stroke.name.c_str(), name_of(records), push, seen.force, 1e3 * seen.expected,
                    1e3 * seen.true_depth, seen.crossed ? " CROSSED" : "");
        CHECK(seen.points_back);
        CHECK_FALSE(seen.crossed);
        CHECK(seen.force > 0.5 * push);
        // Within 10 %, or what a tool at rest is allowed: 0.1 voxel.
        CHECK(std::abs(seen.true_depth - seen.expected) <= std::max(0.1 * seen.expected, 0.1 * kFine));
      }
    }
  }
}

namespace {

/// A plate of 1 mm with a round hole all through, its wall at 0.5 as phantoms have it.
ShippedBone ring_of(double radius) {
  PhantomSpec spec = fine_spec(PhantomKind::plate);
  spec.extent = Vec3(0.007, 0.007, 0.005);
  spec.above = 0.002;
  spec.thickness = 0.001;
  DenseBone dense = phantom_of(spec).bone;
  for (std::size_t n = 0; n < dense.occupancy.size(); ++n) {
    const auto nx = static_cast<std::size_t>(dense.dims.x), ny = static_cast<std::size_t>(dense.dims.y);
    const Vec3 at = dense.bone_from_index * Vec3(static_cast<double>(n % nx), static_cast<double>(n / nx % ny), 0.0);
    const double left = std::clamp(0.5 + (std::hypot(at.x, at.y) - radius) / (2.0 * kFine), 0.0, 1.0);
    dense.occupancy[n] = std::min(dense.occupancy[n], static_cast<float>(left));
    if (dense.occupancy[n] > 0.0f) continue;
    dense.hardness[n] = 0.0f;
    dense.labels[n] = 0;
  }
  return ShippedBone(dense);
}

struct Release {
  double first = 0.0, last = 0.0, least = 0.0, largest_rise = 0.0;  ///< [N] of the force out of bone
  double height = 0.0;                                              ///< [m] of the tool at the end
};

/// A spinning ball of 2 mm is pressed on a ring that it does not fit through, which is then opened by 2 um a tick until it does.
Release release(double push_out, double cutting_stiffness = ConstrainedToolConfig{}.cutting_stiffness) {
  const PointShell shell = ball_shell(kBallRadius, 200);
  ConstrainedToolConfig config;
  config.push_out = push_out;
  config.cutting_stiffness = cutting_stiffness;
  auto tool = ConstrainedTool::create(config, shell, kFine);
  REQUIRE(tool.ok());
  const Pose hand{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, -2e-3)};  // of the ball's middle
  tool->place({hand.rotation, Vec3(0.0, 0.0, 1.5e-3)});
  Release out;
  double before = 0.0;
  for (int tick = 0; tick < 260; ++tick) {
    const ShippedBone bone = ring_of(1.6e-3 + std::max(0, tick - 40) * 2e-6);
    const double force = tool->step(bone.view(), {hand, Vec3(0.0)}, kPeriod, {.spinning = true}).on_hand.force.z;
    if (tick == 40) out.first = force;
    if (tick > 40) out.largest_rise = std::max(out.largest_rise, force - before);
    out.least = std::min(out.least, force);
    before = out.last = force;
  }
  out.height = tool->state().world_from_tool.translation.z;
  return out;
}

}  // namespace

TEST_CASE("a spinning ball that comes through a ring: what holds it falls to nothing and never turns round") {
  const Release held = release(ConstrainedToolConfig{}.push_out), thrown = release(std::numeric_limits<double>::infinity(), 70e3);
  MESSAGE("held " << held.first << " N, least " << held.least << ", last " << held.last << ", largest rise " << held.largest_rise
                  << "; thrown: least " << thrown.least << " N");
  CHECK(held.first > 5.0);
  CHECK(held.least >= -ConstrainedToolConfig{}.push_out);  // what bone may push out with
  CHECK(std::abs(held.last) < 1e-6);
  CHECK(std::abs(held.height + 2e-3) < 1e-6);  // where the hand would have it
  CHECK(thrown.least <
        -4.0 * ConstrainedToolConfig{}.push_out);  // sabotage: engaged deeper and moved out as far as the surface, it is pulled through
}
