// The account of one bone step: time, voxels and bytes of its parts, for three shipped tools half way through the shipped bone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bench/areas.h"
#include "app/bench/contact_bones.h"
#include "app/bench/step_replay.h"

namespace burrhole {
namespace {

constexpr std::size_t kSteps = 24, kQuickSteps = 3;
// [-] of the removed bone. The search for the lag of the face starts from the mean lag of the step before, which a replay does not know in
// its first step, and lags are exact to 1e-4 voxel edge.
constexpr double kRunDifference = 1e-4;
constexpr double kMilliseconds = 1e3, kKilobyte = 1e3;

/// Counts and results of one replay.
struct Replayed {
  std::vector<std::uint64_t> numbers;  // of each step: voxels, nodes and records that change; hashes after the last
  std::vector<StepCounts> steps;
};

Replayed count_steps(StepReplay& replay) {
  Replayed out;
  if (!replay.begin()) return out;  // create() succeeded with the same bone
  for (const StepInput& input : replay.inputs()) {
    out.steps.push_back(replay.count(input));
    out.numbers.insert(out.numbers.end(), {out.steps.back().voxels, out.steps.back().nodes, out.steps.back().records});
  }
  for (const std::uint64_t hash : replay.hashes()) out.numbers.push_back(hash);
  return out;
}

/// @returns by how much the bone after the replay differs from that after the run, over the bone that the run removed [-].
double difference_from_run(RecordedSteps& recorded, const Voxmap& replayed) {
  std::vector<float> before(recorded.after_box.count()), after(before.size());
  recorded.before->read_remaining(recorded.after_box, before);
  replayed.read_remaining(recorded.after_box, after);
  double difference = 0.0, removed = 0.0;
  for (std::size_t n = 0; n < after.size(); ++n) {
    difference += static_cast<double>(std::abs(after[n] - recorded.after[n]));
    removed += static_cast<double>(before[n] - recorded.after[n]);
  }
  return difference / removed;
}

/// Compares a replay with the recorded run, with another replay, and with one at the lowest SIMD level.
bool replays_agree(Bench& bench, const std::string& name, RecordedSteps& recorded, StepReplay& replay, const Replayed& counted) {
  const double difference = difference_from_run(recorded, replay.bone());
  const Replayed again = count_steps(replay);
  return bench.require(name, difference < kRunDifference, fmt::format("replay and run differ by {} of the removed bone", difference)) &&
         bench.require(name, std::ranges::all_of(counted.steps, [](const StepCounts& step) { return step.voxels > 0; }),
                       "a step removed no bone") &&
         bench.agree(name, bytes_of(counted.numbers), bytes_of(again.numbers)) &&
         levels_agree(bench, name, counted, [&] { return count_steps(replay); });
}

/// Reads and writes each float of a box once. @param values over the window.
void pass_over(const VoxelBox& window, const VoxelBox& box, std::vector<float>& values) {
  const auto length = static_cast<std::size_t>(box.size().x);
  for (int k = box.lo.z; k < box.hi.z; ++k)
    for (int j = box.lo.y; j < box.hi.y; ++j) {
      float* const row = values.data() + window.offset_of({box.lo.x, j, k});
      for (std::size_t n = 0; n < length; ++n) row[n] *= 0.999f;
    }
}

/// Times of all steps of a replay.
struct TimedSteps {
  Medians whole;                                    // [s]; the baseline is a plain pass over the tight box of each step
  std::vector<double> removal, commit, publishing;  // [s] samples
};

TimedSteps time_steps(const Bench& bench, StepReplay& replay, const Replayed& counted) {
  TimedSteps out;
  const VoxelBox window = replay.bone().window().box;
  std::vector<float> values(window.count());
  const Side plain{[&] { std::ranges::fill(values, 1.0f); },
                   [&] {
                     for (const StepCounts& step : counted.steps) pass_over(window, step.box, values);
                   }};
  const Side steps{[&] { (void)replay.begin(); },
                   [&] {
                     StepTimes times;
                     for (const StepInput& input : replay.inputs()) replay.run(input, times);
                     out.removal.push_back(times.removal);
                     out.commit.push_back(times.commit);
                     out.publishing.push_back(times.publishing);
                   }};
  out.whole = bench.time(plain, steps);
  return out;
}

void add_counts(Bench& bench, const std::string& what, const std::vector<StepCounts>& steps) {
  const auto add = [&](const char* row, const char* unit, auto&& of, double per_unit = 1.0) {
    double sum = 0.0;
    for (const StepCounts& step : steps) sum += static_cast<double>(of(step));
    bench.add_absolute(fmt::format("{}: {}", what, row), unit, sum / per_unit / static_cast<double>(steps.size()), true);
  };
  add("voxels whose remaining changes in a step", "voxels", [](const StepCounts& s) { return s.voxels; });
  add("tight box of those voxels", "voxels", [](const StepCounts& s) { return s.box.count(); });
  add("nodes of the cut surface that change in a step", "nodes", [](const StepCounts& s) { return s.nodes; });
  add("voxels committed in a step", "voxels", [](const StepCounts& s) { return s.committed; });
  add("voxels whose record changes in a step", "voxels", [](const StepCounts& s) { return s.records; });
  add("records written to the snapshot in a step", "records", [](const StepCounts& s) { return s.copied; });
  add(
      "bytes written to the snapshot in a step", "kB", [](const StepCounts& s) { return s.copied_bytes; }, kKilobyte);
  add(
      "bytes that a step must read", "kB", [](const StepCounts& s) { return s.bytes_read(); }, kKilobyte);
  add(
      "bytes that a step must write", "kB", [](const StepCounts& s) { return s.bytes_written(); }, kKilobyte);
}

Status account_for(Bench& bench, const std::string& tool) {
  auto recorded = record_bone_steps(tool, StepReplay::kWarmUp + (bench.quick() ? kQuickSteps : kSteps), bench.quick());
  if (!recorded) return recorded.error();
  auto replay = StepReplay::create(*recorded);
  if (!replay) return replay.error();
  const std::string what = tool + " half way", name = what + ": bone step over a plain pass";
  const Replayed counted = count_steps(*replay);
  if (!replays_agree(bench, name, *recorded, *replay, counted)) return {};
  const TimedSteps times = time_steps(bench, *replay, counted);
  const auto steps = static_cast<double>(counted.steps.size());
  bench.add_cost(name, "ms", kMilliseconds / steps, times.whole, {.ship = 10.0, .aim = {}});
  const auto add_time = [&](const char* part, double seconds) {
    bench.add_absolute(fmt::format("{}: {}", what, part), "ms", kMilliseconds * seconds / steps, true);
  };
  add_time("bone step", times.whole.value);
  add_time("removal in a bone step", median(times.removal));
  add_time("commit in a bone step", median(times.commit));
  add_time("publishing in a bone step", median(times.publishing));
  double voxels = 0.0;
  for (const StepCounts& step : counted.steps) voxels += static_cast<double>(step.voxels);
  bench.add_absolute(what + ": bone step by voxel whose remaining changes", "ns/voxel", 1e9 * times.whole.value / voxels, true);
  add_counts(bench, what, counted.steps);
  return {};
}

}  // namespace

Status bench_step(Bench& bench) {
  for (const char* tool : {"perforator_14_11", "round_burr_6mm", "round_burr_2mm"})
    if (Status done = account_for(bench, tool); !done) return done;
  return {};
}

}  // namespace burrhole
