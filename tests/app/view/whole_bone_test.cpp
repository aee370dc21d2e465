// A bone without a scene: what the camera holds, which edges of its box are seen, slices through its middle.
#include "app/view/whole_bone.h"

#include <doctest/doctest.h>

#include <cmath>

#include "app/view/camera.h"

using namespace burrhole;

namespace {

const Bounds kBox{Vec3(-0.02, 0.10, -0.30), Vec3(0.12, 0.13, -0.22)};

/// @returns the largest |x| or |y| of the corners in the picture, 1 at its edge.
double reach_of(const Bounds& box, const FrameView& frame, double aspect) {
  const auto rays = make_camera_rays(frame.camera, aspect);
  REQUIRE(rays.ok());
  double reach = 0.0;
  for (const Vec3& corner : box.corners()) {
    const glm::dvec4 clip = clip_from_world(*rays, {0.001, 10.0}) * glm::dvec4(corner, 1.0);
    REQUIRE(clip.w > 0.0);
    reach = std::max({reach, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
  }
  return reach;
}

/// @returns whether the segment from p to the eye, without its ends, meets the inside of the box.
bool is_hidden(const Bounds& box, const Vec3& p, const Vec3& eye) {
  for (int n = 1; n < 2000; ++n) {
    const Vec3 q = glm::mix(p, eye, n / 2000.0);
    if (glm::all(glm::greaterThan(q, box.lo + 1e-6)) && glm::all(glm::lessThan(q, box.hi - 1e-6))) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("whole bone: its box fills nine tenths of the picture from any side") {
  for (const double aspect : {4.0 / 3.0, 1.0, 0.5})
    for (const double azimuth : {0.0, 0.6, 2.0, -1.5})
      for (const double elevation : {-1.0, 0.0, 0.3, 1.4}) {
        const FrameView frame = make_outer_frame(kBox, kBox.corners(), {.azimuth = azimuth, .elevation = elevation}, aspect);
        CHECK(reach_of(kBox, frame, aspect) == doctest::Approx(0.9).epsilon(1e-9));
      }
  const FrameView nearer = make_outer_frame(kBox, kBox.corners(), {.distance = 0.3}, 1.0);
  CHECK(glm::length(nearer.camera.eye - nearer.camera.target) == doctest::Approx(0.3));
}

TEST_CASE("whole bone: the default view is from anterior left above, in LPS") {
  const FrameView frame = make_outer_frame(kBox, kBox.corners(), {}, 1.0);
  const Vec3 back = frame.camera.eye - frame.camera.target;
  CHECK(back.x > 0.0);
  CHECK(back.y < 0.0);
  CHECK(back.z > 0.0);
}

TEST_CASE("whole bone: a section removes the side that faces the camera") {
  for (const double azimuth : {1.2, -1.2}) {
    const FrameView frame = make_outer_frame(kBox, kBox.corners(), {.azimuth = azimuth, .cut = true}, 1.0);
    REQUIRE(frame.cut.has_value());
    CHECK(glm::dot(frame.cut->normal, frame.camera.eye) > frame.cut->offset);
    CHECK(glm::dot(frame.cut->normal, 0.5 * (kBox.lo + kBox.hi)) == doctest::Approx(frame.cut->offset));
  }
}

TEST_CASE("whole bone: a section is never seen edge-on: it is the one that faces the camera most") {
  for (double azimuth = -3.1; azimuth < 3.1; azimuth += 0.31)
    for (const double elevation : {-1.4, -0.5, 0.0, 0.3, 1.4}) {
      const FrameView frame = make_outer_frame(kBox, kBox.corners(), {.azimuth = azimuth, .elevation = elevation, .cut = true}, 1.0);
      REQUIRE(frame.cut.has_value());
      const double facing = glm::dot(frame.cut->normal, glm::normalize(frame.camera.eye - frame.camera.target));
      CHECK(facing >= 1.0 / std::sqrt(3.0) - 1e-12);  // the largest component of a unit vector
      CHECK(glm::dot(frame.cut->normal, 0.5 * (kBox.lo + kBox.hi)) == doctest::Approx(frame.cut->offset));
    }
}

TEST_CASE("whole bone: seen edges are those whose points nothing of the box hides") {
  for (const Vec3& eye : {Vec3(0.4, -0.3, 0.2), Vec3(-0.4, 0.5, -0.9), Vec3(0.05, 0.115, 0.5), Vec3(0.05, -0.4, 0.1)}) {
    const std::vector<BoxEdge> seen = seen_edges(kBox, eye);
    std::size_t expected = 0;
    for (unsigned a = 0; a < 8; ++a)
      for (unsigned bit : {1u, 2u, 4u}) {
        if ((a & bit) != 0) continue;
        const Vec3 from = kBox.corner(a), to = kBox.corner(a | bit), middle = 0.5 * (from + to);
        const bool listed = std::ranges::any_of(seen, [&](const BoxEdge& edge) { return edge.from == from && edge.to == to; });
        expected += listed ? 1 : 0;
        CHECK(listed == !is_hidden(kBox, middle, eye));
      }
    CHECK(seen.size() == expected);
  }
}

TEST_CASE("whole bone: slices show the middle of a bone, and its box to the pixel") {
  DenseBone dense;
  dense.dims = Vec3i(20, 16, 12);
  dense.bone_from_index = Affine::scaling(2e-3, Vec3(0.01, 0.02, 0.03));
  const VoxelBox inside{{4, 3, 2}, {16, 13, 10}};
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const bool bone = inside.contains({v, v + 1}) && !(v.x == 9 && v.y == 7);  // a hole along z
    dense.occupancy.push_back(bone ? 1.0f : 0.0f);
    dense.hardness.push_back(bone ? 0.5f : 0.0f);
    dense.labels.push_back(bone ? 1 : 0);
  });
  const auto bone = BoneModel::create(dense);
  REQUIRE(bone.ok());
  const Bounds box = bounds_of_bone(**bone);
  CHECK(glm::length(box.lo - (Vec3(4, 3, 2) * 2e-3 + Vec3(0.01, 0.02, 0.03))) < 1e-12);
  CHECK(glm::length(box.hi - (Vec3(15, 12, 9) * 2e-3 + Vec3(0.01, 0.02, 0.03))) < 1e-12);
  const TipSlices slices = make_middle_slices(**bone, box, 120);
  const auto grey = [&](std::size_t plane, const Vec3& p) {
    const Vec3 way = (p - 0.5 * (box.lo + box.hi)) / slices.pixel + 60.0;
    const int x = static_cast<int>(plane == 2 ? way.y : way.x), y = static_cast<int>(plane == 0 ? way.y : 120.0 - way.z);
    return static_cast<int>(slices.planes[plane].grey[static_cast<std::size_t>(120 * y + x)]);
  };
  const Vec3 hole = Vec3(9, 7, 5) * 2e-3 + Vec3(0.01, 0.02, 0.03), full = hole + Vec3(4e-3, 4e-3, 0.0);
  CHECK(grey(0, hole) < 20);
  CHECK(std::abs(grey(0, full) - 128) <= 1);
  CHECK(std::abs(grey(1, full) - 128) <= 1);
  CHECK(grey(2, box.hi + 4e-3) == 0);
  REQUIRE(slices.planes[0].tool.size() == 4);
  const double right = 60.0 + 0.5 * (box.hi.x - box.lo.x) / slices.pixel;
  CHECK(slices.planes[0].tool[1][0].x == doctest::Approx(right));
}
