// Resolution while the camera moves, against pictures of known cost.
#include "app/render/dynamic_resolution.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A machine on which a picture takes `fixed` + `full` x pixels.
struct Machine {
  double fixed, full;
  [[nodiscard]] double time(double resolution) const { return fixed + full * resolution * resolution; }
};

}  // namespace

TEST_CASE("pace: the rate is held from the second picture on, with the finest step that fits") {
  for (const double full : {0.004, 0.02, 0.05, 0.1, 0.4}) {
    const Machine machine{0.0, full};
    DynamicResolution pace(1.0 / 30.0);
    CHECK(pace.resolution() == DynamicResolution::kCoarsest);
    for (int picture = 0; picture < 20; ++picture) {
      const double resolution = pace.resolution();
      pace.record(resolution, machine.time(resolution));
      const double next = pace.resolution();
      const bool fits = machine.time(next) <= pace.budget() * (1.0 + 1e-9);
      CHECK((fits || next == DynamicResolution::kCoarsest));
      if (next < 1.0) CHECK(machine.time(next + DynamicResolution::kStep) > pace.budget());
    }
  }
}

TEST_CASE("pace: a part of the time that does not shrink with the pixels makes it coarser, never too slow") {
  const Machine machine{0.01, 0.05};
  DynamicResolution pace(1.0 / 30.0);
  for (int picture = 0; picture < 40; ++picture) {
    const double resolution = pace.resolution();
    if (picture > 0) CHECK(machine.time(resolution) <= pace.budget());
    pace.record(resolution, machine.time(resolution));
  }
  CHECK(pace.resolution() >= 0.5);  // 0.683 would fit
}

TEST_CASE("pace: a picture that suddenly takes three times as long is followed at once, one that is quicker again within a few") {
  DynamicResolution pace(0.02);
  const Machine light{0.0, 0.02}, heavy{0.0, 0.06};
  for (int n = 0; n < 10; ++n) pace.record(pace.resolution(), light.time(pace.resolution()));
  CHECK(pace.resolution() == 1.0);
  pace.record(1.0, heavy.time(1.0));
  CHECK(heavy.time(pace.resolution()) <= pace.budget());
  int pictures = 0;
  while (pace.resolution() < 0.875 && pictures < 100) {
    pace.record(pace.resolution(), light.time(pace.resolution()));
    ++pictures;
  }
  CHECK(pictures <= 5);
}

TEST_CASE("pace: a moving camera draws fewer pixels than asked, a resting one every one of them, the same bytes as ever") {
  constexpr int kWidth = 160, kHeight = 120;
  Renderer paced = require_renderer(), plain = require_renderer();
  for (Renderer* renderer : {&paced, &plain}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  DynamicResolution hopeless(1e-9), generous(1e3);  // whatever the machine: never met, always met
  FrameView view = oblique_view();
  const auto pixels = [&](DynamicResolution& pace) {
    const std::uint64_t before = paced.counters().drawn_pixels;
    const auto image = paced.draw_at_pace(view, kWidth, kHeight, pace);
    REQUIRE(image.ok());
    CHECK(image->width == kWidth);
    CHECK(image->height == kHeight);
    return paced.counters().drawn_pixels - before;
  };
  for (int n = 0; n < 3; ++n) {
    view.camera.eye.x += 1e-3;
    CHECK(pixels(hopeless) == kWidth * kHeight / 16);
  }
  CHECK(pixels(hopeless) == kWidth * kHeight);  // at rest it refines
  CHECK(pixels(hopeless) == 0);                 // and is kept
  const auto still = paced.draw_at_pace(view, kWidth, kHeight, hopeless), expected = plain.draw(view, kWidth, kHeight);
  REQUIRE((still.ok() && expected.ok()));
  CHECK(pictures_agree("pace-still", *still, *expected, {}));
  view.camera.eye.x += 1e-3;
  CHECK(pixels(generous) == kWidth * kHeight / 16);  // nothing is known of the time yet
  view.camera.eye.x += 1e-3;
  CHECK(pixels(generous) == kWidth * kHeight);
}
