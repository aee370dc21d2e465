// A run that is put away half way and taken up again: the bone is the same to the bit, and drilling goes on through it.

#include <doctest/doctest.h>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

TEST_CASE("checkpoint: a saved bone comes back to the bit, raises the growth epoch, and is drilled on to breakthrough") {
  const TemporaryFolder folder;
  const std::vector<std::string> sets{"tool.erosion_scale=2", "hand.reaction_ms=20"};
  SmallScene half{.sets = sets};
  half.sets.push_back("duration_s=0.7");
  DrillRun first(half);
  first.run();
  const double depth = first.simulation().progress().depth;
  REQUIRE(first.simulation().voxmap().save(folder.file("bone.vdb")));

  SimulationOptions options;
  options.restore_path = folder.file("bone.vdb");
  DrillRun second(SmallScene{.sets = sets}, options);
  DrillRun fresh(SmallScene{.sets = sets});
  CHECK(second.voxel_hash() == first.voxel_hash());
  CHECK(second.voxel_hash() != fresh.voxel_hash());
  CHECK(second.simulation().voxmap().growth_epoch() == fresh.simulation().voxmap().growth_epoch() + 1);

  // The bone is felt where the first run left it: the tip goes down the hole before it meets anything.
  fresh.run();
  const DrillProgress& went_on = second.run().simulation().progress();
  const DrillProgress& whole = fresh.simulation().progress();
  REQUIRE(went_on.breakthrough_time.has_value());
  REQUIRE(whole.breakthrough_time.has_value());
  MESSAGE("put away at " << depth * 1e3 << " mm; breakthrough after another " << *went_on.breakthrough_time << " s, in one go "
                         << *whole.breakthrough_time << " s");
  CHECK(*went_on.breakthrough_time < *whole.breakthrough_time);
  CHECK(first_contact(second.simulation()) > first_contact(fresh.simulation()) + 0.05);
}

TEST_CASE("checkpoint: a file of the changes alone restores the same bone, and is no source") {
  const TemporaryFolder folder;
  DrillRun first(SmallScene{.sets = {"duration_s=0.7"}});
  first.run();
  REQUIRE(first.simulation().voxmap().save(folder.file("whole.vdb"), SavedBone::whole));
  REQUIRE(first.simulation().voxmap().save(folder.file("changes.vdb"), SavedBone::changes));
  SimulationOptions options;
  options.restore_path = folder.file("changes.vdb");
  DrillRun second(SmallScene{}, options);
  CHECK(second.voxel_hash() == first.voxel_hash());
  CHECK(second.voxel_hash() != DrillRun(SmallScene{}).voxel_hash());
  CHECK(BoneModel::load(folder.file("whole.vdb")).ok());
  CHECK_FALSE(BoneModel::load(folder.file("changes.vdb")).ok());
}

TEST_CASE("checkpoint: that of another bone, or of one at another place, is refused with its name") {
  for (const auto& [key, why] :
       {std::pair("volume.extent_mm=[5,5,6]", "the dimensions differ"), std::pair("volume.above_mm=1.75", "it lies at another place")}) {
    const TemporaryFolder folder;
    DrillRun other(SmallScene{.sets = {key}});
    REQUIRE(other.simulation().voxmap().save(folder.file("other.vdb")));
    const LoadedScene loaded = load_small({});
    SimulationOptions options;
    options.restore_path = folder.file("other.vdb");
    Issues issues;
    CHECK(Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues) == nullptr);
    REQUIRE(issues.size() == 1);
    CHECK(issues.front().text() == folder.file("other.vdb") + ": was saved from another bone: " + why);
  }
}

}  // namespace
}  // namespace burrhole::test
