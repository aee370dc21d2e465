#include "app/lab/frontier_loop.h"
#include "core/contact/constrained_tool.h"
#include "haptics/device/device_config.h"

#include <fmt/format.h>

#include <cmath>

namespace burrhole {
namespace {

// 40 points on the ball of the plate and 177 on that of the sphere: a tick of all steps takes some microseconds.
constexpr const char* kPlateTool = R"(title = "Ball of 2 mm"
[shell]
pitch_mm = 0.5
[[region]]
name = "ball"
shape = "sphere"
z_mm = 0
diameter_mm = 2
erosion_factor = 0.1
)";
constexpr const char* kSphereTool = R"(title = "Ball of 10 mm"
[shell]
pitch_mm = 1.2
[[region]]
name = "ball"
shape = "sphere"
z_mm = 0
diameter_mm = 10
erosion_factor = 0.1
)";
constexpr const char* kPlate = R"(source = "phantom:plate"
spacing_mm = 0.25
extent_mm = [6.0, 6.0, 4.0]
above_mm = 1.5
thickness_mm = 1.5
)";
constexpr const char* kSphere = R"(source = "phantom:sphere"
spacing_mm = 0.5
extent_mm = [13.0, 13.0, 13.0]
above_mm = 1.5
radius_mm = 5.0
)";

// A thrust of 2 N engages the bit by a voxel: enough to be cut. In series with the coupling.
constexpr double kCuttingStiffness = 4e3;  // [N/m]

const char* tool_of(const FrontierLoopConfig& config) { return config.bone == FrontierBone::plate ? kPlateTool : kSphereTool; }

std::string text_of(const FrontierLoopConfig& config) {
  std::string text = fmt::format("title = \"Frontier\"\nservo_hz = {}\n[volume]\n{}[tool]\nname = \"ball\"\nspin_rpm = {}\n",
                                 config.servo_hz, config.bone == FrontierBone::plate ? kPlate : kSphere, config.drilling ? 1000 : 0);
  text += "[approach]\nentry_mm = [0.0, 0.0, 0.0]\n[hand]\nstandoff_mm = 0.01\n";
  // The force limit of the servo is above that of any device; planes are extrapolated as far as docs/servo.md requires.
  // A grip that starts pressed gets the full force at once.
  text += fmt::format("[servo]\nmultirate = \"{}\"\nforce_N = 1e4\nreach_mm = 10.0\nsoft_start_s = 0\nenergy_mJ = 0\n[device]\n",
                      name_of(config.scheme));
  text += fmt::format(
      "[contact]\nmodel = \"surface\"\nturning = \"locked\"\nbone_N_per_m = {}\ncoupling_N_per_m = 1000.0\ncoupling_N_s_per_m = {}\n"
      "rate_hz = {}\nlatency_ticks = {}\n",
      kBoneStiffness, config.coupling_damping, config.servo_hz / config.contact_ticks, config.latency_ticks);
  return config.drilling ? text + fmt::format("cutting_N_per_m = {}\n[erosion]\n", kCuttingStiffness) : text;
}

}  // namespace

Result<PushedGrip> PushedGrip::create(const SimulatedDeviceConfig& config, const Pose& world_from_approach, double period) {
  auto created = SimulatedDevice::create(config, period);
  if (!created) return created.error();
  auto device = std::make_unique<SimulatedDevice>(std::move(created).value());
  auto hand = DeviceHand::create(*device, {.world_from_device = world_from_approach});
  if (!hand) return hand.error();
  return PushedGrip(std::move(device), *hand);
}

void PushedGrip::start(const FrontierStart& start) noexcept {
  start_ = start;
  ticks_ = 0;
  device_->place({0.0, 0.0, start.height});
  device_->set_goal({{0.0, 0.0, start.rest}, {0.0, 0.0, -start.thrust}});
}

void PushedGrip::apply(const Wrench& on_hand) noexcept {
  hand_.apply(on_hand);
  if (++ticks_ > start_.held) return;
  device_->place({0.0, 0.0, start_.height});
  device_->set_goal({{0.0, 0.0, start_.rest}, {0.0, 0.0, -start_.thrust}});
}

FrontierRun::FrontierRun(std::unique_ptr<PushedGrip> grip, std::unique_ptr<Stage> parts)
    : grip_(std::move(grip)),
      parts_(std::move(parts)),
      lockstep_(*parts_),
      approach_from_world_((parts_->config.volume.world_from_bone * parts_->approach.bone_from_approach).inverse()) {}

FrontierTick FrontierRun::tick() {
  const Vec3 at = grip_->device().grip().position;
  lockstep_.tick();
  const Vec3 tool = approach_from_world_ * parts_->contact->state().world_from_tool.translation;
  return {at.z, tool.z, std::hypot(at.x, at.y), grip_->device().force()};
}

Result<FrontierLoop> FrontierLoop::create(const FrontierLoopConfig& config) {
  auto document = TomlDocument::parse(text_of(config), "frontier.toml");
  if (!document) return document.error();
  Issues issues;
  auto loaded =
      load_scene(*document, {.tool_folders = {}, .tool_given = true}, issues, {.tool_text = tool_of(config), .progress = {}, .say = {}});
  if (!loaded) return issues.front();
  loaded->scene.find<DeviceConfig>()->config = config.device;
  const auto approach = make_approach(*loaded->bone, loaded->scene.approach);
  if (!approach) return approach.error();
  const Pose world_from_approach = loaded->scene.volume.world_from_bone * approach->bone_from_approach;
  return FrontierLoop(config, std::move(*loaded), world_from_approach);
}

Result<std::unique_ptr<Stage>> FrontierLoop::parts(double stiffness, HandSource& hand) const {
  Scene scene = loaded_->scene;
  scene.find<ConstrainedToolConfig>()->coupling_stiffness = stiffness;
  Stage::Outside outside;
  outside.hand = &hand;
  return Stage::make(scene, scene.effects, loaded_->bone, loaded_->tool, outside);
}

Result<FrontierRun> FrontierLoop::begin(double stiffness, const FrontierStart& start) const {
  auto grip = PushedGrip::create(loaded_->scene.find<DeviceConfig>()->config, world_from_approach_, 1.0 / config_.servo_hz);
  if (!grip) return grip.error();
  auto held = std::make_unique<PushedGrip>(std::move(grip).value());
  held->start(start);
  auto made = parts(stiffness, *held);
  if (!made) return made.error();
  return FrontierRun(std::move(held), std::move(made).value());
}

}  // namespace burrhole
