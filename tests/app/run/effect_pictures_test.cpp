// What effects add to pictures, in whole runs: a replay shows the triangles that the run showed, whenever the run was copied from, live on threads
// too; after an undo, a reset and a restored checkpoint they are those of the bone as it is.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/view/heat_mesh.h"
#include "app/view/saline_mesh.h"
#include "app/view/tissue_texels.h"
#include "core/base/bounds.h"
#include "core/heat/bone_cells.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A display that keeps the triangles of each picture and hashes them in place of pixels.
class MeshSink final : public FrameSink {
 public:
  Status start(const VolumeView&, const TriangleMesh&) override { return {}; }
  void update(const TexelBox&) override {}
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override {
    now_ = mesh;
    ++sent;
    return {};
  }
  Status draw(const std::string& name, const FrameView&, int, int, Hash64& hash) override {
    names.push_back(name);
    shown.push_back(now_ != nullptr ? *now_ : AddedMesh{});
    for (const glm::vec3& p : shown.back().vertices)
      for (int axis = 0; axis < 3; ++axis) hash.add(std::uint64_t{std::bit_cast<std::uint32_t>(p[axis])});
    for (const Rgba8& c : shown.back().colors)
      hash.add(std::uint64_t{c.r} | std::uint64_t{c.g} << 8 | std::uint64_t{c.b} << 16 | std::uint64_t{c.a} << 24);
    for (const std::uint8_t share : shown.back().unlit) hash.add(std::uint64_t{share});
    return {};
  }
  Status film(const FrameView&, int, int) override {
    ++frames;
    return {};
  }
  std::vector<std::string> names;
  std::vector<AddedMesh> shown;
  int sent = 0, frames = 0;

 private:
  std::shared_ptr<const AddedMesh> now_;
};

constexpr double kReach = 2e-3;  // [m] of saline
constexpr const char* kHeatAndSaline =
    "\n[heat]\n[heat.picture]\nlowest_C = 38\n[irrigation]\ndrawn = true\nreach_mm = 2\nflow_ml_per_min = 0.05\n";

LoadedScene scene_with(const std::string& effects, const char* seconds) {
  const SmallScene scene{.volume = kSkullPatchKeys,
                         .record = true,
                         .display = true,
                         .sets = {seconds, "tool.erosion_scale=4", "hand.standoff_mm=0.3", "erosion.rate_hz=500"}};
  return load_text(scene_text(scene) + effects, scene.sets);
}

/// Compares the pictures of a recorded run with those of its replay. After 0.6 of the time the drill stands: what is left changes by less from
/// frame to frame than is seen. @param seconds of the run. @param film_hz [Hz] of the run; it copies at each frame.
/// @returns the most triangles of a picture; the caller demands some, of which the pictures must differ.
std::size_t check_replayed(const std::string& effects, bool live, double film_hz, double seconds = 1.5) {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  MeshSink recorded, replayed;
  const std::string duration = "duration_s=" + std::to_string(seconds);
  const auto stop = static_cast<std::uint64_t>(600.0 * seconds);  // [ticks]
  DrillRun run(scene_with(effects, duration.c_str()),
               {.sink = &recorded, .live = live, .inputs = {{stop, InputKind::spin, 0.0, {}, {}}}, .film_hz = film_hz});
  run_recorded(run, path);
  CHECK((recorded.frames > 0) == (film_hz > 0.0));
  ReplayRun replay(path, {.sink = &replayed});
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  const std::vector<SessionStill>&before = session->stills(), &again = replay.run().simulation().redrawn();
  REQUIRE(before.size() >= 3);
  REQUIRE(again.size() == before.size());
  REQUIRE(replayed.names == recorded.names);
  std::size_t most = 0;
  for (std::size_t n = 0; n < before.size(); ++n) {
    CAPTURE(recorded.names[n]);
    CHECK(again[n].hash == before[n].hash);
    const AddedMesh& mesh = recorded.shown[n];
    CHECK(replayed.shown[n].vertices == mesh.vertices);
    CHECK(replayed.shown[n].colors == mesh.colors);
    CHECK(replayed.shown[n].triangles == mesh.triangles);
    CHECK(mesh.colors.size() == mesh.vertices.size());
    CHECK(mesh.unlit.size() <= mesh.vertices.size());
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) REQUIRE(corner < mesh.vertices.size());
    most = std::max(most, mesh.triangles.size());
  }
  CHECK((most <= 100 || std::ranges::any_of(before, [&](const SessionStill& still) { return still.hash != before.front().hash; })));
  return most;
}

template <class Picture>
Picture& picture_of(DrillRun& run) {
  Picture* out = nullptr;
  for (const Stage::MadeEffect& made : run.simulation().stage().effects())
    if (auto* picture = dynamic_cast<Picture*>(made.effect->picture_source())) out = picture;
  REQUIRE(out != nullptr);
  return *out;
}

AddedMesh mesh_of(PictureSource& picture) {
  (void)picture.copy_for_picture(true);
  AddedMesh out;
  picture.append_mesh(out);
  return out;
}

/// @returns the share of what a copy of heat has of the bone that differs from the bone read anew: densities, and shares of cells.
double wrong_share(DrillRun& run, const HeatCopy& shown) {
  if (shown.cells.empty()) return 0.0;
  const Voxmap& bone = run.simulation().voxmap();
  std::vector<float> density(shown.voxels.count());
  bone.read_density(shown.voxels, density);
  DensityBytes fresh(shown.voxels);
  fresh.set(shown.voxels, density);
  std::vector<std::uint8_t> bytes;
  fresh.copy(shown.voxels, bytes);
  const BoneCells cells(2);
  const VoxelBox all = cells.voxels_of(shown.cells);
  density.resize(all.count());
  bone.read_density(all, density);
  std::vector<float> share(shown.cells.count());
  cells.mean(shown.cells, density, share);
  double wrong = 0.0;
  for (std::size_t n = 0; n < bytes.size(); ++n) wrong += bytes[n] != shown.density[n] ? 1.0 : 0.0;
  for (std::size_t n = 0; n < share.size(); ++n)
    wrong += shown.share[n] != (share[n] >= HeatField::kLeastShare ? share[n] : 0.0f) ? 1.0 : 0.0;
  return wrong / static_cast<double>(bytes.size() + share.size());
}

/// What is wet now, of the bone read anew, within reach of the drilled line.
AddedMesh whole_saline(DrillRun& run) {
  Stage& stage = run.simulation().stage();
  const BoneModel& bone = stage.voxmap->bone();
  const Affine& frame = bone.bone_from_index();
  const BoneShape shape{.dims = bone.dims(), .bone_from_index = frame, .thickness = stage.approach.thickness};
  const DrillingWay way = drilling_way(stage.config, shape);
  const Vec3 from = frame * way.index_from_tool.offset, to = frame * (way.index_from_tool.offset + way.along);
  const Bounds near = bounds_under(frame.inverse(), {glm::min(from, to) - kReach, glm::max(from, to) + kReach});
  const VoxelBox voxels = VoxelBox{floor_int(near.lo), floor_int(near.hi) + 2}.intersect(bone.bounds());
  SalinePicture picture(voxels, make_colors(bone, voxels), frame);
  std::vector<float> density(voxels.count());
  stage.voxmap->read_density(voxels, density);
  picture.set_bone(voxels, density);
  const Cut* cut = stage.graph.find(slots::kCut);
  REQUIRE(cut != nullptr);
  const Affine bone_from_tool = frame * cut->path.to;
  picture.set_film(
      {.tip = bone_from_tool.offset, .up = glm::normalize(bone_from_tool.linear[2]), .reach = kReach, .below = frame.mean_edge()});
  return mesh_of(picture);
}

}  // namespace

TEST_CASE("effect pictures: a replay of heat and saline shows what each still of the run showed") {
  CHECK(check_replayed(kHeatAndSaline, false, 0.0) > 100);
}

// Fails where a still is copied as a frame of a film is, without what cannot be seen.
TEST_CASE("effect pictures: a run that was filmed shows in its stills what a replay without a film shows, of every effect") {
  CHECK(check_replayed(std::string(kHeatAndSaline) + "always = true\n", false, 500.0) > 100);
  CHECK(check_replayed("\n[dust]\n[bleeding]\n[dura]\nradius_mm = 3\nspacing_mm = 0.5\n", false, 500.0) > 100);
}

TEST_CASE("effect pictures: a run on threads with heat and saline replays to the triangles of each still") {
  std::size_t most = 0;  // a machine under load may drill nothing in a short run: then a longer one
  for (double seconds = 1.5; most <= 100 && seconds < 50.0; seconds *= 3.0) most = check_replayed(kHeatAndSaline, true, 0.0, seconds);
  CHECK(most > 100);
}

TEST_CASE(
    "effect pictures: through undo, reset and restore in a run heat lies on the bone as it is, and what is wet is that of a whole new "
    "picture") {
  const auto input = [](std::uint64_t tick, InputKind kind, double value = 0.0) { return Input{tick, kind, value, "half", {}}; };
  DrillRun* running = nullptr;
  std::vector<std::uint64_t> bones;
  std::optional<HeatCopy> last;
  int wet = 0, hot = 0, stale = 0;
  SimulationOptions options;
  options.history = true;
  options.inputs = {input(600, InputKind::spin, 0.0),  input(650, InputKind::undo),        input(700, InputKind::spin, 1.0),
                    input(1200, InputKind::spin, 0.0), input(1250, InputKind::checkpoint), input(1300, InputKind::spin, 1.0),
                    input(1700, InputKind::reset),     input(1950, InputKind::restore)};
  options.progress = [&](double time, const DrillProgress&) {
    CAPTURE(time);
    bones.push_back(running->voxel_hash());
    auto& heat = picture_of<HeatPicture>(*running);
    (void)heat.copy_for_picture(true);
    CHECK(wrong_share(*running, heat.shown()) == 0.0);
    hot += heat.shown().cells.empty() ? 0 : 1;
    if (last && bones.back() != bones[bones.size() - 2]) stale += wrong_share(*running, *last) > 0.0 ? 1 : 0;
    last = heat.shown();
    const AddedMesh shown = mesh_of(picture_of<SalinePicture>(*running)), whole = whole_saline(*running);
    CHECK(shown.vertices == whole.vertices);
    CHECK(shown.colors == whole.colors);
    CHECK(shown.triangles == whole.triangles);
    wet += shown.triangles.empty() ? 0 : 1;
  };
  DrillRun run(scene_with(std::string(kHeatAndSaline) + "always = true\n", "duration_s=2.2"), options);
  running = &run;
  run.run();
  REQUIRE(bones.size() >= 21);
  // Once the bone is that of the start again, by the undo and by the reset, and once that of the checkpoint.
  const auto bone_at = [&](int tenths) { return bones[static_cast<std::size_t>(tenths - 1)]; };
  CHECK(bone_at(7) != bone_at(6));
  CHECK(bone_at(18) != bone_at(17));
  CHECK(bone_at(20) != bone_at(19));
  CHECK(wet > 15);
  CHECK(hot > 10);
  CHECK(stale > 3);  // the sabotage: a copy of 0.1 s before is noticed
}
