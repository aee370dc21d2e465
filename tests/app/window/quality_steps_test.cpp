#include "app/window/quality_steps.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace burrhole;

namespace {

Image grey(int width, int height, std::uint8_t value) {
  return {width, height, std::vector<Rgba8>(static_cast<std::size_t>(width * height), Rgba8{value, value, value, 255})};
}

}  // namespace

TEST_CASE("quality: steps along the Pareto front end at its ends, and errors are those of its points") {
  for (const bool translucent : {false, true}) {
    const auto front = shipped_front(translucent);
    DrawingQuality quality = front.front().quality;
    CHECK(next_quality(front, quality, false) == quality);
    for (std::size_t n = 0; n < front.size(); ++n) {
      CHECK(known_psnr(front, quality) == front[n].psnr_db);
      const DrawingQuality finer = next_quality(front, quality, true);
      if (n + 1 < front.size()) CHECK(next_quality(front, finer, false) == quality);
      if (n + 1 == front.size()) CHECK(finer == quality);
      quality = finer;
    }
  }
}

TEST_CASE("quality: beside the Pareto front nothing is known, and a step goes to the nearest point with more or fewer rays") {
  const std::array front{QualityPoint{{1, 0, true, 1, 0.5}, 1.0, 30.0}, QualityPoint{{1, 0, true, 1, 1}, 4.0, 35.0},
                         QualityPoint{{1, 0, true, 2, 1}, 16.0, 40.0}};
  const DrawingQuality beside{0.3, 2, false, 1, 1};
  CHECK_FALSE(known_psnr(front, beside).has_value());
  CHECK(next_quality(front, beside, true) == front[2].quality);
  CHECK(next_quality(front, beside, false) == front[0].quality);
  CHECK(next_quality(front, {0.3, 2, true, 4, 1}, true) == front[2].quality);
  CHECK(next_quality(front, {0.3, 2, true, 1, 0.25}, false) == front[0].quality);
  CHECK(next_quality({}, beside, true) == beside);
}

TEST_CASE("quality: the error of a picture is its closed form") {
  const Image a = grey(7, 5, 100);
  for (const int by : {1, 10, 100})
    CHECK(*psnr_of(a, grey(7, 5, static_cast<std::uint8_t>(100 + by))) == doctest::Approx(20.0 * std::log10(255.0 / by)).epsilon(1e-12));
  Image one = a;
  one.pixels[3].g = 110;  // one of 105 values differs by 10
  CHECK(*psnr_of(one, a) == doctest::Approx(10.0 * std::log10(255.0 * 255.0 * 105.0 / 100.0)).epsilon(1e-12));
  CHECK_FALSE(psnr_of(a, a).has_value());
  CHECK_FALSE(psnr_of(a, grey(5, 7, 100)).has_value());
  CHECK_FALSE(psnr_of({}, {}).has_value());
}

TEST_CASE("quality: what shadows and highlights cost and change is stated as it was measured") {
  CHECK(lights_text({}).find("are measured when one is changed") != std::string::npos);
  const std::string more = lights_text(LightsChange{123.4, 31.25});
  CHECK(more.find("+123 ms") != std::string::npos);
  CHECK(more.find("31.2 dB") != std::string::npos);
  CHECK(lights_text(LightsChange{-80.0, 31.0}).find("-80 ms") != std::string::npos);
  CHECK(lights_text(LightsChange{1.0, {}}).find("no pixel differs") != std::string::npos);
}
