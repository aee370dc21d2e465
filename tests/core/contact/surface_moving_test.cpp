// The model `surface` as shipped where frames move: bone that is turned and carried while it is felt, and tools whose origin is far away.
#include "stroke_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kPush = 2e-3;  ///< [m] of the hand beyond the surface: 10 N

/// Whether the ball's way, seen from the bone, ever met it, and how deep a shell point came [voxel].
struct Ride {
  double deepest = 0.0, carried = 0.0;  ///< [voxel], [m]
  bool crossed = false;
};

/// Bone moves by 1 mm along `way` and turns by 1 degree each tick, its outer face always towards the tool; the hand stays.
Ride ride(const Bench& bench, const Vec3& way, const std::function<Pose(ConstrainedTool&, const SurfaceView&, const HandMotion&)>& step) {
  ConstrainedTool tool = bench.tool();
  SurfaceView view = bench.view();
  const HandMotion hand{{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, -kPush)}, Vec3(0.0)};
  for (int tick = 0; tick < 60; ++tick) (void)tool.step(view, hand, kPeriod);
  Ride out;
  const Vec3 centre(0.0, 0.0, kBallRadius);
  Vec3 before = view.world_from_bone.inverse() * (tool.state().world_from_tool * centre);
  const Vec3 start = tool.state().world_from_tool.translation;
  for (int tick = 1; tick <= 20; ++tick) {
    view.world_from_bone = {turn_about_x(tick * kDegree), way * (tick * 1e-3)};
    const Pose in_bone = view.world_from_bone.inverse() * step(tool, view, hand);
    const Vec3 now = in_bone * centre, moved = now - before;
    if (glm::length(moved) > 0.0)
      if (const auto entry = bench.phantom.truth.entry_distance(before, moved)) out.crossed = out.crossed || *entry < glm::length(moved);
    before = now;
    out.deepest = std::max(out.deepest, deepest_of(bench.shell, in_bone, bench.phantom.truth));
  }
  out.carried = glm::length(tool.state().world_from_tool.translation - start);
  return out;
}

Stroke wide_plate() {
  Stroke press{"plate", fine_spec(PhantomKind::plate)};
  press.spec.extent = Vec3(0.024, 0.024, 0.012);
  return press;
}

}  // namespace

TEST_CASE("surface: bone that moves by 1 mm and 1 degree a tick carries the tool along and is never passed") {
  const auto step = [](ConstrainedTool& tool, const SurfaceView& view, const HandMotion& hand) {
    return tool.step(view, hand, kPeriod).world_from_tool;
  };
  for (const Records records : kBoth) {
    CAPTURE(name_of(records));
    const Bench bench(wide_plate(), records);
    for (const Vec3& way : {Vec3(0.0, 0.0, 1.0), Vec3(0.3, 0.0, 1.0), Vec3(0.0, 0.0, 0.0)}) {
      const Ride went = ride(bench, way, step);
      CAPTURE(went.deepest);
      CHECK(went.deepest <= 0.1);
      CHECK_FALSE(went.crossed);
      if (way.z > 0.0) CHECK(went.carried > 15e-3);  // of 20 mm; it turns and slides on the way
    }
  }
  // Sabotage: a tool that each tick forgets where bone was, and so takes what it finds itself in for where it came to rest.
  const Bench bench(wide_plate(), Records::shipped);
  const Ride forgot = ride(bench, Vec3(0.0, 0.0, 1.0), [](ConstrainedTool& tool, const SurfaceView& view, const HandMotion& hand) {
    tool.place(tool.state().world_from_tool);
    return tool.step(view, hand, kPeriod).world_from_tool;
  });
  CAPTURE(forgot.deepest);
  CHECK((forgot.deepest > 0.1 || forgot.crossed));
}

TEST_CASE("surface: the force is the same with the tool's origin, or the whole scene, 10 m away") {
  const Vec3 far(10.0, -3.0, 7.0);
  PhantomSpec spec = fine_spec(PhantomKind::plate);
  spec.thickness = 0.004;
  spec.plate_normal = Vec3(0.3, 0.2, 1.0);
  const Phantom phantom = phantom_of(spec);
  const ShippedBone bone(phantom), bone_away(phantom, {turn_about_x(0.0), far});
  ConstrainedToolConfig config = kConfig;
  config.turn_stiffness = std::numeric_limits<double>::infinity();  // a spring 10 m from what it holds would be another spring
  PointShell shell = shipped_shell("acosta_liu_round"), shell_away = shell;
  for (Vec3& p : shell_away.positions) p += far;
  const auto force_of = [&](const PointShell& points, const SurfaceView& view, const Vec3& origin) {
    auto tool = ConstrainedTool::create(config, points, kFine);
    REQUIRE(tool.ok());
    tool->place({Quat(1.0, 0.0, 0.0, 0.0), origin + Vec3(0.0, 0.0, 1e-3)});
    for (int tick = 0; tick < 80; ++tick)
      (void)tool->step(view, {{Quat(1.0, 0.0, 0.0, 0.0), origin - Vec3(0.0, 0.0, kPush)}, Vec3(0.0)}, kPeriod);
    return tool->state().on_hand.force;
  };
  const Vec3 here = force_of(shell, bone.view(), Vec3(0.0));
  REQUIRE(glm::length(here) > 5.0);
  const double allowed = 1e-6 * glm::length(here);
  CHECK(glm::length(force_of(shell_away, bone.view(), -far) - here) <= allowed);
  CHECK(glm::length(force_of(shell, bone_away.view(), far) - here) <= allowed);
  // Sabotage: points of single precision at 10 m, 1e-6 m off, are told.
  for (Vec3& p : shell_away.positions) p = Vec3(Vec3f(p));
  CHECK(glm::length(force_of(shell_away, bone.view(), -far) - here) > allowed);
}
