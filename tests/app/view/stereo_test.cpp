// Two eyes: parallax by its closed form, a screen in space by its corners, pictures joined.
#include "app/view/stereo.h"

#include <doctest/doctest.h>

#include <cmath>

#include "app/view/camera.h"

using namespace burrhole;

namespace {

const CameraView kCamera{.eye = {0.05, -0.09, 0.07}, .target = {0.01, 0.0, 0.0}, .up = {0.1, 0.2, 1.0}, .vertical_fov = 0.7};
constexpr double kAspect = 1.4;

/// Normalised device coordinates of a world point.
glm::dvec2 seen(const CameraView& camera, double aspect, const Vec3& p) {
  const auto rays = make_camera_rays(camera, aspect);
  REQUIRE(rays.ok());
  const glm::dvec4 c = clip_from_world(*rays, {0.01, 10.0}) * glm::dvec4(p, 1.0);
  return glm::dvec2(c) / c.w;
}

}  // namespace

TEST_CASE("stereo: an off-axis projection and its rays agree") {
  CameraView camera = kCamera;
  camera.shift = {0.3, -0.2};
  const auto rays = make_camera_rays(camera, kAspect);
  REQUIRE(rays.ok());
  const DepthRange range{0.02, 0.3};
  const glm::dmat4 clip = clip_from_world(*rays, range);
  for (const double x : {-0.9, 0.0, 0.4})
    for (const double y : {-0.3, 0.8})
      for (const double t : {0.02, 0.11, 0.3}) {
        const glm::dvec4 c = clip * glm::dvec4(rays->eye + t * rays->direction(x, y), 1.0);
        CHECK(c.x / c.w == doctest::Approx(x).epsilon(1e-9).scale(1.0));
        CHECK(c.y / c.w == doctest::Approx(y).epsilon(1e-9).scale(1.0));
        CHECK(0.5 * c.z / c.w + 0.5 == doctest::Approx(range.depth_of(t)).epsilon(1e-9).scale(1.0));
      }
}

TEST_CASE("stereo: no parallax on the screen's plane, the closed form elsewhere, none up and down") {
  const StereoView stereo{.mode = StereoMode::side_by_side, .separation = 4e-3, .screen = 0.12};
  const auto eyes = make_stereo_cameras(kCamera, stereo, kAspect);
  const auto rays = make_camera_rays(kCamera, kAspect);
  REQUIRE((eyes.ok() && rays.ok()));
  for (const double x : {-0.5, 0.0, 0.7})
    for (const double y : {-0.6, 0.3})
      for (const double z : {0.05, 0.12, 0.4}) {
        const Vec3 p = rays->eye + z * rays->direction(x, y);
        const glm::dvec2 left = seen((*eyes)[0], kAspect, p), right = seen((*eyes)[1], kAspect, p);
        const double parallax = stereo.separation * (1.0 / stereo.screen - 1.0 / z) / (std::tan(0.35) * kAspect);
        CHECK(std::abs(right.x - left.x - parallax) < 1e-9);
        CHECK(std::abs(right.y - left.y) < 1e-9);
        if (z == stereo.screen) CHECK(std::abs(right.x - left.x) < 1e-9);
        CHECK(std::abs(0.5 * (left.x + right.x) - x) < 1e-9);
      }
}

TEST_CASE("stereo: eyes that are toed in would show parallax up and down, and the check would see it") {
  const Vec3 side = glm::normalize(make_camera_rays(kCamera, kAspect)->right);
  CameraView left = kCamera, right = kCamera;
  left.eye -= 2e-3 * side;
  right.eye += 2e-3 * side;
  const auto rays = make_camera_rays(kCamera, kAspect);
  const Vec3 p = rays->eye + 0.05 * rays->direction(0.7, 0.6);
  CHECK(std::abs(seen(left, kAspect, p).y - seen(right, kAspect, p).y) > 1e-3);
}

TEST_CASE("stereo: eyes and screens that cannot be are refused") {
  CHECK_FALSE(make_stereo_cameras(kCamera, {.separation = -1e-3, .screen = 0.1}, kAspect).ok());
  CHECK_FALSE(make_stereo_cameras(kCamera, {.separation = 1e-3, .screen = 0.0}, kAspect).ok());
  CHECK_FALSE(make_stereo_cameras(kCamera, {.separation = std::nan(""), .screen = 0.1}, kAspect).ok());
  CHECK_FALSE(make_screen_camera({0.0, 0.0, -0.1}, {.world_from_screen = {}, .width = 0.4, .height = 0.3}).ok());
  CHECK_FALSE(make_screen_camera({0.0, 0.0, 0.1}, {.world_from_screen = {}, .width = 0.4, .height = 0.0}).ok());
  CHECK_FALSE(make_screen_camera({std::nan(""), 0.0, 0.1}, {.world_from_screen = {}, .width = 0.4, .height = 0.3}).ok());
}

TEST_CASE("workbench: the screen's corners are the picture's, wherever head and screen are") {
  const ScreenView screen{
      .world_from_screen = {glm::angleAxis(0.8, glm::normalize(Vec3(1.0, 0.3, -0.2))), {0.1, -0.2, 0.05}}, .width = 0.4, .height = 0.25};
  for (const Vec3& head : {Vec3(0.0, 0.0, 0.5), Vec3(0.15, -0.3, 0.4), Vec3(-0.5, 0.2, 0.2)}) {
    const Pose world_from_head = screen.world_from_screen * Pose{glm::angleAxis(0.3, glm::normalize(Vec3(0.2, 1.0, 0.5))), head};
    const auto eyes = make_workbench_cameras(world_from_head, 0.063, screen);
    REQUIRE(eyes.ok());
    CHECK(glm::length((*eyes)[1].eye - (*eyes)[0].eye) == doctest::Approx(0.063));
    for (const CameraView& eye : *eyes)
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
          const Vec3 corner = screen.world_from_screen * Vec3(0.5 * x * screen.width, 0.5 * y * screen.height, 0.0);
          const glm::dvec2 at = seen(eye, screen.width / screen.height, corner);
          CHECK(std::abs(at.x - x) < 1e-9);
          CHECK(std::abs(at.y - y) < 1e-9);
        }
  }
}

TEST_CASE("workbench: bone on the screen's plane has its true size and place in both pictures, for any head and camera distance") {
  const double aspect = 1.5, height = 0.3;
  for (const double distance : {0.07, 0.4}) {
    const Vec3 towards = glm::normalize(Vec3(0.3, -0.6, 0.7));
    const CameraView camera{.eye = Vec3(0.01, 0.02, 0.0) + distance * towards, .target = {0.01, 0.02, 0.0}};
    const Vec3 right = glm::normalize(glm::cross(-towards, camera.up)), up = glm::cross(right, -towards);
    for (const Vec3& head : {Vec3(0.0, 0.0, 0.5), Vec3(0.2, 0.3, 0.4)}) {
      const StereoView stereo{.mode = StereoMode::side_by_side, .separation = 0.06, .workbench = WorkbenchView{height, head}};
      const auto eyes = make_eye_cameras(camera, stereo, aspect);
      REQUIRE(eyes.ok());
      REQUIRE(eyes->size() == 2);
      const auto one = make_eye_cameras(camera, {.workbench = stereo.workbench}, aspect);
      REQUIRE(one.ok());
      REQUIRE(one->size() == 1);
      CHECK(glm::length(0.5 * ((*eyes)[0].eye + (*eyes)[1].eye) - one->front().eye) < 1e-12);
      for (const CameraView& eye : {(*eyes)[0], (*eyes)[1], one->front()}) {
        const glm::dvec2 middle = seen(eye, aspect, camera.target);
        CHECK(std::abs(middle.x) < 1e-9);
        CHECK(std::abs(middle.y) < 1e-9);
        // 40 mm are 40 mm of the screen, whose half width and height are 1 in the picture.
        CHECK(seen(eye, aspect, camera.target + 0.04 * right).x == doctest::Approx(0.04 / (0.5 * aspect * height)).epsilon(1e-9));
        CHECK(seen(eye, aspect, camera.target + 0.04 * up).y == doctest::Approx(0.04 / (0.5 * height)).epsilon(1e-9));
      }
      // Before the screen a point lies further right for the left eye; the sabotage: a camera that ignores the head would show none.
      const Vec3 near = camera.target + 0.05 * towards;
      CHECK(seen((*eyes)[0], aspect, near).x > seen((*eyes)[1], aspect, near).x + 0.01);
    }
  }
  CHECK(make_eye_cameras({}, {}, aspect)->size() == 1);
  CHECK(make_eye_cameras({}, {}, aspect)->front() == CameraView{});
  CHECK_FALSE(make_eye_cameras({}, {.workbench = WorkbenchView{0.3, {0.0, 0.0, -0.1}}}, aspect).ok());
}

TEST_CASE("workbench: for a mirror each eye's picture is upside down") {
  const Rgba8 a{1, 1, 1, 255}, b{2, 2, 2, 255}, c{3, 3, 3, 255}, d{4, 4, 4, 255};
  const Image left{1, 2, {a, b}}, right{1, 2, {c, d}};
  const WorkbenchView mirror{0.3, {0.0, 0.0, 0.5}, true};
  CHECK(make_screen_picture({.workbench = mirror}, {left}).pixels == std::vector<Rgba8>{b, a});
  CHECK(make_screen_picture({.mode = StereoMode::side_by_side, .workbench = mirror}, {left, right}).pixels ==
        std::vector<Rgba8>{b, d, a, c});
  CHECK(make_screen_picture({.mode = StereoMode::top_bottom, .workbench = mirror}, {left, right}).pixels == std::vector<Rgba8>{b, a, d, c});
  CHECK(make_screen_picture({.mode = StereoMode::top_bottom}, {left, right}).pixels == std::vector<Rgba8>{a, b, c, d});
}

TEST_CASE("stereo: each mode has a word of its own") {
  for (const StereoMode mode : {StereoMode::off, StereoMode::side_by_side, StereoMode::top_bottom, StereoMode::anaglyph, StereoMode::quad})
    CHECK(stereo_mode(stereo_name(mode)) == mode);
  CHECK(stereo_mode("no mode") == StereoMode::off);
}

TEST_CASE("stereo: with a buffer for each eye the pictures are those that side by side joins, in the same order") {
  const Rgba8 a{1, 1, 1, 255}, b{2, 2, 2, 255}, c{3, 3, 3, 255}, d{4, 4, 4, 255};
  const Image left{1, 2, {a, b}}, right{1, 2, {c, d}};
  for (const bool mirrored : {false, true}) {
    StereoView stereo{.mode = StereoMode::quad, .separation = 4e-3, .screen = 0.12};
    if (mirrored) stereo.workbench = WorkbenchView{0.3, {0.0, 0.0, 0.5}, true};
    const auto quad = make_buffer_pictures(stereo, {left, right});
    const auto cameras = make_eye_cameras({}, stereo, 1.25);
    stereo.mode = StereoMode::side_by_side;
    const auto beside = make_buffer_pictures(stereo, {left, right});
    REQUIRE(quad.size() == 2);
    REQUIRE(beside.size() == 1);
    CHECK(join_eyes(StereoMode::side_by_side, quad[0], quad[1]).pixels == beside[0].pixels);
    REQUIRE(cameras.ok());
    CHECK(*cameras == *make_eye_cameras({}, stereo, 1.25));
  }
  CHECK(make_buffer_pictures({}, {left}).size() == 1);
}

TEST_CASE("stereo: pictures are joined side by side, one over the other, or by colour") {
  Image left{2, 1, {{200, 100, 50, 255}, {1, 2, 3, 255}}}, right{2, 1, {{10, 20, 30, 255}, {4, 5, 6, 255}}};
  const Image beside = join_eyes(StereoMode::side_by_side, left, right);
  CHECK((beside.width == 4 && beside.height == 1));
  CHECK(beside.pixels == std::vector<Rgba8>{left.pixels[0], left.pixels[1], right.pixels[0], right.pixels[1]});
  const Image stacked = join_eyes(StereoMode::top_bottom, left, right);
  CHECK((stacked.width == 2 && stacked.height == 2));
  CHECK(stacked.pixels == beside.pixels);
  const Image anaglyph = join_eyes(StereoMode::anaglyph, left, right);
  CHECK(anaglyph.pixels[0] == Rgba8{124, 20, 30, 255});  // 0.299 200 + 0.587 100 + 0.114 50 = 124.2
  CHECK(anaglyph.pixels[1] == Rgba8{2, 5, 6, 255});
}
