#include "app/report/map_plot.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace burrhole;

namespace {

ValueMap small() {
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  return {.title = "Temperature",
          .caption = "",
          .x_label = "Distance (mm)",
          .y_label = "Depth (mm)",
          .unit = "Temperature (°C)",
          .x = -1.0,
          .y = 0.0,
          .pitch = 0.5,
          .columns = 3,
          .rows = 2,
          .values = {37.0f, nothing, 38.5f, 40.0f, 41.0f, 42.0f}};
}

}  // namespace

TEST_CASE("map: its script holds the values row by row, nothing where nothing is drawn, and depth downwards") {
  const std::string script = map_script(small(), 600);
  CHECK(script.find("37 NaN 38.5 \n40 41 42 \n") != std::string::npos);
  CHECK(script.find("set xrange [-1.25:0.25]") != std::string::npos);
  CHECK(script.find("set yrange [0.75:-0.25]") != std::string::npos);
  CHECK(script.find("set cbrange [37:42]") != std::string::npos);
  CHECK(script.find("(-1+$1*0.5):(0+$2*0.5):3") != std::string::npos);
}

TEST_CASE("map: it is drawn with any values, with none, and as one square") {
  ValueMap map = small();
  const auto drawn = [&] {
    const auto svg = draw_map(map, 500);
    if (!svg) return svg.error().code == ErrorCode::unavailable;  // without gnuplot
    return svg->find("<svg") != std::string::npos && svg->find("Temperature") != std::string::npos &&
           svg->find("Gnuplot</title>") == std::string::npos;
  };
  CHECK(drawn());
  map.values.assign(6, std::numeric_limits<float>::quiet_NaN());
  CHECK(drawn());
  map.values.assign(6, std::numeric_limits<float>::infinity());
  CHECK(drawn());
  map.values.assign(6, 37.0f);
  CHECK(drawn());
  map.columns = map.rows = 1;
  map.values = {40.0f};
  CHECK(drawn());
}

TEST_CASE("map: without gnuplot the error says so") {
  const auto svg = draw_map(small(), 500, "/nonexistent/gnuplot");
  REQUIRE_FALSE(svg.ok());
  CHECK(svg.error().code == ErrorCode::unavailable);
}
