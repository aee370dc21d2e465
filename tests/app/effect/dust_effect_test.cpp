// [dust] in a scene: where the removed bone goes, what saline and suction take, each key, undo and reset, replay, hard cases, refusals.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "haptics/hand/hand_switches.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// The plate, drilled for 6 s; particles so small that each key shows.
LoadedScene plate(const std::string& tables, const std::vector<std::string>& sets = {}, const std::string& volume = kPlateKeys,
                  const std::string& contact = kHeldKeys) {
  std::vector<std::string> all{"duration_s=6.0"};
  if (tables.find("[dust]") != std::string::npos) all.emplace_back("dust.particle_mm3=0.01");
  all.insert(all.end(), sets.begin(), sets.end());
  return load_text(scene_text({.volume = volume, .contact_keys = contact}) + tables, all);
}

struct Outcome {
  double removed, eroded, held, flying, mist, settled, rinsed, sucked, lost, undone, error, hidden, most_hidden, particles, most, merged;
  std::uint64_t voxels = 0, forces = 0;
  [[nodiscard]] double sum() const { return held + flying + settled + rinsed + sucked + lost + undone; }
  [[nodiscard]] std::vector<double> all() const {
    return {removed, held, flying, mist, settled, rinsed, sucked, lost, undone, hidden, most_hidden, particles, most, merged};
  }
};

Outcome outcome_of(DrillRun& run) {
  const auto get = [&](const char* name) { return figure(run.simulation(), "dust", name); };
  return {get("removed_mm3"),       figure(run.simulation(), "erosion", "removed_mass_mm3"),
          get("held_mm3"),          get("flying_mm3"),
          get("mist_mm3"),          get("settled_mm3"),
          get("rinsed_mm3"),        get("sucked_mm3"),
          get("lost_mm3"),          get("undone_mm3"),
          get("balance_error"),     get("hidden_share"),
          get("most_hidden_share"), get("particles"),
          get("most_particles"),    get("merged"),
          run.voxel_hash(),         run.simulation().force_hash()};
}

Outcome drill(const std::string& tables, const std::vector<std::string>& sets = {}, const std::string& volume = kPlateKeys,
              const std::string& contact = kHeldKeys) {
  DrillRun run(plate(tables, sets, volume, contact));
  run.run();
  return outcome_of(run);
}

std::vector<std::string> errors_of(const std::string& tables) {
  Issues issues;
  const auto document = TomlDocument::parse(scene_text({}) + tables, "small.toml");
  REQUIRE(document);
  auto loaded = load_scene(*document, test_context(), issues);
  if (loaded && issues.empty()) (void)Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
  std::vector<std::string> out;
  for (const Error& issue : issues) {
    CHECK((issue.code == ErrorCode::bad_input || issue.code == ErrorCode::out_of_range));
    out.push_back(issue.text());
  }
  return out;
}

constexpr const char* kSaline = "[irrigation]\nflow_ml_per_min = 60\nalways = true\n";

}  // namespace

TEST_CASE("dust: all removed bone is held, flies, lies, or went: as much as erosion says; bone and forces do not change") {
  const Outcome with = drill("[dust]\n");
  MESSAGE(with.removed << " mm3 removed: held " << with.held << ", flying " << with.flying << ", settled " << with.settled << ", lost "
                       << with.lost << "; hidden " << with.hidden << ", " << with.particles << " particles");
  REQUIRE(with.removed > 3.0);
  CHECK(with.removed == doctest::Approx(with.eroded).epsilon(1e-12));
  CHECK(with.sum() == doctest::Approx(with.removed).epsilon(1e-11));
  CHECK(with.error < 1e-11);
  CHECK(with.settled > 0.0);
  CHECK(with.hidden > 0.0);
  CHECK(with.rinsed == 0.0);
  CHECK(with.sucked == 0.0);
  CHECK(with.merged == 0.0);
  DrillRun plain(plate(""));
  plain.run();
  CHECK(plain.voxel_hash() == with.voxels);
  CHECK(plain.simulation().force_hash() == with.forces);
  CHECK_FALSE(plain.simulation().stage().figure("dust", "removed_mm3").has_value());
  for (const StepColumn& column : plain.simulation().stage().graph.columns(Clock::simulation)) CHECK(column.name.find("dust") != 0);
}

TEST_CASE("dust: saline rinses and suction takes; both uncover the hole, and a later start of the suction leaves it hidden longer") {
  const Outcome dry = drill("[dust]\n"), wet = drill("[dust]\n" + std::string(kSaline)), sucked = drill("[dust]\n[dust.suction]\n");
  MESSAGE("hidden dry " << dry.hidden << ", wet " << wet.hidden << ", sucked " << sucked.hidden << "; rinsed " << wet.rinsed << ", sucked "
                        << sucked.sucked << " of " << dry.removed << " mm3");
  CHECK(wet.rinsed > 0.5 * (wet.removed - wet.held - wet.lost));
  CHECK(wet.hidden < dry.hidden);
  CHECK(sucked.sucked > 0.2 * (sucked.removed - sucked.held - sucked.lost));
  CHECK(sucked.hidden < dry.hidden);
  const Outcome late = drill("[dust]\n[dust.suction]\nfrom_s = 10\n");
  CHECK(late.sucked == 0.0);
  CHECK(late.settled == dry.settled);
  for (const Outcome& one : {wet, sucked, late}) {
    CHECK(one.sum() == doctest::Approx(one.removed).epsilon(1e-11));
    CHECK(one.voxels == dry.voxels);
  }
}

TEST_CASE("dust: suction and saline by switch are on while their switch is, in a replay too") {
  const TemporaryFolder folder;
  const std::string tables = "[dust]\n[dust.suction]\nby_switch = true\n[irrigation]\nby_switch = true\n";
  struct Used {
    double sucked, sucked_s, rinsed, rinsed_s;
  };
  const auto with = [&](const std::vector<Input>& inputs) {
    SimulationOptions options;
    options.inputs = inputs;
    options.history = true;
    DrillRun run(plate(tables), options);
    run_recorded(run, folder.file("switch.sqlite"));
    const auto get = [&](const char* table, const char* name) { return figure(run.simulation(), table, name); };
    const Used out{get("dust", "sucked_mm3"), get("dust", "suction_s"), get("dust", "rinsed_mm3"), get("irrigation", "on_s")};
    ReplayRun replayed(folder.file("switch.sqlite"), {.history = true});
    CHECK(figure(replayed.run().simulation(), "dust", "sucked_mm3") == out.sucked);
    CHECK(figure(replayed.run().simulation(), "dust", "rinsed_mm3") == out.rinsed);
    CHECK(figure(replayed.run().simulation(), "dust", "suction_s") == out.sucked_s);
    return out;
  };
  const auto at = [](double time, std::uint32_t bits) {
    return Input{static_cast<std::uint64_t>(time * 1000.0 + 0.5), InputKind::switches, static_cast<double>(bits), {}, {}};
  };
  const Used never = with({}), sucks = with({at(4.0, kSuctionSwitch), at(5.5, 0)}), rinses = with({at(4.0, kIrrigationSwitch)}),
             other = with({at(0.0, kWaxSwitch)});
  constexpr double kStep = 0.02;  // [s] of bone: a switch is seen by the next one
  CHECK(never.sucked + never.sucked_s + never.rinsed + never.rinsed_s == 0.0);
  CHECK(other.sucked + other.sucked_s + other.rinsed + other.rinsed_s == 0.0);
  CHECK(std::abs(sucks.sucked_s - 1.5) <= kStep + 1e-9);
  CHECK(sucks.sucked > 0.0);
  CHECK(sucks.rinsed == 0.0);
  CHECK(std::abs(rinses.rinsed_s - 2.0) <= kStep + 1e-9);
  CHECK(rinses.rinsed > 0.0);
  CHECK(rinses.sucked == 0.0);
}

TEST_CASE("dust: each key changes the figure that it names") {
  const auto keyed = [](const std::vector<std::string>& keys, const std::string& tables = "[dust]\n") {
    std::vector<std::string> sets;
    for (const std::string& key : keys) sets.push_back("dust." + key);
    return drill(tables, sets);
  };
  const Outcome usual = keyed({});
  CHECK(keyed({"most_particles=20"}).most == 20.0);
  CHECK(keyed({"most_particles=20"}).merged > 0.0);
  CHECK(keyed({"particle_mm3=0.1"}).particles < 0.2 * usual.particles);
  CHECK(keyed({"clearing_per_rev=0.001"}).held > usual.held);
  CHECK(keyed({"throw_share=10"}).settled < usual.settled);
  CHECK(keyed({"spread=3"}).settled != usual.settled);
  CHECK(keyed({"mist_share=0"}).mist == 0.0);
  CHECK(keyed({"mist_share=0"}).settled != usual.settled);
  // Mist of 1 um falls 0.06 mm/s, of 100 um 0.3 m/s: it is aloft for seconds, or for a bone step or two.
  CHECK(keyed({"mist_um=1", "mist_share=0.5"}).mist > 0.2 * (usual.removed - usual.held));
  CHECK(keyed({"mist_um=100", "mist_share=0.5"}).mist < 0.05 * usual.removed);
  CHECK(keyed({"mist_cloud_mm=0", "mist_um=5", "mist_share=0.5"}).mist < keyed({"mist_um=5", "mist_share=0.5"}).mist);
  CHECK(keyed({"bulk=6"}).most_hidden > usual.most_hidden);
  CHECK(keyed({"reach_mm=2"}).lost > usual.lost);
  CHECK(keyed({"heap_cell_mm=0.25"}).hidden != usual.hidden);
  CHECK(keyed({"down=[0, 1, -1]"}).settled < usual.settled);
  CHECK(keyed({"seed=2"}).hidden != usual.hidden);
  // Coarse and dense chips fly farther: beyond the plate, of which the rim is 2 mm away.
  const std::string fast = "throw_share=2";
  const double lost = keyed({fast}).lost;
  CHECK(keyed({fast, "smallest_um=200"}).lost > lost);
  CHECK(keyed({fast, "chip_ratio=10000"}).lost > lost);
  CHECK(keyed({fast, "chip_ratio=10000", "largest_um=60"}).lost < keyed({fast, "chip_ratio=10000"}).lost);
  CHECK(keyed({fast, "density_kg_per_m3=10000"}).lost > lost);
  CHECK(keyed({fast, "size_spread=8"}).lost != lost);
  // Rinsing and suction.
  const auto rinsed = [&](const std::vector<std::string>& keys) { return keyed(keys, "[dust]\n" + std::string(kSaline)).rinsed; };
  CHECK(rinsed({"rinse_s=10"}) < rinsed({}));
  CHECK(rinsed({"rinse_load=0.001"}) < rinsed({}));
  CHECK(rinsed({"rinse_load=0"}) == 0.0);
  const auto sucked = [&](const std::vector<std::string>& keys) { return keyed(keys, "[dust]\n[dust.suction]\n").sucked; };
  CHECK(sucked({"suction.flow_l_per_min=1"}) < sucked({}));
  CHECK(sucked({"suction.reach_mm=2"}) < sucked({}));
  CHECK(sucked({"suction.distance_mm=40"}) == 0.0);
}

TEST_CASE("dust: what the bit holds follows clearing_per_rev by the closed form, from the recorded removal") {
  const TemporaryFolder folder;
  constexpr double kSpin = 1000.0 / 60.0, kStep = 0.02;  // [rev/s], [s]
  for (const double clearing : {0.005, 0.01, 0.02}) {
    CAPTURE(clearing);
    DrillRun run(plate("[record]\n[dust]\n", {fmt::format("dust.clearing_per_rev={}", clearing)}));
    run_recorded(run, folder.file("run.sqlite"));
    const std::vector<double> removed = session_column(folder.file("run.sqlite"), "removed_mass");  // [m^3] after each step
    // dC/dt = V/dt - k C over each step: what is removed in it decays for half of it on the mean; k dt of at most 0.07 makes that wrong by (k dt)^2 / 24.
    const auto held = [&](double k) {
      double sum = 0.0;
      for (std::size_t n = 1; n < removed.size(); ++n)
        sum = sum * std::exp(-k * kStep) + (removed[n] - removed[n - 1]) * std::exp(-0.5 * k * kStep);
      return sum * 1e9;
    };
    const double found = outcome_of(run).held, expected = held(clearing * kSpin), other = held(1.5 * clearing * kSpin);
    // What it releases counts as held until it makes a particle of 0.01 mm3.
    CHECK(std::abs(found - expected) < 0.002 * expected + 0.01);
    CHECK(std::abs(found - other) > 0.05 * expected + 0.01);  // sabotage: another rate
  }
}

TEST_CASE("dust: saline that is full carries chips in proportion to rinse_load, at most that share of its own volume") {
  const auto rinsed = [](const std::vector<std::string>& keys) {
    std::vector<std::string> sets;
    for (const std::string& key : keys) sets.push_back("dust." + key);
    return drill("[dust]\n" + std::string(kSaline), sets).rinsed;
  };
  // 60 ml/min of 1e-6: 1e-3 mm3/s, less than what falls from the first chips on.
  const double once = rinsed({"rinse_load=1e-6"}), twice = rinsed({"rinse_load=2e-6"});
  CHECK(once > 0.5 * 6e-3);
  CHECK(once <= 6e-3 * (1.0 + 1e-9));  // all of the six seconds
  CHECK(twice == doctest::Approx(2.0 * once).epsilon(0.02));
}

TEST_CASE("dust: a reset takes all chips away, and an undo those of the bone that it brings back") {
  SimulationOptions options;
  options.history = true;
  DrillRun run(plate("[dust]\n"), options);
  run.run();
  Stage& stage = run.simulation().stage();
  const Outcome before = outcome_of(run);
  REQUIRE(before.particles > 0.0);
  const auto undone = stage.undo();
  REQUIRE(undone);
  REQUIRE(*undone);
  const Outcome after = outcome_of(run);
  CHECK(after.particles == 0.0);
  CHECK(after.settled == 0.0);
  CHECK(after.hidden == 0.0);
  CHECK(after.undone == doctest::Approx(before.held + before.flying + before.settled).epsilon(1e-11));
  CHECK(after.sum() == doctest::Approx(after.removed).epsilon(1e-11));
  DrillRun again(plate("[dust]\n"), options);
  again.run();
  REQUIRE(again.simulation().stage().reset());
  CHECK(outcome_of(again).particles == 0.0);
  CHECK(outcome_of(again).error < 1e-11);
}

TEST_CASE("dust: a replay has the same bits") {
  const TemporaryFolder folder;
  DrillRun run(plate("[record]\n[spindle]\n[heat]\n[irrigation]\n[dust]\n[dust.suction]\nfrom_s = 1\n"));
  run_recorded(run, folder.file("run.sqlite"));
  ReplayRun replay(folder.file("run.sqlite"));
  const Outcome first = outcome_of(run), second = outcome_of(replay.run());
  CHECK(first.all() == second.all());
  CHECK(first.voxels == second.voxels);
  CHECK(first.forces == second.forces);
  const std::vector<double> hidden = session_column(folder.file("run.sqlite"), "dust_hidden");
  CHECK(*std::ranges::max_element(hidden) == doctest::Approx(first.most_hidden).epsilon(1e-3));
}

TEST_CASE("dust: bone steps of 1 to 100 ms, any law, extreme speed, no bone, a thin shell, dura, tremor: finite, and the balance closes") {
  struct Case {
    std::vector<std::string> sets;
    std::string volume = kPlateKeys, contact = kHeldKeys;
  };
  const std::string empty = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [6.0, 6.0, 6.0]
above_mm = 1.5
thickness_mm = 3.0
hardness = 0.0
)";
  const std::vector<Case> cases{{{"erosion.rate_hz=1000"}},
                                {{"erosion.rate_hz=10"}},
                                {{"erosion.law=energy"}},
                                {{"erosion.subvoxel=false"}},
                                {{"erosion.law=threshold"}},
                                {{"tool.spin_rpm=200000"}},
                                {{"tool.spin_rpm=1"}},
                                {{"hand.tremor_mm=0.3"}},
                                {{"dust.most_particles=1"}},
                                {{}, kPlateKeys, kPenaltyKeys},
                                {{}, kSkullPatchKeys},
                                {{}, kInnerTableKeys},
                                {{}, empty}};
  for (const Case& one : cases) {
    CAPTURE(one.sets.empty() ? one.volume : one.sets.front());
    const Outcome out = drill("[dust]\n[irrigation]\n", one.sets, one.volume, one.contact);
    for (const double value : out.all()) CHECK(std::isfinite(value));
    CHECK(out.error < 1e-11);
    CHECK(out.removed == doctest::Approx(out.eroded).epsilon(1e-12));
    CHECK(out.hidden <= 1.0);
  }
}

TEST_CASE("dust: a table that is wrong is refused at its place, with the range") {
  const auto refused = [](const std::string& keys, const std::string& part) {
    const std::vector<std::string> errors = errors_of("[dust]\n" + keys);
    CAPTURE(keys);
    REQUIRE(errors.size() == 1);
    CHECK(errors.front().find(part) != std::string::npos);
    CHECK(errors.front().find("small.toml:") == 0);
  };
  CHECK(errors_of("[dust]\n").empty());
  refused("most_particles = 0\n", "most_particles");
  refused("particle = 1\n", "particle_mm3");
  refused("particle_mm3 = 0\n", "particle_mm3");
  refused("largest_um = 10\n", "smallest_um");
  refused("mist_share = 2\n", "mist_share");
  refused("bulk = 0.5\n", "bulk");
  refused("down = [0, 0, 0]\n", "down");
  refused("[dust.suction]\nflow_l_per_min = 0\n", "flow_l_per_min");
  refused("reach_mm = 200\n", "reach_mm");
}

}  // namespace burrhole::test
