// A run on a bone that is kept in a temporary file, because of [limits] memory_mb: the same voxels, forces and records as in memory.

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <filesystem>

#include "app/run/inputs.h"
#include "app/scene/memory_plan.h"
#include "core/voxel/paged_bone.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// The scene with a limit that its run meets with the bone in a file alone.
LoadedScene load_paged(const SmallScene& scene) {
  const LoadedScene loaded = load_small(scene);
  const Vec3i dims = loaded.bone->dims();
  const BoneShape shape{dims, loaded.bone->bone_from_index(), PagedBone::index_bytes(dims, 1.0)};
  const auto limit = static_cast<double>(plan_memory(loaded.scene, loaded.tool, shape, dense_fields_bytes(dims)).peak) * 1e-6 + 0.001;
  LoadedScene out = load_text(scene_text(scene) + "[limits]\nmemory_mb = " + std::to_string(limit) + "\n", scene.sets);
  REQUIRE(out.bone->file_bytes().has_value());
  return out;
}

struct Outcome {
  std::uint64_t voxels, forces, sent;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};
Outcome outcome_of(DrillRun& run) { return {run.voxel_hash(), run.simulation().force_hash(), run.simulation().sent_hash()}; }

std::vector<Input> many_inputs() {
  const auto text = read_tool_text("pin", "small.toml", test_context());
  REQUIRE(text);
  return {{300, InputKind::checkpoint, 0.0, "a", {}},  {700, InputKind::spin, 0.0, {}, {}},      {720, InputKind::undo, 0.0, {}, {}},
          {740, InputKind::reset, 0.0, {}, {}},        {760, InputKind::spin, 1.0, {}, {}},      {1000, InputKind::tool, 0.0, "pin", *text},
          {1200, InputKind::checkpoint, 0.0, "b", {}}, {1300, InputKind::restore, 0.0, "a", {}}, {1400, InputKind::restore, 0.0, "b", {}}};
}

/// The open file of a paged bone, which has no name.
int descriptor_of_bone() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code ignored;
    const std::string target = std::filesystem::read_symlink(entry.path(), ignored).string();
    if (target.starts_with(temporary_folder()) && target.ends_with("(deleted)")) return std::stoi(entry.path().filename());
  }
  return -1;
}

TEST_CASE("paged run: with every contact model, and with undo, tool change, checkpoints and reset, the bits are those of a run in memory") {
  for (const char* volume : {kPlateKeys, kSkullPatchKeys})
    for (const bool penalty : {false, true})
      for (const bool inputs : {false, true}) {
        CAPTURE(volume);
        CAPTURE(penalty);
        CAPTURE(inputs);
        SmallScene scene{.volume = volume, .sets = {"duration_s=2.2"}};
        if (penalty) scene.contact_keys = kPenaltyKeys;
        SimulationOptions options;
        options.history = inputs;
        if (inputs) options.inputs = many_inputs();
        DrillRun memory(scene, options), paged(load_paged(scene), options);
        CHECK(outcome_of(memory.run()) == outcome_of(paged.run()));
        if (!inputs) CHECK(memory.voxel_hash() != DrillRun(scene).voxel_hash());
        if (inputs) CHECK(outcome_of(memory) != outcome_of(DrillRun(scene).run()));
        CHECK(paged.loaded().bone->read_status().ok());
      }
}

TEST_CASE("paged run: sabotage, damaged blocks in the file change the run") {
  const SmallScene scene{.sets = {"duration_s=1.0"}};
  DrillRun memory(scene);
  LoadedScene loaded = load_paged(scene);
  const int file = descriptor_of_bone();
  REQUIRE(file >= 0);
  const std::vector<float> soft_bone(*loaded.bone->file_bytes() / sizeof(float), 0.25f);
  REQUIRE(pwrite(file, soft_bone.data(), soft_bone.size() * sizeof(float), 0) > 0);
  DrillRun paged(std::move(loaded));
  CHECK(memory.run().simulation().force_hash() != paged.run().simulation().force_hash());
}

TEST_CASE("paged run: a file that cannot be read any more ends the run with an error, in lockstep and live") {
  for (const bool live : {false, true}) {
    CAPTURE(live);
    LoadedScene loaded = load_paged({.sets = {"duration_s=2.5", "hand.push_N=2"}});
    SimulationOptions options;
    options.live = live;
    Issues issues;
    auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
    REQUIRE(simulation);
    REQUIRE(ftruncate(descriptor_of_bone(), 0) == 0);
    std::vector<float> values(loaded.bone->bounds().count());
    loaded.bone->read_occupancy(loaded.bone->bounds(), values);
    const Status ran = simulation->run();
    REQUIRE(!ran.ok());
    CHECK(ran.error().code == ErrorCode::unavailable);
    CHECK(ran.error().message.find("cannot be read") != std::string::npos);
    CHECK(simulation->time() < 1.0);  // at the first tick, or after the soft stop of the force
    Issues again;
    CHECK(!Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, again));
    REQUIRE(again.size() == 1);
    CHECK(again.front().message.find("cannot be read") != std::string::npos);
  }
}

}  // namespace
}  // namespace burrhole::test
