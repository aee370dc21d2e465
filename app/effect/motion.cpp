// [motion]: the bone is moved and turned while it is felt and drilled: by keyframes, by switches, by the hand.

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "app/effect/registry.h"
#include "app/stage/stage.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "haptics/hand/bone_drive.h"

namespace burrhole {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct MotionConfig {
  std::vector<PoseKey> keys;          ///< bone frame at rest
  std::optional<Vec3> pivot;          ///< [m] bone frame; absent: the middle of the volume
  double speed = 0.02;                ///< [m/s]
  double turn_rate = 45.0 * kDegree;  ///< [rad/s]
};

class MotionEffect final : public Effect, public BoneMover {
 public:
  MotionEffect(const BoneDrive& drive, Stage& stage) : drive_(drive), stage_(&stage) {}

  Status bind(StepGraph& graph) override {
    stage_->contact->follow(this);
    auto step = graph.step(
        Clock::contact, "motion", "motion", [](void* self, const Tick&) { static_cast<MotionEffect*>(self)->note(); }, this);
    constexpr std::array<std::pair<const char*, const char*>, 7> kColumns{
        {{"bone_x", "m"}, {"bone_y", "m"}, {"bone_z", "m"}, {"bone_qw", ""}, {"bone_qx", ""}, {"bone_qy", ""}, {"bone_qz", ""}}};
    for (std::size_t n = 0; n < kColumns.size(); ++n) step.column(kColumns[n].first, kColumns[n].second, &pose_[n], true);
    if (stage_->frame() == nullptr) return {};
    auto frame = graph.step(
        Clock::frame, "motion", "bone's pose", [](void* self, const Tick&) { static_cast<MotionEffect*>(self)->show(); }, this);
    seen_ = frame.latest(slots::kBone);
    stage_->frame()->move_bone(shown_ ? now_.world_from_rest : drive_.start());
    return {};
  }
  BoneMotion move(const HandState& hand) noexcept override { return now_ = drive_.move(hand); }
  void report(Figures& out) const override {
    const double w = std::abs(now_.world_from_rest.rotation.w);
    out.add("turned_deg", 2.0 * std::acos(std::min(1.0, w)) / kDegree);
    out.add("fastest_turn_deg_s", fastest_ / kDegree);
  }

 private:
  void note() noexcept {
    const Vec3& t = now_.world_from_rest.translation;
    const Quat& q = now_.world_from_rest.rotation;
    pose_ = {t.x, t.y, t.z, q.w, q.x, q.y, q.z};
    fastest_ = std::max(fastest_, glm::length(now_.angular_velocity));
  }
  /// Before the first step of bone the slot has its start value, and the bone is drawn where the motion starts.
  void show() noexcept {
    const Pose& pose = seen_->world_from_rest;
    shown_ = shown_ || pose.translation != Vec3(0.0) || pose.rotation != Quat(1.0, 0.0, 0.0, 0.0);
    if (shown_) stage_->frame()->move_bone(pose);
  }

  BoneDrive drive_;
  Stage* stage_;
  BoneMotion now_;
  double fastest_ = 0.0;  // [rad/s]
  std::array<double, 7> pose_{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
  const BoneMotion* seen_ = nullptr;
  bool shown_ = false;
};

class MotionPlan final : public ConfigPlan<MotionPlan, MotionConfig> {
 public:
  explicit MotionPlan(TableReader& table) {
    constexpr double kFar = 10.0;  // [m]
    const NumberRule length{.min = -kFar / kMillimetre, .max = kFar / kMillimetre, .to_si = kMillimetre};
    const auto pivot =
        table.optional_numbers("pivot_mm", 3, length, "point about which the bone turns, bone frame; absent: the middle of the volume");
    if (pivot) config_.pivot = Vec3((*pivot)[0], (*pivot)[1], (*pivot)[2]);
    config_.speed = table.number("speed_mm_per_s", above_zero(config_.speed / kMillimetre, kMillimetre, 1e3),
                                 "speed of the bone while a switch moves it");
    config_.turn_rate =
        table.number("turn_deg_per_s", above_zero(45.0, kDegree, 3600.0), "speed of rotation while a switch turns the bone");
    for (TableReader& key : table.tables("key", "keyframes of the bone's pose relative to its pose in the scene, in the order of time")) {
      PoseKey one;
      one.time = key.number("time_s", {.min = 0.0, .max = 1e5}, "simulated time");
      one.translation = key.vector("translation_mm", Vec3(0.0), length, "displacement of the pivot, bone frame at rest");
      one.axis = key.vector("axis", one.axis, {.min = -1e6, .max = 1e6}, "axis of the rotation about the pivot, bone frame at rest");
      one.angle =
          key.number("angle_deg", {.fallback = 0.0, .min = -1e6, .max = 1e6, .to_si = kDegree},
                     "angle of the rotation; between two keyframes with one axis the bone turns by the difference, which may exceed 360");
      if (glm::length(one.axis) == 0.0) key.fault("axis", "must not be zero");
      if (!config_.keys.empty() && one.time <= config_.keys.back().time) key.fault("time_s", "must be later than that of the previous key");
      key.finish();
      config_.keys.push_back(one);
    }
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "motion",
            .clock = Clock::contact,
            .step = "pose of the bone",
            .needs = "hand",
            .gives = "bone's pose",
            .detail = fmt::format("{} keyframes, switches {:g} mm/s and {:g} deg/s", config_.keys.size(), config_.speed / kMillimetre,
                                  config_.turn_rate / kDegree),
            .rate_hz = static_cast<double>(context.needs.contact_hz > 0 ? context.needs.contact_hz : context.config.servo_hz),
            .bytes = sizeof(MotionEffect) + config_.keys.size() * sizeof(PoseKey)};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (context.needs.through_device)
      out.push_back(
          "[motion] with [device]: a moving bone does work on the hand, which the energy detector counts as generated; set "
          "servo.energy_mJ = 0 if it latches");
  }
  std::string setting() const override { return fmt::format("motion by {} keyframes", config_.keys.size()); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const Pose& rest = stage.config.volume.world_from_bone;
    const BoneModel& bone = stage.voxmap->bone();
    const Vec3 pivot = config_.pivot ? *config_.pivot : bone.bone_from_index() * (0.5 * Vec3(bone.dims() - 1));
    std::vector<PoseKey> keys = config_.keys;
    for (PoseKey& key : keys) {
      key.translation = rest.rotate(key.translation);
      key.axis = rest.rotate(key.axis);
    }
    auto path = PosePath::create(std::move(keys));
    if (!path) return Error{path.error().code, path.error().message, stage.config.file};
    const BoneDriveConfig config{rest * pivot, rest.rotation, config_.speed, config_.turn_rate, stage.period};
    const BoneDrive drive(config, std::move(path).value());
    stage.offer_bone_pose(drive.start());
    return std::unique_ptr<Effect>(std::make_unique<MotionEffect>(drive, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<MotionPlan>(table); }

}  // namespace

EffectEntry motion_effect() {
  return {"motion", "the bone moves while it is felt and drilled; without it the bone is at rest", read, {"[[motion.key]]\ntime_s = 0"}};
}

}  // namespace burrhole
