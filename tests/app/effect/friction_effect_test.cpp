// [friction] in a scene: the hand feels the friction that contact finds, what each key changes, slow contact, replay.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kThrust = 28.0, kStatic = 0.37;      // [N], [-] of the scene
constexpr double kCoupling = 5000.0, kPeriod = 1e-3;  // [N/m], [s] of the scene
constexpr std::size_t kWindow = 100;                  // ticks over which forces are averaged
constexpr double kTicksOfBone = 20.0;                 // servo ticks in a bone step

/// The force that the hand feels, and how far it is from that of contact across the shaft, in lockstep with a result in each tick.
struct Felt {
  double largest = 0.0;     // [N] of all forces on the hand
  double most_apart = 0.0;  // [N] largest mean difference of a window
  double most_over = 0.0;   // [-] the same over its bound
};

Felt felt_of(const std::vector<std::string>& sets) {
  LoadedScene loaded = load_parietal(sets);
  Simulation* simulation = nullptr;
  Felt out;
  Vec3 apart(0.0);
  double moved = 0.0;
  std::size_t ticks = 0;
  WatchedHand hand(loaded, [&] {
    const ServoOutput& servo = simulation->stage().servo->output();
    const ContactState& contact = simulation->contact_state();
    if (contact.number == 0) return;
    apart += servo.wanted - contact.on_hand.force;
    moved += glm::length(contact.hand_velocity) * kPeriod;
    out.largest = std::max(out.largest, glm::length(servo.force));
    if (++ticks % kWindow != 0) return;
    apart.z = 0.0;
    const double mean = glm::length(apart) / kWindow;
    // Both tools were in one place a tick before, and in a tick neither moves farther than the hand. The planes are tangents of bone: a tool
    // that moves 0.1 mm round 1 mm leaves them by 5 um. In the tick after a step of bone the planes are others, and friction may point
    // anywhere in its cone.
    const double bound = 2.0 * kCoupling * (moved / kWindow + 5e-6) + 2.0 * kStatic * kThrust / kTicksOfBone;
    out.most_apart = std::max(out.most_apart, mean);
    out.most_over = std::max(out.most_over, mean / bound);
    apart = Vec3(0.0);
    moved = 0.0;
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  simulation = &run.simulation();
  run.run();
  REQUIRE(ticks > 1000);
  return out;
}

/// [N m] Mean moment about the shaft, from 5 to 6 s, of a drill that is pressed on bone.
double drag_of(const std::string& coefficients) {
  LoadedScene loaded = load_parietal({"friction=" + coefficients, "duration_s=6"});
  Simulation* simulation = nullptr;
  double sum = 0.0;
  int count = 0;
  WatchedHand hand(loaded, [&] {
    const ContactState& contact = simulation->contact_state();
    if (contact.tick < 5000) return;
    sum += contact.on_hand.torque.z;
    ++count;
  });
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  simulation = &run.simulation();
  run.run();
  return sum / count;
}

/// A ball that does not turn, pressed on a level plate along an axis 15.07 degrees off its normal: 0.269 of the load pushes it aside.
struct Pressed {
  double aside;  // [m] of the tool from where the axis meets the plate
  double share;  // [-] of the normal force
};
Pressed press_aside(const std::string& coefficients) {
  DrillRun run(SmallScene{.sets = {"tool.name=ball", "tool.spin_rpm=0", "approach.axis=[-0.25,-0.1,-1.0]", "hand.push_N=20",
                                   "hand.tremor_mm=0", "duration_s=3", "friction=" + coefficients}});
  run.run();
  const ContactState& contact = run.simulation().contact_state();
  const Vec3& at = contact.world_from_tool.translation;
  const Vec3 force = contact.on_hand.force;
  return {std::hypot(at.x, at.y), std::hypot(force.x, force.y) / force.z};
}

}  // namespace

TEST_CASE("friction: the hand feels the friction of contact, and the drill does not walk round its hole") {
  const Felt felt = felt_of({"friction={}", "duration_s=10"});
  std::printf("friction: largest force %.2f N; servo and contact differ by up to %.3f N in 0.1 s, %.2f of the bound\n", felt.largest,
              felt.most_apart, felt.most_over);
  CHECK(felt.most_over < 1.0);
  CHECK(felt.largest < 1.1 * kThrust);  // a tool of the servo that goes its own way is met by the hand with up to 70 N
}

TEST_CASE("friction: the tip whirls in its pit at the rate of the hand on its springs, and not with a hand that damps it") {
  const auto swing_of = [](const std::vector<std::string>& more) {
    std::vector<std::string> sets{"friction={}", "duration_s=6"};
    sets.insert(sets.end(), more.begin(), more.end());
    DrillRun run(load_parietal(sets));
    run.run();
    return run.simulation().stage().servo->swing();
  };
  // The arm and the coupling carry the hand, 0.6 kg by default. The pit gives way, so the rate is below that of a fixed tool; a hand that is
  // carried by the arm alone is far below.
  const double held = std::sqrt((1000.0 + kCoupling) / 0.6) / (2.0 * std::numbers::pi),
               loose = std::sqrt(1000.0 / 0.6) / (2.0 * std::numbers::pi);
  const Swing swing = swing_of({}), heavy = swing_of({"hand.mass_kg=2.4"});
  std::printf("friction: swings of %.2f N at %.1f Hz, of a hand of four times the mass at %.1f Hz; %.1f Hz on its springs\n", swing.force,
              swing.frequency, heavy.frequency, held);
  CHECK(swing.frequency > 0.5 * (held + loose));
  CHECK(swing.frequency < held);
  CHECK(std::abs(heavy.frequency / swing.frequency - 0.5) < 0.1);  // 1 / sqrt(4); counted in whole periods of about ten
  CHECK(swing_of({"hand.damping_N_s_per_m=40"}).force == 0.0);
}

TEST_CASE("friction: the moment of the drag on the shaft is in proportion to the kinetic coefficient") {
  const double whole = drag_of("{static_coefficient=0.3,kinetic_coefficient=0.3}");
  const double half = drag_of("{static_coefficient=0.3,kinetic_coefficient=0.15}");
  const double stiff = drag_of("{static_coefficient=0.6,kinetic_coefficient=0.3}");
  std::printf("friction: drag %.4f N m, %.4f at half the coefficient\n", whole, half);
  CHECK(std::abs(whole) > 1e-3);  // of 28 N: an arm above 0.1 mm
  // mu N r, with the same load. The places that carry it are those of a hole cut in voxels: 3 % is a tenth of a voxel of 0.25 mm over an arm of 1 mm.
  CHECK(std::abs(half / whole - 0.5) < 0.5 * 0.03);
  CHECK(std::abs(stiff / whole - 1.0) < 0.03);  // a rim that slides knows no static friction
}

TEST_CASE("friction: a tool that is pushed aside with 0.269 of its load stays below the static coefficient, and slides above it") {
  const double tilt = std::hypot(0.25, 0.1);
  const Pressed held = press_aside("{static_coefficient=0.37,kinetic_coefficient=0.3}");
  const Pressed slid = press_aside("{static_coefficient=0.2,kinetic_coefficient=0.1}");
  std::printf("friction: pushed aside by %.3f: stays at %.4f mm with %.4f; slides to %.3f mm\n", tilt, held.aside * 1e3, held.share,
              slid.aside * 1e3);
  CHECK(held.aside < 0.1e-3);  // the foot of the axis, and the ball's side
  CHECK(std::abs(held.share - tilt) < 0.02 * tilt);
  CHECK(slid.aside > 1e-3);  // until the arm's spring, 1 N/mm, carries 0.07 to 0.17 of 20 N
  CHECK(slid.share < 0.2);
}

namespace {

/// A hand that presses a ball by kPressed on the plate, and from kAside on moves sideways at 1 mm/s. What it gets does not move it.
class DraggedHand final : public HandSource {
 public:
  static constexpr double kPressed = 1e-3;    // [m]
  static constexpr std::size_t kAside = 600;  // ticks
  const HandState& read() noexcept override {
    const double t = static_cast<double>(shares.size()) * 1e-3;
    const double aside = static_cast<double>(shares.size() - std::min(shares.size(), kAside)) * 1e-6;
    state_.world_from_hand.translation = Vec3(aside, 0.0, std::max(-kPressed, 0.5e-3 - 5e-3 * t));
    state_.tick = shares.size();
    return state_;
  }
  void apply(const Wrench&) noexcept override {
    const ContactState& contact = run->simulation().contact_state();
    shares.push_back(contact.on_hand.force.z > 0.0 ? -contact.on_hand.force.x / contact.on_hand.force.z : 0.0);
    places.push_back(contact.world_from_tool.translation.x);
  }
  DrillRun* run = nullptr;
  std::vector<double> shares, places;  // [-] of the normal force, [m] of the tool, in each tick

 private:
  HandState state_;
};

DraggedHand drag_aside(double at_rest, double moving) {
  DraggedHand hand;
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(
      SmallScene{
          .sets = {"tool.name=ball", "tool.spin_rpm=0", "duration_s=1.6", "contact.turning=locked", "contact.coupling_N_s_per_m=0",
                   "friction={static_coefficient=" + std::to_string(at_rest) + ",kinetic_coefficient=" + std::to_string(moving) + "}"}},
      options);
  hand.run = &run;
  run.run();
  REQUIRE(hand.shares.size() == 1600);
  return hand;
}

}  // namespace

TEST_CASE(
    "friction: a tool that is dragged sticks up to static_coefficient of the normal force, then slides with kinetic_coefficient of it") {
  // Without damping the spring carries K s aside and K d along the normal: s / d of the normal force, a thousandth more in each tick. So it breaks away within a
  // thousandth above the coefficient, after that many micrometres. A tool that touches while it moves sideways slides at once, by Coulomb's law.
  for (const auto& [at_rest, moving] : {std::pair{0.37, 0.3}, {0.37, 0.1}, {0.2, 0.1}, {0.8, 0.3}}) {
    CAPTURE(at_rest);
    CAPTURE(moving);
    const DraggedHand hand = drag_aside(at_rest, moving);
    const double largest = *std::ranges::max_element(hand.shares);
    const auto tick_of = [&, rest = at_rest](double factor) { return DraggedHand::kAside + static_cast<std::size_t>(factor * rest * 1e3); };
    std::printf("friction: sticks up to %.5f of the normal force, then %.5f; moved %.3g um at 0.99 of it, %.3g um at 1.01\n", largest,
                hand.shares.back(), hand.places[tick_of(0.99)] * 1e6, hand.places[tick_of(1.01)] * 1e6);
    CHECK(std::abs(hand.places[tick_of(0.99)]) < 1e-8);
    CHECK(largest > at_rest - 2e-3);
    CHECK(largest < at_rest + 1e-6);
    CHECK(hand.places[tick_of(1.01)] > 0.9 * (at_rest - moving) * DraggedHand::kPressed);
    CHECK(std::abs(hand.shares.back() - moving) < 1e-6);
  }
}

TEST_CASE(
    "friction: contact at 1000 to 20 Hz, at rest and at ten times the speed: no latched fault, and no force beyond twice the thrust") {
  for (const char* rate : {"1000", "200", "50", "20"})
    for (const char* spin : {"0", "1000", "10000"}) {
      CAPTURE(rate);
      CAPTURE(spin);
      DrillRun run(SmallScene{.sets = {"tool.name=pin", std::string("contact.rate_hz=") + rate, std::string("tool.spin_rpm=") + spin,
                                       "hand.push_N=10", "duration_s=6", "friction={}"}});
      run.run();
      CHECK(run.simulation().progress().peak_force < 20.0);
      CHECK((run.simulation().stage().servo->faults() & kServoLatched) == 0);
    }
}

TEST_CASE("friction: a replay has the same bits") {
  const TemporaryFolder folder;
  DrillRun run(SmallScene{.record = true, .sets = {"tool.name=pin", "hand.push_N=10", "duration_s=6", "friction={}"}});
  run_recorded(run, folder.file("friction.bhs"));
  ReplayRun again(folder.file("friction.bhs"));
  CHECK(again.run().voxel_hash() == run.voxel_hash());
  CHECK(again.run().simulation().force_hash() == run.simulation().force_hash());
  CHECK(again.run().simulation().sent_hash() == run.simulation().sent_hash());
}

}  // namespace burrhole::test
