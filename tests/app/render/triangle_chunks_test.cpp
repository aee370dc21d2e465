// The oracle projects each triangle by itself.
#include "app/render/triangle_chunks.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "app/view/camera.h"

namespace burrhole {
namespace {

constexpr Vec2i kPicture{320, 240};

/// A plate of 96 x 96 x 12 voxels of 0.25 mm, about its middle.
BoneMesh plate() {
  VolumeView view;
  view.dims = {100, 100, 16};
  view.bone_from_index = Affine::scaling(0.25e-3, Vec3(-0.0125, -0.0125, -0.002));
  const VoxelBox bone{{2, 2, 2}, {98, 98, 14}};
  for_each_voxel(VoxelBox{Vec3i(0), view.dims}, [&](const Vec3i& v) {
    view.normal_opacity.push_back({128, 128, 255, static_cast<std::uint8_t>(bone.contains(v) ? 255 : 0)});
    view.color.push_back({200, 200, 200, 0});
  });
  auto made = BoneMesh::create(view);
  REQUIRE(made.ok());
  return std::move(made).value();
}

TriangleChunks chunks_of(const BoneMesh& mesh) {
  TriangleChunks out;
  out.arrange(mesh);
  return out;
}

CameraRays rays() {
  const CameraView camera{.eye = {0.01, -0.03, 0.03}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.6};
  return make_camera_rays(camera, static_cast<double>(kPicture.x) / kPicture.y).value();
}

std::uint32_t count(const std::vector<TriangleRange>& ranges) {
  std::uint32_t out = 0;
  for (const TriangleRange& range : ranges) out += range.size();
  return out;
}

TEST_CASE("triangle chunks: no triangle that a part of a picture shows is left out, and most others are") {
  const BoneMesh mesh = plate();
  TriangleChunks chunks = chunks_of(mesh);
  const Pose pose{glm::angleAxis(0.7, glm::normalize(Vec3(1.0, 2.0, 3.0))), {0.002, -0.001, 0.003}};
  const Affine world_from_bone = Affine::from_pose(pose);
  std::uint32_t seen = 0, found = 0;
  for (int y = 0; y < kPicture.y; y += 48)
    for (int x = 0; x < kPicture.x; x += 64) {
      const PixelRect part{{x, y}, {x + 20, y + 20}};
      const std::vector<TriangleRange>& ranges = chunks.find(rays(), world_from_bone, part, kPicture);
      found += count(ranges);
      for (std::uint32_t n = 0; n < mesh.slots(); ++n) {
        const MeshTriangle triangle = mesh.triangle(n);
        std::array<Vec3, 3> corners{};
        for (std::size_t m = 0; m < 3; ++m) corners[m] = world_from_bone * Vec3(triangle[m].position);
        if (find_footprint(rays(), corners, kPicture).intersect(part).empty()) continue;
        ++seen;
        const std::uint32_t place = chunks.place_of(n);
        CHECK(chunks.number_at(place) == n);
        CHECK(std::ranges::any_of(ranges, [&](const TriangleRange& range) { return range.begin <= place && place < range.end; }));
      }
    }
  CHECK(seen > 500);
  // 25 parts of 20 x 20 pixels are 13 % of the picture. A chunk that covers a square of 11 x 11 voxels, 19 pixels wide here, is met by a part within
  // 39 x 39 pixels, four times its area.
  MESSAGE("triangles drawn for all parts: ", found, " of ", 25 * mesh.slots());
  CHECK(found < 25 * mesh.slots() / 10);
}

TEST_CASE("triangle chunks: a triangle that is removed is not found, one that takes its number is") {
  const BoneMesh mesh = plate();
  TriangleChunks chunks;
  chunks.extend(1);
  const PixelRect whole{{0, 0}, kPicture};
  CHECK(chunks.find(rays(), {}, whole, kPicture).empty());
  chunks.set(0, mesh.triangle(0));
  CHECK(count(chunks.find(rays(), {}, whole, kPicture)) == 1);
  chunks.set(0, MeshTriangle{});
  CHECK(chunks.find(rays(), {}, whole, kPicture).empty());
  chunks.set(0, mesh.triangle(1));
  CHECK(count(chunks.find(rays(), {}, whole, kPicture)) == 1);
}

TEST_CASE("triangle chunks: what lies behind the eye is drawn, what lies beside the picture is not") {
  const BoneMesh mesh = plate();
  TriangleChunks chunks = chunks_of(mesh);
  const PixelRect whole{{0, 0}, kPicture};
  CHECK(chunks.find(rays(), {Mat3(1.0), {0.19, 0.063, 0.0}}, whole, kPicture).empty());
  CHECK(count(chunks.find(rays(), {Mat3(1.0), {0.02, -0.06, 0.06}}, whole, kPicture)) == mesh.slots());
}

}  // namespace
}  // namespace burrhole
