// Which knobs a budget buys: a pure choice from a front and the time of its first point.
#include "app/view/quality.h"

#include <doctest/doctest.h>

#include <array>

using namespace burrhole;

namespace {

const std::array kFront{QualityPoint{{.step_voxels = 1.0, .resolution = 0.5}, 1.0, 28.0}, QualityPoint{{.step_voxels = 1.0}, 4.0, 33.0},
                        QualityPoint{{.supersample = 2}, 16.0, 40.0}};

}  // namespace

TEST_CASE("quality: the most accurate point within the budget, by the time of the first") {
  const double first = 2e-3;
  CHECK(choose_quality(kFront, first, 100e-3).quality == kFront[2].quality);
  CHECK(choose_quality(kFront, first, 32e-3).quality == kFront[2].quality);  // just met
  CHECK(choose_quality(kFront, first, 31.9e-3).quality == kFront[1].quality);
  CHECK(choose_quality(kFront, first, 3e-3).quality == kFront[0].quality);
  const QualityChoice choice = choose_quality(kFront, first, 10e-3);
  CHECK(choice.met);
  CHECK(choice.expected == doctest::Approx(8e-3));
  // A machine four times as fast draws the next better point within the same budget.
  CHECK(choose_quality(kFront, first / 4.0, 10e-3).quality == kFront[2].quality);
}

TEST_CASE("quality: a budget that nothing meets gets the cheapest point, and that is reported") {
  const QualityChoice choice = choose_quality(kFront, 2e-3, 1e-3);
  CHECK_FALSE(choice.met);
  CHECK(choice.quality == kFront[0].quality);
  CHECK(choice.expected == doctest::Approx(2e-3));
}

TEST_CASE("quality: what is chosen never exceeds a budget that can be met, and is never worse with a larger one") {
  for (const bool translucent : {false, true}) {
    const auto front = shipped_front(translucent);
    double last = 0.0;
    for (double budget = 1e-3; budget < 1.0; budget *= 1.1) {
      const QualityChoice choice = choose_quality(front, 1e-3, budget);
      REQUIRE(choice.expected <= budget);
      for (const QualityPoint& point : front)
        if (point.quality == choice.quality) {
          CHECK(point.psnr_db >= last);
          last = point.psnr_db;
        }
    }
    CHECK(last == front.back().psnr_db);  // a second is enough for the best there is
  }
}

TEST_CASE("quality: the shipped Pareto fronts begin with what costs one, and each next point costs more and is more accurate") {
  for (const bool translucent : {false, true}) {
    const auto front = shipped_front(translucent);
    REQUIRE(front.size() >= 4);
    CHECK(front.front().cost == 1.0);
    for (std::size_t n = 1; n < front.size(); ++n) {
      CHECK(front[n].cost > front[n - 1].cost);
      CHECK(front[n].psnr_db > front[n - 1].psnr_db);
      CHECK((front[n].quality.resolution >= 0.25 && front[n].quality.resolution <= 1.0));
      CHECK((front[n].quality.supersample >= 1 && front[n].quality.supersample <= 4));
    }
  }
}

TEST_CASE("quality: a set of knobs as a line for people") {
  CHECK(quality_text({}, false) == "step 0.5 voxel, 5 bisections, finish, 1 x 1 rays a pixel, resolution 1");
  CHECK(quality_text({.step_voxels = 1.0, .resolution = 0.5}, true) == "step 1 voxel, 1 x 1 rays a pixel, resolution 0.5");
}
