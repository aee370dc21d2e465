// [dust] in a scene: the amount by which each key changes the figure that it names, by closed forms and twins on the recorded removal.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "app/job/plan.h"
#include "core/debris/chip_flight.h"
#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kStep = 0.02, kSpin = 1000.0 / 60.0;  // [s] of bone, [rev/s]
constexpr std::size_t kTicks = 20;                     // of the servo in a bone step

/// A plate of which no mist finds the rim, and which is not drilled through.
constexpr const char* kDeepPlate = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [20.0, 20.0, 10.0]
above_mm = 1.5
thickness_mm = 7.0
hardness = 0.8
)";

struct Course {
  std::vector<double> removed, flying, settled;  // [m^3] after each bone step
  std::vector<std::pair<std::string, double>> figures;
  std::uint64_t voxels = 0;
  [[nodiscard]] double of(const std::string& name) const {
    const auto at = std::ranges::find(figures, name, &std::pair<std::string, double>::first);
    REQUIRE_MESSAGE(at != figures.end(), name);
    return at->second;
  }
};

/// The plate, drilled for 6 s by the script's hand.
Course drilled(const std::vector<std::string>& keys, const std::string& tables = "[dust]\n", const std::string& volume = kPlateKeys) {
  std::vector<std::string> sets{"duration_s=6.0", "dust.particle_mm3=0.01"};
  for (const std::string& key : keys) sets.push_back("dust." + key);
  LoadedScene loaded = load_text(scene_text({.volume = volume}) + tables, sets);
  Course out;
  const double *removed = nullptr, *flying = nullptr, *settled = nullptr;
  std::size_t ticks = 0;
  const auto note = [&] {
    out.removed.push_back(*removed);
    out.flying.push_back(*flying);
    out.settled.push_back(*settled);
  };
  WatchedHand hand(loaded, [&] {
    if (++ticks > kTicks && ticks % kTicks == kTicks / 2) note();
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  for (const StepColumn& column : run.simulation().stage().graph.columns(Clock::simulation)) {
    if (column.name == "removed_mass") removed = column.value;
    if (column.name == "dust_flying") flying = column.value;
    if (column.name == "dust_settled") settled = column.value;
  }
  REQUIRE(removed != nullptr);
  REQUIRE(settled != nullptr);
  run.run();
  note();  // the last step
  REQUIRE(out.removed.size() == 300);
  for (const char* const name : {"removed_mm3", "held_mm3", "flying_mm3", "mist_mm3", "settled_mm3", "rinsed_mm3", "sucked_mm3", "lost_mm3",
                                 "hidden_share", "particles", "mean_chip_um"})
    out.figures.emplace_back(name, figure(run.simulation(), "dust", name));
  out.voxels = run.voxel_hash();
  return out;
}

/// [m^3] What leaves the bit in each step: a share of `clearing` a revolution of what it holds.
std::vector<double> released(const Course& course, double clearing) {
  const double decay = clearing * kSpin * kStep;
  double held = 0.0, before = 0.0;
  std::vector<double> out;
  for (const double removed : course.removed) {
    const double arrives = removed - before, kept = held * std::exp(-decay) + arrives * (1.0 - std::exp(-decay)) / decay;
    out.push_back(held + arrives - kept);
    held = kept;
    before = removed;
  }
  return out;
}

constexpr double kMm3 = 1e-9;  // [m^3]

}  // namespace

TEST_CASE("dust: particle_mm3 is the bone of each particle") {
  for (const double particle : {0.01, 0.02, 0.1}) {
    CAPTURE(particle);
    const Course run = drilled({fmt::format("particle_mm3={}", particle), "mist_share=0"});
    const double count = (run.of("flying_mm3") + run.of("settled_mm3")) / particle;
    REQUIRE(count > 10.0);
    CHECK(run.of("particles") == doctest::Approx(count).epsilon(1e-9));
  }
}

TEST_CASE("dust: mean_chip_um is chip_ratio times the thickness of the cut, within smallest_um and largest_um, times that of size_spread") {
  const auto mean = [](const std::vector<std::string>& keys) {
    std::vector<std::string> all{"mist_share=0", "size_spread=1"};
    all.insert(all.end(), keys.begin(), keys.end());
    return drilled(all).of("mean_chip_um");
  };
  CHECK(mean({"chip_ratio=0.001"}) == doctest::Approx(50.0).epsilon(1e-12));
  CHECK(mean({"chip_ratio=0.001", "smallest_um=80"}) == doctest::Approx(80.0).epsilon(1e-12));
  CHECK(mean({"chip_ratio=10000"}) == doctest::Approx(500.0).epsilon(1e-12));
  CHECK(mean({"chip_ratio=10000", "largest_um=300"}) == doctest::Approx(300.0).epsilon(1e-12));
  // Between them in proportion: the cut does not depend on dust. Chips that a heap gives back to the bit count again, at another time in other runs:
  // a hundredth.
  const double once = mean({"chip_ratio=20", "smallest_um=1", "largest_um=5000"});
  CHECK(once > 10.0);
  CHECK(mean({"chip_ratio=40", "smallest_um=1", "largest_um=5000"}) == doctest::Approx(2.0 * once).epsilon(0.01));
  // sinh(ln s) / ln s of diameters that spread evenly in their logarithm, to four standard deviations of 300 chips.
  const Course wide = drilled({"mist_share=0", "size_spread=4", "chip_ratio=10000", "largest_um=300"});
  const double log = std::log(4.0), factor = std::sinh(log) / log, square = std::sinh(2.0 * log) / (2.0 * log);
  const double count = (wide.of("removed_mm3") - wide.of("held_mm3")) / 0.01;
  REQUIRE(count > 200.0);
  CHECK(std::abs(wide.of("mean_chip_um") / 300.0 - factor) < 4.0 * std::sqrt((square - factor * factor) / count));
}

TEST_CASE("dust: mist_share of what leaves the bit is mist; of 0.5 um all of it stays aloft") {
  for (const double share : {0.1, 0.4}) {
    CAPTURE(share);
    const Course run = drilled({fmt::format("mist_share={}", share), "mist_um=0.5"}, "[dust]\n", kDeepPlate);
    const double out = run.of("removed_mm3") - run.of("held_mm3");
    // It falls 14 um/s, 0.09 mm of a cloud of 8 mm: 1 %, and heaps stand in the cloud's lowest millimetre.
    CHECK(run.of("mist_mm3") > 0.93 * share * out);
    CHECK(run.of("mist_mm3") < share * out + 0.001);  // what waits for a particle is held
  }
}

TEST_CASE("dust: mist falls at Stokes' speed out of its cloud, so less is aloft the coarser and denser it is and the smaller the cloud") {
  struct Case {
    double diameter, density, cloud;  // [m], [kg/m^3], [m]
  };
  const double quantum = 0.1 * 0.002 * kMm3;  // [m^3] of a particle of mist
  for (const Case& one : {Case{15e-6, 1900.0, 8e-3}, {20e-6, 1900.0, 8e-3}, {15e-6, 3800.0, 8e-3}, {15e-6, 1900.0, 4e-3}}) {
    CAPTURE(one.diameter);
    CAPTURE(one.density);
    CAPTURE(one.cloud);
    const Course run =
        drilled({"particle_mm3=0.002", "mist_share=1", "most_particles=100000", fmt::format("mist_um={}", one.diameter * 1e6),
                 fmt::format("density_kg_per_m3={}", one.density), fmt::format("mist_cloud_mm={}", one.cloud * 1e3)},
                "[dust]\n", kDeepPlate);
    const std::vector<double> leaves = released(run, 0.05);
    // Even over the cloud's height at first; what left in the step m has fallen for the steps since, and in its own.
    const auto aloft = [&](double speed, double* scatter) {
      double sum = 0.0, variance = 0.0;
      for (std::size_t m = 0; m < leaves.size(); ++m) {
        const double since = static_cast<double>(leaves.size() - m) * kStep, share = std::clamp(1.0 - speed * since / one.cloud, 0.0, 1.0);
        sum += leaves[m] * share;
        variance += leaves[m] / quantum * share * (1.0 - share);
      }
      if (scatter != nullptr) *scatter = std::sqrt(variance) * quantum;
      return sum / kMm3;
    };
    const double speed = one.density * 9.81 * one.diameter * one.diameter / (18.0 * 1.8e-5);
    double scatter = 0.0;
    const double expected = aloft(speed, &scatter), found = run.of("mist_mm3");
    MESSAGE("aloft " << found << " mm3, expected " << expected << ", scatter " << scatter / kMm3);
    // The mouth is up to half a voxel above the plate, 3 % of 4 mm. Over the hole, of 1.25 mm radius and up to 3 mm deep, mist falls farther, and the
    // bit takes it up and releases it again: that share of the cloud's square counts once more, and longer by the depth over half of the cloud.
    const double hole = std::numbers::pi * 1.25e-3 * 1.25e-3 / (4.0 * one.cloud * one.cloud) * (1.0 + 3e-3 / (0.5 * one.cloud));
    const double off = 4.0 * scatter / kMm3 + 0.03 * expected;
    CHECK(found > expected - off);
    CHECK(found < expected * (1.0 + hole) + off);
    CHECK(found > aloft(1.5 * speed, nullptr) + off + hole * expected);  // sabotage
    CHECK(found < aloft(speed / 1.5, nullptr) - off);
  }
}

TEST_CASE("dust: rinse_s is the time constant with which saline takes all wet chips") {
  const std::string saline = "[dust]\n[irrigation]\nalways = true\nflow_ml_per_min = 10000\nreach_mm = 200\n";
  for (const double time : {0.5, 1.0, 4.0}) {
    CAPTURE(time);
    const Course run = drilled({fmt::format("rinse_s={}", time)}, saline);
    // Of what is wet before a step exp(-dt / T) is left: W of it after, so W (exp(dt / T) - 1) went. The last thousandth of a particle goes at once.
    const auto rinsed = [&](double constant) {
      double sum = 0.0;
      for (std::size_t n = 0; n < run.flying.size(); ++n) sum += (run.flying[n] + run.settled[n]) * std::expm1(kStep / constant);
      return sum / kMm3;
    };
    CHECK(run.of("rinsed_mm3") > 0.5);
    CHECK(run.of("rinsed_mm3") == doctest::Approx(rinsed(time)).epsilon(2e-3));
    CHECK(std::abs(run.of("rinsed_mm3") - rinsed(1.1 * time)) > 0.02 * run.of("rinsed_mm3"));  // sabotage
  }
}

TEST_CASE("dust: a suction takes as far as its flow over 4 pi r2 lifts a chip, or its reach") {
  // Chips of one size: within r either by the flow or by the reach, the same chips, so the same bits.
  const double falls = terminal_speed(chip_drag({}, 100e-6), 9.81);
  const auto sucked = [&](double flow, double reach) {
    return drilled({"mist_share=0", "size_spread=1", "smallest_um=100", "largest_um=100", "suction.distance_mm=3",
                    fmt::format("suction.flow_l_per_min={:.17g}", flow * 60e3), fmt::format("suction.reach_mm={:.17g}", reach * 1e3)},
                   "[dust]\n[dust.suction]\n")
        .of("sucked_mm3");
  };
  const auto flow_of = [&](double radius) { return 4.0 * std::numbers::pi * radius * radius * falls; };
  double before = 0.0;
  for (const double radius : {2.5e-3, 3.5e-3, 4.5e-3}) {
    CAPTURE(radius);
    const double by_flow = sucked(flow_of(radius), 0.1);
    CHECK(by_flow == sucked(1e-2, radius));
    CHECK(by_flow > before);
    before = by_flow;
  }
  CHECK(sucked(flow_of(2.5e-3), 0.1) != sucked(flow_of(2.6e-3), 0.1));  // sabotage
}

namespace {

constexpr double kDeep = 2.06e-3, kSucks = 0.5;  // [m] of the tip; [s] from when on a nozzle sucks

/// Down into the plate in 0.2 s, where the bit goes on turning.
class StandingHand final : public HandSource {
 public:
  const HandState& read() noexcept override {
    state_.world_from_hand.translation = Vec3(0.0, 0.0, std::max(-kDeep, 0.5e-3 - 15e-6 * static_cast<double>(tick_)));
    state_.tick = tick_++;
    return state_;
  }
  void apply(const Wrench&) noexcept override {}

 private:
  HandState state_;
  std::uint64_t tick_ = 0;
};

constexpr double kCloud = 10e-3, kMist = 0.5e-6;  // [m]

/// Of a cloud of mist round a pin that stands, the share that a nozzle has taken.
struct Sucked {
  double share, count;  // [-]; particles
};
Sucked suck_mist(double distance, double radius) {
  const double falls = terminal_speed(chip_drag({}, kMist), 9.81), flow = 4.0 * std::numbers::pi * radius * radius * falls;
  StandingHand hand;
  SimulationOptions options;
  options.hand = &hand;
  const SmallScene scene{.volume = kDeepPlate, .contact = false};
  const std::string tables = fmt::format(
      "[dust]\nparticle_mm3 = 0.02\nmist_share = 1\nmist_um = {}\nmist_cloud_mm = {}\nreach_mm = 30\n[dust.suction]\nfrom_s = {}\nreach_mm "
      "= 200\n"
      "distance_mm = {}\nflow_l_per_min = {:.17g}\n",
      kMist * 1e6, kCloud * 1e3, kSucks, distance * 1e3, flow * 60e3);
  DrillRun run(load_text(scene_text(scene) + tables, {"duration_s=3.0", "tool.name=\"pin\"", "tool.erosion_scale=1e4"}), options);
  run.run();
  const auto of = [&](const char* name) { return figure(run.simulation(), "dust", name); };
  const double left = of("sucked_mm3") + of("flying_mm3") + of("settled_mm3");
  CHECK(of("lost_mm3") == 0.0);
  return {of("sucked_mm3") / left, left / 0.002};
}

/// The same in closed form: the share of a box, of 2 kCloud across and kCloud high, over each place of the bit's rim, that lies within a ball.
double share_within(double distance, double radius) {
  // The tip of the nozzle's frame; mist leaves a voxel beside the bit, at the first half voxel over the tip that is in the open.
  const double half = 0.125e-3, mouth = half * std::ceil(kDeep / half) - kDeep, ring = 1e-3 + 2.0 * half, away = distance * std::sqrt(0.5);
  const Vec3 nozzle(away, 0.0, away - kDeep);
  constexpr int kAngles = 12, kCells = 40;
  int within = 0;
  for (int a = 0; a < kAngles; ++a)
    for (int k = 0; k < kCells; ++k)
      for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
          const auto place = [](int n) { return (n + 0.5) / kCells; };
          const double angle = 2.0 * std::numbers::pi * a / kAngles;
          const Vec3 p = Vec3(ring * std::cos(angle), ring * std::sin(angle), mouth) +
                         kCloud * Vec3(2.0 * place(i) - 1.0, 2.0 * place(j) - 1.0, place(k));
          within += glm::length(p - nozzle) < radius ? 1 : 0;
        }
  return static_cast<double>(within) / (kAngles * kCells * kCells * kCells);
}

}  // namespace

TEST_CASE("dust: a suction at distance_mm takes the share of a cloud of mist that lies within the radius of its flow") {
  // Mist of 0.5 um falls by 0.04 mm in the run and is even in its box, so each particle is in the ball by the same chance: four standard deviations of a binomial.
  // The grid of the closed form and the bit's radius of whole points are good for 0.005.
  for (const double distance : {8e-3, 30e-3, 100e-3})
    for (const double farther : {-4e-3, 0.0, 4e-3}) {
      const double radius = distance + farther;
      CAPTURE(distance);
      CAPTURE(farther);
      const Sucked found = suck_mist(distance, radius);
      const double expected = share_within(distance, radius), off = 4.0 * std::sqrt(expected * (1.0 - expected) / found.count) + 0.005;
      MESSAGE("share " << found.share << " of " << found.count << " particles, expected " << expected << ", within " << off);
      CHECK(std::abs(found.share - expected) < off);
      if (distance > 20e-3) CHECK(std::abs(found.share - share_within(1.1 * distance, radius)) > off);  // sabotage
    }
}

TEST_CASE("dust: gravity that points up takes all chips away from the bone") {
  const Course run = drilled({"down=[0, 0, 1]"}, "[dust]\n", kDeepPlate);
  CHECK(run.of("settled_mm3") == 0.0);
  CHECK(run.of("hidden_share") == 0.0);
  CHECK(run.of("lost_mm3") > 0.0);
  CHECK(run.of("lost_mm3") == doctest::Approx(run.of("removed_mm3") - run.of("held_mm3") - run.of("flying_mm3")).epsilon(1e-9));
}

TEST_CASE("dust: heap_cell_mm and reach_mm are the edge of the cells and the distance of their box from the drilled line") {
  // The line has the plate's 3 mm. `explain` prints the cells.
  for (const auto& [cell, reach] : {std::pair{0.6, 20.0}, {0.3, 20.0}, {0.6, 7.0}}) {
    const Plan plan = make_plan(load_text(scene_text({}) + fmt::format("[dust]\nheap_cell_mm = {}\nreach_mm = {}\n", cell, reach), {}));
    const auto row = std::ranges::find(plan.rows, std::string("dust"), &PlanRow::table);
    REQUIRE(row != plan.rows.end());
    const double across = std::floor(2.0 * reach / cell + 1e-9) + 1.0, along = std::floor((2.0 * reach + 3.0) / cell + 1e-9) + 1.0;
    CHECK(row->detail.find(fmt::format(", {:.0f} cells of {:g} mm", across * across * along, cell)) != std::string::npos);
  }
}

TEST_CASE("dust: another seed puts chips elsewhere, with the same statistics and the same bone") {
  // Of n particles thrown towards the rim, a share p goes over it: the volumes of two seeds differ by four standard deviations of a binomial at most.
  std::vector<Course> runs;
  for (int seed = 1; seed <= 5; ++seed) runs.push_back(drilled({"throw_share=2", "mist_share=0", fmt::format("seed={}", seed)}));
  double lost = 0.0, left = 0.0;
  for (const Course& run : runs) {
    lost += run.of("lost_mm3") / 5.0;
    left += (run.of("removed_mm3") - run.of("held_mm3")) / 5.0;
  }
  const double share = lost / left, count = left / 0.01, deviation = left * std::sqrt(share * (1.0 - share) / count);
  MESSAGE(count << " particles, of which " << share << " are lost; standard deviation " << deviation << " mm3");
  REQUIRE(share > 0.02);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    CHECK(runs[n].voxels == runs[0].voxels);
    CHECK(runs[n].removed == runs[0].removed);
    CHECK(std::abs(runs[n].of("lost_mm3") - lost) < 4.0 * deviation);
    if (n > 0) CHECK(runs[n].settled != runs[0].settled);
  }
  // Sabotage: a throw that is half as fast again is found.
  CHECK(std::abs(drilled({"throw_share=3", "mist_share=0"}).of("lost_mm3") - lost) > 4.0 * deviation);
}

}  // namespace burrhole::test
