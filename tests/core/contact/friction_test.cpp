// friction against Coulomb's cone in every form of contact, creep, the energy of random closed strokes, and a spinning tool's closed form.
#include "core/contact/friction.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/units.h"
#include "friction_support.h"
#include "tests/support/sanitized.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

Friction friction_of(double coefficient, double kinetic = -1.0) {
  auto made = Friction::create({.static_coefficient = coefficient, .kinetic_coefficient = kinetic < 0.0 ? coefficient : kinetic});
  REQUIRE(made.ok());
  return *made;
}

constexpr double kNormal = 3.0;  // [N]
constexpr double kPi = std::numbers::pi;
Vec3 direction(int n) { return {std::cos(0.7 * n), std::sin(0.7 * n), 0.0}; }

/// [m] by which a block moves in the last fifth of a second under a tangential load of `share` times mu N.
double slid(const Form& form, TangentialLaw& law, double coefficient, double share, const Vec3& way) {
  Block block(form, &law);
  block.run(0.3, [](double) { return Vec3(0.0, 0.0, -kNormal); });
  const Vec3 load = way * (share * coefficient * kNormal) - Vec3(0.0, 0.0, kNormal);
  block.run(0.2, [&](double t) { return load * Vec3(5.0 * t, 5.0 * t, 1.0); });
  block.run(0.4, [&](double) { return load; });
  const Vec3 before = block.place();
  block.run(0.2, [&](double) { return load; });
  CHECK(std::abs(block.state().on_hand.force.z - kNormal) < 0.001 * kNormal);
  return glm::length(block.place() - before);
}

/// A law that is wrong in one way.
class Sabotaged final : public TangentialLaw {
 public:
  enum class Way { sign, forgets, no_cone };
  Sabotaged(Friction law, Way way) : law_(law), way_(way) {}
  void clear() noexcept override { law_.clear(); }
  [[nodiscard]] TangentialLoads loads(const TangentialProblem& problem) noexcept override {
    if (way_ == Way::sign) {
      TangentialLoads out = law_.loads(problem);
      out.on_tool = {-out.on_tool.force, -out.on_tool.torque};
      return out;
    }
    points_.assign(problem.points.begin(), problem.points.end());
    if (way_ == Way::no_cone)
      for (PressedPoint& point : points_) point.load *= 1e3;
    TangentialProblem asked = problem;
    asked.points = points_;
    if (way_ == Way::forgets) {
      // A force that grows with the displacement of this step alone, as of a law without an anchor.
      law_.clear();
      asked.stiffness = asked.turn_stiffness = 1e12;
      TangentialLoads out = law_.loads(asked);
      const double moved = glm::length(problem.free.at(problem.points.empty() ? Vec3(0.0) : problem.points[0].arm));
      const double share = moved / (moved + 1e-6);
      out.on_tool = {out.on_tool.force * share, out.on_tool.torque * share};
      out.move = {problem.free.translation + out.on_tool.force / problem.stiffness,
                  problem.free.turn + out.on_tool.torque / problem.turn_stiffness};
      return out;
    }
    return law_.loads(asked);
  }
  void end_step(const SmallMove& moved) noexcept override { law_.end_step(moved); }

 private:
  Friction law_;
  Way way_;
  std::vector<PressedPoint> points_;
};

}  // namespace

TEST_CASE("friction: a block slides if and only if the load along the plate exceeds mu N, within 1 %, in every form of contact") {
  int n = 0;
  for (const Form& form : every_form())
    for (const double coefficient : {0.1, 0.3, 0.8}) {
      CAPTURE(form.name);
      CAPTURE(coefficient);
      const Vec3 way = direction(n++);
      Friction law = friction_of(coefficient);
      // Roundings of 1e-17 m and forces that have settled to e^-50; sliding at 0.01 mu N / (20 N s/m) makes 3e-5 m and more.
      CHECK(slid(form, law, coefficient, 0.99, way) < 1e-9);
      law.clear();
      CHECK(slid(form, law, coefficient, 1.01, way) > 1e-5);
      Sabotaged endless(friction_of(coefficient), Sabotaged::Way::no_cone);
      CHECK(slid(form, endless, coefficient, 1.01, way) < 1e-9);
    }
}

TEST_CASE("friction: under loads that oscillate within the cone a block at rest does not creep in 10 s, in every form of contact") {
  constexpr double kMu = 0.3;
  // Tangential load up to 0.9 of the least cone, the normal load swinging by 20 %, both at rates that share no period with the tick.
  const auto push = [](double t) {
    const double normal = kNormal * (1.0 + 0.2 * std::sin(2.0 * kPi * 11.3 * t));
    const Vec3 along(std::cos(2.0 * kPi * 0.7 * t), std::sin(2.0 * kPi * 1.1 * t), 0.0);
    return Vec3(0.0, 0.0, -normal) + along * (0.9 * 0.8 * kMu * kNormal / std::sqrt(2.0) * std::sin(2.0 * kPi * 7.1 * t));
  };
  const auto drift = [&](const Form& form, TangentialLaw& law) {
    Block block(form, &law);
    const auto rest = [](double) { return Vec3(0.0, 0.0, -kNormal); };
    block.run(0.5, rest);
    block.run(1.0, push);
    block.run(0.5, rest);
    const Vec3 before = block.place();
    block.run(10.0, push);
    block.run(0.5, rest);
    const Vec3 moved = block.place() - before;
    return block.lost() ? 1.0 : glm::length(Vec3(moved.x, moved.y, 0.0));
  };
  for (const Form& form : every_form()) {
    Friction law = friction_of(kMu);
    Sabotaged forgetful(friction_of(kMu), Sabotaged::Way::forgets);
    const double kept = drift(form, law), lost = drift(form, forgetful);
    std::printf("creep in 10 s, %s: %.3g m; without an anchor %.3g m\n", form.name.c_str(), kept, lost);
    // A step leaves up to 1e-12 m, which the next takes back; 1e4 of them that added up would be 1e-8 m.
    CHECK(kept < 1e-10);
    CHECK(lost > 1e-9);
  }
}

namespace {

/// [J] Work of a hand that carries the tool through a random closed stroke, from air through contact and back; its force at the end of each
/// period times its move in it, as the implicit step balances them.
double work_of_stroke(const Form& form, TangentialLaw* law, std::uint64_t seed, double rate) {
  auto model = form.make(pad(), {.voxel_edge = kPitch});
  HandMotion hand;
  hand.world_from_hand.translation = Vec3(0.0, 0.0, 3e-4);
  model->place(hand.world_from_hand);
  ContactState state;
  double work = 0.0;
  constexpr int kTicks = 2000;
  for (int n = 1; n <= kTicks; ++n) {
    const double t = 2.0 * kPi * n / kTicks;
    Vec3 place(0.0, 0.0, 3e-4 - 0.33e-3 * (1.0 - std::cos(t)));
    for (int k = 1; k <= 5; ++k)
      place += Vec3(1.0, 1.0, 0.05) * (4e-4 / k) * random_vector(seed, static_cast<std::uint64_t>(k)) * std::sin(k * t);
    const Vec3 moved = place - hand.world_from_hand.translation;
    const double turned = 0.02 * std::sin(3.0 * t), turned_before = 0.02 * std::sin(3.0 * (t - 2.0 * kPi / kTicks));
    hand.velocity = moved / kTick;
    hand.world_from_hand = {glm::angleAxis(turned, Vec3(0.0, 0.0, 1.0)), place};
    const BoneView bone = plate_bone().view();
    const ContactInput in{.bone = bone, .hand = hand, .dt = kTick, .spin = {.rate = rate}, .added = {.tangential = law}};
    (void)model->step(in, state);
    work -= glm::dot(state.on_hand.force, moved) + state.on_hand.torque.z * (turned - turned_before);
  }
  return work;
}

}  // namespace

TEST_CASE("friction: over random closed strokes it always takes work from the hand") {
  for (const Form& form : every_form()) {
    double least = 1e300, least_wrong = 1e300;
    for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 3 : 20); ++seed) {
      const double none = work_of_stroke(form, nullptr, seed, 0.0);
      for (const double coefficient : {0.1, 0.3, 0.9}) {
        Friction law = friction_of(1.2 * coefficient, coefficient);
        least = std::min(least, work_of_stroke(form, &law, seed, 0.0) - none);
      }
      Sabotaged wrong(friction_of(0.3), Sabotaged::Way::sign);
      least_wrong = std::min(least_wrong, work_of_stroke(form, &wrong, seed, 0.0) - none);
    }
    std::printf("least work against friction, %s: %.3g J; sign flipped %.3g J\n", form.name.c_str(), least, least_wrong);
    CHECK(least > 0.0);
    CHECK(least_wrong < 0.0);
  }
}

namespace {

/// A tool that is carried at a steady speed over the plate, pressed down, once its springs have settled.
struct Dragged {
  Wrench on_hand;
  double normal;
};
Dragged drag(const Form& form, const PointShell& shell, TangentialLaw& law, const Vec3& velocity, double rate, double depth) {
  auto model = form.make(shell, {.voxel_edge = kPitch});
  HandMotion hand;
  hand.world_from_hand.translation = Vec3(0.0, 0.0, 1e-4) - 0.2 * velocity;
  model->place(hand.world_from_hand);
  ContactState state;
  for (int n = 0; n < 400; ++n) {
    hand.velocity = velocity;
    hand.world_from_hand.translation += velocity * kTick;
    hand.world_from_hand.translation.z = std::max(-depth, hand.world_from_hand.translation.z - 1e-5);
    const BoneView bone = plate_bone().view();
    (void)model->step({.bone = bone, .hand = hand, .dt = kTick, .spin = {.rate = rate}, .added = {.tangential = &law}}, state);
  }
  return {state.on_hand, state.on_hand.force.z};
}

}  // namespace

TEST_CASE("friction: a spinning tool has the drag torque and side force of Coulomb's law at each point, and feed is eased as v / rim") {
  constexpr double kMu = 0.25;
  // A ring of points about the axis, and a single point beside it.
  PointShell ring = pad();
  ring.positions.clear();
  for (int n = 0; n < 9; ++n) ring.positions.push_back(1.5e-3 * Vec3(std::cos(2.0 * kPi * n / 9.0), std::sin(2.0 * kPi * n / 9.0), 0.0));
  PointShell beside = pad();
  for (Vec3& p : beside.positions) p = 1e-5 * p + Vec3(2e-3, 0.0, 0.0);
  for (const Form& form : every_form()) {
    CAPTURE(form.name);
    const double depth = form.name.starts_with("voxmap") ? 0.30e-3 : 0.1e-3;
    Friction law = friction_of(0.4, kMu);
    const Dragged turned = drag(form, ring, law, Vec3(0.0), 300.0, depth);
    // Round the ring every point rubs against its rim speed: torque mu N R, no net force.
    CHECK(std::abs(turned.on_hand.torque.z / (-kMu * turned.normal * 1.5e-3) - 1.0) < 1e-3);
    CHECK(std::hypot(turned.on_hand.force.x, turned.on_hand.force.y) < 1e-3 * kMu * turned.normal);
    // Beside the axis: a side force mu N against the rim speed, which is along +y, and its torque.
    law.clear();
    const Dragged aside = drag(form, beside, law, Vec3(0.0), 300.0, depth);
    CHECK(std::abs(aside.on_hand.force.y / (-kMu * aside.normal) - 1.0) < 1e-3);
    CHECK(std::abs(aside.on_hand.force.x) < 1e-3 * kMu * aside.normal);
    CHECK(std::abs(aside.on_hand.torque.z / (-kMu * aside.normal * 2e-3) - 1.0) < 1e-2);
    // Feed along x at v, the rim speed w R across it: resistance mu N v / sqrt(v^2 + (w R)^2).
    for (const double rate : {0.0, 10.0, 100.0, 1000.0}) {
      law.clear();
      constexpr double kFeed = 5e-3;
      const Dragged fed = drag(form, beside, law, Vec3(kFeed, 0.0, 0.0), rate, depth);
      const double expected = kMu * fed.normal * kFeed / std::hypot(kFeed, rate * 2e-3);
      CAPTURE(rate);
      // The normals of voxmap turn with the tool, by N 2 mm / (5 N m/rad): up to 4e-4 of N, which is 2e-3 of mu N.
      CHECK(std::abs(-fed.on_hand.force.x - expected) < 0.01 * expected + 2e-3 * kMu * fed.normal);
    }
  }
}
