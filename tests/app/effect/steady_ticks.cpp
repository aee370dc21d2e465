// Runs a scene in lockstep and lets callgrind count the instructions of a tenth of a simulated second, deep enough in for the bit to cut.
//   steady_ticks SCENE TOOL_FOLDER [--set values...]       see absent_effect_test.py

#include <valgrind/callgrind.h>

#include <atomic>
#include <cstdio>

#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "core/base/simd.h"

int main(int argc, char** argv) {
  using namespace burrhole;
  constexpr double kFrom = 1.95, kUntil = 2.05;  // [s] progress comes ten times a second, at 2.0 and 2.1
  if (argc < 3) return std::fputs("usage: steady_ticks SCENE TOOL_FOLDER [KEY=VALUE...]\n", stderr), 2;
  auto document = TomlDocument::load(argv[1]);
  if (!document) return std::puts(document.error().text().c_str()), 2;
  for (int n = 3; n < argc; ++n)
    if (const Status set = document->set(argv[n]); !set) return std::puts(set.error().text().c_str()), 2;
  if (const Status level = choose_simd("avx2"); !level) return std::puts(level.error().text().c_str()), 4;
  Issues issues;
  const auto loaded = load_scene(*document, {.tool_folders = {argv[2]}}, issues);
  if (!loaded) return std::puts(issues.front().text().c_str()), 2;

  std::atomic<bool> stop{false};
  SimulationOptions options;
  options.stop = &stop;
  options.progress = [&](double time, const DrillProgress&) {
    if (time > kUntil) {
      CALLGRIND_STOP_INSTRUMENTATION;
      stop = true;
    } else if (time > kFrom) {
      CALLGRIND_START_INSTRUMENTATION;
    }
  };
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, options, issues);
  if (!simulation) return std::puts(issues.front().text().c_str()), 2;
  if (const Status ran = simulation->run(); !ran) return std::puts(ran.error().text().c_str()), 1;
  std::printf("hash %016llx after %llu ticks\n", static_cast<unsigned long long>(simulation->voxmap().hash()),
              static_cast<unsigned long long>(simulation->ticks()));
  return 0;
}
