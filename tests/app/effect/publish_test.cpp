// Bone is published in the form that something reads: window copies for a contact model, the paper's grids, or the approach axis alone. A
// scene without contact publishes no copy. And each duration is charged to one effect.

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/trilinear.h"
#include "core/contact/contact_view.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

/// Every sample of the axis, as the bone is now, read from the whole bone: the slow twin of AxisBone.
std::vector<std::uint8_t> axis_now(Simulation& simulation) {
  const Vec3i dims = simulation.voxmap().bone().dims();
  const VoxelBox all{Vec3i(0), dims};
  std::vector<float> density(all.count());
  simulation.voxmap().read_density(all, density);
  std::vector<std::uint8_t> out;
  for (const Vec3& index : simulation.approach().axis_index)
    out.push_back(trilinear(all, density.data(), index) < static_cast<double>(kSurfaceLevel) ? 0 : 1);
  return out;
}

/// What must hold of a run without contact, whatever its schedule.
void check_axis_only(Simulation& simulation) {
  BoneStep& bone = simulation.bone_step();
  CHECK(bone.window_copies() == 0);
  CHECK(bone.publisher() == nullptr);
  CHECK(bone.grids() == nullptr);
  REQUIRE(bone.axis() != nullptr);
  CHECK(simulation.timing("publish").count == 0);
  CHECK(simulation.timing("planes").count == 0);
  CHECK(bone.removed_mass() > 0.0);
  // Published when the window moved or bone was removed, which is not in every step.
  CHECK(bone.published() > 10);
  CHECK(simulation.timing("axis").count > 0);
  CHECK(static_cast<std::uint64_t>(simulation.timing("axis").count) < bone.published());  // and once at the start
  const AxisSamples& axis = bone.axis()->exchange().latest();
  CHECK(axis.number == bone.published());
  CHECK(axis.bone == axis_now(simulation));
}

TEST_CASE("publish: without contact no window copy is published, in lockstep") {
  DrillRun run(SmallScene{.contact = false, .sets = {"duration_s=1.5"}});
  check_axis_only(run.run().simulation());
  // The script walks through the plate of 3 mm at 5 mm/s and erodes what it passes.
  CHECK(run.simulation().progress().passed_time.has_value());
}

TEST_CASE("publish: without contact no window copy is published, live") {
  SimulationOptions options;
  options.live = true;
  DrillRun run(SmallScene{.contact = false, .sets = {"duration_s=1.2"}}, options);
  check_axis_only(run.run().simulation());
}

TEST_CASE("publish: a contact model has its copies, and the paper's storage has grids and no copy") {
  for (const bool live : {false, true}) {
    SimulationOptions options;
    options.live = live;
    DrillRun run(SmallScene{.sets = {"duration_s=0.5"}}, options);
    BoneStep& bone = run.run().simulation().bone_step();
    CHECK(bone.window_copies() > 0);
    CHECK(bone.window_copies() == bone.published());
    CHECK(bone.axis() == nullptr);
  }
  DrillRun paper(SmallScene{.contact_keys = std::string(kPenaltyKeys) + "storage = \"vdb\"\n", .sets = {"duration_s=0.5"}});
  BoneStep& bone = paper.run().simulation().bone_step();
  CHECK(bone.window_copies() == 0);
  CHECK(bone.grids() != nullptr);
  CHECK(bone.published() > 0);
}

TEST_CASE("publish: a copy has triangles of the surface for the mesh model, and for no other") {
  for (const char* keys : {kHeldKeys, kPenaltyKeys, "model = \"voxmap\"\n", "model = \"mesh\"\n"}) {
    CAPTURE(keys);
    DrillRun run(SmallScene{.contact_keys = keys, .sets = {"duration_s=0.1"}});
    BoneStep& bone = run.run().simulation().bone_step();
    REQUIRE(bone.publisher() != nullptr);
    const TrianglePatch& patch = bone.publisher()->exchange().latest().triangles;
    const bool mesh = std::string(keys).find("mesh") != std::string::npos;
    CHECK((patch.blocks.size() > 0) == mesh);
    CHECK((patch.bytes() > 0) == mesh);
    CHECK((bone.publisher()->fields().triangles != nullptr) == mesh);
  }
}

TEST_CASE("publish: drilling that is not felt is monitored as through a copy of the window") {
  // The same hand and erosion; a penalty model of almost no stiffness leaves the tool where the hand is, as no model does.
  const std::vector<std::string> sets{"duration_s=1.5", "hand.feels=false"};
  DrillRun axis(SmallScene{.contact = false, .sets = sets});
  DrillRun copies(SmallScene{.contact_keys = "model = \"voxmap\"\nstiffness_N_per_m = 1e-6\n", .sets = sets});
  const DrillProgress a = axis.run().simulation().progress(), c = copies.run().simulation().progress();
  REQUIRE(copies.simulation().bone_step().window_copies() > 0);
  REQUIRE(axis.voxel_hash() == copies.voxel_hash());
  CHECK(a.passed_time == c.passed_time);
  CHECK(a.removed_at_passing == c.removed_at_passing);
  CHECK(a.breakthrough_time == c.breakthrough_time);
  CHECK(a.front == c.front);
}

/// An effect that reads bone on the contact clock without saying so in its plan.
class Peek final : public Effect {
 public:
  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::contact, "peek", "peek", [](void*, const Tick&) {}, this);
    (void)step.now(slots::kTouch);
    return {};
  }
};
class PeekPlan final : public ConfigPlan<PeekPlan, int> {
 public:
  PlanRow row(const PlanContext&) const override { return {.table = "peek", .step = "", .needs = "", .gives = "", .detail = ""}; }
  Result<std::unique_ptr<Effect>> make(Stage&) const override { return std::unique_ptr<Effect>(std::make_unique<Peek>()); }
};

TEST_CASE("publish: an effect that reads a copy of bone which nothing requires is refused") {
  LoadedScene loaded = load_small({.contact = false});
  loaded.scene.effects.add("peek", std::make_unique<PeekPlan>());
  Issues issues;
  CHECK(Simulation::create(loaded.scene, loaded.bone, loaded.tool, {}, issues) == nullptr);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().message.find("\"touch\"") != std::string::npos);
}

TEST_CASE("times: the local planes are charged to contact and not to the hand, publishing to its own row") {
  DrillRun run(SmallScene{.sets = {"duration_s=0.5"}});
  const std::vector<TimedStep> steps = run.run().simulation().timings();
  CHECK(run.simulation().timing("planes").count == 500);  // a servo tick each
  CHECK(run.simulation().timing("publish").count > 0);
  double all = 0.0, charged = 0.0;
  for (const TimedStep& step : steps) all += step.within_step || !step.part_of.empty() ? 0.0 : step.timing.total_us;
  for (const char* table : {"hand", "contact", "erosion", "publish"}) charged += charged_us(steps, table);
  CHECK(charged == doctest::Approx(all).epsilon(1e-9));  // the sum of the steps, each once
  const auto timed = [&](const char* name) { return run.simulation().timing(name).total_us; };
  CHECK(charged_us(steps, "contact") == doctest::Approx(timed("contact") + timed("planes")).epsilon(1e-9));
  CHECK(charged_us(steps, "hand") == doctest::Approx(timed("servo") - timed("planes")).epsilon(1e-9));
  CHECK(charged_us(steps, "publish") == timed("publish"));
}

}  // namespace
}  // namespace burrhole::test
