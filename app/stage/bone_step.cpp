#include "app/stage/bone_step.h"

#include <algorithm>
#include <cmath>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr double kWriteBackEvery = 0.1;  // [s]
constexpr double kLeastForce = 1e-6;     // [N] of a contact that has a direction

}  // namespace

VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin) {
  const auto [lo, hi] = bounds_under(index_from_tool, {tool.bound_lo, tool.bound_hi});
  return {floor_int(lo) - margin, floor_int(hi) + 2 + margin};
}

BoneStep::BoneStep(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap, StepGraph& graph)
    : tool_(&tool),
      voxmap_(&voxmap),
      graph_(&graph),
      index_from_world_((Affine::from_pose(config.volume.world_from_bone) * voxmap.bone().bone_from_index()).inverse()),
      margins_(window_margins(needs.fields, voxmap.bone().bone_from_index())),
      spin_(config.tool.spin) {}

Result<BoneStep> BoneStep::create(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap,
                                  const Pose& world_from_tool, StepGraph& graph) {
  BoneStep out(config, needs, tool, voxmap, graph);
  out.last_ = world_from_tool;
  if (Status placed = voxmap.place_window(tool_box(tool, out.index_from_tool(world_from_tool), out.margins_.placed)); !placed)
    return Error{placed.error().code, "tool \"" + tool.name + "\" is too large for this bone's voxels: " + placed.error().message, {}};
  out.publisher_ = std::make_unique<ContactWindowPublisher>(voxmap, needs.fields);
  out.publisher_->publish(voxmap);
  if (needs.paper_grids) out.grids_ = std::make_unique<VdbContactGrids>(voxmap);
  return out;
}

void BoneStep::bind() {
  cut_ = graph_->provide(Clock::simulation, slots::kCut);
  spin_asked_ = graph_->provide(Clock::simulation, slots::kSpinAsked);
  own_spin_ = graph_->is_written(slots::kSpin.name) ? nullptr : graph_->provide(Clock::simulation, slots::kSpin);
  spin_now_ = graph_->find(slots::kSpin);
  removal_ = graph_->find(slots::kRemoval);
  *spin_asked_ = spin_;
  if (own_spin_ != nullptr) *own_spin_ = spin_;
}

WindowMargins window_margins(const ContactFields& fields, const Affine& bone_from_index) {
  // Marches need a margin of at least seven voxels, which is also the reach of records on cubic voxels; on others it is larger.
  int blind = 7;
  if (fields.records) {
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

Status BoneStep::change_tool(const Tool& tool) {
  if (Status placed = voxmap_->place_window(tool_box(tool, index_from_tool(last_), margins_.placed)); !placed)
    return Error{placed.error().code, "tool \"" + tool.name + "\" is too large for this bone's voxels: " + placed.error().message, {}};
  tool_ = &tool;
  publish();
  return {};
}

void BoneStep::publish() {
  publisher_->publish(*voxmap_);
  if (grids_) grids_->update(*voxmap_);
}

void BoneStep::operator()(const ContactState& found, double thrust, double dt) {
  const double force = glm::length(found.on_hand.force);
  const Vec3 reaction = force > kLeastForce ? glm::conjugate(found.world_from_tool.rotation) * found.on_hand.force / force : cut_->reaction;
  *cut_ = {{index_from_tool(last_), index_from_tool(found.world_from_tool)}, thrust, reaction};
  last_ = found.world_from_tool;
  *spin_asked_ = spin_ * found.spin;
  if (own_spin_ != nullptr) *own_spin_ = *spin_asked_;
  // create() has checked the size of the tool. A long or rotated path may still not fit: then the window stays, and erosion counts the points
  // outside.
  (void)keep_window(cut_->path);
  bool changed = voxmap_->window_epoch() != publisher_->published_epoch();
  graph_->receive(Clock::simulation);
  graph_->run_steps(Clock::simulation, {steps_++, dt});
  if (removal_ != nullptr) {
    removed_mass_ += removal_->mass;
    points_outside_ += removal_->outside;
    changed |= removal_->changed;
  }
  turned_ += *spin_now_ * dt;
  turned_ -= std::floor(turned_);
  if (changed) {
    publish_timer_([&] { publish(); });
  }
  graph_->send(Clock::simulation);
  unsaved_for_ += dt;
  if (unsaved_for_ >= kWriteBackEvery) {
    voxmap_->write_back();
    unsaved_for_ = 0.0;
  }
}

}  // namespace burrhole
