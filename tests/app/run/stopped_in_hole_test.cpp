// A bit that is stopped in the hole that it drills stays there, whatever its form, and goes on from there.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kVoxel = 0.25e-3, kThrust = 28.0;  // [m], [N] of the shipped scene
constexpr double kPeriod = 1e-3;                    // [s] of a tick
constexpr std::uint64_t kStop = 5000, kStart = 6500;
constexpr const char* kEnd = "8";  // [s]

Input spin(std::uint64_t tick, double command) { return {tick, InputKind::spin, command, {}, {}}; }

/// Depth [m] of the tip and force [N] per tick, drilling with the inputs.
std::vector<RunSample> drilled(const std::string& bit, std::vector<Input> inputs) {
  SimulationOptions options;
  options.samples = true;
  options.inputs = std::move(inputs);
  DrillRun run(load_parietal({std::string("duration_s=") + kEnd, "tool.name=" + bit, "tool.spin_rpm=1000", "hand.detects=false"}), options);
  run.run();
  return run.simulation().samples();
}

/// Extremes between two ticks, depths relative to that at the first.
struct Range {
  double rise = 0.0, sink = 0.0, force = 0.0;  // [m], [m], [N]
};

Range range_of(const std::vector<RunSample>& samples, std::uint64_t first, std::uint64_t end) {
  Range out;
  double depth = 0.0;
  for (const RunSample& sample : samples) {
    const double tick = sample.time / kPeriod;
    if (tick < static_cast<double>(first) - 0.5) depth = sample.depth;
    if (tick < static_cast<double>(first) - 0.5 || tick > static_cast<double>(end) - 0.5) continue;
    out.rise = std::max(out.rise, depth - sample.depth);
    out.sink = std::max(out.sink, sample.depth - depth);
    out.force = std::max(out.force, sample.force);
  }
  return out;
}

// The bit stands on what it has cut. Only the tremor of 0.04 mm moves it, sideways, and along a face at most as far up or down: 0.16 voxel.
// The search for places between its points is exact to 0.03 voxel, a settled pose to 0.05.
constexpr double kBound = 0.25 * kVoxel;

TEST_CASE("stopped in the hole: every shipped bit stays within a quarter of a voxel under its thrust, and drills on from there") {
  for (const std::string bit :
       {"perforator_14_11", "acosta_liu_perforator", "round_burr_2mm", "round_burr_3mm", "round_burr_4mm", "round_burr_5mm",
        "round_burr_6mm", "acosta_liu_round", "acorn_burr_7_5mm", "matchstick_burr_3mm", "twist_drill_2_5mm", "trephine_12mm"}) {
    const std::vector<RunSample> samples = drilled(bit, {spin(kStop, 0.0), spin(kStart, 1.0)});
    const Range before = range_of(samples, 4000, kStop), still = range_of(samples, kStop, kStart), on = range_of(samples, kStart, 8000);
    const double depth = samples[kStop - 1].depth;
    MESSAGE(bit << ": " << depth * 1e3 << " mm deep, then up by " << still.rise * 1e3 << " mm, down by " << still.sink * 1e3 << " mm, "
                << still.force << " N; then up by " << on.rise * 1e3 << " mm, down by " << on.sink * 1e3 << " mm, " << on.force
                << " N; before it stopped down by " << before.sink * 1e3 << " mm");
    CHECK(still.rise < kBound);
    CHECK(still.sink < kBound);
    CHECK(on.rise < kBound);
    CHECK(still.force < 1.1 * kThrust);
    CHECK(on.force < 1.1 * kThrust);
    CHECK(on.sink > 0.5 * before.sink);
  }
}

TEST_CASE("stopped in the hole: a perforator that has not spun there rises out of it (sabotage)") {
  auto text = read_tool_text("perforator_14_11", "parietal.toml", test_context());
  REQUIRE(text);
  // A change to the same bit leaves pose and bone, and forgets that the bit has cut there.
  const auto samples = drilled("perforator_14_11", {spin(kStop, 0.0), {kStop, InputKind::tool, 0.0, "perforator_14_11", *text}});
  CHECK(range_of(samples, kStop, kStart).rise > 4.0 * kBound);
}

}  // namespace
}  // namespace burrhole::test
