// What a person sees while the view moves, beside the picture at rest.
#include <doctest/doctest.h>

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

TEST_CASE("a moving view of the shipped scene has 640 x 400 rays and 30 dB against the picture at rest") {
  constexpr int kWindow = 1280, kHeight = 800;
  const int width = kWindow - panel_width(kWindow, 1.0f);
  const auto document = TomlDocument::load(test::in_source("app/scenes/parietal.toml"));
  REQUIRE(document);
  Issues issues;
  auto loaded = load_scene(*document, test::test_context(), issues);
  REQUIRE(loaded);
  test::DrillRun run(std::move(*loaded));
  const Scene& scene = run.loaded().scene;
  const DisplayConfig& display = *scene.find<DisplayConfig>();
  Simulation& simulation = run.simulation();
  auto made = Renderer::create(make_render_options(display.quality, display.appearance));
  if (!made) {
    MESSAGE("skipped: " << made.error().text());
    std::exit(77);
  }
  Renderer& renderer = *made;
  REQUIRE(renderer.set_volume(make_volume_view(simulation.voxmap())).ok());
  REQUIRE(renderer.set_tool(run.loaded().tool.look).ok());
  FrameView view = make_frame_view(display, scene.volume.world_from_bone, simulation.stage().world_from_approach(),
                                   simulation.approach().thickness, false);
  view.world_from_tool = simulation.contact_state().world_from_tool;
  const auto rest = renderer.draw(view, width, kHeight);
  REQUIRE(rest.ok());
  // As the viewer does: one ray a pixel, and a pace that no machine keeps, so that the picture is the coarsest.
  DrawingQuality moving = display.quality;
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

}  // namespace
}  // namespace burrhole
