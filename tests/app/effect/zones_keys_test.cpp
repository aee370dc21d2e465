// [zones] in a scene: what reach_mm limits, the reported distance and the memory, and when warn_mm warns, by stated amounts.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "app/job/plan.h"
#include "app/stage/zone_state.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kEdge = 0.25, kThickness = 5.0, kStandoff = 0.5;  // [mm] of a voxel; of the patch; of the hand

/// From 0.4 mm above the outer surface, 5.4 mm above the dura, down at 4 mm/s. Without [contact] the tool is where the hand is.
class FallingHand final : public HandSource {
 public:
  const HandState& read() noexcept override {
    state_.world_from_hand.translation = Vec3(0.0, 0.0, 0.4e-3 - 4e-6 * static_cast<double>(tick_));
    state_.tick = tick_++;
    return state_;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  HandState state_;
  std::uint64_t tick_ = 0;
};

LoadedScene scene_of(double reach, double warn = 1.0) {
  const SmallScene scene{.volume = kSkullPatchKeys, .contact = false, .erosion = false};
  return load_text(scene_text(scene) + fmt::format("[zones]\nreach_mm = {}\nwarn_mm = {}\n", reach, warn), {"duration_s=1.3"});
}

struct Fall {
  std::vector<double> distance;  // [m] of each tick
  double closest = 0.0;          // [mm]
};
Fall fall(double reach) {
  const TemporaryFolder folder;
  FallingHand hand;
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(scene_of(reach), options);
  run_recorded(run, folder.file("fall.bhs"));
  return {session_column(folder.file("fall.bhs"), kZoneDistanceColumn), figure(run.simulation(), "zones", "closest_dura_mm")};
}

const PlanRow& row_of(const Plan& plan) {
  const auto row = std::ranges::find(plan.rows, std::string("zones"), &PlanRow::table);
  REQUIRE(row != plan.rows.end());
  return *row;
}

}  // namespace

TEST_CASE("zones: the distance is reported up to reach_mm, and beyond it reach_mm") {
  // In a cell, of which a corner lies beyond the reach, the value is between the two. A cell's corners differ by up to sqrt(3) voxels. The field has floats, of
  // up to 12 mm: 1e-9 m.
  constexpr double kRounding = 1e-9;
  const Fall far = fall(12.0);
  CHECK(*std::ranges::max_element(far.distance) > 5.0e-3);
  for (const double reach : {2.0, 3.0, 4.5}) {
    CAPTURE(reach);
    const Fall near = fall(reach);
    REQUIRE(near.distance.size() == far.distance.size());
    const double cell = std::sqrt(3.0) * kEdge * 1e-3, limit = reach * 1e-3;
    int beyond = 0, within = 0;
    for (std::size_t n = 0; n < far.distance.size(); ++n) {
      if (far.distance[n] > limit + cell) {
        ++beyond;
        CHECK(std::abs(near.distance[n] - limit) < kRounding);
      } else if (far.distance[n] < limit - cell) {
        ++within;
        CHECK(std::abs(near.distance[n] - far.distance[n]) < kRounding);
      }
    }
    CHECK(beyond > 50);
    CHECK(within > 300);
    CHECK(std::abs(near.closest - far.closest) < kRounding * 1e3);
  }
}

TEST_CASE("zones: it warns from warn_mm on") {
  // The tool comes nearer by 4 um a tick, so a millimetre is 0.25 s of warning, to a tick at each end. Along the axis the distance is linear between voxels.
  const auto near_for = [](double warn) {
    FallingHand hand;
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(scene_of(12.0, warn), options);
    run.run();
    CHECK(figure(run.simulation(), "zones", "warnings") == 1.0);
    return figure(run.simulation(), "zones", "near_s");
  };
  const double base = near_for(1.0);
  for (const double warn : {0.7, 2.0, 4.0}) {
    CAPTURE(warn);
    CHECK(std::abs(near_for(warn) - base - 0.25 * (warn - 1.0)) < 2.1e-3);
  }
}

TEST_CASE("zones: the field has the voxels within reach_mm of the drilled line, of 4 bytes each") {
  // The line goes from the standoff through the patch. Across it there are 2 r / h + 2 voxels, along it L / h more, L its length: both ends are on voxels or
  // between them, and cells are whole.
  const auto voxels = [](double reach) {
    const double across = 2.0 * reach / kEdge + 2.0, along = across + (kStandoff + kThickness) / kEdge;
    return across * across * along;
  };
  double before = 0.0, bytes = 0.0;
  for (const double reach : {2.0, 4.0, 10.0, 11.0}) {
    CAPTURE(reach);
    const Plan plan = make_plan(scene_of(reach));
    const PlanRow& row = row_of(plan);
    CHECK_MESSAGE(row.detail.find(fmt::format(", {:.0f} voxels", voxels(reach))) != std::string::npos, row.detail);
    if (before > 0.0) CHECK(static_cast<double>(row.bytes) - bytes == 4.0 * (voxels(reach) - before));
    before = voxels(reach);
    bytes = static_cast<double>(row.bytes);
  }
}

}  // namespace burrhole::test
