// [irrigation] in a scene: the amount by which each key changes the heat that saline takes, by the closed form of a block of one temperature, and the
// area that pictures show as wet.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "app/stage/coolant.h"
#include "tests/support/drilled_post.h"

namespace burrhole::test {
namespace {

constexpr double kVoxel = 0.25e-3;                                                               // [m]
constexpr double kUnit = 1810.0 * 1250.0;                                                        // [J/(m^3 K)]
constexpr double kConductivity = 500.0, kStep = 16.0 * kVoxel * kVoxel * kUnit / kConductivity;  // [W/(m K)], [s] of conduction

/// Wider than saline reaches, so that it wets the level face alone, which is the middle of a layer of voxels.
constexpr const char* kBlockKeys = R"(source = "phantom:block"
spacing_mm = 0.25
extent_mm = [6.0, 6.0, 3.0]
above_mm = 1.125
block_mm = [4.0, 4.0, 1.0]
hardness = 0.8
)";

struct Saline {
  double celsius = 20.0, film = 200.0, reach = 1.5e-3, flow = 30.0;  // [C], [W/(m^2 K)], [m], [ml/min]
  std::string more = {};
  [[nodiscard]] std::string text() const {
    return fmt::format("[irrigation]\nalways = true\ntemperature_C = {}\nfilm_W_per_m2_K = {}\nreach_mm = {}\nflow_ml_per_min = {}\n{}",
                       celsius, film, reach * 1e3, flow, more);
  }
};

/// A block at 37 C under saline for 10 s. The bit stands, and sinks from the face by 0.01 mm, so that no layer with a part of the face is below it.
std::unique_ptr<DrillRun> wet(const Saline& saline) {
  const std::string heat = fmt::format("[heat]\nconductivity_W_per_m_K = {}\nfourier = 16\ncell_voxels = 1\n", kConductivity);
  auto out = std::make_unique<DrillRun>(drilled_post(
      heat + saline.text(), {"duration_s=10", "tool.spin_rpm=0", "hand.standoff_mm=1e-6", "hand.feed_mm_per_s=1e-3"}, kBlockKeys));
  out->run();
  return out;
}

/// [m^2] of the face: of each voxel within reach, what it holds more than the one above. Voxels more than their edge below the tip are dry.
double wet_area(DrillRun& run, double reach) {
  const BoneModel& bone = *run.loaded().bone;
  const VoxelBox all{Vec3i(0), bone.dims()};
  std::vector<float> density(all.count());
  run.simulation().voxmap().read_density(all, density);
  const Vec3 tip(0.0, 0.0, -0.005e-3);
  double sum = 0.0;
  for_each_voxel(all, [&](const Vec3i& voxel) {
    const Vec3 from = bone.bone_from_index() * Vec3(voxel) - tip;
    const Vec3i above = voxel + Vec3i(0, 0, 1);
    if (glm::length(from) > reach || from.z < -kVoxel || !all.contains(above)) return;
    sum += static_cast<double>(density[all.offset_of(voxel)] - density[all.offset_of(above)]) * kVoxel * kVoxel;
  });
  return sum;
}

}  // namespace

TEST_CASE(
    "irrigation: temperature_C, film_W_per_m2_K, reach_mm and flow_ml_per_min change the heat that saline takes as the closed form says") {
  // rho c V dT/dt = - G (T - Ts), with G = film x wet area, or what the flow carries if that is less.
  const double tenth = 1.1;
  for (const Saline& saline : {Saline{}, Saline{.celsius = 5.0}, Saline{.celsius = 30.0}, Saline{.celsius = 50.0}, Saline{.film = 100.0},
                               Saline{.film = 400.0}, Saline{.reach = 1.0e-3}, Saline{.flow = 0.005}, Saline{.flow = 0.01}}) {
    CAPTURE(saline.celsius);
    CAPTURE(saline.film);
    CAPTURE(saline.reach);
    CAPTURE(saline.flow);
    const auto run = wet(saline);
    const double volume = bone_left(*run), seconds = figure(run->simulation(), "heat", "steps") * kStep;
    const double area = wet_area(*run, saline.reach);
    const auto taken = [&](const Saline& s, double wetted) {
      const double conducts = std::min(s.film * wetted, kWaterCapacity * s.flow * 1e-6 / 60.0);
      return -kUnit * volume * (37.0 - s.celsius) * std::expm1(-conducts * seconds / (kUnit * volume));
    };
    const double expected = taken(saline, area), found = figure(run->simulation(), "heat", "coolant_J");
    // A step of the film is implicit in each voxel; heat comes from the block's edge to the wet face, 2 mm.
    const double error = saline.film * kStep / (kUnit * kVoxel) + saline.film * 2e-3 / kConductivity;
    MESSAGE("area " << area * 1e6 << " mm2, taken " << found << " J, closed form " << expected << " J, " << (found / expected - 1.0) * 100.0
                    << " %, derived " << error * 100.0 << " %");
    CHECK(std::abs(area / (std::numbers::pi * saline.reach * saline.reach) - 1.0) < 0.1);
    CHECK(std::abs(found / expected - 1.0) < error);
    // Sabotage of each key that matters here by a tenth.
    Saline warmer = saline, flowing = saline;
    warmer.celsius *= tenth;
    flowing.film *= tenth;
    flowing.flow *= tenth;
    CHECK(std::abs(found / taken(warmer, area) - 1.0) > 2.0 * error);
    CHECK(std::abs(found / taken(flowing, area) - 1.0) > 2.0 * error);
    if (saline.flow > 1.0) CHECK(std::abs(found / taken(saline, wet_area(*run, tenth * saline.reach)) - 1.0) > 2.0 * error);
  }
}

TEST_CASE("irrigation: drawn = true shows the disc within reach of the tip, and changes no figure and no bone") {
  for (const double reach : {1.0e-3, 1.5e-3}) {
    CAPTURE(reach);
    const auto plain = wet({.reach = reach}), drawn = wet({.reach = reach, .more = "drawn = true\n"});
    CHECK(picture_of(*plain) == nullptr);
    const double disc = std::numbers::pi * reach * reach, area = area_of(mesh_of(*drawn));
    MESSAGE("wet " << area * 1e6 << " mm2, disc " << disc * 1e6 << " mm2");
    // Edges are cut straight, to voxel^2 / (8 R): 1.6 % of the area at 1 mm. The face is lifted by a quarter of a voxel, and its ripples stretch it: 0.9 %.
    CHECK(std::abs(area / disc - 1.0) < 0.025);
    CHECK(std::abs(area / (1.1 * 1.1 * disc) - 1.0) > 0.1);  // sabotage
    for (const char* const name : {"coolant_J", "in_bone_J", "hottest_C", "steps"})
      CHECK(figure(drawn->simulation(), "heat", name) == figure(plain->simulation(), "heat", name));
    CHECK(drawn->voxel_hash() == plain->voxel_hash());
    CHECK(drawn->simulation().force_hash() == plain->simulation().force_hash());
  }
}

}  // namespace burrhole::test
