/// tests/support/drilled_post.h: a post that is drilled at a fixed feed by a flat bit wider than it, for tests of heat and saline: heat flows along
///   the axis alone.   Units  SI.   Errors  fail the test.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/stage/stage.h"
#include "app/view/added_mesh.h"
#include "core/measure/approach.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {

inline constexpr double kPostFeed = 0.15e-3;  // [m/s] about that of a burrhole of 7 mm in 45 s

/// @param heat text of more tables. @param volume keys of the bone.
inline LoadedScene drilled_post(const std::string& heat, const std::vector<std::string>& sets = {}, const char* volume = kPostKeys) {
  std::string text = scene_text({.volume = volume, .contact = false});
  const std::string hand = "push_N = 20.0\nramp_s = 0.1\nstandoff_mm = 0.5\ntremor_mm = 0.0\n";
  const std::size_t at = text.find(hand);
  REQUIRE(at != std::string::npos);
  text.replace(at, hand.size(), "kind = \"feed\"\nstandoff_mm = 0.01\nstop_mm = 3\nfeed_mm_per_s = 0.15\n");
  std::vector<std::string> all{"tool.name=\"punch\"", "tool.erosion_scale=1000", "duration_s=20.0"};
  all.insert(all.end(), sets.begin(), sets.end());
  return load_text(text + heat, all);
}

/// The scene's own feed, with an eye on every servo tick.
class WatchedFeed final : public HandSource {
 public:
  /// `watch` is called before the hand moves.
  WatchedFeed(const LoadedScene& loaded, std::function<void()> watch) : watch_(std::move(watch)) {
    const Scene& scene = loaded.scene;
    const auto approach = make_approach(*loaded.bone, scene.approach);
    REQUIRE(approach);
    auto hand = make_hand(scene, scene.effects.needs(scene), loaded.tool, loaded.bone->bone_from_index().mean_edge(),
                          scene.volume.world_from_bone * approach->bone_from_approach, nullptr);
    REQUIRE(hand);
    hand_ = std::move(hand).value();
  }
  [[nodiscard]] const HandState& read() noexcept override { return hand_->read(); }
  void apply(const Wrench& on_hand) noexcept override {
    watch_();
    hand_->apply(on_hand);
  }

 private:
  std::unique_ptr<HandSource> hand_;
  std::function<void()> watch_;
};

/// @returns a number that a step of the simulation's clock records; one that is not there fails the test.
inline const double* column_of(DrillRun& run, const std::string& name) {
  for (const StepColumn& column : run.simulation().stage().graph.columns(Clock::simulation))
    if (column.name == name) return column.value;
  FAIL(name);
  return nullptr;
}

/// Bone that is left [m^3].
inline double bone_left(DrillRun& run) {
  const Vec3i dims = run.loaded().bone->dims();
  std::vector<float> density(VoxelBox{Vec3i(0), dims}.count());
  run.simulation().voxmap().read_density({Vec3i(0), dims}, density);
  double sum = 0.0;
  for (const float value : density) sum += static_cast<double>(value);
  return sum * run.voxel() * run.voxel() * run.voxel();
}

/// @returns what the effects of a run show in pictures; null: nothing.
inline PictureSource* picture_of(DrillRun& run) {
  PictureSource* out = nullptr;
  for (const Stage::MadeEffect& made : run.simulation().stage().effects())
    if (PictureSource* source = made.effect->picture_source()) out = source;
  return out;
}
/// @returns the triangles that they show now.
inline AddedMesh mesh_of(DrillRun& run) {
  PictureSource* source = picture_of(run);
  REQUIRE(source != nullptr);
  (void)source->copy_for_picture(true);
  AddedMesh mesh;
  source->append_mesh(mesh);
  return mesh;
}
/// @returns the area of triangles [m^2].
inline double area_of(const AddedMesh& mesh) {
  double out = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    out += 0.5 * static_cast<double>(glm::length(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a])));
  return out;
}

}  // namespace burrhole::test
