#include "app/engine/bone_step.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

constexpr double kWriteBackEvery = 0.1;  // [s]

}  // namespace

VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin) {
  Vec3 lo(1e300), hi(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p =
        index_from_tool * Vec3((corner & 1) != 0 ? tool.bound_hi.x : tool.bound_lo.x, (corner & 2) != 0 ? tool.bound_hi.y : tool.bound_lo.y,
                               (corner & 4) != 0 ? tool.bound_hi.z : tool.bound_lo.z);
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  return {floor_int(lo) - margin, floor_int(hi) + 2 + margin};
}

BoneStep::BoneStep(const Scene& scene, const Tool& tool, Voxmap& voxmap)
    : tool_(&tool),
      voxmap_(&voxmap),
      index_from_world_((Affine::from_pose(scene.volume.world_from_bone) * voxmap.bone().bone_from_index()).inverse()),
      margins_(window_margins(scene, voxmap.bone().bone_from_index())),
      spin_(scene.tool.spin),
      slowest_spin_(scene.tool.spin) {}

Result<BoneStep> BoneStep::create(const Scene& scene, const Tool& tool, Voxmap& voxmap, const Pose& world_from_tool) {
  BoneStep out(scene, tool, voxmap);
  if (scene.erosion) {
    auto erosion = Erosion::create(scene.erosion->config, tool.erosion, tool.cutting);
    if (!erosion) return erosion.error();
    out.erosion_.emplace(std::move(erosion).value());
    out.rubbing_radius_ = rubbing_radius(tool.erosion);
  }
  if (scene.spindle && scene.tool.spin > 0.0) {
    auto spindle =
        Spindle::create({.free_speed = scene.tool.spin, .stall_torque = scene.spindle->stall_torque, .inertia = scene.spindle->inertia});
    if (!spindle) return spindle.error();
    out.spindle_.emplace(std::move(spindle).value());
  }
  out.last_ = world_from_tool;
  if (Status placed = voxmap.place_window(tool_box(tool, out.index_from_tool(world_from_tool), out.margins_.placed)); !placed)
    return Error{placed.error().code, "tool \"" + tool.name + "\" is too large for this bone's voxels: " + placed.error().message, {}};
  out.publisher_ = std::make_unique<ContactWindowPublisher>(voxmap, contact_fields(scene));
  out.publisher_->publish(voxmap);
  if (scene.contact && scene.contact->storage == ContactStorage::vdb) out.grids_ = std::make_unique<VdbContactGrids>(voxmap);
  return out;
}

ContactFields contact_fields(const Scene& scene) {
  // The drill monitor reads density; a contact model what it is made for.
  ContactFields fields{.density = true, .gradient = false, .words = false, .records = {}};
  if (!scene.contact) return fields;
  switch (scene.contact->model) {
    case ContactModelKind::surface:
      fields.records = scene.contact->record_bits;
      fields.label_stiffness = scene.contact->label_stiffness;
      break;
    case ContactModelKind::gradient_plane:
      fields.words = scene.contact->storage == ContactStorage::window;
      break;
    case ContactModelKind::voxmap:
      break;
  }
  return fields;
}

WindowMargins window_margins(const Scene& scene, const Affine& bone_from_index) {
  // Marches go seven voxels deep at the least, and so far in are records known on even voxels; on uneven ones it is further.
  int blind = 7;
  if (contact_fields(scene).records) {
    const Vec3i reach = record_reach(bone_from_index);
    blind = std::max({blind, reach.x, reach.y, reach.z});
  }
  return {.placed = blind + 9, .least = blind + 3};
}

Affine BoneStep::index_from_tool(const Pose& world_from_tool) const { return index_from_world_ * Affine::from_pose(world_from_tool); }

Status BoneStep::keep_window(const ErosionPath& path) {
  const auto swept = [&](int margin) { return tool_box(*tool_, path.from, margin).unite(tool_box(*tool_, path.to, margin)); };
  if (voxmap_->window().box.contains(swept(margins_.least))) return {};
  return voxmap_->place_window(swept(margins_.placed));
}

bool BoneStep::erode(const ErosionPath& path, double cutting_force, double dt) {
  const double now = spin();
  const ErosionOutcome outcome = timers_.erosion([&] { return erosion_->step(*voxmap_, path, CuttingLoad{now, cutting_force}, dt); });
  if (spindle_) {
    timers_.spindle([&] {
      const double radius = outcome.rubbing_radius > 0.0 ? outcome.rubbing_radius : rubbing_radius_;
      return spindle_->step(cutting_torque(erosion_->config().energy.cutting_ratio, cutting_force, radius), dt);
    });
    slowest_spin_ = std::min(slowest_spin_, spindle_->speed());
  }
  removed_mass_ += outcome.removed_mass;
  points_outside_ += outcome.outside;
  if (outcome.changed.empty()) return false;
  timers_.gradient([&] { voxmap_->commit(outcome.changed); });
  return true;
}

void BoneStep::operator()(const Pose& world_from_tool, double cutting_force, double dt) {
  const ErosionPath path{index_from_tool(last_), index_from_tool(world_from_tool)};
  last_ = world_from_tool;
  // The size was proven to fit at create(); a long or turned path may not, and then the old window stays and points outside are counted.
  const Status kept = keep_window(path);
  bool changed = !kept.ok() || voxmap_->window_epoch() != publisher_->published_epoch();
  if (erosion_ && spin_ > 0.0) changed |= erode(path, cutting_force, dt);
  turned_ += spin() * dt;
  turned_ -= std::floor(turned_);
  if (changed) {
    timers_.publish([&] {
      publisher_->publish(*voxmap_);
      if (grids_) grids_->update(*voxmap_);
    });
  }
  unsaved_for_ += dt;
  if (unsaved_for_ >= kWriteBackEvery) {
    voxmap_->write_back();
    unsaved_for_ = 0.0;
  }
}

}  // namespace burrhole
