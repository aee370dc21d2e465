// Where surfaces land on the screen and in the volume, against closed forms.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/app/render/render_scenes.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

struct Ball {
  Vec3 center;
  double radius;
};

/// View depth along direction at which a ray meets the ball first; negative for a miss.
double meet(const Ball& ball, const Vec3& eye, const Vec3& direction) {
  const Vec3 to = eye - ball.center;
  const double a = glm::dot(direction, direction), b = glm::dot(to, direction), c = glm::dot(to, to) - ball.radius * ball.radius;
  const double root = b * b - a * c;
  return root < 0.0 ? -1.0 : (-b - std::sqrt(root)) / a;
}

Vec3 pixel_direction(const CameraView& camera, int column, int row, int width, int height) {
  const Vec3 forward = glm::normalize(camera.target - camera.eye);
  const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
  const double pixel = 2.0 * std::tan(0.5 * camera.vertical_fov) / height;
  return forward + (column + 0.5 - 0.5 * width) * pixel * right + (0.5 * height - row - 0.5) * pixel * glm::cross(right, forward);
}

struct Found {
  int wrong_pixels = 0, hits = 0;
  double worst_distance = 0.0;  ///< [m] from the ball's surface
};

Found compare_with_ball(const VolumeView& volume, const FrameView& view, const Ball& ball_in_bone) {
  constexpr int kWidth = 160, kHeight = 120;
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(volume).ok());
  const auto probe = renderer.probe(view, kWidth, kHeight);
  REQUIRE(probe.ok());
  const Ball ball{view.world_from_bone * ball_in_bone.center, ball_in_bone.radius};
  const Affine world_from_index = Affine::from_pose(view.world_from_bone) * volume.bone_from_index;
  Found found;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const std::size_t n = static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column);
      const bool expected = meet(ball, view.camera.eye, pixel_direction(view.camera, column, row, kWidth, kHeight)) > 0.0;
      if (expected != (probe.value().hit[n] != 0)) ++found.wrong_pixels;
      if (probe.value().hit[n] == 0) continue;
      ++found.hits;
      const Vec3 hit = world_from_index * Vec3(probe.value().hit_index[n]);
      found.worst_distance = std::max(found.worst_distance, std::abs(glm::length(hit - ball.center) - ball.radius));
    }
  return found;
}

VolumeView ball_volume(const Affine& bone_from_index, const Ball& ball) {
  return make_volume({.dims = Vec3i(64),
                      .bone_from_index = bone_from_index,
                      .bone = [ball](const Vec3& p) { return ball.radius - glm::length(p - ball.center); },
                      .soft = {},
                      .color = {}});
}

}  // namespace

TEST_CASE("ray caster: hits lie on a ball within a tenth of a voxel") {
  const Ball ball{Vec3(1e-3, -0.5e-3, 0.7e-3), 10e-3};
  const Found found = compare_with_ball(ball_volume(half_millimetre_cube(), ball), oblique_view(), ball);
  CHECK(found.hits > 1000);
  CHECK(found.worst_distance < 0.1 * 0.5e-3);
  // A silhouette of about 150 pixels; one in twenty may see the edge, which the ray crosses within less than a step, on the other side.
  CHECK(found.wrong_pixels < 8);
}

TEST_CASE("ray caster: a ball in a sheared, anisotropic, turned and moved volume lands on the pixels of the ball") {
  const Ball ball{Vec3(0.01, 0.02, -0.005), 9e-3};
  Affine sheared;
  sheared.linear = Mat3(0.5e-3, 0, 0, 0.2e-3, 0.4e-3, 0, -0.15e-3, 0.1e-3, 0.7e-3);
  sheared.offset = ball.center - sheared.linear * Vec3(31.5);
  FrameView view = oblique_view();
  view.world_from_bone = Pose{glm::angleAxis(1.1, glm::normalize(Vec3(0.3, -1.0, 0.6))), Vec3(0.0)};
  view.world_from_bone.translation = Vec3(2e-3, 1e-3, -1e-3) - view.world_from_bone.rotate(ball.center);
  const Found found = compare_with_ball(ball_volume(sheared, ball), view, ball);
  CHECK(found.hits > 1000);
  // The ramp is two mean edges wide while the longest edge is 0.72 mm: its filtered level bends by up to a tenth of that.
  CHECK(found.worst_distance < 0.1 * 0.72e-3);
  CHECK(found.wrong_pixels < 8);
}

TEST_CASE("ray caster: a shift of one voxel is noticed by the closed form") {
  const Ball ball{Vec3(1e-3, -0.5e-3, 0.7e-3), 10e-3};
  VolumeView shifted = ball_volume(half_millimetre_cube(), ball);
  shifted.bone_from_index.offset.x += 0.5e-3;
  const Found found = compare_with_ball(shifted, oblique_view(), ball);
  CHECK(found.worst_distance > 0.1 * 0.5e-3);
  CHECK(found.wrong_pixels >= 8);
}

TEST_CASE("ray caster: a finer step and more bisections do not move the hit away") {
  const Ball ball{Vec3(0.0), 10e-3};
  const VolumeView volume = ball_volume(half_millimetre_cube(), ball);
  const auto worst = [&](double step, int bisections) {
    Renderer renderer = require_renderer({.step_voxels = step, .bisections = bisections, .finish = false});
    REQUIRE(renderer.set_volume(volume).ok());
    const auto probe = renderer.probe(oblique_view(), 80, 60);
    REQUIRE(probe.ok());
    double largest = 0.0;
    for (std::size_t n = 0; n < probe.value().hit.size(); ++n) {
      if (probe.value().hit[n] == 0) continue;
      const Vec3 p = volume.bone_from_index * Vec3(probe.value().hit_index[n]);
      largest = std::max(largest, std::abs(glm::length(p) - ball.radius));
    }
    return largest;
  };
  // Without bisection a hit is up to a step of half a voxel deep; six of them bring it to where the 8-bit field decides.
  CHECK(worst(0.5, 0) > 3.0 * worst(0.5, 6));
}
