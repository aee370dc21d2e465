// What a person sees while the view moves, beside the picture at rest.
#include <doctest/doctest.h>

#include <optional>

#include "app/lab/image_metrics.h"
#include "app/render/renderer.h"
#include "app/view/display_config.h"
#include "app/view/frame_step.h"
#include "app/view/texels.h"
#include "app/window/viewer.h"
#include "tests/support/drill_scene.h"
#include "tests/support/source_folder.h"

namespace burrhole {
namespace {

constexpr int kWindow = 1280, kHeight = 800;

/// The shipped scene before its first cut.
struct Shown {
  Shown() {
    const auto document = TomlDocument::load(test::in_source("app/scenes/parietal.toml"));
    REQUIRE(document);
    Issues issues;
    auto loaded = load_scene(*document, test::test_context(), issues);
    REQUIRE(loaded);
    run.emplace(std::move(*loaded));
    const Scene& scene = run->loaded().scene;
    display = *scene.find<DisplayConfig>();
    view = make_frame_view(display, scene.volume.world_from_bone, run->simulation().stage().world_from_approach(),
                           run->simulation().approach().thickness, false);
    view.world_from_tool = run->simulation().contact_state().world_from_tool;
  }
  /// @returns a renderer with bone and tool. Exits where there is no OpenGL.
  [[nodiscard]] Renderer renderer(const Appearance& appearance) {
    auto made = Renderer::create(make_render_options(display.quality, appearance));
    if (!made) {
      MESSAGE("skipped: " << made.error().text());
      std::exit(77);
    }
    REQUIRE(made->set_volume(make_volume_view(run->simulation().voxmap())).ok());
    REQUIRE(made->set_tool(run->loaded().tool.look).ok());
    return std::move(*made);
  }
  std::optional<test::DrillRun> run;
  DisplayConfig display;
  FrameView view;
};

TEST_CASE("a moving view of the shipped scene has 640 x 400 rays and 30 dB against the picture at rest") {
  const int width = kWindow - panel_width(kWindow, 1.0f);
  Shown shown;
  Renderer renderer = shown.renderer(shown.display.appearance);
  FrameView& view = shown.view;
  const auto rest = renderer.draw(view, width, kHeight);
  REQUIRE(rest.ok());
  // As the viewer does: one ray a pixel, and a pace that no machine keeps, so that the picture is the coarsest.
  DrawingQuality moving = shown.display.quality;
  moving.supersample = 1;
  REQUIRE(renderer.set_quality(moving).ok());
  DynamicResolution pace(1e-9, ViewerConfig{}.coarsest);
  const std::uint64_t before = renderer.counters().drawn_pixels;
  const auto coarse = renderer.draw_at_pace(view, width, kHeight, pace);
  REQUIRE(coarse.ok());
  CHECK(renderer.counters().drawn_pixels - before >= 640u * 400u);
  const double decibel = psnr(*coarse, *rest);
  MESSAGE(decibel << " dB");
  CHECK(decibel >= 30.0);
  // The sabotage: half of that resolution would be noticed.
  DynamicResolution coarser(1e-9, 0.25);
  view.camera.eye.x += 1e-9;
  const auto blurred = renderer.draw_at_pace(view, width, kHeight, coarser);
  REQUIRE(blurred.ok());
  CHECK(psnr(*blurred, *rest) < decibel);
}

TEST_CASE("shadows and highlights that are changed while pictures are drawn give the pictures of a renderer that was made with them") {
  constexpr int kWide = 320, kHigh = 200;
  Shown shown;
  Renderer renderer = shown.renderer(shown.display.appearance);
  const auto plain = renderer.draw(shown.view, kWide, kHigh);
  REQUIRE(plain.ok());
  for (const SurfaceLights& lights : {SurfaceLights{true, false}, SurfaceLights{false, true}, SurfaceLights{true, true}}) {
    CAPTURE(lights.shadow);
    CAPTURE(lights.specular);
    renderer.set_lights(lights);
    const auto drawn = renderer.draw(shown.view, kWide, kHigh);
    REQUIRE(drawn.ok());
    Appearance appearance = shown.display.appearance;
    appearance.shadow = lights.shadow;
    appearance.specular = lights.specular;
    const auto wanted = shown.renderer(appearance).draw(shown.view, kWide, kHigh);
    REQUIRE(wanted.ok());
    CHECK(drawn->pixels == wanted->pixels);
    CHECK(drawn->pixels != plain->pixels);
  }
  renderer.set_lights({});
  const auto again = renderer.draw(shown.view, kWide, kHigh);
  REQUIRE(again.ok());
  CHECK(again->pixels == plain->pixels);
}

}  // namespace
}  // namespace burrhole
