// A head phantom in pictures: the head around the bone, changes of the bone in it, a cloth over it, an overview and a table.
#include <doctest/doctest.h>

#include <cmath>

#include "app/view/drape.h"
#include "app/view/frame_step.h"
#include "app/view/tissue_texels.h"
#include "tests/support/drill_scene.h"
#include "volumes/phantom/head_shape.h"

namespace burrhole::test {
namespace {

constexpr const char* kHeadKeys = R"(source = "phantom:head"
spacing_mm = 0.5
surroundings_mm = 2.0
region_mm = [28.0, 28.0, 26.0]
thickness_mm = 5.0
)";
// The top of the head.
const std::vector<std::string> kOnTop{"approach.entry_mm=[0, -9, 113.2]", "approach.axis=[0, 0, -1]", "duration_s=2", "hand.push_N=40"};

/// A display that applies what it is sent, and keeps what was drawn.
class KeepingSink final : public FrameSink {
 public:
  Status start(const VolumeView& given, const TriangleMesh&) override {
    first = volume = given;
    if (given.detail) detail = *given.detail;
    return {};
  }
  void update(const TexelBox& texels) override {
    VolumeView& target = texels.of_detail ? detail.volume : volume;
    const VoxelBox all{Vec3i(0), target.dims};
    std::size_t n = 0;
    for_each_voxel(texels.box, [&](const Vec3i& v) {
      target.normal_opacity[all.offset_of(v)] = texels.normal_opacity[n];
      target.field[all.offset_of(v)] = texels.field[n++];
    });
  }
  Status move_detail(const DetailView&) override {
    ++moves;
    return {};
  }
  Status draw(const std::string& name, const FrameView& view, int, int, Hash64&) override {
    names.push_back(name);
    views.push_back(view);
    return {};
  }
  VolumeView first, volume;
  DetailView detail;
  int moves = 0;
  std::vector<std::string> names;
  std::vector<FrameView> views;
};

struct DrilledHead {
  explicit DrilledHead(std::vector<std::string> more = {})
      : run(SmallScene{.volume = kHeadKeys, .display = true, .sets = with(std::move(more))}, options()) {
    run.run();
  }
  static std::vector<std::string> with(std::vector<std::string> more) {
    more.insert(more.begin(), kOnTop.begin(), kOnTop.end());
    return more;
  }
  SimulationOptions options() {
    SimulationOptions out;
    out.sink = &sink;
    return out;
  }
  KeepingSink sink;
  DrillRun run;
};

bool is_cloth(const Rgba8& color) { return color.g > color.r; }

}  // namespace

TEST_CASE("surroundings: after drilling both levels are as made anew, and the region is not left") {
  DrilledHead head;
  const Voxmap& voxmap = head.run.simulation().voxmap();
  const Surroundings* around = voxmap.bone().surroundings();
  REQUIRE(around != nullptr);
  const CoarseBone coarse = CoarseBone::around(*around);
  const VolumeView whole = make_volume_view(coarse.drawn(voxmap), coarse.loaded().bounds(), true);
  CHECK(head.sink.moves == 0);
  CHECK(head.sink.volume.field == whole.field);
  CHECK(head.sink.volume.normal_opacity == whole.normal_opacity);
  const DetailView detail = make_detail_view({around->region, around->factor}, coarse, voxmap, true);
  CHECK(head.sink.detail.grid.box == around->region);
  CHECK(head.sink.detail.volume.field == detail.volume.field);
  CHECK(head.sink.detail.volume.normal_opacity == detail.volume.normal_opacity);
  // Bone was removed, in the region alone: outside it every texel is as at the start.
  int changed = 0, outside = 0;
  const VoxelBox all{Vec3i(0), whole.dims}, region{around->region.lo / around->factor - 2, (around->region.hi - 1) / around->factor + 3};
  for_each_voxel(all, [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    if (head.sink.volume.field[n] == head.sink.first.field[n]) return;
    ++changed;
    outside += !region.contains({v, v + 1});
  });
  CHECK(changed > 10);
  CHECK(outside == 0);
}

TEST_CASE("surroundings: the coarse density is that of the head less the weighted mean of what was removed") {
  DrilledHead head;
  const Voxmap& voxmap = head.run.simulation().voxmap();
  const Surroundings& around = *voxmap.bone().surroundings();
  const VoxelBox all = around.coarse->bounds();
  std::vector<float> drawn(all.count());
  CoarseBone::around(around).read_density(voxmap, all, drawn);
  const int factor = around.factor;
  int removed_somewhere = 0;
  double worst = 0.0;
  for_each_voxel({around.region.lo / factor, (around.region.hi - 1) / factor + 1}, [&](const Vec3i& v) {
    double removed = 0.0;
    for_each_voxel({factor * v - factor + 1, factor * v + factor}, [&](const Vec3i& at) {
      float density = 0.0f;
      voxmap.read_density({at, at + 1}, {&density, 1});
      const Vec3i d = factor - glm::abs(at - factor * v);
      removed += static_cast<double>(d.x * d.y * d.z) / std::pow(factor, 6) * (static_cast<double>(voxmap.bone().occupancy(at)) - density);
    });
    removed_somewhere += removed > 0.01;
    const double left = std::max(static_cast<double>(around.coarse->occupancy(v)) - removed, 0.0);
    worst = std::max(worst, std::abs(left - static_cast<double>(drawn[all.offset_of(v)])));
  });
  CHECK(removed_somewhere > 5);
  CHECK(worst < 2e-6);  // rounding of sums of 7^3 floats, see coarse_bone_test.cpp
}

TEST_CASE("drape: the cloth leaves the window free, covers the rest of the head from above, and cutting does not touch it") {
  for (const std::string shape : {"square", "round"}) {
    CAPTURE(shape);
    DrilledHead head({"display.drape=\"" + shape + "\""});
    const VolumeView &first = head.sink.first, &last = head.sink.volume;
    const VoxelBox all{Vec3i(0), first.dims};
    const Affine& bone_from_index = first.bone_from_index;
    int cloth = 0, in_window = 0, changed = 0;
    const double least = shape == "round" ? std::sqrt(2.0) * 40e-3 : 40e-3;  // 28 mm and three coarse voxels on each side
    for_each_voxel(all, [&](const Vec3i& v) {
      const std::size_t n = all.offset_of(v);
      if (!is_cloth(first.color[n]) || first.field[n] < 32768) return;
      ++cloth;
      changed += first.field[n] != last.field[n];
      const Vec3 p = bone_from_index * Vec3(v) - Vec3(0.0, -9e-3, 0.0);
      const double across = shape == "round" ? std::sqrt(p.x * p.x + p.y * p.y) : std::max(std::abs(p.x), std::abs(p.y));
      // The corners of the square are rounded with a radius of a fifth of its half: 0.29 of 4 mm.
      in_window += p.z > 90e-3 && across < 0.5 * least - 1.2e-3;
    });
    CHECK(cloth > 1'000);
    CHECK(in_window == 0);
    CHECK(changed == 0);
    // From above, each column that holds bone and lies outside the window meets cloth first.
    int bare = 0, covered = 0;
    for (int j = 0; j < first.dims.y; ++j)
      for (int i = 0; i < first.dims.x; ++i) {
        const Vec3 place = bone_from_index * Vec3(i, j, 0) - Vec3(0.0, -9e-3, 0.0);
        if (std::sqrt(place.x * place.x + place.y * place.y) < 0.5 * least + 8e-3 ||
            std::max(std::abs(place.x), std::abs(place.y)) < 0.5 * least + 4e-3)
          continue;
        for (int k = first.dims.z - 1; k >= 0; --k) {
          const std::size_t n = all.offset_of({i, j, k});
          if (first.field[n] < 32768) continue;
          (is_cloth(first.color[n]) ? covered : bare) += 1;
          break;
        }
      }
    CHECK(covered > 1'000);
    CHECK(bare == 0);
  }
}

TEST_CASE("skin: it is there only where the scene names it, and leaves the texels of the bone, the drilling and the view alone") {
  const DrilledHead plain, skinned({"display.skin=true"}), draped({"display.skin=true", "display.drape=\"square\""});
  CHECK(!plain.sink.first.skin);
  REQUIRE(skinned.sink.first.skin);
  CHECK(plain.sink.first.field == skinned.sink.first.field);
  CHECK(plain.sink.first.color == skinned.sink.first.color);
  CHECK(plain.sink.first.normal_opacity == skinned.sink.first.normal_opacity);
  CHECK(plain.sink.volume.field == skinned.sink.volume.field);
  CHECK(plain.sink.detail.volume.field == skinned.sink.detail.volume.field);
  CHECK(plain.sink.views.back().camera == skinned.sink.views.back().camera);
  const SkinView& skin = *skinned.sink.first.skin;
  CHECK(skin.shell.indices.size() > 30'000);
  // The opening at the entry, 42 mm wide: above it no skin, 5.5 mm above the bone beside it.
  double nearest = 1.0, highest = -1.0;
  for (const std::uint32_t n : skin.shell.indices) {
    const Vec3 p = Vec3(skin.shell.positions[n]) - Vec3(0.0, -9e-3, 113.2e-3);
    highest = std::max(highest, p.z);
    if (p.z > -20e-3) nearest = std::min(nearest, std::sqrt(p.x * p.x + p.y * p.y));
  }
  CHECK(nearest > 21e-3 - 4e-3);  // less the longest edge of a triangle, whose part inside is not drawn
  CHECK(nearest < 21e-3);
  CHECK(highest > 1e-3);
  CHECK(highest < 5.6e-3);
  // Under a drape 5 mm of skin lie between its window and the opening: 28 + 6 x 2 - 10 mm.
  double edge = 0.0;
  for (const Vec3f& p : draped.sink.first.skin->rim.positions) edge = std::max(edge, static_cast<double>(std::abs(p.x)));
  CHECK(std::abs(edge - 15e-3) < 1e-6);
}

TEST_CASE("overview: the first picture shows the middle of the head from its own distance; the table lies under the head") {
  DrilledHead head({"display.overview_mm=500", "display.table=true"});
  REQUIRE(head.sink.names.size() >= 3);
  CHECK(head.sink.names[0] == "overview");
  CHECK(head.sink.names[1] == "before");
  const FrameView& view = head.sink.views[0];
  CHECK(std::abs(glm::length(view.camera.eye - view.camera.target) - 0.5) < 1e-9);
  // The middle of the vault and jaw, to a voxel of 2 mm on each side.
  CHECK(std::abs(view.camera.target.x) < 2e-3);
  CHECK(std::abs(view.camera.target.z - 0.5 * (0.113 - 0.105)) < 4e-3);
  REQUIRE(view.table);
  CHECK(std::abs(view.table->offset + 0.105) < 4e-3);
  CHECK(view.table->normal.z > 0.999);
  const DrilledHead plain;
  CHECK(plain.sink.names[0] == "before");
  CHECK(!plain.sink.views[0].table);
}

}  // namespace burrhole::test
