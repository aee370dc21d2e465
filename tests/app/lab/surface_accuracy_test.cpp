// What surface records cost in accuracy, as the lab measures it.
#include "app/lab/surface_accuracy.h"

#include <doctest/doctest.h>

#include <algorithm>

using namespace burrhole;

namespace {

const std::vector<CostRow>& measured() {
  static const std::vector<CostRow> rows = [] {
    auto made = measure_surface_accuracy({.pitches = {0.5e-3, 0.25e-3}, .points = 1000, .repeats = 3, .seed = 5});
    REQUIRE(made.ok());
    return std::move(made).value();
  }();
  return rows;
}

double error_of(const std::string& shape, const std::string& bits, double pitch_mm, const std::string& name) {
  const auto row = std::ranges::find_if(measured(), [&](const CostRow& one) {
    return one.subject == "surface of a " + shape && one.model == "records of " + bits && std::abs(one.setting - pitch_mm) < 1e-9 &&
           one.error_name == name;
  });
  REQUIRE(row != measured().end());
  return row->error;
}

}  // namespace

TEST_CASE("surface accuracy: the felt surface is within a tenth of a voxel of the closed form, whatever shape, bits and pitch") {
  int judged = 0;
  for (const CostRow& row : measured()) {
    CAPTURE(row.subject);
    CAPTURE(row.model);
    CHECK(row.bytes == (row.model == "records of 8 bits" ? 4.0 : 8.0));
    if (row.error_name != "distance_worst") continue;
    ++judged;
    CHECK(row.error < 0.1);  // what the project promises
  }
  CHECK(judged == 3 * 2 * 2);  // shapes, bits, pitches
}

TEST_CASE("surface accuracy: each knob acts on the error that it is for") {
  // 8 bits store 1/32 of an edge: on a plane, where trilinear interpolation is exact, half a step is all there is to lose.
  CHECK(error_of("tilted plate", "8 bits", 0.25, "distance_worst") > 5.0 * error_of("tilted plate", "16 bits", 0.25, "distance_worst"));
  CHECK(error_of("tilted plate", "8 bits", 0.25, "distance_worst") < 1.0 / 64.0 + 1e-3);
  // Between voxels a ball's distance is read from a chord: the error in voxels goes with the voxel's edge over the radius.
  CHECK(error_of("ball of 4 mm", "16 bits", 0.5, "distance_worst") > 1.4 * error_of("ball of 4 mm", "16 bits", 0.25, "distance_worst"));
}
