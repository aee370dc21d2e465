// What the world may get wrong: sizes, maps, cameras, meshes, shader folders.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

TEST_CASE("errors: a refused volume leaves the old one in place") {
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

TEST_CASE("errors: sizes, cameras and lights out of range are refused with a reason") {
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

TEST_CASE("errors: a view from inside the bone and one along `up` are drawn all the same") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  FrameView view = oblique_view();
  view.camera.eye = Vec3(1e-3, 0.0, 2e-3);
  CHECK(renderer.draw(view, 32, 24).ok());
  view.camera = {.eye = {0.0, 0.0, 0.1}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.4};
  CHECK(renderer.draw(view, 32, 24).ok());
}

TEST_CASE("errors: faulty meshes are refused") {
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

TEST_CASE("errors: options out of range are refused") {
  static_cast<void>(require_renderer());
  CHECK(Renderer::create({.step_voxels = 0.0}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.step_voxels = 1.5}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.supersample = 5}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.resolution = 0.2}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.bisections = -1}).error().code == ErrorCode::out_of_range);
}

TEST_CASE("errors: a shader folder that is missing or holds a faulty shader is named") {
  static_cast<void>(require_renderer());
  const auto missing = Renderer::create({.shader_folder = "/nonexistent/shaders"});
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.error().text().find("/nonexistent/shaders") != std::string::npos);

  const TemporaryFolder written;
  const std::filesystem::path& folder = written.path();
  for (const auto& [name, text] : embedded_shaders())
    std::ofstream(folder / name) << text << (name == "raycast.frag" ? "\nnonsense;\n" : "");
  const auto faulty = Renderer::create({.shader_folder = folder});
  REQUIRE_FALSE(faulty.ok());
  CHECK(faulty.error().code == ErrorCode::bad_input);
  const auto line = std::ranges::count(embedded_shaders().find("raycast.frag")->second, '\n') + 2;
  const std::string place = (folder / "raycast.frag").string() + ":" + std::to_string(line) + ":";
  CHECK_MESSAGE(faulty.error().text().starts_with(place), faulty.error().text());
  CHECK(faulty.error().text().find('\n') == std::string::npos);

  // In a file that another one includes it is that file's own line.
  for (const auto& [name, text] : embedded_shaders()) std::ofstream(folder / name) << (name == "shade.glsl" ? "\nnonsense;\n" : "") << text;
  const auto included = Renderer::create({.shader_folder = folder});
  REQUIRE_FALSE(included.ok());
  CHECK_MESSAGE(included.error().text().starts_with((folder / "shade.glsl").string() + ":2:"), included.error().text());
}

TEST_CASE("errors: a volume larger than the driver draws is reported the size that would fit, and that size does") {
  Renderer renderer = require_renderer();
  const auto stick = [](const Vec3i& dims) {
    VolumeView view;
    view.dims = dims;
    view.bone_from_index = half_millimetre_cube();
    view.normal_opacity.assign(VoxelBox{Vec3i(0), dims}.count(), Rgba8{128, 128, 255, 255});
    view.color.assign(view.normal_opacity.size(), Rgba8{200, 200, 200, 0});
    return view;
  };
  const Status refused = renderer.set_volume(stick({2, 1 << 20, 1}));  // no driver has textures a million texels long
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == ErrorCode::out_of_range);
  const std::string text = refused.error().text();
  CHECK(text.find("2 x 1048576 x 1 voxels is more than this driver draws") != std::string::npos);
  const std::size_t from = text.find(": 1 x ");
  REQUIRE_MESSAGE(from != std::string::npos, text);
  const int fits = std::stoi(text.substr(from + 6));
  CHECK(fits >= 2048);  // what OpenGL 4.5 asks of every driver
  CHECK(renderer.set_volume(stick({1, fits, 1})).ok());
  CHECK_FALSE(renderer.set_volume(stick({1, fits + 1, 1})).ok());
  CHECK(renderer.set_volume(stick({0, 4, 4})).error().text().find("it is empty") != std::string::npos);
}

TEST_CASE("errors: floats of another count than the texels are refused") {
  Renderer renderer = require_renderer();
  VolumeView wrong = ball_on_plate();
  wrong.precise.normal_opacity.resize(3);
  CHECK(renderer.set_volume(wrong).error().code == ErrorCode::bad_input);
}
