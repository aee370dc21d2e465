#include "app/view/camera.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace burrhole;

namespace {

const CameraView kCamera{.eye = {0.05, -0.09, 0.07}, .target = {0.01, 0.0, 0.0}, .up = {0.1, 0.2, 1.0}, .vertical_fov = 0.7};

}  // namespace

TEST_CASE("camera: the projection and the rays agree on pixel and depth") {
  const auto rays = make_camera_rays(kCamera, 1.5);
  REQUIRE(rays.ok());
  const DepthRange range{0.02, 0.3};
  const glm::dmat4 clip = clip_from_world(rays.value(), range);
  for (const double x : {-0.9, 0.0, 0.4})
    for (const double y : {-0.3, 0.8})
      for (const double t : {0.02, 0.11, 0.3}) {
        const glm::dvec4 c = clip * glm::dvec4(rays.value().eye + t * rays.value().direction(x, y), 1.0);
        // Rounding of doubles only.
        CHECK(c.x / c.w == doctest::Approx(x).epsilon(1e-9).scale(1.0));
        CHECK(c.y / c.w == doctest::Approx(y).epsilon(1e-9).scale(1.0));
        CHECK(0.5 * c.z / c.w + 0.5 == doctest::Approx(range.depth_of(t)).epsilon(1e-9).scale(1.0));
        CHECK(range.view_depth_of(range.depth_of(t)) == doctest::Approx(t).epsilon(1e-9));
      }
}

TEST_CASE("camera: the target is the middle, up is up, and the field of view is the vertical one") {
  const auto rays = make_camera_rays(kCamera, 2.0);
  REQUIRE(rays.ok());
  const Vec3 towards = glm::normalize(kCamera.target - kCamera.eye);
  CHECK(glm::dot(rays.value().forward, towards) == doctest::Approx(1.0));
  CHECK(glm::dot(rays.value().up, kCamera.up) > 0.0);
  CHECK(std::abs(glm::dot(rays.value().up, rays.value().right)) < 1e-12);
  CHECK(glm::length(rays.value().up) == doctest::Approx(std::tan(0.35)));
  CHECK(glm::length(rays.value().right) == doctest::Approx(2.0 * std::tan(0.35)));
}

TEST_CASE("camera: the depth range holds the points and starts no nearer than a millimetre") {
  const auto rays = make_camera_rays({.eye = {0, 0, 0}, .target = {0, 0, 1}, .up = {0, 1, 0}, .vertical_fov = 1.0}, 1.0);
  REQUIRE(rays.ok());
  const std::array<Vec3, 2> ahead{Vec3(0.0, 0.1, 0.2), Vec3(0.3, 0.0, 0.5)};
  const DepthRange range = fit_depth_range(rays.value(), ahead);
  CHECK(range.near_plane < 0.2);
  CHECK(range.near_plane > 0.19);
  CHECK(range.far_plane > 0.5);
  const std::array<Vec3, 2> behind{Vec3(0.0, 0.0, -0.2), Vec3(0.0, 0.0, -0.1)};
  CHECK(fit_depth_range(rays.value(), behind).near_plane == 1e-3);
  CHECK(fit_depth_range(rays.value(), behind).far_plane > 1e-3);
}
