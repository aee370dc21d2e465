// Time, force and removed volume of each layer: what goes in comes out once, and what is removed of all labels is what is removed.
#include "core/measure/layer_loads.h"

#include <doctest/doctest.h>

#include <numeric>

#include "core/measure/hole_measure.h"
#include "tests/app/run/cleared_plate.h"

namespace burrhole::test {
namespace {

Approach three_layers() {
  Approach out;
  out.thickness = 7.1e-3;
  out.layers = {
      {VoxelLabel::outer_table, 0.05e-3, 2.35e-3}, {VoxelLabel::diploe, 2.45e-3, 5.25e-3}, {VoxelLabel::inner_table, 5.35e-3, 7.05e-3}};
  return out;
}

TEST_CASE("layer loads: time and impulse of a descent go to the layers of its depth, once, and a tip in air counts nowhere") {
  LayerLoads loads(three_layers());
  // 0.1 mm/s from 1 mm above to 1 mm below, with a force of 10 N in bone, 4 N in diploe, none in air.
  constexpr double kDt = 1e-3, kSpeed = 1e-4;
  double time = 0.0;
  for (double depth = -1e-3; depth < 8.1e-3; depth += kSpeed * kDt) {
    time += kDt;
    const bool air = depth < 0.0 || depth >= 7.1e-3, diploe = depth >= 2.4e-3 && depth < 5.3e-3;
    loads.add(depth, air ? 0.0 : diploe ? 4.0 : 10.0, time);
  }
  const std::vector<LayerLoad>& l = loads.loads();
  REQUIRE(l.size() == 3);
  // Borders are half way between samples: 2.4, 5.3 and 7.1 mm. A tick is 0.1 um: two of them may be on the other side of each border.
  CHECK(std::abs(l[0].time - 24.0) < 2.5 * kDt);
  CHECK(std::abs(l[1].time - 29.0) < 2.5 * kDt);
  CHECK(std::abs(l[2].time - 18.0) < 2.5 * kDt);
  CHECK(std::abs(l[1].impulse / l[1].time - 4.0) < 0.01);
  CHECK(l[0].peak == 10.0);
  CHECK(l[2].peak == 10.0);
}

TEST_CASE("layer loads: a pause, a jump of the time and a force below the least do not count; no layers are no error") {
  LayerLoads loads(three_layers());
  loads.add(1e-3, 10.0, 1.0);            // a jump of a second
  loads.add(1e-3, 0.01, 1.001);          // no force
  loads.add(1e-3, std::nan(""), 1.002);  // not finite
  loads.add(std::nan(""), 10.0, 1.003);  // nowhere
  loads.add(1e-3, 10.0, 1.003);          // no time
  CHECK(loads.loads()[0].time == 0.0);
  loads.add(1e-3, 10.0, 1.004);
  CHECK(loads.loads()[0].time == doctest::Approx(1e-3));
  LayerLoads none{Approach{}};
  none.add(1e-3, 10.0, 1e-3);
  CHECK(none.loads().empty());
}

TEST_CASE("layer loads: the volumes of all labels sum to the mass that was removed") {
  ClearedPlate plate;
  CHECK(removed_by_label(*plate.voxmap)[static_cast<std::size_t>(VoxelLabel::bone)] == 0.0);
  plate.clear(1.5e-3, 10e-3);
  const auto removed = removed_by_label(*plate.voxmap);
  const double sum = std::accumulate(removed.begin(), removed.end(), 0.0);
  const HoleMeasure hole = measure_hole(*plate.voxmap, plate.approach);
  // The same differences of floats, summed in another order.
  CHECK(sum == doctest::Approx(hole.removed_mass).epsilon(1e-9));
  CHECK(removed[static_cast<std::size_t>(VoxelLabel::bone)] == doctest::Approx(sum));
  CHECK(removed[static_cast<std::size_t>(VoxelLabel::none)] == 0.0);
}

}  // namespace
}  // namespace burrhole::test
