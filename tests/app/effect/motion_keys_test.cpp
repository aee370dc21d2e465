// [motion] in a run: each key gives the recorded pose of the bone by its closed form, and what a hand at rest feels of it.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/rotation.h"
#include "haptics/hand/bone_drive.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kMilli = 1e-3;

/// A scene in which bone frame and world differ in every number.
SmallScene turned_scene() {
  return {.contact = false,
          .erosion = false,
          .record = true,
          .sets = {"duration_s=1.2", "volume.turn_deg=[20, -35, 50]", "volume.position_mm=[4, -7, 11]", "hand.standoff_mm=8"}};
}
struct Moved {
  std::vector<Pose> poses;  // world from rest, a tick each
  Pose world_from_bone;
  double turned = 0.0, fastest = 0.0;  // [deg], [deg/s] the figures
};
Moved moved(const std::string& motion, const SimulationOptions& options = {}) {
  const TemporaryFolder folder;
  const SmallScene scene = turned_scene();
  DrillRun run(load_text(scene_text(scene) + "\n[motion]\n" + motion, scene.sets), options);
  run_recorded(run, folder.file("run.sqlite"));
  const auto column = [&](const char* name) { return session_column(folder.file("run.sqlite"), name); };
  const std::array<std::vector<double>, 7> c{column("bone_x"),  column("bone_y"),  column("bone_z"), column("bone_qw"),
                                             column("bone_qx"), column("bone_qy"), column("bone_qz")};
  Moved out{.poses = {}, .world_from_bone = run.loaded().scene.volume.world_from_bone};
  REQUIRE(c[0].size() == 1200);
  for (std::size_t n = 0; n < c[0].size(); ++n)
    out.poses.push_back({Quat(c[3][n], c[4][n], c[5][n], c[6][n]), Vec3(c[0][n], c[1][n], c[2][n])});
  out.turned = figure(run.simulation(), "motion", "turned_deg");
  out.fastest = figure(run.simulation(), "motion", "fastest_turn_deg_s");
  return out;
}

/// A displacement of the bone in its own frame at rest.
struct Given {
  Vec3 pivot{0.0}, translation{0.0}, turn{0.0};  // [m], [m], [rad]
};
/// [m] The furthest that one of a few points of the bone is from where `given` has it, at any tick.
double furthest(const Moved& run, const std::function<Given(double)>& given) {
  double out = 0.0;
  for (std::size_t n = 0; n < run.poses.size(); ++n) {
    const Given at = given(static_cast<double>(n) * kMilli);
    for (const Vec3& point : {Vec3(0.0), Vec3(0.01, 0.0, 0.0), Vec3(0.0, 0.01, -0.005)}) {
      const Vec3 expected = at.pivot + at.translation + rotation_of(at.turn) * (point - at.pivot);
      out = std::max(out, glm::length(run.poses[n] * (run.world_from_bone * point) - run.world_from_bone * expected));
    }
  }
  return out;
}

constexpr double kRounding = 1e-12;  // [m] poses of centimetres, and a recorded number has all its bits
constexpr double kSeen = 1e-4;       // [m] what a tenth more of a key moves at least

/// Two keyframes with one axis, their numbers as a scene has them.
struct Keys {
  Vec3 pivot{3, -2, 5}, first{0.5, 0, -1}, second{2, -3, 1.5}, axis{1, -2, 0.5};  // [mm], [mm], [mm], any length
  double from = 0.2, to = 0.9, start = 20, end = 140;                             // [s], [s], [deg], [deg]
  [[nodiscard]] std::string text() const {
    const auto list = [](const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); };
    return fmt::format(
        "pivot_mm = {}\n[[motion.key]]\ntime_s = {}\ntranslation_mm = {}\naxis = {}\nangle_deg = {}\n"
        "[[motion.key]]\ntime_s = {}\ntranslation_mm = {}\naxis = {}\nangle_deg = {}\n",
        list(pivot), from, list(first), list(axis), start, to, list(second), list(axis), end);
  }
  [[nodiscard]] Given at(double time) const {
    const double share = std::clamp((time - from) / (to - from), 0.0, 1.0);
    return {pivot * kMilli, (first + (second - first) * share) * kMilli,
            axis * ((start + (end - start) * share) * kDegree / glm::length(axis))};
  }
};

}  // namespace

TEST_CASE("motion by keyframes: pivot_mm, time_s, translation_mm, axis and angle_deg give the recorded pose") {
  Keys many;
  many.end = 1000;
  for (const Keys& keys : {Keys{}, many}) {
    const Moved run = moved(keys.text());
    const auto off = [&](const Keys& these) { return furthest(run, [&](double time) { return these.at(time); }); };
    MESSAGE("within " << off(keys) << " m");
    CHECK(off(keys) < kRounding);
    for (double Keys::*const key : {&Keys::from, &Keys::to, &Keys::start, &Keys::end}) {
      Keys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(off(wrong) > kSeen);
    }
    for (Vec3 Keys::*const key : {&Keys::pivot, &Keys::first, &Keys::second}) {
      Keys wrong = keys;
      wrong.*key *= 1.1;
      CHECK(off(wrong) > kSeen);
    }
    Keys wrong = keys;
    wrong.axis.x *= 1.1;
    CHECK(off(wrong) > kSeen);
    wrong.axis = keys.axis * 1.1;  // any length
    CHECK(off(wrong) < kRounding);
    CHECK(run.fastest == doctest::Approx((keys.end - keys.start) / 0.7).epsilon(1e-9).scale(0.0));
  }
}

TEST_CASE("motion by keyframes without pivot_mm: it turns about the middle of the volume") {
  // The volume is 6 mm wide about the origin, and reaches from 1.5 mm above it to 4.5 mm below.
  Keys keys;
  const std::string text = keys.text();
  const Moved run = moved(text.substr(text.find('\n') + 1));
  keys.pivot = {0.0, 0.0, -1.5};
  CHECK(furthest(run, [&](double time) { return keys.at(time); }) < kRounding);
  keys.pivot.z *= 1.1;
  CHECK(furthest(run, [&](double time) { return keys.at(time); }) > kSeen);
}

TEST_CASE("motion by switches: speed_mm_per_s and turn_deg_per_s times the time for which they are pressed") {
  // Pressed at 0.3 s for 0.4 s: an input counts for the tick before which it is applied.
  for (const auto& [speed, rate] : {std::pair{20.0, 45.0}, {5.0, 200.0}}) {
    CAPTURE(speed);
    SimulationOptions options;
    options.inputs = {{300, InputKind::switches, static_cast<double>(BoneSwitch::bit(2) | BoneSwitch::bit(9)), {}, {}},
                      {700, InputKind::switches, 0.0, {}, {}}};
    const Moved run = moved(fmt::format("pivot_mm = [3, -2, 5]\nspeed_mm_per_s = {}\nturn_deg_per_s = {}\n", speed, rate), options);
    const auto off = [&](double v, double w) {
      return furthest(run, [&](double time) {
        const double pressed = std::clamp(time - 0.299, 0.0, 0.4);
        return Given{Vec3(3, -2, 5) * kMilli, Vec3(0.0, v * pressed * kMilli, 0.0), Vec3(0.0, -w * pressed * kDegree, 0.0)};
      });
    };
    MESSAGE("within " << off(speed, rate) << " m");
    CHECK(off(speed, rate) < kRounding);
    CHECK(off(1.1 * speed, rate) > kSeen);
    CHECK(off(speed, 1.1 * rate) > kSeen);
    CHECK(run.turned == doctest::Approx(0.4 * rate).epsilon(1e-9).scale(0.0));
    CHECK(run.fastest == doctest::Approx(rate).epsilon(1e-9).scale(0.0));
  }
}

namespace {

/// A hand that stays where it is.
class StillHand final : public HandSource {
 public:
  explicit StillHand(const Vec3& at) { state_.world_from_hand.translation = at; }
  const HandState& read() noexcept override {
    state_.tick = forces.size();
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override { forces.push_back(on_hand.force); }
  std::vector<Vec3> forces;  // [N] of each tick

 private:
  HandState state_;
};

}  // namespace

TEST_CASE("motion: a hand at rest feels the stiffness of its spring times how far the bone has risen") {
  // The tip of the ball is 0.2 mm above the plate, which rises by 1.2 mm in a second. Contact is found to 0.03 of a voxel (constrained_tool.h),
  // 0.04 N, at either end; the damper of 10 N s/m adds 0.012 N to both.
  for (const double rise : {1.2, 0.9}) {
    StillHand hand(Vec3(0.0, 0.0, 0.2e-3));
    SimulationOptions options;
    options.hand = &hand;
    const SmallScene scene{.erosion = false, .sets = {"duration_s=1.0", "tool.spin_rpm=0"}};
    const std::string motion =
        fmt::format("\n[motion]\n[[motion.key]]\ntime_s = 0\n[[motion.key]]\ntime_s = 1\ntranslation_mm = [0, 0, {}]\n", rise);
    DrillRun run(load_text(scene_text(scene) + motion, scene.sets), options);
    run.run();
    REQUIRE(hand.forces.size() == 1000);
    const double grown = hand.forces[949].z - hand.forces[449].z, expected = 5000.0 * 0.5 * rise * kMilli;
    MESSAGE("force grows by " << grown << " N, expected " << expected);
    CHECK(std::abs(grown - expected) < 0.08);
    CHECK(std::abs(hand.forces[949].z - 5000.0 * (0.95 * rise - 0.2) * kMilli) < 0.08);
    CHECK(std::abs(grown - 1.1 * expected) > 0.08);
    CHECK(hand.forces[100] == Vec3(0.0));
  }
}

}  // namespace burrhole::test
