// constrained_tool against the closed forms of the phantoms: what bone holds, what it lets in, and that nothing passes through; on records
// made from the closed form, and on those that a run makes from the voxels.
#include "core/contact/constrained_tool.h"

#include "stroke_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

struct Outcome {
  double deepest = 0.0;  ///< [voxel] of any shell point under the true surface, over all ticks
  double felt = 0.0;     ///< [voxel] the same under the 0.5 level of the voxels, where records are made of them
  bool crossed = false;  ///< the ball's centre went through bone between two ticks
};

/// Moves the hand along the stroke by `voxels` a tick; `step(hand)` gives the tool's pose.
template <class Step>
Outcome run(const Bench& bench, const Stroke& stroke, double voxels, Step&& step) {
  const Truth& truth = bench.phantom.truth;
  Outcome out;
  const double speed = voxels * kFine / kPeriod;
  Vec3 before = stroke.from + Vec3(0.0, 0.0, kBallRadius);
  const int moving = static_cast<int>(std::ceil(stroke.length / (voxels * kFine)));
  for (int tick = 0; tick <= moving + 10; ++tick) {
    const bool moves = tick < moving;
    const double gone = std::min(stroke.length, tick * voxels * kFine);
    HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), stroke.from + stroke.along * gone}, moves ? stroke.along * speed : Vec3(0.0)};
    const Pose pose = step(hand);
    const Vec3 centre = pose * Vec3(0.0, 0.0, kBallRadius), way = centre - before;
    // A centre that never meets bone, in or between ticks, has stayed on its side: the path is followed, not only its end.
    if (glm::length(way) > 0.0)
      if (const auto entry = truth.entry_distance(before, way)) out.crossed = out.crossed || *entry < glm::length(way);
    before = centre;
    out.deepest = std::max(out.deepest, deepest_of(bench.shell, pose, truth));
    if (bench.shipped_bone) out.felt = std::max(out.felt, felt_deepest_of(bench.shell, pose, *bench.shipped_bone));
  }
  return out;
}

/// Whether nothing entered bone and nothing came out on the far side.
bool held(const Bench& bench, const Outcome& outcome) {
  return outcome.deepest <= bench.stroke.allowed && outcome.felt <= kHeld && !outcome.crossed;
}

Bench plate_bench() {
  Stroke press{"plate", fine_spec(PhantomKind::plate)};
  press.spec.thickness = 0.004;
  return Bench(press);
}

ConstrainedToolConfig soft_cutting() {
  ConstrainedToolConfig out;
  out.cutting_stiffness = 50e3;
  return out;
}

}  // namespace

TEST_CASE("constrained tool: at spin 0 up to 40 N leave it on the plate and the force balances the push") {
  for (const Records records : kBoth)
    for (const Vec3& up : {Vec3(0.0, 0.0, 1.0), Vec3(0.3, 0.2, 1.0)}) {
      CAPTURE(name_of(records));
      Stroke press{"plate", fine_spec(PhantomKind::plate)};
      press.spec.thickness = 0.004;
      press.spec.plate_normal = up;
      const Bench bench(press, records);
      const Vec3 normal = glm::normalize(up);
      ConstrainedTool tool = bench.tool();
      for (const double force : {1.0, 8.0, 20.0, 40.0}) {
        CAPTURE(force);
        const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), -normal * (force / kConfig.coupling_stiffness)}, Vec3(0.0)};
        for (int tick = 0; tick < 60; ++tick) {
          const ConstrainedToolState& state = tool.step(bench.view(), hand, kPeriod);
          CHECK(deepest_of(bench.shell, state.world_from_tool, bench.phantom.truth) < 0.1);  // what the project promises
        }
        const ConstrainedToolState& state = tool.state();
        // What the hand feels is the coupling's stretch, normal to the plate; it rests within 0.01 voxel, which is 0.0125 N of stretch.
        const Vec3 stretch = kConfig.coupling_stiffness * (state.world_from_tool.translation - hand.world_from_hand.translation);
        CHECK(glm::length(state.on_hand.force - stretch) <= 0.0125);
        CHECK(std::abs(glm::dot(state.on_hand.force, normal) - glm::dot(stretch, normal)) <= 0.0125);
        CHECK(state.engagement == 0.0);
      }
    }
}

TEST_CASE("constrained tool: spinning, it engages by F / K_cut where it cuts") {
  const Bench bench = plate_bench();
  const ConstrainedToolConfig config = soft_cutting();
  ConstrainedTool tool = bench.tool(config);
  for (const double push : {5.0, 20.0}) {
    CAPTURE(push);
    const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, -push / config.coupling_stiffness)}, Vec3(0.0)};
    for (int tick = 0; tick < 60; ++tick) (void)tool.step(bench.view(), hand, kPeriod, {.spinning = true});
    const ConstrainedToolState& state = tool.state();
    const double force = glm::length(state.on_hand.force);
    REQUIRE(force > 0.8 * push);
    CHECK(std::abs(state.engagement - force / config.cutting_stiffness) <= 0.01 * state.engagement);
    // The tip is that deep in the true bone: planes are found to 0.002 voxel and the tool rests within 0.01 voxel of balance.
    CHECK(std::abs(-state.world_from_tool.translation.z - state.engagement) <= 0.02 * kFine);
  }
}

TEST_CASE("constrained tool: stopped where it engaged, it stays there until it is lifted") {
  const Bench bench = plate_bench();
  const ConstrainedToolConfig config = soft_cutting();
  ConstrainedTool tool = bench.tool(config);
  constexpr double kPush = 20.0;
  const HandMotion pressed{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, -kPush / config.coupling_stiffness)}, Vec3(0.0)};
  const HandMotion lifted{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, 1e-3)}, Vec3(0.0)};
  const auto step = [&](const HandMotion& hand, bool spinning, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) (void)tool.step(bench.view(), hand, kPeriod, {.spinning = spinning});
    return tool.state().world_from_tool.translation.z;
  };
  // A pose is settled to 0.05 voxel; the sum of two.
  constexpr double kSettled = 0.1 * kFine;
  const double engaged = step(pressed, true, 60);
  REQUIRE(engaged < -5.0 * kSettled);
  CHECK(std::abs(step(pressed, false, 60) - engaged) <= kSettled);
  // Spin that comes and goes does not dig where nothing is removed.
  for (int n = 0; n < 50; ++n) {
    CHECK(std::abs(step(pressed, true, 1 + n % 7) - engaged) <= kSettled);
    CHECK(std::abs(step(pressed, false, 1 + n % 3) - engaged) <= kSettled);
  }
  CHECK(step(lifted, false, 60) > 0.9e-3);
  CHECK(tool.state().on_hand.force == Vec3(0.0));
  CHECK(std::abs(step(pressed, false, 60)) <= kSettled);  // on the plate, as if it had never spun
}

TEST_CASE("constrained tool: a tool that cannot cut does not engage even when it spins") {
  Stroke press{"plate", fine_spec(PhantomKind::plate)};
  press.spec.thickness = 0.004;
  Bench bench(press);
  bench.shell.cutting.assign(bench.shell.size(), 0);
  ConstrainedTool tool = bench.tool();
  const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, -4e-3)}, Vec3(0.0)};
  for (int tick = 0; tick < 60; ++tick) (void)tool.step(bench.view(), hand, kPeriod, {.spinning = true});
  CHECK(tool.state().engagement == 0.0);
  CHECK(tool.state().world_from_tool.translation.z > -0.1 * kFine);
}

TEST_CASE("constrained tool: strokes of 0.5 to 10 voxels a tick do not pass a 1.7 mm wall, whatever its shape") {
  for (const Stroke& stroke : every_stroke()) {
    CAPTURE(stroke.name);
    for (const Records records : kBoth) {
      CAPTURE(name_of(records));
      const Bench bench(stroke, records);
      for (const double voxels : {0.5, 1.0, 2.0, 5.0, 10.0}) {
        CAPTURE(voxels);
        ConstrainedTool tool = bench.tool();
        const SurfaceView view = bench.view();
        const Outcome outcome =
            run(bench, stroke, voxels, [&](const HandMotion& hand) { return tool.step(view, hand, kPeriod).world_from_tool; });
        CAPTURE(outcome.deepest);
        CAPTURE(outcome.felt);
        CAPTURE(outcome.crossed);
        CHECK(held(bench, outcome));
      }
    }
  }
}

TEST_CASE("constrained tool: strokes from any side at any speed do not pass either") {
  constexpr std::uint64_t kSeed = 77;
  MESSAGE("seed " << kSeed);
  for (Stroke shape : every_stroke()) {
    if (shape.name == "slot") continue;  // no way in from aside
    CAPTURE(shape.name);
    shape.spec.extent = Vec3(0.024, 0.024, 0.016);  // bone wherever the tool slides to: 2 + 6 + 2 mm
    for (const Records records : kBoth) {
      CAPTURE(name_of(records));
      const Bench bench(shape, records);
      const SurfaceView view = bench.view();
      for (std::uint64_t n = 0; n < 20; ++n) {
        CAPTURE(n);
        Stroke stroke = shape;
        // Within 50 degrees of straight down, from 1 mm up; the tip starts within 2 mm of the axis.
        stroke.along = glm::normalize(Vec3(1.2, 1.2, 0.0) * random_vector(kSeed, n) - Vec3(0.0, 0.0, 1.0));
        stroke.from = Vec3(2e-3, 2e-3, 0.0) * random_vector(kSeed + 1, n) + Vec3(0.0, 0.0, 2e-3);
        if (deepest_of(bench.shell, {Quat(1.0, 0.0, 0.0, 0.0), stroke.from}, bench.phantom.truth) > -1.0) continue;  // not in air
        stroke.length = 8e-3;
        ConstrainedTool tool = bench.tool();
        tool.place({Quat(1.0, 0.0, 0.0, 0.0), stroke.from});
        const Outcome outcome = run(bench, stroke, 0.5 + 9.5 * uniform01(kSeed + 2, n),
                                    [&](const HandMotion& hand) { return tool.step(view, hand, kPeriod).world_from_tool; });
        CAPTURE(outcome.deepest);
        CAPTURE(outcome.felt);
        CAPTURE(outcome.crossed);
        CHECK(held(bench, outcome));
      }
    }
  }
}

TEST_CASE("constrained tool: a flat bit pressed with 40 N stays out while it is tilted by 10 degrees and back") {
  Stroke press{"plate", fine_spec(PhantomKind::plate)};
  press.spec.thickness = 0.004;
  press.spec.extent = Vec3(0.022, 0.022, 0.020);
  press.spec.above = 0.015;
  for (const Records records : kBoth) {
    CAPTURE(name_of(records));
    const Bench bench(press, records, "acosta_liu_perforator");
    ConstrainedTool tool = bench.tool();
    const SurfaceView view = bench.view();
    for (int tick = 0; tick < 200; ++tick) {
      const double part = tick < 100 ? tick / 100.0 : 2.0 - tick / 100.0;
      const HandMotion hand{{turn_about_x(10.0 * kDegree * part), Vec3(0.0, 0.0, -8e-3)}, Vec3(0.0)};
      const ConstrainedToolState& state = tool.step(view, hand, kPeriod);
      CAPTURE(tick);
      CHECK(deepest_of(bench.shell, state.world_from_tool, bench.phantom.truth) < 0.1);
    }
  }
}

TEST_CASE("constrained tool: engagement at spin 0 would fail the same check (sabotage)") {
  const Bench bench(every_stroke().front());
  ConstrainedToolConfig config;
  config.cutting_stiffness = 50e3;
  ConstrainedTool tool = bench.tool(config);
  const SurfaceView view = bench.view();
  const Outcome outcome = run(bench, bench.stroke, 1.0, [&](const HandMotion& hand) {
    return tool.step(view, hand, kPeriod, {.spinning = true}).world_from_tool;  // a tool that takes itself to spin
  });
  CHECK_FALSE(held(bench, outcome));
}

TEST_CASE("constrained tool: records of a corner a sixth of a voxel further in would fail the check of the felt surface (sabotage)") {
  for (const Stroke& stroke : every_stroke()) {
    if (stroke.name != "corner") continue;
    const Bench bench(stroke, Records::shipped);
    Stroke less = stroke;
    less.spec.block_size -= kFine / 6.0 * Vec3(2.0, 2.0, 0.0);  // both sides of either axis
    const Bench further_in(less, Records::shipped);
    for (const bool sabotaged : {false, true}) {
      CAPTURE(sabotaged);
      ConstrainedTool tool = bench.tool();
      const SurfaceView view = sabotaged ? further_in.view() : bench.view();
      const Outcome outcome =
          run(bench, stroke, 1.0, [&](const HandMotion& hand) { return tool.step(view, hand, kPeriod).world_from_tool; });
      CAPTURE(outcome.felt);
      CHECK((outcome.felt <= kHeld) == !sabotaged);
      CHECK(outcome.deepest <= stroke.allowed);  // the check against the true shape alone would let it pass
    }
  }
}

TEST_CASE("constrained tool: jumping to the target instead of sweeping there would fail the same check (sabotage)") {
  const Bench bench(every_stroke().front());
  const SurfaceView view = bench.view();
  ConstrainedTool tool = bench.tool();
  const Outcome outcome = run(bench, bench.stroke, 10.0, [&](const HandMotion& hand) {
    tool.place(hand.world_from_hand);
    return tool.step(view, hand, kPeriod).world_from_tool;
  });
  CHECK_FALSE(held(bench, outcome));
}

TEST_CASE("constrained tool: in free space it follows the hand without force") {
  const Bench bench(every_stroke().front());
  ConstrainedTool tool = bench.tool();
  for (int tick = 0; tick < 200; ++tick) {
    const double t = tick * kPeriod;
    const Vec3 velocity(0.005, -0.003, 0.004);
    const Pose hand{turn_about_x(0.2 * t), bench.stroke.from + velocity * t};
    const ConstrainedToolState& state = tool.step(bench.view(), {hand, velocity}, kPeriod, {.spinning = tick % 2 == 0});
    CHECK(state.on_hand.force == Vec3(0.0));
    CHECK(state.on_hand.torque == Vec3(0.0));
    CHECK(state.engagement == 0.0);
    // The damper is dragged along from the sudden start and lets go by B/dt / (K + B/dt) = 2/3 a tick: (2/3)^30 = 5e-6 of 5 um.
    if (tick >= 30) CHECK(glm::length(state.world_from_tool.translation - hand.translation) <= 1e-4 * kFine);
    // The turn of a period is found and made again: rounding alone, 1e-16 a tick.
    CHECK(std::abs(std::abs(glm::dot(state.world_from_tool.rotation, hand.rotation)) - 1.0) < 1e-12);
  }
}

TEST_CASE(
    "constrained tool: motion that is not finite gives no force, cuts nothing and loses no pose; the next that is finite is answered") {
  const Bench bench(every_stroke().front());
  const SurfaceView view = bench.view();
  ConstrainedTool tool = bench.tool();
  HandMotion pressed{{glm::identity<Quat>(), bench.stroke.from}, Vec3(0.0)};
  const auto press = [&] {
    for (int tick = 0; tick < 400; ++tick) {
      if (tool.state().on_hand.force.z < 5.0) pressed.world_from_hand.translation.z -= 0.02e-3;
      (void)tool.step(view, pressed, kPeriod, {.spinning = true});
    }
    return tool.state();
  };
  const ConstrainedToolState before = press();
  REQUIRE(before.cutting_force > 1.0);
  REQUIRE(before.engagement > 0.0);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (int part = 0; part < 3; ++part) {
      HandMotion broken = pressed;
      if (part == 0) broken.world_from_hand.translation.x = bad;
      if (part == 1) broken.world_from_hand.rotation.y = bad;
      if (part == 2) broken.velocity.z = bad;
      const ConstrainedToolState state = tool.step(view, broken, kPeriod, {.spinning = true});
      CHECK(state.flags == kContactNotFinite);
      CHECK(state.on_hand.force == Vec3(0.0));
      CHECK(state.on_hand.torque == Vec3(0.0));
      CHECK(state.cutting_force == 0.0);
      CHECK(state.engagement == 0.0);
      CHECK(state.world_from_tool.translation == before.world_from_tool.translation);
    }
  // The same press again: the tool was where it had been.
  (void)tool.step(view, pressed, kPeriod, {.spinning = true});
  CHECK(std::abs(tool.state().on_hand.force.z / before.on_hand.force.z - 1.0) < 0.01);
}

TEST_CASE("constrained tool: a step cut short by its bound on moves says so, and one that comes to rest does not") {
  const Bench bench(every_stroke().front());
  const SurfaceView view = bench.view();
  for (const int moves : {1, 40}) {
    auto tool = ConstrainedTool::create({.max_moves = moves}, bench.shell, kFine);
    REQUIRE(tool.ok());
    tool.value().place({glm::identity<Quat>(), bench.stroke.from});
    // Half a millimetre into bone in one step: several looks' worth.
    const HandMotion hand{{glm::identity<Quat>(), bench.stroke.from + Vec3(0.0, 0.0, -8e-3)}, Vec3(0.0)};
    CHECK((tool.value().step(view, hand, kPeriod).flags & kContactUnsettled) == (moves == 1 ? kContactUnsettled : 0u));
  }
}

TEST_CASE("constrained tool: create refuses stiffnesses and limits it could not use") {
  const PointShell shell = shell_of({Vec3(0.0)});
  const auto refused = [&](ConstrainedToolConfig config) { return !ConstrainedTool::create(config, shell, kFine).ok(); };
  CHECK_FALSE(refused({}));
  CHECK(refused({.coupling_stiffness = 0.0}));
  CHECK(refused({.coupling_damping = -1.0}));
  CHECK(refused({.turn_stiffness = 0.0}));
  CHECK(refused({.cutting_stiffness = -1.0}));
  CHECK(refused({.coupling_damping = std::numeric_limits<double>::infinity()}));
  CHECK(refused({.bone_stiffness = std::nan("")}));
  CHECK(refused({.max_moves = 0}));
  CHECK_FALSE(ConstrainedTool::create({}, PointShell{}, kFine).ok());
  CHECK_FALSE(ConstrainedTool::create({}, shell, std::nan("")).ok());
  PointShell short_of_normals = shell, short_of_edges = shell;
  short_of_normals.inward_normals.clear();
  short_of_edges.cutting.clear();
  CHECK_FALSE(ConstrainedTool::create({}, short_of_normals, kFine).ok());
  CHECK_FALSE(ConstrainedTool::create({}, short_of_edges, kFine).ok());
}
