// The shipped burrhole with a clutch in its perforator: the outcome of whole runs, with each failure and with hands of other reaction times.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "app/job/summary.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

struct Run {
  RunSummary summary;
  DrillResult result = DrillResult::stopped_short;
  double releases = 0.0, torque = 0.0;  // torque [N m] after the release
};

/// @param clutch false: without [clutch], whether the shipped scene has it or not.
Run drill(bool clutch, std::vector<std::string> sets) {
  if (clutch) sets.emplace_back("clutch.engage_N=12");
  LoadedScene loaded = load_parietal(sets);
  if (!clutch) (void)loaded.scene.effects.remove("clutch");
  DrillRun run(std::move(loaded));
  run.run();
  Run out{make_summary(run.loaded(), run.simulation(), make_plan(run.loaded()), 1.0), {}};
  out.result = outcome_of(out.summary).result;
  const Stage& stage = run.simulation().stage();
  out.releases = stage.figure("clutch", "releases").value_or(0.0);
  out.torque = stage.figure("clutch", "torque_after_release_Nm").value_or(0.0);
  std::string keys;
  for (const std::string& set : sets) keys += set + " ";
  MESSAGE(keys << ": " << out.summary.plunge_mm.value_or(-1.0) << " mm of plunge, " << out.summary.beyond_mm.value_or(-1.0)
               << " mm beyond the bone, cleared " << out.summary.cleared_share.value_or(-1.0) << ", reached " << out.summary.reached_mm
               << " mm; " << out.releases << " releases, took " << stage.figure("clutch", "release_took_ms").value_or(-1.0) << " ms, "
               << out.summary.duration_s << " s; voxels " << out.summary.voxel_hash << " forces " << out.summary.force_hash);
  return out;
}

}  // namespace

TEST_CASE(
    "clutch: the shipped burrhole is drilled through with and without, and with it the bit comes less far beyond the bone, however slow "
    "the hand") {
  const Run without = drill(false, {}), with = drill(true, {}), slow = drill(true, {"hand.reaction_ms=400"});
  const Run without_slow = drill(false, {"hand.reaction_ms=400"}), late = drill(true, {"clutch.release_delay_s=0.3"});
  for (const Run* run : {&without, &with, &slow, &without_slow, &late}) CHECK(run->result == DrillResult::drilled_through);
  CHECK(with.releases == 1.0);
  CHECK(with.torque == 0.0);
  CHECK(*with.summary.beyond_mm < *without.summary.beyond_mm);
  CHECK(*late.summary.beyond_mm > *with.summary.beyond_mm);
  // Without a clutch the drill feeds while the hand reacts. With one it stands, and only the hand's springs move it.
  CHECK(*without_slow.summary.beyond_mm > *without.summary.beyond_mm);
  CHECK(std::abs(*slow.summary.beyond_mm - *with.summary.beyond_mm) < 0.05);
}

}  // namespace burrhole::test
