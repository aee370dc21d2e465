#include "app/lab/stability_rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/lab/oracle/contact_cone.h"
#include "core/base/portable_math.h"
#include "core/base/trilinear.h"
#include "core/base/units.h"
#include "haptics/device/device_config.h"

namespace burrhole {
namespace {

constexpr int kBetween = 8;        // poses sampled between tool and hand
constexpr double kGrain = 0.05;    // [-] density about a voxel outside the surface: a model of whole voxels starts to push there
constexpr double kNoForce = 1e-6;  // [N]
constexpr double kTouched = 0.5;   // [N]

Result<std::unique_ptr<LoadedScene>> load_case(const StabilityCase& of, const StabilityModel& model, bool sabotaged) {
  auto document = TomlDocument::parse(of.scene + "\n[contact]\nrate_hz = " + std::to_string(of.rate_hz) + "\n" + model.keys, of.name);
  if (!document) return document.error();
  if (sabotaged) {
    if (Status applied = document->set("servo.energy_mJ=0"); !applied) return applied.error();  // it would stop what is to be measured
    for (const std::string& set : of.sabotage.sets)
      if (Status applied = document->set(set); !applied) return applied.error();
  }
  Issues issues;
  auto loaded = load_scene(*document, {}, issues, {.tool_text = of.tool, .progress = {}, .say = {}});
  if (!loaded) return issues.front();
  return std::make_unique<LoadedScene>(std::move(*loaded));
}

/// Bone with a slot along y through all of it, of width 2 x `half`: occupancy as of phantoms, 0.5 on the wall of the slot.
Result<std::shared_ptr<const BoneModel>> with_slot(const BoneModel& bone, double half) {
  DenseBone dense;
  dense.dims = bone.dims();
  dense.bone_from_index = bone.bone_from_index();
  const std::size_t count = bone.bounds().count();
  dense.occupancy.resize(count);
  dense.hardness.resize(count);
  std::vector<float> labels(count);
  bone.read_occupancy(bone.bounds(), dense.occupancy);
  bone.read_hardness(bone.bounds(), dense.hardness);
  bone.read_labels(bone.bounds(), labels);
  for (const float label : labels) dense.labels.push_back(static_cast<std::uint8_t>(label));
  const double edge = dense.bone_from_index.mean_edge();
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 at = dense.bone_from_index * Vec3(static_cast<double>(n % static_cast<std::size_t>(dense.dims.x)), 0.0, 0.0);
    const double left = std::clamp(0.5 + (std::abs(at.x) - half) / (2.0 * edge), 0.0, 1.0);
    dense.occupancy[n] = std::min(dense.occupancy[n], static_cast<float>(left));
    if (dense.occupancy[n] == 0.0f) {
      dense.hardness[n] = 0.0f;
      dense.labels[n] = static_cast<std::uint8_t>(VoxelLabel::none);
    }
  }
  return BoneModel::create(dense);
}

}  // namespace

Result<std::unique_ptr<StabilityRig>> StabilityRig::create(const StabilityCase& of, const StabilityModel& model, bool sabotaged) {
  std::unique_ptr<StabilityRig> out(new StabilityRig(of, sabotaged));
  if (Status made = out->put_together(model); !made) return made.error();
  return out;
}

Status StabilityRig::put_together(const StabilityModel& model) {
  auto loaded = load_case(*case_, model, sabotaged_);
  if (!loaded) return loaded.error();
  loaded_ = std::move(loaded).value();
  if (sabotaged_ && case_->sabotage.points_only) loaded_->tool.surface = nullptr;
  const Scene& scene = loaded_->scene;
  if (scene.find<DeviceConfig>() == nullptr || !scene.volume.phantom)
    return Error{ErrorCode::bad_input, "a hard case needs a device and a phantom", case_->name};
  truth_ = std::make_unique<Truth>(*scene.volume.phantom);
  std::shared_ptr<const BoneModel> bone = loaded_->bone;
  if (case_->slot_half_width > 0.0) {
    auto slotted = with_slot(*bone, case_->slot_half_width);
    if (!slotted) return slotted.error();
    bone = std::move(slotted).value();
  }
  const auto approach = make_approach(*bone, scene.approach);
  if (!approach) return approach.error();
  const Pose world_from_approach = scene.volume.world_from_bone * approach->bone_from_approach;
  const double scale = scene.find<DeviceConfig>()->force_scale.value_or(1.0);
  auto hand = StabilityHand::create({.device = scene.find<DeviceConfig>()->config,
                                     .map = {.world_from_device = world_from_approach, .force_scale = scale},
                                     .world_from_approach = world_from_approach,
                                     .period = 1.0 / scene.servo_hz},
                                    *case_, sabotaged_);
  if (!hand) return hand.error();
  hand_ = std::move(hand).value();
  auto parts = Stage::make(scene, scene.effects, bone, loaded_->tool, {.sink = nullptr, .hand = hand_.get(), .restore_path = {}});
  if (!parts) return parts.error();
  parts_ = std::move(parts).value();
  world_from_bone_ = scene.volume.world_from_bone;
  if (model.constrained && !scene.effects.has("erosion") &&
      std::ranges::any_of(case_->checks, [](const StabilityCheck& check) { return check.measure == StabilityMeasure::penetration; })) {
    auto solid = SolidDepth::create(case_->tool, *bone);
    if (!solid) return solid.error();
    solid_.emplace(std::move(solid).value());
  }
  if (sabotaged_ && case_->sabotage.only_window) parts_->contact->know(nullptr);
  if (Status placed = parts_->place({world_from_approach.rotation, world_from_approach * case_->start}); !placed) return placed;
  loop_.emplace(*parts_);
  return {};
}

TraceContext StabilityRig::context() const {
  const SimulatedDeviceConfig& device = loaded_->scene.find<DeviceConfig>()->config;
  const auto ticks = static_cast<double>(parts_->latency + parts_->contact_every) + device.delay + 1.0;
  return {.dissipation = {.damping = device.plant.body.damping, .friction = device.plant.friction},
          .voxel_edge = loaded_->bone->bone_from_index().mean_edge(),
          .grace = ticks * parts_->period};
}

void StabilityRig::move_bone(double time) {
  const Pose& rest = loaded_->scene.volume.world_from_bone;
  const Pose before = world_from_bone_;
  if (case_->loose_drag > 0.0) {
    // Only the tool moves this bone: it dissipates energy, and the energy of the wall is that of the grip's motion.
    shift_ -= last_force_ * (parts_->period / case_->loose_drag);
    world_from_bone_ = {rest.rotation, rest.translation + shift_};
    parts_->contact->move_bone(world_from_bone_);
    parts_->bone->move_bone(world_from_bone_);
    return;
  }
  const double phase = 2.0 * std::numbers::pi * time, half = 0.5 * case_->turn * portable_sin(phase);
  const Quat turned(portable_cos(half), 0.0, portable_sin(half), 0.0);
  world_from_bone_ = {turned * rest.rotation, rest.translation + Vec3(case_->swing * portable_sin(phase), 0.0, 0.0)};
  parts_->contact->move_bone(world_from_bone_);
  parts_->bone->move_bone(world_from_bone_);
  const Vec3 tool = parts_->contact->state().world_from_tool.translation;
  const Vec3 moved = world_from_bone_ * (before.inverse() * tool) - tool;
  carried_ += hand_->map().device(hand_->map().world_from_device.translation + moved);
}

void StabilityRig::prepare(double time) {
  const StabilityTrouble& trouble = case_->trouble;
  bool stalled = sabotaged_ && case_->sabotage.dead_contact && touched_;
  for (const TimeSpan& stall : trouble.contact_stalls) stalled |= stall.holds(time);
  parts_->contact->set_stalled(stalled);
  if (trouble.reset_at >= 0.0 && std::abs(time - trouble.reset_at) < 0.5 * parts_->period) parts_->servo->request_reset();
  if (case_->swing != 0.0 || case_->turn != 0.0 || case_->loose_drag > 0.0) move_bone(time);
  const Vec3 before = hand_->grip().position;
  hand_->begin_tick(time);
  carried_ += hand_->grip().position - before;  // a teleport is neither motion nor work
}

void StabilityRig::tick(std::vector<StabilitySample>& samples) {
  StabilitySample out;
  out.time = static_cast<double>(loop_->ticks()) * parts_->period;
  prepare(out.time);
  out.grip = hand_->grip().position;
  out.grip_velocity = hand_->grip().velocity;
  const ServoOutput& servo = loop_->tick();
  out.shown = hand_->shown();
  out.carried = carried_;
  out.force = hand_->felt();
  out.faults = servo.faults;
  out.hand = servo.hand.world_from_hand.translation;
  last_force_ = servo.force;
  touched_ |= glm::length(servo.force) > kTouched;
  sample_tool(out);
  samples.push_back(out);
  for (const PlantState& grip : hand_->left_alone()) {
    out.grip = grip.position;
    out.grip_velocity = grip.velocity;
    samples.push_back(out);
  }
}

void StabilityRig::remember(const Pose& bone_from_tool) {
  const std::uint64_t tick = loop_->ticks(), late = parts_->latency + parts_->contact_every + 1;
  if (lately_.empty() || lately_.back().bone_from_tool.translation != bone_from_tool.translation) lately_.push_back({tick, bone_from_tool});
  while (lately_.size() > 1 && lately_[1].since + late <= tick) lately_.erase(lately_.begin());
}

double StabilityRig::attractive_force_of(const StabilitySample& sample) const {
  const double towards = -glm::dot(sample.force, sample.normal);
  if (!(towards > 0.0)) return std::isnan(towards) ? towards : 0.0;
  if (loaded_->scene.effects.has("erosion")) return towards;
  const Pose bone_from_world = world_from_bone_.inverse();
  std::vector<Vec3> normals{bone_from_world.rotate(sample.normal)}, points;
  for (const Was& was : lately_)
    for (const Vec3& point : solid_ ? solid_->tool_points() : loaded_->tool.shell.positions) points.push_back(was.bone_from_tool * point);
  touched_normals(parts_->voxmap->window(), parts_->voxmap->bone().bone_from_index(), points, normals);
  return outside_cone(bone_from_world.rotate(sample.force), normals);
}

void StabilityRig::sample_tool(StabilitySample& sample) {
  const ContactState& contact = parts_->contact->state();
  sample.tool = contact.world_from_tool.translation;
  const Pose bone_from_tool = world_from_bone_.inverse() * contact.world_from_tool;
  const SurfaceDistance least = nearest_of(bone_from_tool);
  sample.depth = depth_under(bone_from_tool, least);
  // Bone that is being cut no longer has the shape as loaded: its outward direction is back along the axis.
  const bool cut = loaded_->scene.effects.has("erosion");
  sample.normal = world_from_bone_.rotate(cut ? parts_->approach.bone_from_approach.rotate({0.0, 0.0, 1.0}) : least.normal);
  remember(bone_from_tool);
  sample.attractive_force = attractive_force_of(sample);
  const double height = (parts_->approach.bone_from_approach.inverse() * bone_from_tool.translation).z;
  if (case_->far_side != 0.0) sample.beyond = case_->far_side - height;
  if (glm::length(sample.force) > kNoForce) sample.bone_between = bone_between(contact.world_from_tool, hand_->world_grip());
}

SurfaceDistance StabilityRig::nearest_of(const Pose& bone_from_tool) const {
  SurfaceDistance out{std::numeric_limits<double>::infinity(), Vec3(0.0, 0.0, 1.0)};
  for (const Vec3& point : loaded_->tool.shell.positions) {
    const SurfaceDistance at = nearest(bone_from_tool * point);
    if (at.signed_distance < out.signed_distance) out = at;
  }
  return out;
}

double StabilityRig::depth_under(const Pose& bone_from_tool, const SurfaceDistance& least) const {
  // The density falls from 1 to 0 over twice the voxel's width across the normal (volumes/phantom/phantom.h). Inside this ramp it
  // determines the depth below the 0.5 surface, which differs slightly from the shape's own at edges. Deeper, the shape's distance is used.
  double densest = 0.0;
  for (const Vec3& point : loaded_->tool.shell.positions) densest = std::max(densest, density_at(bone_from_tool * point));
  const double solid = solid_ ? solid_->deepest(bone_from_tool) : 0.0;
  const auto or_solid = [solid](double points) { return solid > 0.0 ? std::max(points, solid) : points; };
  if (densest <= 0.0 || densest >= 1.0) return or_solid(-least.signed_distance);
  const double width = std::abs(least.normal.x) + std::abs(least.normal.y) + std::abs(least.normal.z);
  return or_solid((densest - 0.5) * 2.0 * width * parts_->voxmap->bone().bone_from_index().mean_edge());
}

bool StabilityRig::bone_between(const Pose& world_from_tool, const Vec3& hand) const {
  const Pose bone_from_world = world_from_bone_.inverse();
  for (int n = kBetween; n >= 1; --n) {
    const Vec3 at = world_from_tool.translation + (hand - world_from_tool.translation) * (static_cast<double>(n) / kBetween);
    const Pose bone_from_tool = bone_from_world * Pose{world_from_tool.rotation, at};
    for (const Vec3& point : loaded_->tool.shell.positions)
      if (density_at(bone_from_tool * point) >= kGrain) return true;
  }
  return false;
}

double StabilityRig::density_at(const Vec3& in_bone) const {
  const BoneModel& bone = parts_->voxmap->bone();
  const Vec3 index = bone.bone_from_index().inverse() * in_bone;
  const MasterWindow& window = parts_->voxmap->window();
  const Vec3i v = floor_int(index);
  if (window.box.contains(v) && window.box.contains(v + 1)) return trilinear(window.box, window.density.data(), index);
  return sample_occupancy(bone, index);
}

SurfaceDistance StabilityRig::nearest(const Vec3& in_bone) const {
  SurfaceDistance out = truth_->nearest(in_bone);
  if (case_->slot_half_width == 0.0) return out;
  // The rest of the plate is farther away than its face and the wall of the slot.
  const double wall = case_->slot_half_width - std::abs(in_bone.x);
  if (wall > out.signed_distance) out = {wall, Vec3(in_bone.x > 0.0 ? -1.0 : 1.0, 0.0, 0.0)};
  return out;
}

}  // namespace burrhole
