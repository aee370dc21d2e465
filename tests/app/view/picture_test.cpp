// What the engine asks of a display: the bit as it looks and is turned, where a scene cuts its pictures open, slices through the tip.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "app/view/texels.h"
#include "app/view/tip_slices.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

/// A display that keeps what it is given.
class KeepingSink final : public FrameSink {
 public:
  Status start(const VolumeView& given, const TriangleMesh& mesh) override {
    volume = given;
    tool = mesh;
    return {};
  }
  void update(const TexelBox&) override {}
  Status draw(const std::string& name, const FrameView& view, int, int, Hash64&) override {
    views[name] = view;
    return {};
  }
  VolumeView volume;
  TriangleMesh tool;
  std::map<std::string, FrameView> views;
};

struct Drawn {
  explicit Drawn(std::vector<std::string> sets) : run(SmallScene{.display = true, .sets = std::move(sets)}, options()) {}
  SimulationOptions options() {
    SimulationOptions out;
    out.sink = &sink;
    return out;
  }
  KeepingSink sink;
  DrillRun run;
};

/// Angle [rad] about its axis by which the tool is turned in a picture, from the approach, -pi..pi.
double turn_of(const FrameView& view) {
  const Vec3 x = view.world_from_tool->rotate(Vec3(1, 0, 0));
  return std::atan2(x.y, x.x);
}

}  // namespace

TEST_CASE("pictures: the bit with its flutes, turned by what the spindle has made at that moment, clockwise from above") {
  Drawn drawn({"duration_s=1.0", "tool.spin_rpm=615"});
  Simulation& simulation = drawn.run.simulation();
  CHECK(drawn.sink.tool.positions == drawn.run.loaded().tool.look.positions);
  CHECK(drawn.sink.tool.positions != drawn.run.loaded().tool.mesh.positions);
  drawn.run.run();
  REQUIRE(drawn.sink.views.count("before") == 1);
  CHECK(turn_of(drawn.sink.views["before"]) == doctest::Approx(0.0));
  // The tool is locked to its axis, so what turns it in the picture is the spindle: 10.25 turns in a second.
  CHECK(simulation.bone_step().turned() == doctest::Approx(0.25).epsilon(1e-6));
  simulation.frame_step()->gather(simulation.bone_step().turned());
  REQUIRE(simulation.frame_step()->draw("now", Pose{}, false).ok());
  CHECK(turn_of(drawn.sink.views["now"]) == doctest::Approx(-0.5 * std::numbers::pi).epsilon(1e-6));
  CHECK(drawn.sink.views["now"].world_from_tool->rotate(Vec3(0, 0, 1)).z == doctest::Approx(1.0));
}

TEST_CASE("pictures: a blade does not turn, nor what stands still beside a bit") {
  for (const auto& [name, turns] : {std::pair("sagittal_saw_12mm", false), {"craniotome_2_3mm", false}, {"round_burr_5mm", true}}) {
    Drawn drawn({std::string("tool.name=") + name, "duration_s=0.01"});
    CHECK(drawn.run.loaded().tool.turns == turns);
    drawn.run.simulation().frame_step()->gather(0.125);
    REQUIRE(drawn.run.simulation().frame_step()->draw("now", Pose{}, false).ok());
    CHECK(turn_of(drawn.sink.views["now"]) == doctest::Approx(turns ? -0.25 * std::numbers::pi : 0.0));
  }
}

TEST_CASE("pictures: a spindle that is not there turns nothing") {
  Drawn drawn({"duration_s=0.3", "tool.spin_rpm=0"});
  drawn.run.run();
  CHECK(drawn.run.simulation().bone_step().turned() == 0.0);
}

TEST_CASE("pictures: a scene's cut is at its plane, in the bone's frame") {
  const Pose world_from_bone{glm::angleAxis(0.7, Vec3(0.0, 0.0, 1.0)), Vec3(0.01, 0.02, 0.03)};
  const CutConfig cut{.kind = CutKind::plane, .point = {1e-3, 2e-3, 3e-3}, .normal = {0.0, -2.0, 0.0}};
  const auto made = make_scene_cut(cut, CameraView{}, world_from_bone, Vec3(9.0));
  REQUIRE(made);
  // Points of the plane are on it, a millimetre along the normal is cut away.
  for (const Vec3& p : {Vec3(1e-3, 2e-3, 3e-3), Vec3(-4e-3, 2e-3, 8e-3)})
    CHECK(std::abs(glm::dot(made->normal, world_from_bone * p) - made->offset) < 1e-12);
  CHECK(glm::dot(made->normal, world_from_bone * Vec3(0.0, 1e-3, 0.0)) - made->offset == doctest::Approx(1e-3));
  CHECK_FALSE(make_scene_cut({}, CameraView{}, world_from_bone, Vec3(0.0)));
}

TEST_CASE("pictures: a cut at the tip faces the camera and follows the tip; the axis cut of a run takes its place") {
  Drawn drawn({"display.cut=tip", "duration_s=0.01"});
  FrameStep& frame = *drawn.run.simulation().frame_step();
  const Vec3 tip(1e-3, -2e-3, -1e-3);
  REQUIRE(frame.draw("held", Pose{Quat(1, 0, 0, 0), tip}, false).ok());
  REQUIRE(frame.draw("gone", std::nullopt, false).ok());
  REQUIRE(frame.draw("open", std::nullopt, true).ok());
  for (const char* name : {"held", "gone"}) {
    const FrameView& view = drawn.sink.views[name];
    REQUIRE(view.cut);
    CHECK(std::abs(glm::dot(view.cut->normal, tip) - view.cut->offset) < 1e-12);
    CHECK(glm::dot(view.cut->normal, glm::normalize(view.camera.eye - view.camera.target)) == doctest::Approx(1.0));
  }
  CHECK(drawn.sink.views["open"].cut->normal.y == doctest::Approx(-1.0));
}

TEST_CASE("pictures: what a voxel was as loaded is sent where tissue is asked for, and nowhere else") {
  Drawn with({"duration_s=0.01"}), without({"duration_s=0.01", "display.tissue=plain"});
  CHECK(with.sink.volume.tissue.size() == with.sink.volume.color.size());
  CHECK(without.sink.volume.tissue.empty());
  // As loaded, the density is the occupancy.
  for (std::size_t n = 0; n < with.sink.volume.tissue.size(); ++n)
    REQUIRE(with.sink.volume.tissue[n].r == with.sink.volume.normal_opacity[n].a);
  const Drawn slices({"duration_s=0.01", "display.method=slices"});
  CHECK(slices.sink.volume.tissue.empty());
}

TEST_CASE("slices through the tip: a pixel is the density of its place, from voxel to voxel a straight line") {
  DrillRun run(SmallScene{.sets = {"duration_s=0.6"}});
  run.run();
  Voxmap& voxmap = run.simulation().voxmap();
  const Pose bone_from_tool{glm::angleAxis(0.2, Vec3(1.0, 0.0, 0.0)), Vec3(0.2e-3, -0.3e-3, -0.4e-3)};
  const int size = 30;
  const TipSlices slices = make_tip_slices(voxmap, run.loaded().tool.mesh, bone_from_tool, 2e-3, size);
  REQUIRE(voxmap.changed_bounds().count() > 0);
  const Affine index_from_bone = voxmap.bone().bone_from_index().inverse();
  // A slow twin: one voxel at a time, its place from the names of the patient's axes.
  const auto voxel = [&](const Vec3i& v) {
    float density = 0.0f, hardness = 0.0f;
    voxmap.read_density({v, v + 1}, std::span(&density, 1));
    voxmap.bone().read_hardness({v, v + 1}, std::span(&hardness, 1));
    return static_cast<double>(density) * static_cast<double>(hardness);
  };
  const std::map<char, Vec3> patient{{'L', {1, 0, 0}},  {'R', {-1, 0, 0}}, {'P', {0, 1, 0}},
                                     {'A', {0, -1, 0}}, {'S', {0, 0, 1}},  {'I', {0, 0, -1}}};
  int cut_pixels = 0;
  for (const TipSlice& slice : slices.planes) {
    const Vec3 right = patient.at(slice.right), down = patient.at(slice.bottom);
    CHECK(patient.at(slice.left) == -right);
    CHECK(patient.at(slice.top) == -down);
    for (int y = 0; y < size; y += 3)
      for (int x = 0; x < size; x += 2) {
        const double u = (x + 0.5) / size * 4e-3 - 2e-3, w = (y + 0.5) / size * 4e-3 - 2e-3;
        const Vec3 index = index_from_bone * (bone_from_tool.translation + u * right + w * down);
        const Vec3i low(glm::floor(index));
        const Vec3 f = index - Vec3(low);
        double sum = 0.0;
        for (int k = 0; k < 2; ++k)
          for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i)
              sum += (i != 0 ? f.x : 1 - f.x) * (j != 0 ? f.y : 1 - f.y) * (k != 0 ? f.z : 1 - f.z) * voxel(low + Vec3i(i, j, k));
        const int grey = slice.grey[static_cast<std::size_t>(y * size + x)];
        REQUIRE(std::abs(grey - 255.0 * sum) <= 0.51);  // rounding to a level
        cut_pixels += grey < 100 ? 1 : 0;
      }
  }
  CHECK(cut_pixels > 20);  // of the hole and of the air
}

TEST_CASE("slices through the tip: of two levels the first that holds a point is seen") {
  const auto filled = [](const Vec3i& lo, const Vec3i& hi, double edge, float value) {
    const VoxelBox box{lo, hi};
    return MineralBox{box, Affine{glm::dmat3(1.0 / edge), Vec3(0.0)}, std::vector<float>(box.count(), value)};
  };
  const std::vector<MineralBox> levels{filled(Vec3i(-4), Vec3i(5), 0.25e-3, 1.0f), filled(Vec3i(-3), Vec3i(4), 1e-3, 0.5f)};
  const TipSlices slices = make_tip_slices(levels, {}, {}, 4e-3, 64);
  for (const TipSlice& slice : slices.planes)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const double away = std::max(std::abs(x + 0.5 - 32.0), std::abs(y + 0.5 - 32.0)) * slices.pixel;
        const int expected = away <= 1e-3 ? 255 : away <= 3e-3 ? 128 : 0;
        REQUIRE(slice.grey[static_cast<std::size_t>(y * 64 + x)] == expected);
      }
}

TEST_CASE("slices through the tip: the tool's outline is where its surface crosses the plane") {
  DrillRun run(SmallScene{.sets = {"duration_s=0.01"}});
  const double radius = 1e-3;  // of the ball; its tip is its lowest point, so a plane half a millimetre up would cut a circle of 0.87 mm
  const Pose bone_from_tool{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, 0.5e-3)};
  const TipSlices slices = make_tip_slices(run.simulation().voxmap(), run.loaded().tool.mesh, bone_from_tool, 2e-3, 100);
  int crossed = 0;
  for (const TipSlice& slice : slices.planes) {
    if (slice.axis == 'z') continue;  // touches the tip in a point
    ++crossed;
    REQUIRE(slice.tool.size() > 20);
    for (const auto& stroke : slice.tool)
      for (const glm::dvec2& end : stroke) {
        const glm::dvec2 at = (end - 50.0) * slices.pixel;  // right and down from the tip
        // The mesh is a ball of flats: its chords lie up to r (1 - cos(pi / 64)) inside, and its slices stand on their corners.
        CHECK(std::abs(glm::length(at - glm::dvec2(0.0, -radius)) - radius) < 5e-6);
      }
  }
  CHECK(crossed == 2);
}

}  // namespace burrhole::test
