// [contact] in a run: stiffness and damping of springs, rate and latency, each against the closed form of a hand that is pressed on a plate.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/app/effect/pressed_plate.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kCoupling = 5000.0;    // [N/m] the default
constexpr double kFound = 7.5e-6;       // [m] contact is found to 0.03 of a voxel of 0.25 mm (constrained_tool.h),
constexpr double kMet = 0.5e-6;         // and a plane is met to 0.002 of one (constrained_tool.cpp)
constexpr double kHardness = 0.8;       // [-] of the plate
constexpr double kHardnessStep = 5e-3;  // [-] of the force: hardness is stored in steps of 1/255

/// Slowly from the air to a depth [m], where it stays from 0.3 s on.
std::function<double(std::size_t)> down_to(double depth) {
  return [depth](std::size_t tick) { return -0.05e-3 + (depth + 0.05e-3) * std::min(1.0, static_cast<double>(tick) / 300.0); };
}
/// The models that hold a tool back.
constexpr const char* kHeldModels[] = {"contact.model=\"surface\"", "contact.model=\"mesh\""};
double in_series(double a, double b) { return 1.0 / (1.0 / a + 1.0 / b); }

}  // namespace

TEST_CASE("contact: coupling_N_per_m is the force over the way of the hand into bone") {
  for (const char* const model : kHeldModels)
    for (const double stiffness : {5000.0, 5500.0, 1000.0}) {
      CAPTURE(model);
      const double force = sent({model, fmt::format("contact.coupling_N_per_m={}", stiffness)}, down_to(2e-3)).back();
      CHECK(std::abs(force - stiffness * 2e-3) < stiffness * kFound);
    }
}

TEST_CASE("contact: coupling_N_s_per_m is the force over the speed of the hand, beside that of the spring") {
  // 2 mm in 0.3 s, and at rest after.
  const double speed = 2.05e-3 / 0.3;
  for (const char* const model : kHeldModels) {
    CAPTURE(model);
    const std::vector<double> spring = sent({model}, down_to(2e-3));
    for (const double damping : {30.0, 33.0, 100.0}) {
      const std::vector<double> found = sent({model, fmt::format("contact.coupling_N_s_per_m={}", damping)}, down_to(2e-3));
      for (const std::size_t n : {100u, 200u, 290u})
        CHECK(found[n] - spring[n] == doctest::Approx(damping * speed).epsilon(0.01).scale(0.0));
      CHECK(std::abs(found.back() - spring.back()) < 1e-3);
    }
  }
}

TEST_CASE("contact: cutting_N_per_m is the force over the engagement of a flat bit that spins") {
  for (const char* const model : kHeldModels)
    for (const double cutting : {10e3, 11e3, 40e3}) {
      CAPTURE(model);
      const std::vector<std::string> keys{model, "tool.name=\"pin\"", "tool.spin_rpm=1000",
                                          fmt::format("contact.cutting_N_per_m={}", cutting)};
      const double force = sent(keys, down_to(2e-3)).back(), expected = 2e-3 * in_series(kCoupling, cutting);
      MESSAGE("cutting " << cutting << ": " << force << " N, expected " << expected);
      CHECK(std::abs(force - expected) < kCoupling * kFound);
    }
}

TEST_CASE("contact: coupling_Nm_per_rad is the torque over the angle of the hand to a flat bit that lies on bone") {
  // A thrust of 20 N holds a face of 1 mm radius flat against up to 0.02 N m. Planes that are met to 0.5 um let it lean by 0.5 mrad of 20.
  for (const double stiffness : {0.5, 0.55, 0.2}) {
    PressingHand hand(down_to(4e-3));
    hand.angle = [](std::size_t) { return 0.02; };
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(SmallScene{.erosion = false,
                            .sets = {"duration_s=0.6", "tool.spin_rpm=0", "tool.name=\"pin\"",
                                     fmt::format("contact.coupling_Nm_per_rad={}", stiffness)}},
                 options);
    run.run();
    const double torque = -run.simulation().contact_state().on_hand.torque.y;
    MESSAGE("torque " << torque << " N m, expected " << 0.02 * stiffness);
    CHECK(torque == doctest::Approx(0.02 * stiffness).epsilon(0.03).scale(0.0));
  }
}

TEST_CASE("contact: bone_N_per_m times hardness and label_stiffness is the stiffness of bone under a point, in series with the coupling") {
  // 40 um deep, of which bone gives less than the 31 um at which the ball's next points touch.
  for (const auto& [bone, factor] : {std::pair{6250.0, 1.0}, {6875.0, 1.0}, {6250.0, 0.8}, {20e3, 1.0}}) {
    const double force =
        sent({fmt::format("contact.bone_N_per_m={}", bone), fmt::format("contact.label_stiffness={{bone={}}}", factor)}, down_to(40e-6))
            .back();
    const double expected = 40e-6 * in_series(kCoupling, kHardness * factor * bone);
    MESSAGE("bone " << bone << ", factor " << factor << ": " << force << " N, expected " << expected);
    CHECK(std::abs(force - expected) < kCoupling * kMet + kHardnessStep * expected);
  }
}

TEST_CASE("contact: bone_N_per_m of a mesh is the stiffness under a point, whatever the hardness") {
  for (const double bone : {5000.0, 5500.0, 20e3}) {
    const double force = sent({"contact.model=\"mesh\"", fmt::format("contact.bone_N_per_m={}", bone)}, down_to(40e-6)).back();
    const double expected = 40e-6 * in_series(kCoupling, bone);
    MESSAGE("bone " << bone << ": " << force << " N, expected " << expected);
    CHECK(std::abs(force - expected) < kCoupling * kMet);
  }
}

TEST_CASE("contact: felt_hardness is the share by which the spring is softer on bone of hardness 0") {
  for (const double share : {0.5, 0.55, 0.9}) {
    const double force = sent({fmt::format("contact.felt_hardness={}", share)}, down_to(2e-3)).back();
    const double expected = 2e-3 * kCoupling * (1.0 - share * (1.0 - kHardness));
    MESSAGE("felt " << share << ": " << force << " N, expected " << expected);
    CHECK(std::abs(force - expected) < kCoupling * kFound);
  }
}

namespace {

/// [N] on a hand that presses the flat face of a pin down to a depth [m], by a penalty model.
double pressed(const std::string& keys, double stiffness, double depth) {
  PressingHand hand(down_to(depth));
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(SmallScene{.erosion = false,
                          .contact_keys = fmt::format("{}stiffness_N_per_m = {}\n", keys, stiffness),
                          .sets = {"duration_s=0.6", "tool.spin_rpm=0", "tool.name=\"pin\""}},
               options);
  run.run();
  return hand.sent.back();
}

}  // namespace

TEST_CASE("contact: stiffness_N_per_m of a penalty model is the force of a flat face over its depth, in series with a virtual coupling") {
  // Packed places are 2^-14 of a voxel apart.
  for (const std::string model : {"model = \"gradient-plane\"\n", "model = \"mesh\"\ntool = \"hand\"\n",
                                  "model = \"mesh\"\ntool = \"hand\"\nstacking = \"deepest\"\n"})
    for (const double stiffness : {2000.0, 2200.0, 20e3}) {
      CAPTURE(model);
      CAPTURE(stiffness);
      CHECK(pressed(model, stiffness, 0.1e-3) == doctest::Approx(0.1e-3 * stiffness).epsilon(0.002).scale(0.0));
      for (const double coupling : {5000.0, 5500.0})
        CHECK(pressed(model + fmt::format("coupling = \"virtual\"\ncoupling_N_per_m = {}\n", coupling), stiffness, 0.1e-3) ==
              doctest::Approx(0.1e-3 * in_series(stiffness, coupling)).epsilon(0.002).scale(0.0));
    }
  // A voxmap has steps, and the lean of a normal counts (voxmap_law_test): the force is in proportion to the stiffness.
  for (const std::string stacking : {"sum", "sum-limited", "average", "deepest"}) {
    const std::string model = "model = \"voxmap\"\nstacking = \"" + stacking + "\"\n";
    const double force = pressed(model, 2000.0, 0.2e-3);
    CHECK(force > 0.1);
    CHECK(pressed(model, 2200.0, 0.2e-3) == doctest::Approx(1.1 * force).epsilon(1e-12).scale(0.0));
  }
}

TEST_CASE("contact: latency_ticks is the time from a motion to its force, and rate_hz how often the force is found anew") {
  const auto step = [](std::size_t tick) { return tick < 100 ? -0.1e-3 : 2e-3; };
  for (const std::size_t latency : {0u, 10u, 11u, 40u}) {
    const std::vector<double> found = sent({fmt::format("contact.latency_ticks={}", latency), "servo.multirate=\"hold\""}, step);
    CHECK(found[100 + latency] > 9.0);
    if (latency > 0) CHECK(found[100 + latency - 1] == 0.0);
  }
  for (const std::size_t rate : {20u, 100u, 1000u}) {
    const std::vector<double> found =
        sent({fmt::format("contact.rate_hz={}", rate), "servo.multirate=\"hold\"", "contact.latency_ticks=-1"}, down_to(5e-3));
    std::size_t changes = 0;
    for (std::size_t n = 100; n < 300; ++n) changes += found[n] != found[n - 1] ? 1 : 0;
    CHECK(changes == rate * 200 / 1000);
  }
  // Absent, a force is a contact period late.
  CHECK(sent({"contact.rate_hz=20", "servo.multirate=\"hold\"", "contact.latency_ticks=-1"}, step)[149] == 0.0);
  CHECK(sent({"contact.rate_hz=20", "servo.multirate=\"hold\"", "contact.latency_ticks=-1"}, step)[150] > 9.0);
}

namespace {

/// Keys of a virtual coupling, of one degree of freedom: mass or inertia, stiffness, damping.
struct BodyKeys {
  double mass = 0.05, stiffness = 20.0, damping = 0.2;
  double inertia = 2e-5, turning_stiffness = 0.01, turning_damping = 1e-4;
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "model = \"gradient-plane\"\ncoupling = \"virtual\"\nlatency_ticks = 0\nmass_kg = {}\ncoupling_N_per_m = {}\ncoupling_N_s_per_m = "
        "{}\n"
        "inertia_kg_m2 = {}\ncoupling_Nm_per_rad = {}\ncoupling_Nm_s_per_rad = {}\n",
        mass, stiffness, damping, inertia, turning_stiffness, turning_damping);
  }
};
double hand_height(std::size_t tick) { return 0.5e-3 + 0.1e-3 * (1.0 - std::cos(0.03 * static_cast<double>(tick))); }  // [m]
double hand_angle(std::size_t tick) { return 0.05 * (1.0 - std::cos(0.02 * static_cast<double>(tick))); }              // [rad]

/// What a body in the air gives to the hand at each tick, by the implicit step of virtual_coupling.h in one degree of freedom.
/// @param stretch [m] or [rad] of the spring between two places.
std::vector<double> given(double mass, double stiffness, double damping, double (*hand)(std::size_t), double (*stretch)(double)) {
  std::vector<double> out;
  double x = hand(0), v = 0.0;
  for (std::size_t n = 0; n < 600; ++n) {
    const double h = hand(n), hand_speed = n == 0 ? 0.0 : stretch(h - hand(n - 1)) / 1e-3;
    v = (mass * v + 1e-3 * (stiffness * stretch(h - x) + damping * hand_speed)) / (mass + 1e-3 * damping + 1e-6 * stiffness);
    x += 1e-3 * v;
    out.push_back(-stiffness * stretch(h - x) + damping * (v - hand_speed));
  }
  return out;
}
double straight(double way) { return way; }
double turned(double angle) { return 2.0 * std::sin(0.5 * angle); }

double furthest(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) out = std::max(out, std::abs(a[n] - b[n]));
  return out;
}

}  // namespace

TEST_CASE(
    "contact: mass, inertia, springs and dampers of a virtual coupling give the force and torque of a tool that is swung in the air") {
  for (const BodyKeys& keys : {BodyKeys{}, BodyKeys{.mass = 0.1, .inertia = 1e-4}, BodyKeys{.stiffness = 50, .turning_stiffness = 0.03},
                               BodyKeys{.damping = 1, .turning_damping = 1e-3}}) {
    CAPTURE(keys.text());
    const TemporaryFolder folder;
    PressingHand hand([](std::size_t tick) { return -hand_height(tick); });
    hand.angle = hand_angle;
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(SmallScene{.erosion = false,
                            .record = true,
                            .contact_keys = keys.text(),
                            .sets = {"duration_s=0.6", "tool.spin_rpm=0", "servo.multirate=\"hold\""}},
                 options);
    run_recorded(run, folder.file("run.sqlite"));
    const std::vector<double> torque = session_column(folder.file("run.sqlite"), "torque_y");
    const auto force_off = [&](const BodyKeys& k) {
      return furthest(hand.sent, given(k.mass, k.stiffness, k.damping, hand_height, straight));
    };
    const auto torque_off = [&](const BodyKeys& k) {
      return furthest(torque, given(k.inertia, k.turning_stiffness, k.turning_damping, hand_angle, turned));
    };
    const double most = std::ranges::max(hand.sent), most_torque = std::ranges::max(torque);
    MESSAGE("force of " << most << " N within " << force_off(keys) << ", torque of " << most_torque << " N m within " << torque_off(keys));
    CHECK(force_off(keys) < 1e-10 * keys.stiffness);  // the tool starts over an entry that is found to 1e-10 m
    CHECK(torque_off(keys) < 1e-6 * most_torque);     // a recorded torque is a float
    for (double BodyKeys::*const key : {&BodyKeys::mass, &BodyKeys::stiffness, &BodyKeys::damping}) {
      BodyKeys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(force_off(wrong) > 1e-3 * most);
    }
    for (double BodyKeys::*const key : {&BodyKeys::inertia, &BodyKeys::turning_stiffness, &BodyKeys::turning_damping}) {
      BodyKeys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(torque_off(wrong) > 1e-3 * most_torque);
    }
  }
}

}  // namespace burrhole::test
