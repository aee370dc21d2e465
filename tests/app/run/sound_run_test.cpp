// [sound] in whole runs: what is heard, that it changes nothing else, and that a replay of any session gives the same samples.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/run/simulation.h"
#include "app/session/recorded_hand.h"
#include "core/sound/drill_sound.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

class Heard final : public SoundSink {
 public:
  void write(std::span<const float> samples) noexcept override { all.insert(all.end(), samples.begin(), samples.end()); }
  std::vector<float> all;
};

SmallScene short_scene(const std::string& sound = "sound={}") {
  SmallScene scene{.spindle = true, .sets = {"duration_s=1.0", "hand.standoff_mm=0.5"}};
  if (!sound.empty()) scene.sets.push_back(sound);
  return scene;
}

struct Outcome {
  std::vector<float> samples;
  std::string hash;
  std::uint64_t voxels = 0, forces = 0;
};

Outcome run_of(const SmallScene& scene, SimulationOptions options, const std::string& path) {
  Heard heard;
  options.sound = &heard;
  DrillRun run(scene, options);
  run_recorded(run, path);
  return {heard.all, run.simulation().sound_hash(), run.voxel_hash(), run.simulation().force_hash()};
}

Outcome replay_of(const SmallScene& scene, const std::string& path, bool history = false) {
  const LoadedScene loaded = load_small(scene);
  auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  Heard heard;
  SimulationOptions options;
  options.hand = &*hand;
  options.sound = &heard;
  options.history = history;
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  REQUIRE(simulation);
  const Status ran = simulation->run_recorded(*session, *hand);
  REQUIRE_MESSAGE(ran.ok(), (ran ? "" : ran.error().text()));
  return {heard.all, simulation->sound_hash(), simulation->voxmap().hash(), simulation->force_hash()};
}

double rms(const std::vector<float>& samples, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t n = from; n < to; ++n) sum += static_cast<double>(samples[n]) * static_cast<double>(samples[n]);
  return std::sqrt(sum / static_cast<double>(to - from));
}

}  // namespace

TEST_CASE("sound: equal runs give equal samples, and the sound changes neither voxels nor forces") {
  const TemporaryFolder folder;
  const Outcome one = run_of(short_scene(), {}, folder.file("one.sqlite")), two = run_of(short_scene(), {}, folder.file("two.sqlite"));
  CHECK(one.samples.size() == 48000);
  CHECK(one.samples == two.samples);
  CHECK(one.hash == two.hash);
  CHECK_FALSE(one.hash.empty());
  // The motor before contact, and bone after it.
  CHECK(rms(one.samples, 1000, 4000) > 0.005);
  const Outcome silent = run_of(short_scene(""), {}, folder.file("silent.sqlite"));
  CHECK(silent.samples.empty());
  CHECK(silent.voxels == one.voxels);
  CHECK(silent.forces == one.forces);
  const Outcome other = run_of(short_scene("sound={tooth_level=0.2}"), {}, folder.file("other.sqlite"));
  CHECK(other.samples != one.samples);  // the comparison can fail
}

TEST_CASE("sound: the motor turns at motor_rpm, and lags by response_ms") {
  const TemporaryFolder folder;
  // From 6 mm above the plate nothing is cut for a second. The speed starts at 0 and follows as f (1 - exp(-t / T)): after t it has turned f (t - T) times.
  const auto turns = [&](const std::string& keys) {
    SmallScene scene{.sets = {"duration_s=0.6", "hand.standoff_mm=6", "sound={" + keys + "}"}};
    const std::vector<float> samples = run_of(scene, {}, folder.file("motor.sqlite")).samples;
    REQUIRE(samples.size() == 28800);
    // sum sin(k x) / k, k = 1..6, passes zero upwards once a turn.
    return std::ranges::count_if(samples, [last = 0.0f](float now) mutable { return std::exchange(last, now) < 0.0f && now >= 0.0f; });
  };
  // Each count is a whole number, and the one turn that the count begins in is not counted.
  CHECK(std::abs(static_cast<double>(turns("motor_rpm=24000")) - 400.0 * (0.6 - 0.01)) <= 1.0);
  CHECK(std::abs(static_cast<double>(turns("motor_rpm=12000")) - 200.0 * (0.6 - 0.01)) <= 1.0);
  CHECK(std::abs(static_cast<double>(turns("motor_rpm=24000, response_ms=50")) - 400.0 * (0.6 - 0.05)) <= 1.0);
}

TEST_CASE("sound: without the table, or with nothing that hears it, no step, slot, column or sample of it exists") {
  for (const bool table : {false, true}) {
    DrillRun run(short_scene(table ? "sound={}" : ""));
    Simulation& simulation = run.run().simulation();
    CHECK(simulation.stage().graph.empty(Clock::audio));
    CHECK_FALSE(simulation.stage().graph.is_written("chip_load"));
    CHECK_FALSE(simulation.stage().needs.chip_load);
    CHECK(simulation.timing("sound").count == 0);
    CHECK(simulation.sound_hash().empty());
    CHECK(session_layout(simulation.stage()).streams.size() == 3);
  }
  Heard heard;
  SimulationOptions options;
  options.sound = &heard;
  DrillRun run(short_scene(), options);
  Simulation& simulation = run.run().simulation();
  CHECK(simulation.stage().graph.is_written("chip_load"));
  CHECK(simulation.timing("sound").count == 100);
  CHECK(session_layout(simulation.stage()).streams.size() == 4);
}

TEST_CASE("sound: the replay of a lockstep session gives the same samples, also with undo and another tool") {
  const TemporaryFolder folder;
  const Outcome plain = run_of(short_scene(), {}, folder.file("a.sqlite"));
  CHECK(replay_of(short_scene(), folder.file("a.sqlite")).samples == plain.samples);
  SimulationOptions options;
  options.history = true;
  const auto pin = read_tool_text("pin", "small.toml", test_context());
  REQUIRE(pin);
  options.inputs = {{300, InputKind::spin, 0.0, {}, {}},      {400, InputKind::undo, 0.0, {}, {}},
                    {450, InputKind::spin, 1.0, {}, {}},      {555, InputKind::pause, 0.0, {}, {}},
                    {655, InputKind::tool, 0.0, "pin", *pin}, {700, InputKind::mark, 0.0, "here", {}}};
  const Outcome run = run_of(short_scene(), options, folder.file("b.sqlite"));
  const Outcome replayed = replay_of(short_scene(), folder.file("b.sqlite"), true);
  CHECK(run.samples == replayed.samples);
  CHECK(run.hash == replayed.hash);
  CHECK(run.voxels == replayed.voxels);
}

TEST_CASE("sound: the replay of a live session gives the same samples") {
  const TemporaryFolder folder;
  SimulationOptions options;
  options.live = true;
  options.history = true;
  options.inputs = {{500, InputKind::undo, 0.0, {}, {}}};
  const Outcome run = run_of(short_scene(), options, folder.file("live.sqlite"));
  const Outcome replayed = replay_of(short_scene(), folder.file("live.sqlite"), true);
  CHECK(run.samples.size() > 40000);
  CHECK(run.samples == replayed.samples);
  CHECK(run.hash == replayed.hash);
}

TEST_CASE("sound: teeth and chips are louder in the tables than in the diploe, silent beyond, and the spindle slows") {
  // The patch's hardness: tables 0.9, trabeculae 0.45 and pores 0.12. At equal thrust and law `rate` the feed goes with 1 / H, so the levels of
  // teeth and chips go with H^2 H^(-1/2): between a table and the diploe at least 20 log10 (0.9 / 0.45)^(3/2) = 9.0 dB. A decibel is for the
  // noise, which 0.1 s windows sample.
  constexpr double kBound = 8.0, kBall = 1e-3, kEngaged = 0.5e-3;
  SmallScene scene{.volume = std::string(kSkullPatchKeys) + "outer_table_mm = 1.6\ninner_table_mm = 1.6\n",
                   .spindle = true,
                   .sets = {"duration_s=20", "hand.standoff_mm=0.5", "volume.thickness_mm=6", "sound={motor_level=0.0}"}};
  Heard heard;
  SimulationOptions options;
  options.sound = &heard;
  DrillRun run(scene, options);
  Simulation& simulation = run.run().simulation();
  std::vector<Approach::Layer> bone;
  for (const Approach::Layer& layer : simulation.approach().layers)
    if (layer.label == VoxelLabel::outer_table || layer.label == VoxelLabel::diploe || layer.label == VoxelLabel::inner_table)
      bone.push_back(layer);
  REQUIRE(bone.size() == 3);
  // Windows in which the whole of the half ball that cuts is in one layer: the face of bone lags the tip by the engaged depth.
  struct Sum {
    double power = 0.0;
    int count = 0;
    [[nodiscard]] double level() const { return 10.0 * std::log10(power / count); }
  };
  std::array<Sum, 4> sums;  // outer table, diploe, inner table, beyond the bone
  const auto& samples = simulation.samples();
  for (std::size_t n = 0; n + 100 < samples.size() && samples[n].time < *simulation.progress().breakthrough_time + 3.0; n += 100) {
    const double low = samples[n].depth - kEngaged - kBall, high = samples[n + 100].depth - kEngaged;
    const auto from = static_cast<std::size_t>(samples[n].time * 48000.0), to = static_cast<std::size_t>(samples[n + 100].time * 48000.0);
    const double level = rms(heard.all, from, to);
    for (std::size_t k = 0; k < 4; ++k) {
      const bool inside = k < 3 ? low > bone[k].from && high < bone[k].to : low > bone[2].to + kBall;
      if (inside) sums[k].power += level * level, ++sums[k].count;
    }
  }
  for (const Sum& one : sums) REQUIRE(one.count > 0);
  CAPTURE(sums[0].level());
  CAPTURE(sums[1].level());
  CAPTURE(sums[2].level());
  CHECK(sums[0].level() - sums[1].level() > kBound);
  CHECK(sums[2].level() - sums[1].level() > kBound);
  CHECK(sums[3].level() < sums[1].level() - 20.0);
  CHECK(slowest_spin(simulation) < simulation.stage().config.tool.spin);
}
