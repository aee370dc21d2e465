// The bone as triangles: the same surface as that of rays, kept up to date by what has changed and by no more.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "app/view/bone_mesh.h"
#include "app/view/texels.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/drill_scene.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 240, kHeight = 180;
using Bytes = std::array<unsigned char, sizeof(MeshTriangle)>;

/// All triangles, each from its smallest corner on, in an order that does not depend on their numbers.
std::vector<Bytes> sorted_triangles(const BoneMesh& mesh) {
  std::vector<Bytes> out;
  for (std::uint32_t n = 0; n < mesh.slots(); ++n) {
    MeshTriangle triangle = mesh.triangle(n);
    if (triangle == MeshTriangle{}) continue;
    const auto key = [](const MeshVertex& v) { return std::array{v.position.x, v.position.y, v.position.z}; };
    const auto least = std::ranges::min_element(triangle, {}, key);
    std::ranges::rotate(triangle, least);
    std::memcpy(out.emplace_back().data(), triangle.data(), sizeof(MeshTriangle));
  }
  std::ranges::sort(out);
  return out;
}

std::uint64_t count_of(const std::vector<TriangleRange>& ranges) {
  std::uint64_t sum = 0;
  for (const TriangleRange& range : ranges) sum += range.size();
  return sum;
}

/// Looks into the hole, from aside by `side`.
FrameView view_of(const Pose& world_from_bone, const Approach& approach, double side) {
  const Pose world_from_approach = world_from_bone * approach.bone_from_approach;
  FrameView view;
  view.world_from_bone = world_from_bone;
  view.camera = {.eye = world_from_approach * Vec3(0.008 * side, -0.010 * side, 0.022),
                 .target = world_from_approach * Vec3(0.0, 0.0, -0.5e-3),
                 .up = world_from_approach.rotate(Vec3(0.0, 1.0, 0.0)),
                 .vertical_fov = 0.3};
  return view;
}

struct Agreement {
  std::size_t both = 0, one = 0, near = 0;  ///< pixels: both show, one alone shows, and near by 0.5 voxel along the normal
  double worst = 0.0;                       ///< [voxels]
  std::size_t off_depth = 0;                ///< pixels of the mesh where depth buffer and hit differ by more than 1e-6 m
  [[nodiscard]] double share() const { return static_cast<double>(near) / static_cast<double>(both); }
};

/// @returns the normal of the drawn surface where a ray ends: that of the box on its faces, elsewhere that of the nearest texel.
/// Index axes of these phantoms are those of the bone, with equal edges.
Vec3 normal_at(const VolumeView& volume, const Vec3& p, const Vec3& other) {
  const Vec3 lo(-0.5), hi = Vec3(volume.dims) - 0.5;
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] < lo[axis] + 0.02 || p[axis] > hi[axis] - 0.02) {
      Vec3 out(0.0);
      out[axis] = 1.0;
      return out;
    }
  const Vec3i nearest = glm::clamp(Vec3i(glm::round(p)), Vec3i(0), volume.dims - 1);
  const Vec3 normal = decode_normal(volume.normal_opacity[VoxelBox{Vec3i(0), volume.dims}.offset_of(nearest)]);
  return glm::normalize(glm::length(normal) < 0.5 ? p - other : normal);  // unknown: the whole way counts
}

Agreement compare(Renderer& rays, Renderer& mesh, const VolumeView& volume, const FrameView& view) {
  const auto a = rays.probe(view, kWidth, kHeight), b = mesh.probe(view, kWidth, kHeight);
  REQUIRE(a.ok());
  REQUIRE(b.ok());
  const Vec3 forward = glm::normalize(view.camera.target - view.camera.eye);
  Agreement out;
  for (std::size_t n = 0; n < a->hit.size(); ++n) {
    if (a->hit[n] != b->hit[n]) ++out.one;
    if (a->hit[n] == 0 || b->hit[n] == 0) continue;
    ++out.both;
    const Vec3 p(a->hit_index[n]), q(b->hit_index[n]);
    const double apart = std::abs(glm::dot(p - q, normal_at(volume, p, q)));
    if (!(apart >= 0.5)) ++out.near;
    out.worst = std::max(out.worst, apart);
    const Vec3 world = view.world_from_bone * (volume.bone_from_index * q);
    if (!(std::abs(glm::dot(world - view.camera.eye, forward) - static_cast<double>(b->view_depth[n])) < 1e-6)) ++out.off_depth;
  }
  return out;
}

/// A scene that drills, with all that changed handed to a BoneMesh and to renderers, some ticks at a time.
class Following {
 public:
  explicit Following(const char* keys) : run_(SmallScene{.volume = keys, .sets = {"duration_s=1.2"}}) {}
  [[nodiscard]] DrillRun& run() { return run_; }
  [[nodiscard]] Voxmap& voxmap() { return run_.simulation().voxmap(); }
  [[nodiscard]] const Scene& scene() { return run_.loaded().scene; }
  [[nodiscard]] FrameView view(double side) { return view_of(scene().volume.world_from_bone, run_.simulation().approach(), side); }

 private:
  DrillRun run_;
};

Renderer mesh_renderer(bool finish = false) { return require_renderer({.finish = finish, .mesh = true}); }

}  // namespace

TEST_CASE("mesh display: a drilled hole is the same surface as that of rays, within half a voxel at 99 % of the pixels") {
  Following following(kSkullPatchKeys);
  Voxmap& voxmap = following.voxmap();
  Renderer rays = require_renderer(), mesh = mesh_renderer();
  const VolumeView loaded = make_volume_view(voxmap);
  REQUIRE(rays.set_volume(loaded).ok());
  REQUIRE(mesh.set_volume(loaded).ok());
  CHECK(mesh.counters().volume_bytes == 0);
  const std::size_t listener = voxmap.add_listener();
  const auto check = [&](const std::string& when, const VolumeView& volume) {
    for (const double side : {0.0, 0.5, 1.0})
      for (const bool cut : {false, true}) {
        CAPTURE(side);
        CAPTURE(cut);
        FrameView view = following.view(side);
        const Vec3 normal = following.scene().volume.world_from_bone.rotate(
            following.run().simulation().approach().bone_from_approach.rotate(Vec3(0.0, -1.0, 0.0)));
        if (cut) view.cut = FrameView::Cut{normal, glm::dot(normal, view.camera.target)};
        const Agreement found = compare(rays, mesh, volume, view);
        MESSAGE(when << ", side " << side << std::string(cut ? ", cut" : "") << ": " << found.both << " pixels, near " << found.share()
                     << ", worst " << found.worst << " voxel, one alone " << found.one << ", off depth " << found.off_depth);
        CHECK(found.both > 4000);
        CHECK(found.share() >= 0.99);
        // The mesh bevels the edges of the box by 0.3 voxel, a ray does not: along an outline of 4 x 32 voxels that is 3.7 % of 32 x 32.
        CHECK(found.one < found.both / 25);
        // A triangle that is seen along its plane has no depth of its own at a pixel.
        if (!cut) CHECK(found.off_depth <= 3);
      }
  };
  check("as loaded", loaded);
  const std::uint64_t whole = voxmap.hash();
  following.run().run();
  REQUIRE(voxmap.hash() != whole);
  for (const VoxelBox& box : voxmap.take_dirty(listener))
    if (const TexelBox texels = make_texels(voxmap, box); !texels.box.empty()) {
      rays.update(texels);
      mesh.update(texels);
    }
  check("drilled", make_volume_view(voxmap));
  Renderer stale = mesh_renderer();
  REQUIRE(stale.set_volume(loaded).ok());
  CHECK(compare(rays, stale, make_volume_view(voxmap), following.view(0.0)).share() < 0.97);
}

TEST_CASE("mesh display: after each step of a drilling the mesh is one that is built anew, and what differs is sent and no more") {
  const LoadedScene loaded = load_small({.volume = kSkullPatchKeys, .sets = {"duration_s=1.2"}});
  DrillRun* running = nullptr;
  std::optional<BoneMesh> mesh;
  std::optional<Renderer> renderer;
  std::vector<MeshTriangle> copy;  // what a display has
  std::size_t listener = 0;
  int tick = 0, steps = 0;
  std::uint64_t sent = 0, most = 0;
  const auto draw = [&] {
    FrameView view = view_of(loaded.scene.volume.world_from_bone, running->simulation().approach(), 1.0);
    const auto image = renderer->draw(view, 64, 48);
    REQUIRE(image.ok());
  };
  WatchedHand hand(loaded, [&] {
    Voxmap& voxmap = running->simulation().voxmap();
    if (!mesh) {
      auto made = BoneMesh::create(make_volume_view(voxmap));
      REQUIRE(made.ok());
      mesh.emplace(std::move(made).value());
      CHECK(count_of(mesh->take_changed()) == mesh->slots());
      for (std::uint32_t n = 0; n < mesh->slots(); ++n) copy.push_back(mesh->triangle(n));
      renderer.emplace(mesh_renderer());
      REQUIRE(renderer->set_volume(make_volume_view(voxmap)).ok());
      draw();
      CHECK(renderer->counters().mesh_bytes == mesh->slots() * sizeof(MeshTriangle));
      listener = voxmap.add_listener();
    }
    if (++tick % 60 != 0) return;
    for (const VoxelBox& box : voxmap.take_dirty(listener))
      if (const TexelBox texels = make_texels(voxmap, box); !texels.box.empty()) {
        mesh->update(texels);
        renderer->update(texels);
      }
    const std::vector<TriangleRange> changed = mesh->take_changed();
    copy.resize(std::max<std::size_t>(copy.size(), mesh->slots()));
    for (const TriangleRange& range : changed)
      for (std::uint32_t n = range.begin; n < range.end; ++n) copy[n] = mesh->triangle(n);
    bool same = true;
    for (std::uint32_t n = 0; n < mesh->slots(); ++n) same = same && copy[n] == mesh->triangle(n);
    CHECK(same);
    auto anew = BoneMesh::create(make_volume_view(voxmap));
    REQUIRE(anew.ok());
    CHECK(sorted_triangles(*mesh) == sorted_triangles(*anew));
    const std::uint64_t before = renderer->counters().mesh_update_bytes;
    draw();
    CHECK(renderer->counters().mesh_update_bytes - before == count_of(changed) * sizeof(MeshTriangle));
    draw();  // nothing has changed
    CHECK(renderer->counters().mesh_update_bytes - before == count_of(changed) * sizeof(MeshTriangle));
    sent += count_of(changed);
    most = std::max(most, count_of(changed));
    if (!changed.empty()) ++steps;
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(loaded, options);
  running = &run;
  run.run();
  MESSAGE(steps << " steps sent " << sent << " triangles, at most " << most << " of " << mesh->triangles());
  CHECK(steps > 10);
  CHECK(most * 4 < mesh->triangles());
  CHECK(renderer->counters().mesh_bytes <= 2 * mesh->slots() * sizeof(MeshTriangle));
  CHECK(renderer->counters().volume_bytes == 0);
}

TEST_CASE("mesh display: a turned, mirrored and sheared bone has its triangles counter-clockwise from outside, with normals outward") {
  VolumeView ball = ball_on_plate();
  for (const double sign : {1.0, -1.0}) {
    VolumeView volume = ball;
    volume.bone_from_index.linear = Mat3(Vec3(sign * 0.4e-3, 0.0, 0.0), Vec3(0.1e-3, 0.5e-3, 0.0), Vec3(0.0, 0.05e-3, 0.6e-3)) * Mat3(1.0);
    auto mesh = BoneMesh::create(volume);
    REQUIRE(mesh.ok());
    double volume_m3 = 0.0;
    int outward = 0, inward = 0;
    for (std::uint32_t n = 0; n < mesh->slots(); ++n) {
      const MeshTriangle t = mesh->triangle(n);
      const Vec3 a(t[0].position), b(t[1].position), c(t[2].position), face = glm::cross(b - a, c - a);
      volume_m3 += glm::dot(a, glm::cross(b, c)) / 6.0;
      for (const MeshVertex& v : t) {
        const Vec3 normal = Vec3(v.normal[0], v.normal[1], v.normal[2]) / 32767.0;
        CHECK(glm::length(normal) == doctest::Approx(1.0).epsilon(1e-3));
        ++(glm::dot(normal, face) > 0.0 ? outward : inward);
      }
    }
    CHECK(volume_m3 > 0.0);
    CHECK(inward == 0);
    CHECK(outward > 1000);
  }
}

TEST_CASE("mesh display: a volume that is too long is refused with what to do") {
  VolumeView volume;
  volume.dims = {1025, 1, 1};
  volume.normal_opacity.resize(1025);
  volume.color.resize(1025);
  const auto made = BoneMesh::create(volume);
  REQUIRE(!made.ok());
  CHECK(made.error().code == ErrorCode::out_of_range);
  CHECK(made.error().message.find("display.whole_voxels") != std::string::npos);
  Renderer renderer = mesh_renderer();
  CHECK(!renderer.set_volume(volume).ok());
  CHECK(!Renderer::create({.slices = SliceOptions{}, .mesh = true}).ok());
}
