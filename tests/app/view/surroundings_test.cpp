// A head phantom in pictures: the head around the bone, changes of the bone in it, a cloth over it, an overview and a table.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/view/camera.h"
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
  Status start(const VolumeView& given, const TriangleMesh& tool) override {
    last_mesh = tool;
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
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64&) override {
    aspect = static_cast<double>(width) / height;
    names.push_back(name);
    views.push_back(view);
    meshes.push_back(last_mesh);
    return {};
  }
  Status change_tool(const TriangleMesh& tool) override {
    last_mesh = tool;
    return {};
  }
  VolumeView first, volume;
  DetailView detail;
  int moves = 0;
  std::vector<std::string> names;
  std::vector<FrameView> views;
  std::vector<TriangleMesh> meshes;  // of the tool, in each picture
  TriangleMesh last_mesh;
  double aspect = 1.0;
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

TEST_CASE("inset: the bone of a head fills nine tenths of it, in the middle, from the direction of each picture") {
  DrilledHead head;
  const VolumeView& whole = head.sink.first;
  const VoxelBox all{Vec3i(0), whole.dims};
  int insets = 0;
  for (const FrameView& view : head.sink.views) {
    if (!view.inset) continue;
    ++insets;
    const CameraView& camera = *view.inset;
    CHECK(glm::length(glm::normalize(camera.eye - camera.target) - glm::normalize(view.camera.eye - view.camera.target)) < 1e-9);
    const auto rays = make_camera_rays(camera, head.sink.aspect);
    REQUIRE(rays.ok());
    const glm::dmat4 clip = clip_from_world(*rays, {0.01, 10.0});
    glm::dvec2 lo(1e9), hi(-1e9);
    for_each_voxel(all, [&](const Vec3i& v) {
      if (whole.normal_opacity[all.offset_of(v)].a < 128) return;
      const glm::dvec4 p = clip * glm::dvec4(view.world_from_bone * (whole.bone_from_index * Vec3(v)), 1.0);
      lo = glm::min(lo, glm::dvec2(p) / p.w);
      hi = glm::max(hi, glm::dvec2(p) / p.w);
    });
    CHECK(lo.x > -0.95);
    CHECK(lo.y > -0.95);
    CHECK(hi.x < 0.95);
    CHECK(hi.y < 0.95);
    // The outline is made of blocks of voxels, and near parts of a head look larger than far ones.
    CHECK(std::max({-lo.x, -lo.y, hi.x, hi.y}) > 0.78);
    CHECK(glm::length(lo + hi) < 0.3);
  }
  CHECK(insets >= 2);
}

TEST_CASE("section: the bit is cut by the plane of the bone, on the kept side, and whole again in the next picture") {
  DrilledHead head;
  const auto with_tool = std::ranges::find_if(head.sink.views, [](const FrameView& view) { return view.world_from_tool.has_value(); });
  REQUIRE(with_tool != head.sink.views.end());
  const Pose pose = *with_tool->world_from_tool;
  FrameStep* const frames = head.run.simulation().frame_step();
  REQUIRE(frames != nullptr);
  REQUIRE(frames->draw("section", pose, true).ok());
  const TriangleMesh half = head.sink.meshes.back();
  const FrameView view = head.sink.views.back();
  REQUIRE(frames->draw("whole", pose, false).ok());
  const TriangleMesh& whole = head.run.loaded().tool.look;
  REQUIRE_FALSE(half.indices.empty());
  REQUIRE(view.cut);
  CHECK(head.sink.meshes.back().positions.size() == whole.positions.size());
  const auto height = [&](const Vec3f& p) { return glm::dot(view.cut->normal, *view.world_from_tool * Vec3(p)) - view.cut->offset; };
  double most = -1.0, least = 1.0, area = 0.0;
  for (const Vec3f& p : half.positions) {
    most = std::max(most, height(p));
    least = std::min(least, height(p));
  }
  for (std::size_t t = 0; t < half.indices.size(); t += 3) {
    const Vec3f a = half.positions[half.indices[t]], b = half.positions[half.indices[t + 1]], c = half.positions[half.indices[t + 2]];
    if (std::min({height(a), height(b), height(c)}) > 1e-5) area += 0.5 * glm::length(glm::cross(Vec3(b - a), Vec3(c - a)));
  }
  CHECK(most < 3e-5);  // 0.02 mm before the section of bone
  CHECK(most > 1e-5);
  CHECK(least < -0.5e-3);
  CHECK(area > 1e-6);  // the section is closed
}

}  // namespace burrhole::test
