// What the world may get wrong: sizes, maps, cameras, meshes, shader folders.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"

using namespace burrhole;
using namespace burrhole::test;

TEST_CASE("faults: a refused volume leaves the old one in place") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  const auto before = renderer.draw(oblique_view(), 64, 48);
  VolumeView wrong = ball_on_plate();
  wrong.color.pop_back();
  CHECK(renderer.set_volume(wrong).error().code == ErrorCode::bad_input);
  wrong = ball_on_plate();
  wrong.bone_from_index.linear = Mat3(0.0);
  CHECK(renderer.set_volume(wrong).error().code == ErrorCode::bad_input);
  wrong.dims = Vec3i(0, 64, 64);
  CHECK(renderer.set_volume(wrong).error().code == ErrorCode::out_of_range);
  const auto after = renderer.draw(oblique_view(), 64, 48);
  REQUIRE((before.ok() && after.ok()));
  CHECK(before.value().pixels == after.value().pixels);
}

TEST_CASE("faults: sizes, cameras and lights out of range are refused with a reason") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  const auto refused = [&](const FrameView& view, int width, int height) {
    const auto image = renderer.draw(view, width, height);
    return !image.ok() && image.error().code == ErrorCode::out_of_range && !image.error().message.empty();
  };
  CHECK(refused(oblique_view(), 0, 10));
  CHECK(refused(oblique_view(), 10, 1'000'000));
  FrameView view = oblique_view();
  view.camera.vertical_fov = 0.0;
  CHECK(refused(view, 10, 10));
  view = oblique_view();
  view.camera.eye = view.camera.target;
  CHECK(refused(view, 10, 10));
  view = oblique_view();
  view.camera.eye.x = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(view, 10, 10));
  view = oblique_view();
  view.light.direction_to_light = Vec3(0.0);
  CHECK(refused(view, 10, 10));
  view = oblique_view();
  view.cut = FrameView::Cut{Vec3(0.0), 0.0};
  CHECK(refused(view, 10, 10));
  CHECK(renderer.draw(oblique_view(), 10, 10).ok());
}

TEST_CASE("faults: a view from inside the bone and one along `up` are drawn all the same") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  FrameView view = oblique_view();
  view.camera.eye = Vec3(1e-3, 0.0, 2e-3);
  CHECK(renderer.draw(view, 32, 24).ok());
  view.camera = {.eye = {0.0, 0.0, 0.1}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.4};
  CHECK(renderer.draw(view, 32, 24).ok());
}

TEST_CASE("faults: faulty meshes are refused") {
  Renderer renderer = require_renderer();
  TriangleMesh mesh = square(1e-3, 0.0);
  CHECK(renderer.set_tool(mesh).ok());
  mesh.indices.back() = 4;
  CHECK(renderer.set_tool(mesh).error().code == ErrorCode::bad_input);
  mesh = square(1e-3, 0.0);
  mesh.normals.pop_back();
  CHECK(renderer.set_tool(mesh).error().code == ErrorCode::bad_input);
  CHECK(renderer.set_tool({}).error().code == ErrorCode::bad_input);
}

TEST_CASE("faults: options out of range are refused") {
  static_cast<void>(require_renderer());
  CHECK(Renderer::create({.step_voxels = 0.0}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.step_voxels = 1.5}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.supersample = 5}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.bisections = -1}).error().code == ErrorCode::out_of_range);
}

TEST_CASE("faults: a shader folder that is missing or holds a faulty shader is named") {
  static_cast<void>(require_renderer());
  const auto missing = Renderer::create({.shader_folder = "/nonexistent/shaders"});
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().text().find("/nonexistent/shaders") != std::string::npos);

  const std::filesystem::path folder = std::filesystem::path(BH_BINARY_DIR) / "test-shaders-faulty";
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : embedded_shaders())
    std::ofstream(folder / name) << text << (name == "raycast.frag" ? "\nnonsense\n" : "");
  const auto faulty = Renderer::create({.shader_folder = folder});
  REQUIRE_FALSE(faulty.ok());
  CHECK(faulty.error().code == ErrorCode::bad_input);
  CHECK(faulty.error().text().find("raycast.frag") != std::string::npos);
}
