#include "app/window/orbit_camera.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "app/view/camera.h"
#include "app/view/frame_step.h"
#include "core/base/units.h"

using namespace burrhole;

namespace {

const Pose kWorld{rotation_from_z({0.48, -0.6, 0.64}), Vec3(0.05, -0.11, 0.2)};

double distance_of(const OrbitCamera& c) {
  const CameraView view = c.camera();
  return glm::length(view.eye - view.target);
}

}  // namespace

TEST_CASE("orbit camera: at the start it sees what a picture of the run sees") {
  const DisplayConfig display;
  const double thickness = 0.006;
  const OrbitCamera camera(kWorld, display.azimuth, display.elevation, display.distance, 0.8 * thickness);
  const CameraView expected = make_frame_view(display, {}, kWorld, thickness, false).camera;
  CHECK(glm::length(camera.camera().eye - expected.eye) < 1e-12);
  CHECK(glm::length(camera.camera().target - expected.target) < 1e-12);
  CHECK(camera.camera().vertical_fov == expected.vertical_fov);
}

TEST_CASE("orbit camera: a turn keeps the distance, a whole turn comes back, and the poles are never reached") {
  OrbitCamera camera(kWorld, 0.3, 0.7, 0.08, 0.005);
  const CameraView start = camera.camera();
  for (int n = 0; n < 8; ++n) camera.turn(45.0 * kDegree, 0.0);
  CHECK(glm::length(camera.camera().eye - start.eye) < 1e-12);
  camera.turn(0.0, 10.0);
  CHECK(distance_of(camera) == doctest::Approx(0.08).epsilon(1e-12));
  const auto rays = make_camera_rays(camera.camera(), 1.5);
  CHECK(rays.ok());
  camera.turn(0.0, -20.0);
  CHECK(make_camera_rays(camera.camera(), 1.5).ok());
  CHECK((kWorld.inverse() * camera.camera().eye).z > (kWorld.inverse() * camera.camera().target).z);
}

TEST_CASE("orbit camera: directions across the bone are those of the picture") {
  OrbitCamera camera(kWorld, 1.1, 0.7, 0.08, 0.005);
  const auto rays = make_camera_rays(camera.camera(), 1.0);
  REQUIRE(rays.ok());
  CHECK(glm::dot(kWorld.rotate(camera.right_across()), glm::normalize(rays->right)) == doctest::Approx(1.0).epsilon(1e-9));
  CHECK(glm::dot(kWorld.rotate(camera.up_across()), glm::normalize(rays->up)) > 0.5);
  // A tenth of the height of the picture at the target's depth: by the rays.
  CHECK(camera.length_of(0.1) == doctest::Approx(0.1 * 2.0 * glm::length(rays->up) * 0.08).epsilon(1e-9));
}

TEST_CASE("orbit camera: surgeon and microscope follow the tip; a trembling tip leaves them still") {
  OrbitCamera camera(kWorld, 0.3, 0.7, 0.08, 0.005);
  for (const CameraMode mode : {CameraMode::surgeon, CameraMode::microscope}) {
    camera.set_mode(mode);
    const Vec3 tip(0.004, -0.002, 0.001);
    for (int n = 0; n < 2000; ++n) camera.follow(tip, 0.005);
    CHECK(glm::length(kWorld.inverse() * camera.camera().target - tip) < 3e-4);
    const CameraView still = camera.camera();
    for (int n = 0; n < 100; ++n) camera.follow(tip + Vec3(1e-5 * (n % 2), 0.0, 0.0), 0.005);
    CHECK(camera.camera() == still);
  }
}

TEST_CASE("orbit camera: values that are no numbers, and endless zoom and pan, leave a usable camera") {
  OrbitCamera camera(kWorld, 0.3, 0.7, 0.08, 0.005);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  camera.turn(nan, 1.0);
  camera.zoom(nan);
  camera.zoom(0.0);
  camera.pan(nan, 0.0);
  camera.follow(Vec3(nan), 0.01);
  for (int n = 0; n < 1000; ++n) camera.zoom(1.5);
  CHECK(make_camera_rays(camera.camera(), 1.5).ok());
  for (int n = 0; n < 1000; ++n) camera.zoom(0.5);
  for (int n = 0; n < 1000; ++n) camera.pan(1.0, -1.0);
  CHECK(make_camera_rays(camera.camera(), 1.5).ok());
  CHECK(distance_of(camera) < 1.0);
  camera.frame();
  CHECK(distance_of(camera) == doctest::Approx(0.08).epsilon(1e-12));
}
