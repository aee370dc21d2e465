// Bone is there whenever the tool comes to it: from far outside the window, fast, at every rate of contact and by every model.

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kTick = 1e-3;    // [s]
constexpr double kStop = 1.5e-3;  // [m] half of the plate
constexpr double kNear = 20e-3;   // [m]

/// A hand that no force moves. It comes along a straight line at one speed and stops when its tip is kStop below the outer face.
class ComingHand final : public HandSource {
 public:
  ComingHand(double height, double speed, const Vec3& way) : speed_(speed), way_(glm::normalize(way)), height_(height) { place(); }
  const HandState& read() noexcept override { return state_; }
  void apply(const Wrench& on_hand) noexcept override {
    const double depth = -state_.world_from_hand.translation.z;
    if (depth >= 0.0 && touched_ < 0) touched_ = static_cast<int>(state_.tick);
    // A tool with mass on a spring feels the start of the motion. That has died out by here.
    if (depth < -kNear) return next();
    if (glm::length(on_hand.force) > 0.05 && felt_ < 0) felt_ = static_cast<int>(state_.tick);
    largest_ = std::max(largest_, glm::length(on_hand.force));
    if (depth < 0.0) stray_ = stray_ || felt_ >= 0;
    next();
  }
  int touched_ = -1, felt_ = -1;  // ticks of first touch and of first force
  double largest_ = 0.0;          // [N]
  bool stray_ = false;            // a force in free space

 private:
  void next() noexcept {
    ++state_.tick;
    place();
  }
  void place() noexcept {
    const double gone = std::min(speed_ * kTick * static_cast<double>(state_.tick), (height_ + kStop) / -way_.z);
    state_.world_from_hand.translation = way_ * (gone - height_ / -way_.z);  // the line meets the face at the origin
    state_.velocity = gone < (height_ + kStop) / -way_.z ? way_ * speed_ : Vec3(0.0);
  }
  double speed_;
  Vec3 way_;
  double height_;
  HandState state_;
};

struct Approach {
  int contact_hz;
  double speed;  // [m/s]
  std::string contact = kHeldKeys;
  std::vector<std::string> sets = {};
  Vec3 way{0.0, 0.0, -1.0};
  double height = 60e-3;  // [m]
};

void comes_to_bone(const Approach& approach) {
  SmallScene small{.contact_keys = approach.contact, .sets = approach.sets};
  small.sets.push_back("contact.rate_hz=" + std::to_string(approach.contact_hz));
  small.sets.push_back("hand.standoff_mm=" + std::to_string(approach.height * 1e3));
  LoadedScene loaded = load_small(small);
  const double way = (approach.height + kStop) / -glm::normalize(approach.way).z;
  loaded.scene.duration = way / approach.speed + 0.2;
  ComingHand hand(approach.height, approach.speed, approach.way);
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(std::move(loaded), options);
  Simulation& simulation = run.run().simulation();
  // A contact evaluation at or after the touch, and its latency. A body on a spring is evaluated where it was a period before.
  const bool on_spring = approach.contact.find("coupling") != std::string::npos;
  const int most = static_cast<int>(simulation.stage().contact_every * (on_spring ? 2 : 1) + simulation.stage().latency);
  MESSAGE(approach.contact.substr(0, 30) << " " << approach.way.x << " " << approach.contact_hz << " Hz, " << approach.speed
                                         << " m/s: force " << hand.felt_ - hand.touched_ << " ms after touch (" << most << "), at most "
                                         << hand.largest_ << " N");
  REQUIRE(hand.touched_ > 0);
  REQUIRE(hand.felt_ > 0);
  CHECK(hand.felt_ - hand.touched_ <= most);
  CHECK_FALSE(hand.stray_);
  CHECK((simulation.contact_flags() & kContactOutsideWindow) == 0);
  CHECK(figure(simulation, "erosion", "points_outside") == 0.0);
}

TEST_CASE("approach: bone is felt within a contact period and its latency, at 20 Hz to 1 kHz and 0.05 to 1 m/s, from far outside") {
  for (const int hz : {20, 50, 100, 1000})
    for (const double speed : {0.05, 0.2, 0.5, 1.0}) comes_to_bone({hz, speed});
}

TEST_CASE("approach: the same aslant, from beyond the grid, in fine and coarse voxels, and by every model") {
  for (const Vec3& way : {Vec3(0.8, 0.0, -1.0), Vec3(-1.0, 1.5, -0.7)}) {
    comes_to_bone({1000, 1.0, kHeldKeys, {}, way});
    comes_to_bone({20, 0.2, kHeldKeys, {}, way});
  }
  for (const char* spacing : {"volume.spacing_mm=0.125", "volume.spacing_mm=0.5"}) comes_to_bone({100, 1.0, kHeldKeys, {spacing}});
  const std::string planes = kPenaltyKeys, voxmap = "model = \"voxmap\"\nstiffness_N_per_m = 20e3\n", coupled = "coupling = \"virtual\"\n";
  for (const std::string& model : {planes, voxmap, planes + coupled, voxmap + coupled}) {
    comes_to_bone({1000, 1.0, model});
    comes_to_bone({100, 0.5, model});
  }
}

}  // namespace
}  // namespace burrhole::test
