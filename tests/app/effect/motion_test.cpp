// [motion]: contact, erosion and measures depend on the pose of the tool relative to the bone alone; a replay moves the bone alike.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/base/rotation.h"
#include "haptics/device/device_hand.h"
#include "haptics/device/device_model.h"
#include "haptics/hand/bone_drive.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

const Quat kUpright(1.0, 0.0, 0.0, 0.0);

/// A hand whose readings are given.
class GivenHand final : public HandSource {
 public:
  explicit GivenHand(std::function<HandState(std::uint64_t)> at) : at_(std::move(at)) {}
  const HandState& read() noexcept override {
    state_ = at_(tick_);
    state_.tick = tick_;
    return state_;
  }
  void apply(const Wrench&) noexcept override { ++tick_; }

 private:
  std::function<HandState(std::uint64_t)> at_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

HandState place(const Pose& world_from_hand, const Vec3& velocity = Vec3(0.0)) {
  HandState out;
  out.world_from_hand = world_from_hand;
  out.velocity = velocity;
  return out;
}

LoadedScene scene_of(const SmallScene& scene, const std::string& motion) { return load_text(scene_text(scene) + motion, scene.sets); }

const Pose kTurned{rotation_of({0.3, -0.5, 0.8}), {4e-3, -7e-3, 2e-3}};
/// The same pose as one keyframe about the bone's origin.
std::string turned_motion() {
  const Vec3 v = rotation_vector(kTurned.rotation), d = kTurned.translation * 1e3;
  return fmt::format(
      "\n[motion]\npivot_mm = [0.0, 0.0, 0.0]\n[[motion.key]]\ntime_s = 0\ntranslation_mm = [{}, {}, {}]\naxis = [{}, {}, {}]\n"
      "angle_deg = {}\n",
      d.x, d.y, d.z, v.x, v.y, v.z, glm::length(v) * 180.0 / std::numbers::pi);
}

/// Moves in from above by a millimetre a second, to 0.6 mm below the face, as seen from `world_from_rest`.
std::function<HandState(std::uint64_t)> pressing(const Pose& world_from_rest) {
  return [world_from_rest](std::uint64_t tick) {
    const double z = std::max(-0.6e-3, 0.3e-3 - 1e-3 * static_cast<double>(tick) * 1e-3);
    return place(world_from_rest * Pose{kUpright, Vec3(0.0, 0.0, z)}, world_from_rest.rotate(Vec3(0.0, 0.0, z > -0.6e-3 ? -1e-3 : 0.0)));
  };
}

struct Held {
  double removed = 0.0;  // [mm^3]
  Vec3 force{0.0};       // [N] at the end
  std::vector<float> density;
};

Held drilled(const SmallScene& scene, const std::string& motion, const Pose& world_from_rest) {
  GivenHand hand(pressing(world_from_rest));
  SimulationOptions options;
  options.hand = &hand;
  DrillRun run(scene_of(scene, motion), options);
  REQUIRE(run.simulation().stage().place(world_from_rest * Pose{kUpright, Vec3(0.0, 0.0, 0.3e-3)}));
  run.run();
  Held out;
  out.force = run.simulation().contact_state().on_hand.force;
  if (scene.erosion) out.removed = figure(run.simulation(), "erosion", "removed_mass_mm3");
  const VoxelBox box{Vec3i(0), run.simulation().voxmap().bone().dims()};
  out.density.resize(box.count());
  run.simulation().voxmap().read_density(box, out.density);
  return out;
}

SmallScene short_scene(bool penalty) {
  SmallScene scene{.sets = {"duration_s=1.2", "tool.erosion_scale=3"}};
  if (penalty) scene.contact_keys = kPenaltyKeys;
  return scene;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += std::pow(static_cast<double>(a[n]) - static_cast<double>(b[n]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST_CASE("motion: bone and tool turned alike give the same hole, and the force turns with them") {
  for (const bool penalty : {true, false}) {
    const SmallScene scene = short_scene(penalty);
    const Held rest = drilled(scene, "", {}), turned = drilled(scene, turned_motion(), kTurned),
               apart = drilled(scene, turned_motion(), {});
    MESSAGE(rest.removed << " mm^3 at rest, " << turned.removed << " turned, " << apart.removed << " with the bone turned alone");
    REQUIRE(rest.removed > 0.02);
    // The same numbers in other digits: poses differ by 1e-16, floats of the bone by 6e-8, and the search for contact stops at 0.03 of a
    // voxel (constrained_tool.h), which is 0.0075 mm of 0.6.
    CHECK(std::abs(turned.removed - rest.removed) < 0.0125 * rest.removed);
    // The bone turned alone: another hole.
    CHECK(rms_difference(turned.density, rest.density) < 0.1 * rms_difference(apart.density, rest.density));
    const double force = glm::length(rest.force);
    REQUIRE(force > 0.05);
    CHECK(glm::length(kTurned.rotation * rest.force - turned.force) < 0.05 * force);
    CHECK(glm::length(rest.force - turned.force) > 0.3 * force);
  }
}

TEST_CASE("motion: a hand that moves bone and tool as one body cuts nothing; with the bone at rest the same hand cuts") {
  // Beside the edge of a post, 0.1 mm off; the hand then swings over it.
  const auto swing = [](bool grasps) {
    return [grasps](std::uint64_t tick) {
      const double t = static_cast<double>(tick) * 1e-3, angle = 0.9 * std::sin(3.0 * t);
      HandState out =
          place({rotation_of({0.0, angle, 0.2 * angle}), Vec3(2e-3 * std::sin(5.0 * t), 0.0, 1e-4 - 1.5e-3 * std::sin(3.0 * t))});
      out.switches = grasps ? BoneSwitch::kGrasp : 0;
      return out;
    };
  };
  for (const bool grasps : {true, false}) {
    GivenHand hand(swing(grasps));
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(scene_of({.contact = false, .sets = {"duration_s=1.0"}}, "\n[motion]\n"), options);
    run.run();
    const double removed = figure(run.simulation(), "erosion", "removed_mass_mm3");
    if (grasps) {
      CHECK(removed == 0.0);
      CHECK(figure(run.simulation(), "motion", "fastest_turn_deg_s") > 100.0);
    } else {
      CHECK(removed > 0.1);
    }
  }
}

/// The grip of a simulated device, which a spring moves away from bone while a button is pressed.
class GraspingDevice final : public HandSource {
 public:
  static constexpr std::uint64_t kFrom = 200, kTo = 600;  ///< [ticks] with the button
  GraspingDevice(SimulatedDevice device, std::uint32_t button) : device_(std::move(device)), button_(button) {
    hand_.emplace(*DeviceHand::create(device_, {}));
    device_.place(Vec3(0.0, 0.0, 5e-3));
  }
  const HandState& read() noexcept override {
    device_.set_buttons(tick_ >= kFrom && tick_ < kTo ? button_ : 0u);
    device_.set_goal({.rest = Vec3(0.0, 8e-6 * static_cast<double>(tick_), 5e-3)});
    const HandState& out = hand_->read();
    if (tick_ == kFrom) from_ = out.world_from_hand.translation;
    if (tick_ == kTo - 1) to_ = out.world_from_hand.translation;
    return out;
  }
  void apply(const Wrench& on_hand) noexcept override {
    hand_->apply(on_hand);
    ++tick_;
  }
  [[nodiscard]] Vec3 moved() const { return to_ - from_; }

 private:
  SimulatedDevice device_;
  std::optional<DeviceHand> hand_;
  std::uint32_t button_;
  std::uint64_t tick_ = 0;
  Vec3 from_{0.0}, to_{0.0};
};

TEST_CASE("motion: the grip of a device moves the bone while its button is pressed, and no other button does") {
  const auto moved = [](std::uint32_t button) {
    auto device = SimulatedDevice::create(make_simulated_config(**find_device("generic"), **find_hand("firm")), 1e-3);
    REQUIRE(device.ok());
    GraspingDevice hand(*device, button);
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(scene_of({.erosion = false, .sets = {"duration_s=0.8"}}, "\n[motion]\n"), options);
    run.run();
    return std::pair(run.simulation().contact_state().bone.world_from_rest.translation, hand.moved());
  };
  const auto [bone, hand] = moved(kGraspButton);
  CHECK(glm::length(hand) > 2e-3);
  CHECK(glm::length(bone - hand) < 0.1e-3);  // the pose at the press may be a position step and a reading later than here
  CHECK(moved(kGraspButton << 1).first == Vec3(0.0));
  CHECK(moved(kGraspButton >> 1).first == Vec3(0.0));
}

TEST_CASE("motion: bone that turns under a tool at rest drags it by friction, the way it moves there") {
  // The ball rests 1.5 mm beside the axis of rotation, z through the origin; there the bone moves along +y.
  SmallScene scene{.erosion = false, .contact_keys = kPenaltyKeys, .sets = {"duration_s=0.5", "tool.spin_rpm=0"}};
  const std::string friction = "\n[friction]\nstatic_coefficient = 0.3\nkinetic_coefficient = 0.3\n";
  for (const double turn : {40.0, -40.0}) {
    GivenHand hand([](std::uint64_t) { return place({kUpright, Vec3(1.5e-3, 0.0, -0.05e-3)}); });
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(
        scene_of(scene, friction +
                            "\n[motion]\npivot_mm = [0, 0, 0]\n[[motion.key]]\ntime_s = 0\n[[motion.key]]\ntime_s = 1\nangle_deg = " +
                            std::to_string(turn) + "\n"),
        options);
    REQUIRE(run.simulation().stage().place({kUpright, Vec3(1.5e-3, 0.0, 0.3e-3)}));
    run.run();
    const Vec3 force = run.simulation().contact_state().on_hand.force;
    CHECK(force.z > 0.3);
    // Sliding friction: mu N along the bone's velocity; some points of the ball's contact press obliquely.
    CHECK(force.y * (turn > 0.0 ? 1.0 : -1.0) > 0.25 * force.z);
    CHECK(std::abs(force.x) < 0.1 * force.z);
  }
}

TEST_CASE("motion: a replay gives the same voxels, forces and poses, keyframes and switches included") {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "moved.bhs").string();
  SmallScene scene{.record = true, .sets = {"duration_s=0.9", "tool.erosion_scale=3", "hand.ramp_s=0.05"}};
  const std::string motion =
      "\n[motion]\n[[motion.key]]\ntime_s = 0.2\n[[motion.key]]\ntime_s = 0.8\nangle_deg = 25\ntranslation_mm = [0.5, 0, 0]\n";
  SimulationOptions options;
  options.inputs = {{300, InputKind::switches, static_cast<double>(BoneSwitch::bit(2) | BoneSwitch::bit(7)), {}, {}},
                    {600, InputKind::switches, 0.0, {}, {}}};
  DrillRun run(scene_of(scene, motion), options);
  run_recorded(run, path);
  const std::vector<double> x = session_column(path, "bone_x"), w = session_column(path, "bone_qw");
  REQUIRE(x.size() == w.size());
  CHECK(w.front() == 1.0);
  CHECK(w.back() < 0.98);
  ReplayRun again(path);
  CHECK(again.run().voxel_hash() == run.voxel_hash());
  CHECK(again.run().simulation().force_hash() == run.simulation().force_hash());
  // Without the switches the bone moves otherwise, so they are part of what is replayed.
  DrillRun other(scene_of(scene, motion));
  other.run();
  CHECK(other.simulation().force_hash() != run.simulation().force_hash());
}

TEST_CASE("motion: a scene without it has no step, column or figure of it, and a bone that is not moved the same bits") {
  DrillRun without(short_scene(false)), with(scene_of(short_scene(false), "\n[motion]\n"));
  without.run();
  with.run();
  for (const auto& step : without.simulation().stage().graph.steps()) CHECK(step.effect != "motion");
  CHECK_FALSE(without.simulation().stage().figure("motion", "turned_deg").has_value());
  CHECK(without.simulation().force_hash() == with.simulation().force_hash());
  CHECK(without.voxel_hash() == with.voxel_hash());
}

TEST_CASE("motion: keyframes out of order and an axis of no length are errors of the scene") {
  for (const std::string bad :
       {"[[motion.key]]\ntime_s = 1\n[[motion.key]]\ntime_s = 1\n", "[[motion.key]]\ntime_s = 1\naxis = [0, 0, 0]\n"}) {
    auto document = TomlDocument::parse(scene_text({}) + "\n[motion]\n" + bad, "small.toml");
    REQUIRE(document.ok());
    Issues issues;
    CHECK_FALSE(load_scene(*document, test_context(), issues).has_value());
    CHECK(issues.size() == 1);
  }
}

}  // namespace
}  // namespace burrhole::test
