#include "app/window/view_cut.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "app/window/orbit_camera.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

Pose some_pose() { return Pose{glm::angleAxis(0.7, glm::normalize(Vec3(1.0, 2.0, -0.5))), Vec3(0.1, -0.2, 0.05)}; }

TEST_CASE("the opened plane contains the axis, and what is towards the eye is not drawn") {
  const Pose world_from_approach = some_pose();
  for (const double azimuth : {-170.0, -40.0, 0.0, 35.0, 90.0, 179.0}) {
    CAPTURE(azimuth);
    const OrbitCamera camera(world_from_approach, azimuth * kDegree, 40.0 * kDegree, 0.07, 0.005);
    ViewCut cut;
    cut.open_towards(camera.camera(), world_from_approach);
    const FrameView::Cut plane = cut.plane(world_from_approach);
    CHECK(glm::length(plane.normal) == doctest::Approx(1.0).epsilon(1e-12));
    for (const double deep : {0.0, 0.01})  // of the axis
      CHECK(std::abs(glm::dot(plane.normal, world_from_approach * Vec3(0.0, 0.0, -deep)) - plane.offset) < 1e-12);
    CHECK(glm::dot(plane.normal, camera.camera().eye) > plane.offset);
    CHECK(std::abs(cut.azimuth - azimuth * kDegree) < 1e-9);  // the same angle as the camera's
  }
}

TEST_CASE("the plane moves along its normal, within its range") {
  ViewCut cut;
  const Pose world_from_approach = some_pose();
  const double before = cut.plane(world_from_approach).offset;
  cut.move(0.003);
  CHECK(cut.plane(world_from_approach).offset - before == doctest::Approx(0.003).epsilon(1e-9));
  cut.move(1.0);
  CHECK(cut.offset == ViewCut::kFurthest);
  cut.move(-1.0);
  CHECK(cut.offset == -ViewCut::kFurthest);
  cut.move(std::numeric_limits<double>::quiet_NaN());
  cut.turn(std::numeric_limits<double>::infinity());
  CHECK(cut.offset == -ViewCut::kFurthest);
  CHECK(cut.azimuth == 0.0);
}

TEST_CASE("a picture shows its target in the middle, and lengths at the target as the camera says") {
  OrbitCamera orbit(some_pose(), 0.3, 0.6, 0.07, 0.005);
  const CameraView camera = orbit.camera();
  const auto middle = project(camera, camera.target, 900, 600);
  REQUIRE(middle);
  CHECK(middle->x == doctest::Approx(450.0));
  CHECK(middle->y == doctest::Approx(300.0));
  // A length across the view at the target: length_of() gives the metres of a share of the height.
  const Vec3 right = glm::normalize(glm::cross(camera.target - camera.eye, camera.up));
  const auto aside = project(camera, camera.target + orbit.length_of(0.25) * right, 900, 600);
  REQUIRE(aside);
  CHECK(aside->x == doctest::Approx(450.0 + 150.0).epsilon(1e-9));
  CHECK(aside->y == doctest::Approx(300.0).epsilon(1e-9));
  CHECK(project(camera, camera.target + 0.01 * camera.up, 900, 600)->y < 300.0);  // up in the picture
  CHECK_FALSE(project(camera, camera.eye + (camera.eye - camera.target), 900, 600));
}

}  // namespace
}  // namespace burrhole
