#include "app/engine/drill_parts.h"

#include <algorithm>

namespace burrhole {
namespace {

/// `voxmap` has the plane of the voxel that a point is in, and its own force never passes that of half a voxel; a point that pushes leaves
/// its plane after a quarter on average. Believed further, planes become walls of ten times a point's stiffness, which throw the hand.
ServoConfig servo_of(const Scene& scene, double edge) {
  ServoConfig out = scene.servo;
  const bool one_voxel = scene.contact && scene.contact->model == ContactModelKind::voxmap && !scene.contact->coupling &&
                         scene.contact->voxmap.plane_voxel != PlaneVoxel::surface;
  if (one_voxel) out.multi_rate.max_distance = std::min(out.multi_rate.max_distance, 0.25 * edge);
  // Beyond what the device shows, slew limit and energy account would go by a force that nobody gets.
  if (scene.device) out.largest_force = std::min(out.largest_force, scene.device->config.largest_force / force_scale_of(scene));
  return out;
}

}  // namespace

DrillParts::DrillParts(const Scene& from, const Tool& with) : scene(from), tool(&with), period(1.0 / from.servo_hz) {
  const auto ticks = [&](int rate_hz) { return static_cast<std::uint64_t>(scene.servo_hz / rate_hz); };
  if (scene.contact) contact_every = ticks(scene.contact->rate_hz);
  if (scene.erosion) bone_every = ticks(scene.erosion->rate_hz);
  contact_period = period * static_cast<double>(contact_every);
  bone_period = period * static_cast<double>(bone_every);
  latency = scene.contact && scene.contact->latency_ticks >= 0 ? static_cast<std::uint64_t>(scene.contact->latency_ticks) : contact_every;
}

Result<std::unique_ptr<DrillParts>> DrillParts::make(const Scene& scene, std::shared_ptr<const BoneModel> bone, const Tool& tool,
                                                     const Outside& outside) {
  std::unique_ptr<DrillParts> out(new DrillParts(scene, tool));
  if (Status built = out->build(std::move(bone), outside); !built) return built.error();
  return out;
}

double force_scale_of(const Scene& scene) noexcept {
  if (!scene.device) return 1.0;
  const SimulatedDeviceConfig& config = scene.device->config;
  return scene.device->force_scale ? *scene.device->force_scale
                                   : fitting_force_scale({.name = config.name, .largest_force = config.largest_force}, scene.hand.push);
}

Status DrillParts::build_hand(const Pose& world_from_approach, HandSource* given) {
  if (given != nullptr) {
    hand = given;
    return {};
  }
  if (!scene.device) {
    auto created = SimulatedHand::create(scene.hand, world_from_approach, period);
    if (!created) return created.error();
    own_hand.emplace(std::move(created).value());
    hand = &*own_hand;
    return {};
  }
  auto created = SimulatedDevice::create(scene.device->config, period);
  if (!created) return created.error();
  device = std::make_unique<SimulatedDevice>(std::move(created).value());
  const double scale = force_scale_of(scene);
  const DeviceMap map{.world_from_device = world_from_approach, .position_scale = scene.device->position_scale, .force_scale = scale};
  auto scripted = ScriptedDeviceHand::create(*device, map, scene.hand, world_from_approach, period, scene.hand.feels);
  if (!scripted) return scripted.error();
  device_hand.emplace(std::move(scripted).value());
  hand = &*device_hand;
  return {};
}

Status DrillParts::build(std::shared_ptr<const BoneModel> model, const Outside& outside) {
  auto found = make_approach(*model, scene.approach);
  if (!found) return Error{found.error().code, found.error().message, scene.approach.place};
  approach = std::move(found).value();

  auto made = Voxmap::create(model, {static_cast<float>(scene.volume.gradient_dead_zone)});
  if (!made) return made.error();
  voxmap = std::make_unique<Voxmap>(std::move(made).value());
  if (!outside.restore_path.empty())
    if (Status restored = voxmap->restore(outside.restore_path); !restored) return restored;

  const Pose world_from_approach = scene.volume.world_from_bone * approach.bone_from_approach;
  if (Status held = build_hand(world_from_approach, outside.hand); !held) return held;
  const ServoConfig limits = servo_of(scene, model->bone_from_index().mean_edge());
  if (Status valid = check(limits); !valid) return valid;
  servo.emplace(limits, *hand, force_mailbox, hand_mailbox);

  const Pose start{world_from_approach.rotation, world_from_approach * Vec3(0.0, 0.0, scene.hand.standoff)};
  auto bone_step = BoneStep::create(scene, *tool, *voxmap, start);
  if (!bone_step) return Error{bone_step.error().code, bone_step.error().message, scene.tool.place};
  bone.emplace(std::move(bone_step).value());

  const Affine& bone_from_index = model->bone_from_index();
  std::optional<ContactStep> step;
  if (scene.contact) {
    auto created = ContactStep::create(*scene.contact, tool->shell,
                                       {bone_from_index.mean_edge(), scene.tool.spin > 0.0, uses_planes(scene.servo.multi_rate.scheme),
                                        contact_period + period * static_cast<double>(latency)});
    if (!created) return created.error();
    step.emplace(std::move(created).value());
  }
  contact.emplace(
      std::move(step), approach,
      ContactTickConfig{
          {&bone->publisher().exchange(), bone->grids(), bone_from_index, scene.volume.world_from_bone}, period, contact_period});
  contact->place(start);

  if (scene.display && outside.sink != nullptr) {
    auto created = FrameStep::create(scene, approach, *tool, *voxmap, *outside.sink);
    if (!created) return created.error();
    frame.emplace(std::move(created).value());
  }
  return {};
}

}  // namespace burrhole
