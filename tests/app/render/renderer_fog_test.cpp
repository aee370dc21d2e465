// Fog of a microscope: its share at the depth of each pixel, on bone, tool and background.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/render/shader_source.h"
#include "app/view/stereo.h"
#include "tests/app/render/render_scenes.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 160;
constexpr FogView kFog{.depth = 6e-3, .color = {0.1, 0.05, 0.2}};

FrameView tilted_view() {
  FrameView view;
  view.camera = {.eye = {0.03, -0.06, 0.08}, .target = {0.0, 0.0, 5e-3}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.5};
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(-4e-3, 0.0, 14e-3)};
  return view;
}

Vec3 stored(const Rgba8& p) { return Vec3(p.r, p.g, p.b); }

Renderer bone_and_tool(const RenderOptions& options) {
  Renderer renderer = require_renderer(options);
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  REQUIRE(renderer.set_tool(square(4e-3, 0.0)).ok());
  return renderer;
}

}  // namespace

TEST_CASE("fog: bone, tool and background have the share of their depth; with the sign of the depth alone they do not") {
  for (const bool finish : {false, true}) {
    CAPTURE(finish);
    Renderer renderer = bone_and_tool({.finish = finish});
    FrameView view = tilted_view();
    const auto plain = renderer.draw(view, kSize, kSize);
    const auto probe = renderer.probe(view, kSize, kSize);
    view.camera.fog = kFog;
    const auto foggy = renderer.draw(view, kSize, kSize);
    REQUIRE((plain.ok() && probe.ok() && foggy.ok()));
    const double focus = glm::length(view.camera.target - view.camera.eye);
    const double farthest = static_cast<double>(*std::max_element(probe->view_depth.begin(), probe->view_depth.end()));
    int near = 0, far = 0, sharp = 0, background = 0, wrong = 0, wrong_linear = 0;
    for (std::size_t n = 0; n < foggy->pixels.size(); ++n) {
      const Vec3 seen = stored(foggy->pixels[n]);
      const auto off_by = [&](double share) {
        const Vec3 d = glm::abs(seen - glm::mix(stored(plain->pixels[n]), 255.0 * kFog.color, share));
        return std::max({d.x, d.y, d.z});
      };
      const double d = (static_cast<double>(probe->view_depth[n]) - focus) / kFog.depth;
      // The plain pixel and the foggy one are rounded to 8 bits; the depth of the probe's picture is that of the same ray.
      if (static_cast<double>(probe->view_depth[n]) > 0.999 * farthest) {
        ++background;
        wrong += off_by(1.0) > 1.5;
        continue;
      }
      near += d < -0.5;
      far += d > 0.5;
      sharp += std::abs(d) < 0.05;
      wrong += off_by(1.0 - std::exp(-d * d)) > 1.5;
      wrong_linear += off_by(std::min(std::abs(d), 1.0)) > 1.5;
    }
    CHECK(near > 200);
    CHECK(far > 200);
    CHECK(sharp > 100);
    CHECK(background > 1'000);
    CHECK(wrong == 0);
    CHECK(wrong_linear > 500);
  }
}

TEST_CASE("fog: slices and translucent bone have it, in the plane of focus nothing changes") {
  for (const bool slices : {true, false}) {
    CAPTURE(slices);
    RenderOptions options{.finish = false};
    if (slices)
      options.slices = SliceOptions{};
    else
      options.translucent = TransferFunction{{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 2e4}};
    Renderer renderer = bone_and_tool(options);
    FrameView view = tilted_view();
    view.world_from_tool.reset();
    const auto plain = renderer.draw(view, kSize, kSize);
    view.camera.fog = FogView{.depth = 10.0, .color = kFog.color};  // so deep that it has a share of 4e-6 here
    const auto thin = renderer.draw(view, kSize, kSize);
    view.camera.fog = FogView{.depth = 1e-4, .color = kFog.color};
    view.camera.target = view.camera.eye + 0.5 * (view.camera.target - view.camera.eye);  // all bone lies far beyond
    const auto thick = renderer.draw(view, kSize, kSize);
    REQUIRE((plain.ok() && thin.ok() && thick.ok()));
    int bone = 0, changed = 0, clear = 0;
    for (std::size_t n = 0; n < plain->pixels.size(); ++n) {
      clear += glm::length(stored(thick->pixels[n]) - 255.0 * kFog.color) > 2.0;
      if (stored(thin->pixels[n]) == 255.0 * kFog.color) continue;
      // Off the bone the background is that of the fog. Slices are blended over it.
      if (glm::length(stored(plain->pixels[n]) - stored(thin->pixels[n])) < 3.0) ++bone;
      changed += glm::length(stored(plain->pixels[n]) - stored(thin->pixels[n])) >= 3.0;
    }
    CHECK(bone > 3'000);
    CHECK(clear == 0);
  }
}

TEST_CASE("fog: without it nothing of it is in a shader, and both eyes have the plane of the camera's target") {
  for (const ShaderVariant& variant : all_shader_variants()) {
    const std::string text = expand_shader(embedded_shaders(), variant.fragment, variant.defines).value();
    const bool is_foggy = variant.name.find("_fog") != std::string::npos;
    CHECK_MESSAGE((text.find("fogged(") != std::string::npos || text.find("return fog.rgb") != std::string::npos) == is_foggy,
                  variant.name);
  }
  CameraView camera = tilted_view().camera;
  camera.fog = kFog;
  const double focus = glm::length(camera.target - camera.eye);
  for (const bool bench : {false, true}) {
    StereoView stereo{.mode = StereoMode::side_by_side, .separation = 5e-3, .screen = 0.1};
    if (bench) stereo.workbench = WorkbenchView{.height = 0.3, .head = {0.0, 0.0, focus}};
    const auto eyes = make_eye_cameras(camera, stereo, 1.0);
    REQUIRE(eyes.ok());
    REQUIRE(eyes->size() == 2);
    for (const CameraView& eye : *eyes) {
      CHECK(eye.fog == camera.fog);
      CHECK(std::abs(glm::dot(camera.target - eye.eye, glm::normalize(eye.target - eye.eye)) - focus) < 1e-9);
    }
  }
  FrameView view = tilted_view();
  view.camera.fog = FogView{.depth = 0.0};
  Renderer renderer = bone_and_tool({});
  const auto refused = renderer.draw(view, kSize, kSize);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().text().find("depth of fog") != std::string::npos);
}
