// [dura] in a scene: what is indented, felt and torn; undo, replay, refused scenes.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/stage/dura_state.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// A hand whose readings are given; it sums the work that is done on it.
class GivenHand final : public HandSource {
 public:
  explicit GivenHand(std::function<Vec3(double)> at, double period = 1e-3) : at_(std::move(at)), period_(period) {}
  const HandState& read() noexcept override {
    state_.world_from_hand.translation = place(tick_);
    state_.tick = tick_;
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override {
    work += glm::dot(on_hand.force, place(tick_ + 1) - place(tick_));
    most = std::max(most, work);
    largest = std::max(largest, on_hand.force.z);
    last = on_hand.force.z;
    ++tick_;
  }
  double work = 0.0, most = 0.0, largest = 0.0, last = 0.0;  // [J]; [N] along +z

 private:
  [[nodiscard]] Vec3 place(std::uint64_t tick) const { return at_(static_cast<double>(tick) * period_); }
  std::function<Vec3(double)> at_;
  double period_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

/// A patch of 5 mm of bone over dura, wide enough for the sheet. Without contact and erosion the ball goes through the bone.
SmallScene free_scene(const std::vector<std::string>& sets = {}) {
  SmallScene scene{.volume = kSkullPatchKeys,
                   .contact = false,
                   .erosion = false,
                   .sets = {"duration_s=1.5", "volume.extent_mm=[16.0, 16.0, 12.0]", "volume.spacing_mm=0.5", "volume.dura_mm=1.0"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  return scene;
}
const std::string kDura = "[dura]\nradius_mm = 6\nspacing_mm = 0.6\npulse_Pa = 0\n";

/// Down from 1 mm above the inner surface of the bone to `depth` [m] below it, and up again. The tool's origin is its lowest point.
std::function<Vec3(double)> dive(double depth, double period = 1.5) {
  return [depth, period](double t) {
    const double share = 0.5 * (1.0 - std::cos(2.0 * 3.14159265358979 * std::min(t / period, 1.0)));
    return Vec3(0.0, 0.0, -4.0e-3 - share * (1.0e-3 + depth));
  };
}

struct Dived {
  GivenHand hand;
  std::unique_ptr<DrillRun> run;
  double of(const char* name) const { return figure(run->simulation(), "dura", name); }
};

Dived dived(double depth, const std::string& dura = kDura, const std::vector<std::string>& sets = {}) {
  Dived out{GivenHand(dive(depth)), nullptr};
  SimulationOptions options;
  options.hand = &out.hand;
  const SmallScene scene = free_scene(sets);
  out.run = std::make_unique<DrillRun>(load_text(scene_text(scene) + dura, scene.sets), options);
  out.run->run();
  return out;
}

}  // namespace

TEST_CASE("dura: it is indented by as much as the bit goes below the bone, is felt, and is whole and at rest afterwards") {
  const Dived run = dived(0.8e-3);
  const double indentation = run.of("indentation_mm");
  // The bit's lowest point goes about 0.8 mm below; its shell has a pitch of 0.25 mm, and the sheet's nodes overshoot by the slope times
  // their distance.
  CHECK(indentation > 0.3);
  CHECK(indentation < 1.4);
  CHECK(run.of("peak_force_N") > 0.05);
  CHECK(run.of("torn_edges") == 0.0);
  CHECK(run.hand.largest > 0.02);
  CHECK(run.hand.last == 0.0);
  CHECK(run.of("felt_N") == doctest::Approx(run.hand.largest).epsilon(0.02));
  CHECK(run.hand.most <= 1e-3 + 1e-12);  // the allowance
  CHECK(run.hand.work < 1e-3);
  const Dived deeper = dived(1.2e-3);
  CHECK(deeper.of("indentation_mm") > indentation + 0.2);
  CHECK(deeper.of("peak_force_N") > run.of("peak_force_N"));
  const Dived above = dived(-0.8e-3);
  CHECK(above.of("indentation_mm") == 0.0);
  CHECK(above.hand.largest == 0.0);
}

TEST_CASE("dura: a deep plunge tears it, which is an event and a warning; the force then ends") {
  const TemporaryFolder folder;
  GivenHand hand(dive(6e-3));
  SimulationOptions options;
  options.hand = &hand;
  const SmallScene scene = free_scene();
  DrillRun run(load_text(scene_text(scene) + kDura, scene.sets), options);
  run_recorded(run, folder.file("torn.bhs"));
  CHECK(figure(run.simulation(), "dura", "torn_edges") > 0.0);
  CHECK(figure(run.simulation(), "dura", "largest_strain") > 0.11);
  CHECK(figure(run.simulation(), "dura", "largest_strain") <= 1.02 * 0.11);
  const auto session = SessionReader::open(folder.file("torn.bhs"));
  REQUIRE(session);
  std::vector<std::string> texts;
  for (const SessionEvent& event : session->events())
    if (event.kind == "dura") texts.push_back(event.text);
  REQUIRE(texts.size() >= 2);
  CHECK(texts[0] == "pressed");
  CHECK(texts.back() == "torn");
  std::vector<std::string> lines;
  run.simulation().stage().warn(lines);
  CHECK(std::ranges::any_of(lines, [](const std::string& line) { return line.find("[dura] the dura tore") == 0; }));
}

TEST_CASE("dura: no energy above the allowance at any rate of servo and bone, and no force that is not finite") {
  for (const auto& [servo, bone] : {std::pair{100, 10}, std::pair{200, 20}, std::pair{1000, 50}, std::pair{1000, 500}}) {
    CAPTURE(servo);
    const double period = 1.0 / servo;
    GivenHand hand([](double t) { return Vec3(0.3e-3 * std::sin(9.0 * t), 0.0, -4.0e-3 - 1.1e-3 * (1.0 - std::cos(15.0 * t))); }, period);
    SimulationOptions options;
    options.hand = &hand;
    SmallScene scene = free_scene({fmt::format("servo_hz={}", servo), fmt::format("erosion.rate_hz={}", bone)});
    scene.erosion = true;
    scene.sets.push_back("tool.spin_rpm=0");
    DrillRun run(load_text(scene_text(scene) + kDura, scene.sets), options);
    run.run();
    CHECK(std::isfinite(hand.work));
    CHECK(hand.most <= 1e-3 + 1e-12);
    CHECK(figure(run.simulation(), "dura", "peak_force_N") > 0.05);
  }
}

TEST_CASE("dura: it tears at strain_limit, and largest_N is the largest force that is felt") {
  for (const double limit : {0.05, 0.11, 0.2}) {
    CAPTURE(limit);
    const Dived torn = dived(6e-3, kDura + fmt::format("strain_limit = {}\n", limit));
    CHECK(torn.of("torn_edges") > 0.0);
    CHECK(torn.of("largest_strain") >= limit);
    CHECK(torn.of("largest_strain") <= 1.02 * limit);  // an edge breaks within 2 % of the limit
  }
  for (const double largest : {0.01, 0.02})
    CHECK(dived(1.0e-3, kDura + fmt::format("largest_N = {}\n", largest)).of("felt_N") == doctest::Approx(largest));
}

TEST_CASE("dura: tension stiffens it, and a force over the speed of what is moved aside adds to its own") {
  const double force = dived(1.0e-3).of("peak_force_N");
  // By far more than the 1 % by which a peak depends on the steps (sheet_test).
  CHECK(dived(1.0e-3, kDura + "tension = 0.03\n").of("peak_force_N") > 1.1 * force);
  CHECK(dived(1.0e-3, kDura + "resistance_kPa_s_per_mm = 100\n").of("peak_force_N") > 1.1 * force);
}

namespace {
/// A plate that is pressed by less than its thickness, on an outer surface that is hardly curved: without adhesion it has the closed
/// form of a clamped plate, with adhesion that of a plate on an elastic foundation. Stiffness [N/m] = force over indentation.
double plate_stiffness(const std::string& keys, double support = 0.0) {
  const Dived run = dived(
      0.15e-3,
      fmt::format("[dura]\npulse_Pa = 0\nsupport_kPa_per_mm = {}\nresistance_kPa_s_per_mm = 0.001\nstrain_limit = 1\n", support) + keys,
      {"volume.curvature_mm=1000"});
  REQUIRE(run.of("indentation_mm") > 0.02);
  REQUIRE(run.of("indentation_mm") < 0.2);
  return run.of("peak_force_N") / (run.of("indentation_mm") * 1e-3);
}
}  // namespace

TEST_CASE("dura: half the radius is four times the stiffness of a clamped plate, and a quarter of the nodes") {
  // Load F in the middle of a clamped plate: F / w = 16 pi D / R^2. The nodes on the rim, which are clamped, lie within a spacing of R.
  const double spacing = 0.3;
  const auto keys = [&](double radius) {
    return fmt::format("radius_mm = {}\nspacing_mm = {}\nthickness_mm = 2\nmodulus_MPa = 7\nadhesion_kPa = 0\n", radius, spacing);
  };
  const double ratio = plate_stiffness(keys(3.0)) / plate_stiffness(keys(6.0));
  CHECK(ratio > 0.97 * std::pow((6.0 - spacing) / 3.0, 2));
  CHECK(ratio < 1.03 * std::pow(6.0 / (3.0 - spacing), 2));
  // The cells of the nodes reach up to spacing / sqrt(3) from them, and cover the disc.
  for (const auto& [radius, apart] : {std::pair{3.0, 0.3}, {6.0, 0.3}, {6.0, 0.6}}) {
    const double cell = std::sqrt(0.75) * apart * apart, reach = apart / std::sqrt(3.0), pi = 3.14159265358979;
    const double nodes = dived(-0.8e-3, fmt::format("[dura]\nradius_mm = {}\nspacing_mm = {}\n", radius, apart)).of("nodes");
    CHECK(nodes > pi * std::pow(radius - reach, 2) / cell);
    CHECK(nodes < pi * std::pow(radius + reach, 2) / cell);
  }
}

TEST_CASE("dura: twice the modulus is twice the stiffness of a clamped plate, and half the thickness an eighth of it") {
  // F / w = 16 pi D / R^2, D as E t^3. The plate of 1 mm is stretched by up to 0.15 mm, which adds about (w / t)^2 = 2 %, that of 2 mm by a quarter of
  // that. How the points of the tool share the load changes the stiffness by some per cent of the ratio of theirs and the plate's: 2 %.
  const auto stiffness = [](double modulus, double thickness) {
    return plate_stiffness(
        fmt::format("radius_mm = 6\nspacing_mm = 0.3\nmodulus_MPa = {}\nthickness_mm = {}\nadhesion_kPa = 0\n", modulus, thickness));
  };
  const double base = stiffness(7.0, 2.0);
  CHECK(stiffness(14.0, 2.0) == doctest::Approx(2.0 * base).epsilon(0.02));
  CHECK(stiffness(7.0, 1.0) == doctest::Approx(base / 8.0).epsilon(0.04));
}

TEST_CASE("dura: a support is as stiff as a bond of its pressure over the way") {
  // Both are a foundation k under a plate; the bond also holds it along the sheet, where it moves by (w / l)^2 of l, 1 %.
  const auto stiffness = [](double adhesion, double support) {
    return plate_stiffness(
        fmt::format("radius_mm = 6\nspacing_mm = 0.3\nthickness_mm = 0.5\nadhesion_kPa = {}\nadhesion_mm = 1\n", adhesion), support);
  };
  CHECK(stiffness(0.0, 100.0) == doctest::Approx(stiffness(100.0, 0.0)).epsilon(0.03));
  CHECK(stiffness(0.0, 50.0) == doctest::Approx(stiffness(50.0, 0.0)).epsilon(0.03));
  CHECK(stiffness(0.0, 100.0) > 1.2 * stiffness(0.0, 50.0));
}

TEST_CASE("dura: four times the adhesion is twice the stiffness, as is a quarter of the way at which it breaks") {
  // A plate on a foundation k = adhesion / way: F / w = 8 sqrt(k D), over a length l = (D / k)^(1/4) of 1.13 mm, then 0.80 mm. Tolerance 8 %: the
  // lattice is softer by (spacing / l)^2 / 8 = 1.8 %; the rim, 5 l away, counts exp(-sqrt(2) 5) = 0.1 %, times a number of order one; the sheet
  // is stretched, (w / t)^2 = 4 % of that order; and the ball touches more than a point, a few %.
  const auto stiffness = [](double adhesion, double way) {
    return plate_stiffness(
        fmt::format("radius_mm = 6\nspacing_mm = 0.3\nthickness_mm = 0.5\nadhesion_kPa = {}\nadhesion_mm = {}\n", adhesion, way));
  };
  const double base = stiffness(1000.0, 2.0);
  CHECK(stiffness(4000.0, 2.0) == doctest::Approx(2.0 * base).epsilon(0.08));
  CHECK(stiffness(1000.0, 0.5) == doctest::Approx(2.0 * base).epsilon(0.08));
  CHECK(stiffness(2000.0, 4.0) == doctest::Approx(base).epsilon(1e-9));  // their quotient alone, while it does not break
}

TEST_CASE("dura: it comes off the bone where it is displaced by more than the way, and not before") {
  // The stiffness of the bond, adhesion / way, is the same in all runs, so they are alike until it breaks.
  const auto run = [](double way) {
    return dived(
        0.15e-3,
        fmt::format("[dura]\nradius_mm = 6\nspacing_mm = 0.6\npulse_Pa = 0\nthickness_mm = 1\nadhesion_kPa = {}\nadhesion_mm = {}\n",
                    500.0 * way, way));
  };
  const double indentation = run(2.0).of("indentation_mm");
  CHECK(run(1.1 * indentation).of("separated_mm2") == 0.0);
  CHECK(run(1.1 * indentation).of("indentation_mm") == doctest::Approx(indentation).epsilon(1e-9));
  CHECK(run(0.9 * indentation).of("separated_mm2") > 0.0);
}

TEST_CASE("dura: a force on a hand at rest is the allowance over the way that the hand may accelerate in a tick") {
  // E = 0, so f <= A / (a T^2): 1e-6 J / (100 m/s^2 x 1 ms^2) = 0.01 N, below what the sheet exerts.
  const auto felt = [](double allowance, double acceleration) {
    GivenHand hand([](double) { return Vec3(0.0, 0.0, -5.5e-3); });
    SimulationOptions options;
    options.hand = &hand;
    const SmallScene scene = free_scene({"duration_s=0.3"});
    DrillRun run(
        load_text(scene_text(scene) + kDura + fmt::format("allowance_mJ = {}\nacceleration_m_per_s2 = {}\n", allowance, acceleration),
                  scene.sets),
        options);
    run.run();
    CHECK(hand.largest == doctest::Approx(figure(run.simulation(), "dura", "felt_N")).epsilon(1e-9));
    return figure(run.simulation(), "dura", "felt_N");
  };
  CHECK(felt(0.001, 100.0) == doctest::Approx(0.01).epsilon(1e-9));
  CHECK(felt(0.002, 100.0) == doctest::Approx(0.02).epsilon(1e-9));
  CHECK(felt(0.001, 200.0) == doctest::Approx(0.005).epsilon(1e-9));
}

namespace {
/// In 0.5 s the hand cuts a hole to the dura, if it cuts, then stands above the bone. @returns the bulge [m] after each bone step of 20 ms.
std::vector<double> pulsed(const std::string& keys, bool cuts = true, const std::string& curvature = "80") {
  GivenHand hand([cuts](double t) { return Vec3(0.0, 0.0, cuts && t < 0.5 ? 0.5e-3 - 11e-3 * t : 3e-3); });
  SimulationOptions options;
  options.hand = &hand;
  const TemporaryFolder folder;
  SmallScene scene = free_scene({"duration_s=3.5", "tool.erosion_scale=1e4", "volume.curvature_mm=" + curvature});
  scene.erosion = true;
  DrillRun run(load_text(scene_text(scene) + "[dura]\nradius_mm = 6\nspacing_mm = 0.6\nadhesion_kPa = 0.01\n" + keys, scene.sets), options);
  run_recorded(run, folder.file("pulse.bhs"));
  std::vector<double> out = session_column(folder.file("pulse.bhs"), "dura_bulge");
  REQUIRE(out.size() == 175);
  return out;
}
}  // namespace

TEST_CASE("dura: under a hole it follows the brain's pulse, between 0 and pulse_Pa at pulse_hz, over the stiffness of its support") {
  // A sheet that is as good as without stiffness of its own, under a hole, moves by b du/dt + g u = p, p = P (1 - cos(2 pi f t)) / 2; b / g = 10 us lets it lag by less than
  // a thousandth of P / g. The solver leaves 1e-4 of the forces of all nodes, of which a single one may have all: 0.2 % of 300.
  struct Case {
    double pressure, rate, support;  // [Pa], [1/s], [kPa/mm]
  };
  for (const Case& one : {Case{1e4, 1.1, 100.0}, {5e3, 1.1, 100.0}, {1e4, 0.7, 100.0}, {1e4, 2.3, 100.0}, {1e4, 1.1, 50.0}}) {
    CAPTURE(one.pressure);
    CAPTURE(one.rate);
    CAPTURE(one.support);
    const std::vector<double> bulge =
        pulsed(fmt::format("modulus_MPa = 1e-6\nsupport_kPa_per_mm = {}\nresistance_kPa_s_per_mm = 0.001\npulse_Pa = {}\npulse_hz = {}\n",
                           one.support, one.pressure, one.rate));
    const double most = one.pressure / (one.support * 1e6);
    double worst = 0.0, larger = 0.0, faster = 0.0;
    for (std::size_t n = 30; n < bulge.size(); ++n) {  // the bit has left
      const auto expected = [&](double pressure, double rate) {
        const double angle = 2.0 * std::numbers::pi * rate * 0.02 * static_cast<double>(n + 1);
        return 0.5 * pressure / (one.support * 1e6) * (1.0 - std::cos(angle));
      };
      worst = std::max(worst, std::abs(bulge[n] - expected(one.pressure, one.rate)));
      larger = std::max(larger, std::abs(bulge[n] - expected(1.1 * one.pressure, one.rate)));
      faster = std::max(faster, std::abs(bulge[n] - expected(one.pressure, 1.1 * one.rate)));
    }
    MESSAGE("largest bulge " << *std::ranges::max_element(bulge) << " m, expected " << most << "; within " << worst / most
                             << " of it; sabotaged " << larger / most << ", " << faster / most);
    CHECK(worst < 3e-3 * most);
    CHECK(larger > 0.09 * most);
    CHECK(faster > 0.09 * most);
  }
  for (const double bulge : pulsed("pulse_Pa = 0\n")) CHECK(bulge < 1e-7);
  for (const double bulge : pulsed("pulse_Pa = 1e4\n", false)) CHECK(bulge == 0.0);  // bone holds it
}

TEST_CASE("dura: resistance_kPa_s_per_mm over the support is the time constant with which it follows the pulse") {
  // As above: u(n) = (p(n) + b u(n - 1) / dt) / (g + b / dt).
  constexpr double kSupport = 1e8, kPulse = 1e4;  // [N/m^3], [Pa]
  for (const double resistance : {2.0, 10.0, 50.0}) {
    CAPTURE(resistance);
    const std::vector<double> bulge = pulsed(fmt::format(
        "modulus_MPa = 1e-6\nsupport_kPa_per_mm = 100\nresistance_kPa_s_per_mm = {}\npulse_Pa = 1e4\npulse_hz = 1.1\n", resistance));
    const auto worst_with = [&](double b) {
      double expected = bulge[30], worst = 0.0;
      for (std::size_t n = 31; n < bulge.size(); ++n) {
        const double pressure = 0.5 * kPulse * (1.0 - std::cos(2.0 * std::numbers::pi * 1.1 * 0.02 * static_cast<double>(n + 1)));
        expected = (pressure + b * 1e6 * expected / 0.02) / (kSupport + b * 1e6 / 0.02);
        worst = std::max(worst, std::abs(bulge[n] - expected));
      }
      return worst / *std::ranges::max_element(bulge);
    };
    MESSAGE("within " << worst_with(resistance) << " of the largest bulge; sabotaged " << worst_with(1.1 * resistance));
    CHECK(worst_with(resistance) < 3e-3);
    CHECK(worst_with(1.1 * resistance) > 6e-3);
  }
}

TEST_CASE("dura: under a hole a membrane bulges in inverse proportion to its tension") {
  // Without bending, w = (p - 2 N / R) a^2 / (4 N), a the radius of the hole, R that of the skull, N in proportion to E t and the strain at rest: the difference of two
  // pressures times N is the same. Tolerance 4 %: the bone c holds the nodes s apart at the edge of the hole, of the area A, up to 2 s N / (a c A), 1 to 2 %; the solver may leave a
  // millionth of a newton, 0.8 % of the load, of each of the two; and the bulge stretches the membrane by (w / a)^2, 0.5 % of its strain.
  const auto wider = [](double tension) {
    const auto most = [&](double pulse) {
      const std::vector<double> bulge = pulsed(
          fmt::format("modulus_MPa = 330\nthickness_mm = 0.0005\nsupport_kPa_per_mm = 0\nresistance_kPa_s_per_mm = 0.0001\ntension = {}\n"
                      "pulse_Pa = {}\n",
                      tension, pulse),
          true, "1000");
      return *std::ranges::max_element(bulge);
    };
    return most(200.0) - most(100.0);
  };
  const double base = wider(0.02);
  MESSAGE("bulge of 100 Pa more: " << base * 1e6 << " um at a tension of 0.02");
  for (const double tension : {0.015, 0.025}) {
    CAPTURE(tension);
    const double ratio = wider(tension) / base * tension / 0.02;
    MESSAGE("times the tension " << ratio);
    CHECK(std::abs(ratio - 1.0) < 0.04);
    CHECK(std::abs(1.1 * ratio - 1.0) > 0.04);  // sabotage
  }
}

TEST_CASE("dura: a drilled hole frees it, a replay has the same bits, and a reset brings it back whole") {
  const TemporaryFolder folder;
  const std::string path = folder.file("drilled.bhs");
  SmallScene scene{.volume = kInnerTableKeys,
                   .record = true,
                   .sets = {"duration_s=5.0", "tool.erosion_scale=5", "volume.extent_mm=[14.0, 14.0, 8.0]", "volume.spacing_mm=0.5",
                            "volume.dura_mm=1.0", "volume.thickness_mm=2.5", "volume.inner_table_mm=2.5"}};
  const std::string dura = "[dura]\nradius_mm = 5\nspacing_mm = 0.6\n";
  DrillRun run(load_text(scene_text(scene) + dura, scene.sets), {.history = true});
  run_recorded(run, path);
  CHECK(figure(run.simulation(), "dura", "indentation_mm") > 0.0);
  CHECK(figure(run.simulation(), "dura", "iterations") > 0.0);
  ReplayRun again(path);
  CHECK(again.run().voxel_hash() == run.voxel_hash());
  CHECK(again.run().simulation().sent_hash() == run.simulation().sent_hash());
  for (const char* const name : {"indentation_mm", "peak_force_N", "largest_strain", "felt_N"})
    CHECK(figure(again.run().simulation(), "dura", name) == figure(run.simulation(), "dura", name));
  // With the bit far away the pulse moves a sheet under a hole, and not one under bone.
  Stage& stage = run.simulation().stage();
  ContactState away = stage.contact->state();
  away.world_from_tool.translation = Vec3(0.0, 0.0, 20e-3);
  const auto iterations_of_steps = [&] {
    const double before = figure(run.simulation(), "dura", "iterations");
    for (int n = 0; n < 5; ++n) stage.cut(away);
    return figure(run.simulation(), "dura", "iterations") - before;
  };
  CHECK(iterations_of_steps() > 0.0);
  REQUIRE(stage.reset());
  CHECK(figure(run.simulation(), "dura", "torn_edges") == 0.0);
  CHECK(figure(run.simulation(), "dura", "separated_mm2") == 0.0);
  CHECK(iterations_of_steps() == 0.0);
}

TEST_CASE("dura: a volume without dura, or keys that contradict each other, are refused with their place") {
  const auto first = [](const std::string& volume, const std::string& dura) {
    SmallScene scene = free_scene();
    if (!volume.empty()) {
      scene.volume = volume;
      scene.sets.clear();
    }
    Issues issues;
    auto document = TomlDocument::parse(scene_text(scene) + dura, "small.toml");
    REQUIRE(document);
    for (const std::string& set : scene.sets) REQUIRE(document->set(set));
    auto loaded = load_scene(*document, test_context(), issues);
    if (loaded && issues.empty()) CHECK(Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues) == nullptr);
    REQUIRE_FALSE(issues.empty());
    CHECK(issues.front().place.find("small.toml:") == 0);
    CHECK(std::ranges::count(issues.front().place, ':') == 2);
    return issues.front().message;
  };
  CHECK(first(kPlateKeys, "[dura]\n").find("no dura under the bone") != std::string::npos);
  CHECK(first("", "[dura]\nradius_mm = 6\nspacing_mm = 3\n").find("a third of radius_mm") != std::string::npos);
  CHECK(first("", "[dura]\ntension = 0.1\nstrain_limit = 0.1\n").find("below strain_limit") != std::string::npos);
  CHECK_FALSE(first("", "[dura]\nmodulus = 3\n").empty());
  CHECK_FALSE(first("", "[dura]\nmodulus_MPa = 0\n").empty());
}

TEST_CASE("dura: a sheet that nothing holds is refused at radius_mm") {
  const auto refused = [](const std::string& dura, const std::vector<std::string>& sets) {
    const SmallScene scene = free_scene(sets);
    const std::string text = scene_text(scene) + dura;
    const auto document = TomlDocument::parse(text, "small.toml");
    REQUIRE(document);
    TomlDocument changed = *document;
    for (const std::string& set : scene.sets) REQUIRE(changed.set(set));
    Issues issues;
    auto loaded = load_scene(changed, test_context(), issues);
    REQUIRE(loaded);
    REQUIRE(issues.empty());
    CHECK(Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues) == nullptr);
    REQUIRE(issues.size() == 1);
    // The line of the key, or of the table without it.
    const std::size_t at = text.find(dura.find("radius_mm") == std::string::npos ? "[dura]" : "radius_mm");
    CHECK(issues[0].place.find(
              fmt::format("small.toml:{}:", 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'))) == 0);
    return issues[0].message;
  };
  // The ball has a radius of 1 mm.
  CHECK(refused("[dura]\nspacing_mm = 0.6\nradius_mm = 2.1\n", {}).find("must be at least 2.") != std::string::npos);
  CHECK(refused("[dura]\nradius_mm = 30\n", {}).find("reaches only") != std::string::npos);
  CHECK(refused("[dura]\n", {}).find("reaches only") != std::string::npos);
  CHECK(refused("[dura]\nspacing_mm = 0.6\nradius_mm = 6\n", {"volume.rim_mm=4"}).find("radius_mm = 6") != std::string::npos);
}

TEST_CASE("dura: without the table there is no step, column or figure of it") {
  DrillRun without(free_scene());
  const auto columns = [](DrillRun& run) {
    return std::ranges::count(run.simulation().stage().graph.columns(Clock::contact), std::string("dura_level"), &StepColumn::name);
  };
  CHECK(columns(without) == 0);
  CHECK_FALSE(without.simulation().stage().figure("dura", "torn").has_value());
  CHECK_FALSE(without.simulation().stage().graph.is_written(slots::kDura.name));
}

}  // namespace burrhole::test
