// A large bone in two levels: where the part lies, what its texels are near its faces, and that changes arrive at both levels.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/view/frame_step.h"
#include "tests/support/drill_scene.h"
#include "tests/support/plain_trilinear.h"

namespace burrhole::test {
namespace {

/// A display that applies what it is sent, as a texture does.
class ApplyingSink final : public FrameSink {
 public:
  Status start(const VolumeView& given, const TriangleMesh&) override {
    volume = given;
    if (given.detail) detail = *given.detail;
    return {};
  }
  void update(const TexelBox& texels) override {
    VolumeView& target = texels.of_detail ? detail.volume : volume;
    const VoxelBox all{Vec3i(0), target.dims};
    REQUIRE(all.contains(texels.box));
    std::size_t n = 0;
    for_each_voxel(texels.box, [&](const Vec3i& v) {
      target.normal_opacity[all.offset_of(v)] = texels.normal_opacity[n];
      target.field[all.offset_of(v)] = texels.field[n++];
    });
  }
  Status move_detail(const DetailView& given) override {
    detail = given;
    ++moves;
    return {};
  }
  Status draw(const std::string&, const FrameView&, int, int, Hash64&) override { return {}; }

  VolumeView volume;
  DetailView detail;
  int moves = 0;
};

struct Drawn {
  explicit Drawn(std::vector<std::string> sets)
      : run(SmallScene{.volume = kSkullPatchKeys, .display = true, .sets = std::move(sets)}, options()) {}
  SimulationOptions options() {
    SimulationOptions out;
    out.sink = &sink;
    return out;
  }
  ApplyingSink sink;
  DrillRun run;
};

// 33 x 33 x 33 voxels; coarse voxels of two, a part whose faces cross the hole.
const std::vector<std::string> kTwoLevels{"display.whole_voxels=6000", "display.detail_mm=6.6", "duration_s=1.5", "hand.push_N=40"};

TexelBox texels_as_loaded(const BoneModel& bone, const VoxelBox& box) {
  TexelSource source;
  source.box = box;
  source.density.resize(box.grown(1).count());
  bone.read_occupancy(box.grown(1), source.density);
  return make_texels(bone, 0.0f, source);
}

bool near_equal(const Rgba8& a, const Rgba8& b, int most) {
  const auto off = [](int x, int y) { return std::abs(x - y); };
  return std::max({off(a.r, b.r), off(a.g, b.g), off(a.b, b.b), off(a.a, b.a)}) <= most;
}

}  // namespace

TEST_CASE("detail: the smallest coarse voxel with which the bone is within the limit") {
  CHECK(coarse_factor({100, 100, 100}, 1'000'000) == 1);
  CHECK(coarse_factor({101, 100, 100}, 1'000'000) == 2);
  CHECK(coarse_factor({960, 960, 860}, 32'000'000) == 3);
  CHECK(coarse_factor({2048, 2048, 2048}, 32'000'000) == 7);
}

TEST_CASE("detail: lies inside the bone, on coarse voxels, around its centre where there is room") {
  for (const Vec3& centre : {Vec3(100, 90, 80), Vec3(0, 0, 0), Vec3(199, 180, 150), Vec3(-50, 500, 70)})
    for (const int factor : {2, 3, 4}) {
      const Vec3i dims(200, 181, 151);
      const DetailGrid grid = place_detail(dims, factor, centre, Vec3(60));
      CHECK(VoxelBox{Vec3i(0), dims}.contains(grid.box));
      CHECK(grid.box.lo % factor == Vec3i(0));
      CHECK((grid.box.hi - 1) % factor == Vec3i(0));
      CHECK(glm::all(glm::greaterThanEqual(grid.box.size(), Vec3i(60))));
      CHECK(glm::all(glm::lessThanEqual(grid.box.size(), Vec3i(60 + factor))));
      if (centre == Vec3(100, 90, 80)) {
        const Vec3 middle = 0.5 * Vec3(grid.box.lo + grid.box.hi - 1);
        CHECK(glm::length(middle - centre) <= std::sqrt(3.0) * factor);
      }
    }
  // A bone thinner than the part.
  CHECK(place_detail({200, 200, 20}, 3, Vec3(100, 100, 10), Vec3(60)).box.size().z == 19);
}

TEST_CASE("detail: a small bone is drawn at its own voxels alone") {
  Drawn drawn({"duration_s=0.01"});
  CHECK(drawn.sink.volume.detail == nullptr);
  CHECK(drawn.sink.volume.dims == drawn.run.loaded().bone->dims());
}

TEST_CASE("detail: slices and translucent bone have no detail") {
  for (const char* method : {"display.method=slices", "display.shading=translucent"}) {
    Drawn drawn({"display.whole_voxels=6000", method, "duration_s=0.01"});
    CHECK(drawn.sink.volume.detail == nullptr);
    CHECK(drawn.sink.volume.dims == CoarseBone::dims_of(drawn.run.loaded().bone->dims(), 2));
  }
}

TEST_CASE("detail: at its faces its texels are the coarse ones interpolated, in the middle its own") {
  Drawn drawn({"display.whole_voxels=6000", "display.detail_mm=7.2", "duration_s=0.01"});
  const VolumeView &whole = drawn.sink.volume, &part = drawn.sink.detail.volume;
  const DetailGrid& grid = drawn.sink.detail.grid;
  REQUIRE(grid.factor == 2);
  const TexelBox own = make_texels(drawn.run.simulation().voxmap(), grid.box);
  const VoxelBox all{Vec3i(0), whole.dims};
  int outer = 0, middle = 0, differ = 0;
  for_each_voxel(grid.box, [&](const Vec3i& v) {
    const std::size_t n = grid.box.offset_of(v);
    const auto coarse = [&](auto channel) {
      return plain_trilinear(glm::min(Vec3(v) / 2.0, Vec3(whole.dims - 1) - 1e-9),
                             [&](const Vec3i& c) { return channel(all.offset_of(c)); });
    };
    if (grid.own_share(v) == 0.0) {
      ++outer;
      const Rgba8& t = part.normal_opacity[n];
      REQUIRE(std::abs(coarse([&](std::size_t c) { return whole.normal_opacity[c].r; }) - t.r) <= 0.51);
      REQUIRE(std::abs(coarse([&](std::size_t c) { return whole.normal_opacity[c].a; }) - t.a) <= 0.51);
      REQUIRE(std::abs(coarse([&](std::size_t c) { return whole.field[c]; }) - part.field[n]) <= 0.51);
      REQUIRE(std::abs(coarse([&](std::size_t c) { return whole.color[c].g; }) - part.color[n].g) <= 0.51);
      REQUIRE(std::abs(coarse([&](std::size_t c) { return whole.tissue[c].g; }) - part.tissue[n].g) <= 0.51);
      differ += near_equal(t, own.normal_opacity[n], 8) ? 0 : 1;
    } else if (grid.own_share(v) == 1.0) {
      ++middle;
      REQUIRE(part.normal_opacity[n] == own.normal_opacity[n]);
      REQUIRE(part.field[n] == own.field[n]);
    }
  });
  CHECK(outer > 1000);
  CHECK(middle > 100);
  CHECK(differ > 100);  // without the blend they would be others
}

TEST_CASE("detail: after drilling both levels hold what a new display would be sent") {
  // The part is small, so that the cut is near its faces; at the end of the bone it cannot move.
  Drawn drawn(kTwoLevels);
  drawn.run.run();
  Simulation& simulation = drawn.run.simulation();
  simulation.frame_step()->gather_rest();
  REQUIRE(simulation.frame_step()->draw("now", std::nullopt, false).ok());
  REQUIRE(drawn.sink.volume.detail != nullptr);
  const auto coarse = CoarseBone::create(simulation.voxmap().bone(), drawn.sink.detail.grid.factor);
  REQUIRE(coarse);
  const VolumeView whole = make_volume_view(coarse->drawn(simulation.voxmap()), coarse->loaded().bounds(), true);
  const DetailGrid grid = drawn.sink.detail.grid;
  const DetailView part = make_detail_view(grid, *coarse, simulation.voxmap(), true);
  CHECK(drawn.sink.volume.normal_opacity == whole.normal_opacity);
  CHECK(drawn.sink.volume.field == whole.field);
  CHECK(drawn.sink.detail.volume.normal_opacity == part.volume.normal_opacity);
  CHECK(drawn.sink.detail.volume.field == part.volume.field);
  // The hole is there, and it reaches voxels that are blended.
  int changed = 0, blended = 0;
  const TexelBox loaded = texels_as_loaded(simulation.voxmap().bone(), grid.box);
  for_each_voxel(grid.box, [&](const Vec3i& v) {
    const std::size_t n = grid.box.offset_of(v);
    if (std::abs(loaded.field[n] - part.volume.field[n]) < 20'000) return;
    ++changed;
    blended += grid.own_share(v) < 1.0 ? 1 : 0;
  });
  CHECK(changed > 200);
  CHECK(blended > 100);
}

TEST_CASE("detail: follows the cut, and then holds what a new display would be sent") {
  constexpr const char* kWide = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [20.0, 20.0, 6.0]
above_mm = 1.5
thickness_mm = 3.0
)";
  ApplyingSink sink;
  SimulationOptions options;
  options.sink = &sink;
  DrillRun run(
      SmallScene{.volume = kWide, .display = true, .sets = {"display.whole_voxels=30000", "display.detail_mm=8", "duration_s=0.01"}},
      options);
  Simulation& simulation = run.simulation();
  REQUIRE(sink.volume.detail != nullptr);
  const DetailGrid start = sink.detail.grid;
  const auto draw = [&] {
    simulation.frame_step()->gather_rest();
    REQUIRE(simulation.frame_step()->draw("now", std::nullopt, false).ok());
  };
  // Bone is removed by hand: first inside the detail, then 6 mm beside it.
  const auto remove = [&](const VoxelBox& box) {
    Voxmap& voxmap = simulation.voxmap();
    REQUIRE(voxmap.place_window(box.grown(20)).ok());
    for_each_voxel(box, [&](const Vec3i& v) { voxmap.remaining()[voxmap.window().box.offset_of(v)] = 0.0f; });
    voxmap.commit(box);
  };
  const Vec3i centre = (start.box.lo + start.box.hi - 1) / 2;
  remove({centre - 1, centre + 2});
  draw();
  CHECK(sink.moves == 0);
  remove({centre + Vec3i(24, 0, 0), centre + Vec3i(27, 3, 3)});
  draw();
  CHECK(sink.moves == 1);
  CHECK(sink.detail.grid.box.lo.x > start.box.lo.x + 15);
  const auto coarse = CoarseBone::create(simulation.voxmap().bone(), start.factor);
  REQUIRE(coarse);
  const DetailView part = make_detail_view(sink.detail.grid, *coarse, simulation.voxmap(), true);
  CHECK(sink.detail.volume.field == part.volume.field);
  CHECK(sink.detail.volume.normal_opacity == part.volume.normal_opacity);
}

}  // namespace burrhole::test
