// [bleeding] in a scene: what flows, fills, is stopped, rinsed and sucked; the balance, keys, undo, replay, refused scenes.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/stage/bleeding_state.h"
#include "haptics/hand/hand_switches.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// A hand whose readings are given, with the spindle on until `stop` [s].
class GivenHand final : public HandSource {
 public:
  GivenHand(double depth, double stop, double period = 1e-3) : depth_(depth), stop_(stop), period_(period) {}
  const HandState& read() noexcept override {
    // Down to `depth` in half a second, then back above the bone.
    const double t = static_cast<double>(tick_) * period_;
    const double z = t < 0.5 ? 1e-3 - (depth_ + 1e-3) * t / 0.5 : std::min(3e-3, -depth_ + (depth_ + 3e-3) * (t - 0.5) / 0.2);
    state_.world_from_hand.translation = Vec3(0.0, 0.0, z);
    state_.spin = t < stop_ ? 1.0 : 0.0;
    state_.tick = tick_++;
    return state_;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  double depth_, stop_, period_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

/// 5 mm of skull, 3 mm of it diploe of one hardness, 0.45. A flat cylinder of 4 mm that cuts at once goes through it without contact.
SmallScene free_scene(const std::vector<std::string>& sets = {}) {
  SmallScene scene{.volume = kSkullPatchKeys,
                   .contact = false,
                   .sets = {"duration_s=3.0", "tool.name=\"punch\"", "tool.erosion_scale=1e4", "volume.extent_mm=[10.0, 10.0, 10.0]",
                            "volume.outer_table_mm=1.0", "volume.inner_table_mm=1.0", "volume.porosity=0.0"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  return scene;
}
constexpr double kRadius = 2e-3, kDiploe = 3e-3, kShare = 1.0 - 0.45 / 0.6;
const std::string kBleeding = "[bleeding]\nconductance_mm_per_s_kPa = 20\n";

struct Bled {
  GivenHand hand;
  std::unique_ptr<DrillRun> run;
  [[nodiscard]] double of(const char* name) const { return figure(run->simulation(), "bleeding", name); }
};

Bled bled(const std::string& tables = kBleeding, const std::vector<std::string>& sets = {}, double depth = 5.5e-3, double stop = 0.7) {
  Bled out{GivenHand(depth, stop), nullptr};
  SimulationOptions options;
  options.hand = &out.hand;
  options.history = true;
  const SmallScene scene = free_scene(sets);
  out.run = std::make_unique<DrillRun>(load_text(scene_text(scene) + tables, scene.sets), options);
  out.run->run();
  return out;
}

}  // namespace

TEST_CASE("bleeding: the flow is conductance x pressure x opened pores, and these are a cylinder's; finer voxels come nearer") {
  const double exact = kShare * 2.0 * std::numbers::pi * kRadius * kDiploe * 1e6;  // [mm^2]
  double errors[2] = {};
  for (int n = 0; n < 2; ++n) {
    const Bled run = bled(kBleeding, {n == 0 ? "volume.spacing_mm=0.5" : "volume.spacing_mm=0.25"});
    // Labels know the borders of the diploe to half a voxel each, of 3 mm.
    errors[n] = run.of("opened_pores_mm2") / exact - 1.0;
    CHECK(std::abs(errors[n]) < (n == 0 ? 0.17 : 0.09));
    const double flow = 20e-6 * 1300.0 * run.of("opened_pores_mm2") * 1e-6 * std::exp(-2.6 / 300.0) * 60e6;  // [ml/min]
    CHECK(run.of("flow_ml_per_min") > 0.95 * flow * (1.0 - 50.0 / 1300.0));                                  // under at most 5 mm of blood
    CHECK(run.of("flow_ml_per_min") < 1.02 * flow);
    CHECK(run.of("balance_error") < 1e-12);
    CHECK(run.of("bled_ml") > 0.0);
    CHECK(run.of("bleeding_s") > 2.3);
  }
  MESSAGE("errors " << errors[0] << ", " << errors[1]);
}

TEST_CASE("bleeding: a session has the events and columns; wax is one of them, and stops it") {
  const TemporaryFolder folder;
  GivenHand hand(5.5e-3, 0.7);
  SimulationOptions options;
  options.hand = &hand;
  const SmallScene scene = free_scene();
  DrillRun run(load_text(scene_text(scene) + kBleeding + "wax = \"after\"\nwax_s = 2.0\n", scene.sets), options);
  run_recorded(run, folder.file("wax.bhs"));
  const auto session = SessionReader::open(folder.file("wax.bhs"));
  REQUIRE(session);
  std::vector<std::string> texts;
  for (const SessionEvent& event : session->events())
    if (event.kind == "bleeding" || event.kind == "floor") texts.push_back(event.kind + ": " + event.text);
  REQUIRE(texts.size() >= 3);
  CHECK(texts.front() == "bleeding: started");
  CHECK(std::ranges::find(texts, "floor: hidden by blood") != texts.end());
  CHECK(texts.back() == "bleeding: stopped by wax");
  const std::vector<double> total = session_column(folder.file("wax.bhs"), "blood_bled");
  CHECK(std::ranges::is_sorted(total));
  const double end = total.back() * 1e6;
  CHECK(end == doctest::Approx(figure(run.simulation(), "bleeding", "bled_ml")).epsilon(1e-3));
  CHECK(total[total.size() * 3 / 4] == total.back());  // 2.25 s
  CHECK(total[total.size() / 2] < total.back());
  CHECK(figure(run.simulation(), "bleeding", "flow_ml_per_min") == 0.0);
  CHECK(figure(run.simulation(), "bleeding", "opened_pores_mm2") == 0.0);
  CHECK(figure(run.simulation(), "bleeding", "waxed_pores_mm2") > 1.0);
  std::vector<std::string> lines;
  run.simulation().stage().warn(lines);
  CHECK(std::ranges::any_of(lines, [](const std::string& line) { return line.find("[bleeding] blood hid the floor") == 0; }));
}

TEST_CASE("bleeding: wax and suction by switch: wax once for each press, suction while it is on") {
  const auto with = [](std::vector<Input> inputs) {
    Bled out{GivenHand(5.5e-3, 0.7), nullptr};
    SimulationOptions options;
    options.hand = &out.hand;
    options.history = true;
    options.inputs = std::move(inputs);
    const SmallScene scene = free_scene();
    const std::string keys = kBleeding + "suction_ml_per_min = 100\nsuction_by_switch = true\nwax = \"switch\"\n";
    out.run = std::make_unique<DrillRun>(load_text(scene_text(scene) + keys, scene.sets), options);
    out.run->run();
    return out;
  };
  const auto at = [](double time, std::uint32_t bits) {
    return Input{static_cast<std::uint64_t>(time * 1000.0 + 0.5), InputKind::switches, static_cast<double>(bits), {}, {}};
  };
  const Bled never = with({}), waxed = with({at(2.0, kWaxSwitch), at(2.4, 0)}), held = with({at(0.0, kWaxSwitch)}),
             twice = with({at(1.0, kWaxSwitch), at(1.2, 0), at(2.0, kWaxSwitch)}), sucked = with({at(2.0, kSuctionSwitch)}),
             over = with({at(1.0, kSuctionSwitch), at(1.5, 0)});
  CHECK(never.of("waxings") == 0.0);
  CHECK(never.of("sucked_ml") == 0.0);
  CHECK(never.of("bled_ml") > 0.0);
  CHECK(waxed.of("waxings") == 1.0);
  CHECK(waxed.of("flow_ml_per_min") == 0.0);
  // As by the clock: the wax of `after` comes with the first step of bone at its time.
  CHECK(waxed.of("bled_ml") == doctest::Approx(bled(kBleeding + "wax = \"after\"\nwax_s = 2\n").of("bled_ml")).epsilon(0.02));
  CHECK(held.of("waxings") == 1.0);  // before there were pores: what is drilled later bleeds
  CHECK(held.of("flow_ml_per_min") > 0.0);
  CHECK(twice.of("waxings") == 2.0);
  CHECK(sucked.of("sucked_ml") > 0.8 * never.of("pooled_ml"));
  CHECK(sucked.of("pooled_ml") == 0.0);
  CHECK(over.of("sucked_ml") > 0.0);
  CHECK(over.of("sucked_ml") < sucked.of("sucked_ml"));
  CHECK(over.of("pooled_ml") > 0.0);
}

TEST_CASE("bleeding: each key changes what it names") {
  const Bled base = bled();
  const auto with = [&](const std::string& keys, const char* name) { return bled(kBleeding + keys).of(name); };
  CHECK(base.of("bled_ml") > 0.005);
  CHECK(with("pressure_kPa = 2.6\n", "bled_ml") == doctest::Approx(2.0 * base.of("bled_ml")).epsilon(0.03));
  CHECK(bled("[bleeding]\nconductance_mm_per_s_kPa = 10\n").of("bled_ml") == doctest::Approx(0.5 * base.of("bled_ml")).epsilon(0.03));
  // The bit has left the bone at 0.63 s; what it rubs until then is fresh again. Without blood over the pores the flow q of 1 s falls as exp(-t / T): by 3 s
  // q T (1 - exp(-2 s / T)) have bled, less dt / (2 T) = 0.13 % by steps of dt = 5 ms.
  const auto dry = [](const char* seconds, const char* name) {
    return bled(kBleeding + "coagulation_s = 2\nsuction_ml_per_min = 1000\n", {std::string("duration_s=") + seconds, "erosion.rate_hz=200"})
        .of(name);
  };
  const double clotting = dry("3.0", "bled_ml") - dry("1.0", "bled_ml"), flow = dry("1.0", "flow_ml_per_min") / 60.0;
  CHECK(clotting == doctest::Approx(flow * 2.0 * (1.0 - std::exp(-1.0))).epsilon(0.003));
  CHECK(std::abs(clotting / (flow * 2.2 * (1.0 - std::exp(-2.0 / 2.2))) - 1.0) > 0.03);  // sabotage
  // Voxels on the border to the tables, of 3 mm, are harder: they have pores by this alone.
  CHECK(with("solid_hardness = 0.9\n", "opened_pores_mm2") == doctest::Approx(2.0 * base.of("opened_pores_mm2")).epsilon(0.05));
  CHECK(with("solid_hardness = 0.4\n", "opened_pores_mm2") == 0.0);
  CHECK(with("suction_ml_per_min = 100\n", "pooled_ml") == 0.0);
  CHECK(with("suction_ml_per_min = 100\n", "sucked_ml") > 0.8 * base.of("pooled_ml"));
  CHECK(with("film_s = 10\n", "film_ml") > 2.0 * base.of("film_ml"));
  CHECK(with("reach_mm = 1.0\n", "opened_pores_mm2") < 0.1 * base.of("opened_pores_mm2"));
  CHECK(with("wax = \"after\"\nwax_s = 1\n", "bled_ml") < with("wax = \"after\"\nwax_s = 2\n", "bled_ml"));
  // The diploe opens at 0.16 s. The turning bit takes what is left of its wall until it leaves the bone at 0.63 s. Each is seen after two steps
  // of 20 ms at most.
  CHECK(with("wax = \"drilled\"\nwax_s = 1\n", "bleeding_s") == doctest::Approx(1.63 - 0.16).epsilon(0.04));
  CHECK(with("wax = \"drilled\"\nwax_s = 0.5\n", "waxings") == 1.0);
  // Down along +x: what the hole cannot hold overflows.
  CHECK(with("down = [1, 0, 0]\n", "overflowed_ml") > base.of("overflowed_ml"));
  // Wax before the last half of the cut: what lies within its depth stays closed.
  const auto waxed = [&](const char* depth) {
    return bled(kBleeding + "wax = \"after\"\nwax_s = 0.3\nwax_mm = " + depth + "\n").of("opened_pores_mm2");
  };
  CHECK(waxed("0") > waxed("1") + 0.2);
}

TEST_CASE("bleeding: the film is what bleeds in film_s, and with saline in film_s and wash_s together") {
  // V = q T (1 - exp(-t / T)), 1 / T = 1 / film_s + 1 / wash_s. The pores open from 0.15 to 0.38 s and the run ends at 3 s: 2.73 s in the mean. The flow q is
  // that at the end, 1 % less than at first by coagulation, and 4 % by 5 mm of blood over the lowest pores.
  const auto check = [](const std::string& keys, double time) {
    CAPTURE(keys);
    const Bled run = bled(kBleeding + keys);
    const double expected = run.of("flow_ml_per_min") / 60.0 * time * (1.0 - std::exp(-2.73 / time));
    CHECK(std::abs(run.of("film_ml") / expected - 1.0) < 0.05);
  };
  for (const double film : {0.5, 1.0, 10.0}) check(fmt::format("film_s = {}\n", film), film);
  for (const double wash : {0.5, 2.0})
    check(fmt::format("film_s = 100\nwash_s = {}\n[irrigation]\nalways = true\n", wash), 1.0 / (1.0 / 100.0 + 1.0 / wash));
}

TEST_CASE("bleeding: each millimetre of wax_mm closes a millimetre of the wall that is cut later; pores beyond reach_mm do not bleed") {
  // Waxed at 0.25 s, 2.25 to 2.5 mm deep; the diploe ends at 4 mm. Of the wall below, what lies within the wax stays closed: of wax that is deeper than the face is
  // wide, two voxels of 0.25 mm, each millimetre a millimetre. Borders are known to half a voxel, 0.125 mm, and areas to 9 %.
  const auto opened = [](double depth) {
    return bled(kBleeding + fmt::format("wax = \"after\"\nwax_s = 0.25\nwax_mm = {}\n", depth)).of("opened_pores_mm2");
  };
  const double ring = kShare * 2.0 * std::numbers::pi * kRadius * 1e-3 * 1e6;  // [mm^2] of a millimetre
  const double least = opened(0.5);
  for (const double depth : {0.75, 1.0, 1.25}) {
    CAPTURE(depth);
    CHECK(std::abs(least - opened(depth) - (depth - 0.5) * ring) < (0.125 + 0.09 * (depth - 0.5)) * ring);
  }
  // All wax closes the face itself, so from none to 0.5 mm it is less than that, and more than nothing where voxels lie between.
  const double none = opened(0.0);
  CHECK(none >= least);
  CHECK(none - least < 0.5 * ring);
  CHECK(bled(kBleeding + "reach_mm = 3\n").of("opened_pores_mm2") == doctest::Approx(bled().of("opened_pores_mm2")).epsilon(1e-9));
  // What is read is a box of whole voxels: its corners lie at up to 1.6 mm, inside the wall of 2 mm by a voxel.
  CHECK(bled(kBleeding + "reach_mm = 0.8\n").of("opened_pores_mm2") < 1e-6);
}

TEST_CASE("bleeding: irrigation rinses the hole, so the floor is seen again; without it blood stays") {
  const std::string wax = "wax = \"drilled\"\nwax_s = 0.1\n";
  const Bled dry = bled(kBleeding + wax), rinsed = bled(kBleeding + wax + "[irrigation]\nalways = true\nflow_ml_per_min = 30\n");
  CHECK(dry.of("rinsed_ml") == 0.0);
  CHECK(dry.of("pooled_ml") > 0.0);
  CHECK(rinsed.of("pooled_ml") < 0.01 * rinsed.of("bled_ml"));
  CHECK(rinsed.of("rinsed_ml") > 0.9 * rinsed.of("bled_ml"));
  CHECK(rinsed.of("floor_hidden_s") < dry.of("floor_hidden_s"));
  CHECK(rinsed.of("balance_error") < 1e-12);
  // Of saline that does not reach the hole nothing is rinsed.
  CHECK(bled(kBleeding + wax + "[irrigation]\nalways = true\nreach_mm = 0.1\n").of("rinsed_ml") < rinsed.of("rinsed_ml"));
  const Bled slow = bled(kBleeding + "wash_s = 100\nfilm_s = 100\n[irrigation]\nalways = true\n");
  CHECK(slow.of("film_ml") > 2.0 * bled(kBleeding + "wash_s = 1\nfilm_s = 100\n[irrigation]\nalways = true\n").of("film_ml"));
}

TEST_CASE("bleeding: steps of 2 to 100 ms bleed the same, and keep the balance") {
  const double fine = bled(kBleeding, {"erosion.rate_hz=500"}).of("bled_ml");
  for (const int rate : {100, 50, 20, 10}) {
    CAPTURE(rate);
    const Bled run = bled(kBleeding, {fmt::format("erosion.rate_hz={}", rate)});
    // Bone opens within a step, so up to half a step of 2.7 s is lost or gained.
    CHECK(run.of("bled_ml") == doctest::Approx(fine).epsilon(0.02 + 0.5 / rate / 2.7));
    CHECK(run.of("balance_error") < 1e-12);
  }
}

TEST_CASE("bleeding: dense bone does not bleed, which is a warning; a cut in the outer table alone neither") {
  GivenHand hand(2e-3, 0.7);
  SimulationOptions options;
  options.hand = &hand;
  SmallScene scene{.contact = false, .sets = {"duration_s=1.0", "tool.name=\"punch\"", "tool.erosion_scale=1e4"}};
  DrillRun run(load_text(scene_text(scene) + kBleeding, scene.sets), options);
  run.run();
  CHECK(figure(run.simulation(), "bleeding", "bled_ml") == 0.0);
  std::vector<std::string> lines;
  run.simulation().stage().warn(lines);
  CHECK(std::ranges::any_of(lines, [](const std::string& line) { return line.find("there is no spongy bone") != std::string::npos; }));
  CHECK(bled(kBleeding, {}, 0.5e-3).of("bled_ml") == 0.0);
}

TEST_CASE("bleeding: bone and forces keep their bits, a replay has the same figures") {
  const TemporaryFolder folder;
  const std::string path = folder.file("bled.bhs");
  SmallScene scene{.volume = kSkullPatchKeys,
                   .record = true,
                   .sets = {"duration_s=4.0", "tool.erosion_scale=5", "volume.outer_table_mm=1.0", "volume.inner_table_mm=1.0"}};
  DrillRun run(load_text(scene_text(scene) + kBleeding + "wax = \"after\"\nwax_s = 3\n[irrigation]\n", scene.sets));
  run_recorded(run, path);
  CHECK(figure(run.simulation(), "bleeding", "bled_ml") > 0.0);
  ReplayRun again(path);
  CHECK(again.run().voxel_hash() == run.voxel_hash());
  CHECK(again.run().simulation().sent_hash() == run.simulation().sent_hash());
  for (const char* const name :
       {"bled_ml", "pooled_ml", "rinsed_ml", "overflowed_ml", "highest_level_mm", "opened_pores_mm2", "waxed_pores_mm2"})
    CHECK(figure(again.run().simulation(), "bleeding", name) == figure(run.simulation(), "bleeding", name));
  DrillRun without(load_text(scene_text(scene), scene.sets));
  without.run();
  CHECK(without.voxel_hash() == run.voxel_hash());
  CHECK(without.simulation().sent_hash() == run.simulation().sent_hash());
}

TEST_CASE("bleeding: a reset closes the pores and takes wax away; the blood that has no room any more has overflowed in the next step") {
  for (const char* const wax : {"", "wax = \"after\"\nwax_s = 2\n"}) {
    Bled run = bled(kBleeding + wax);
    const double bled_before = run.of("bled_ml");
    CHECK(run.of("pooled_ml") > 0.0);
    REQUIRE(run.run->simulation().stage().reset());
    CHECK(std::abs(run.of("opened_pores_mm2")) < 1e-9);
    CHECK(std::abs(run.of("waxed_pores_mm2")) < 1e-9);
    CHECK(std::abs(run.of("cut_spongy_mm2")) < 1e-9);
    CHECK(run.of("hole_ml") == 0.0);
    run.run->simulation().stage().cut(run.run->simulation().stage().contact->state());
    CHECK(run.of("pooled_ml") == 0.0);
    CHECK(run.of("bled_ml") == bled_before);
    CHECK(run.of("balance_error") < 1e-12);
    CHECK(run.of("flow_ml_per_min") == 0.0);
  }
}

TEST_CASE("bleeding: wrong keys are refused with their place; without the table there is no step, column or figure of it") {
  const auto first = [](const std::string& table) {
    const SmallScene scene = free_scene();
    Issues issues;
    auto document = TomlDocument::parse(scene_text(scene) + table, "small.toml");
    REQUIRE(document);
    for (const std::string& set : scene.sets) REQUIRE(document->set(set));
    (void)load_scene(*document, test_context(), issues);
    REQUIRE_FALSE(issues.empty());
    CHECK(issues.front().place.find("small.toml:") == 0);
    CHECK(std::ranges::count(issues.front().place, ':') == 2);
    return issues.front().message;
  };
  CHECK(first("[bleeding]\nwax_s = 3\n").find("needs wax") != std::string::npos);
  CHECK(first("[bleeding]\ndown = [0, 0, 0]\n").find("must not be zero") != std::string::npos);
  CHECK_FALSE(first("[bleeding]\nwax = \"late\"\n").empty());
  CHECK(first("[bleeding]\nwax = \"switch\"\nwax_s = 3\n").find("needs wax") != std::string::npos);
  CHECK(first("[bleeding]\nsuction_by_switch = true\n").find("needs suction_ml_per_min above 0") != std::string::npos);
  CHECK_FALSE(first("[bleeding]\ncoagulation_s = 0\n").empty());
  CHECK_FALSE(first("[bleeding]\npresure_kPa = 1\n").empty());
  DrillRun without(free_scene());
  CHECK(std::ranges::count(without.simulation().stage().graph.columns(Clock::contact), std::string("bleeding"), &StepColumn::name) == 0);
  CHECK_FALSE(without.simulation().stage().figure("bleeding", "bled_ml").has_value());
  CHECK_FALSE(without.simulation().stage().graph.is_written(slots::kBleeding.name));
}

}  // namespace burrhole::test
