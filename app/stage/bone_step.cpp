#include "app/stage/bone_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/stage/drill_clutch.h"
#include "core/base/bounds.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kWriteBackEvery = 0.1;  // [s]
constexpr int kKept = 16;                // [voxels] beyond the margin of a window's new place, that the old window keeps
constexpr double kLeastForce = 1e-6;     // [N] of a contact that has a direction
// [voxel edges] above kLeastFree of the constrained tool, which stops later on the way to bone
constexpr double kNear = 2.0;

/// A contact period, and two bone steps: one until the window is placed, and one by which a live bone step may be late.
double foresight_of(const StageConfig& config, const Needs& needs) {
  const double contact_hz = needs.contact_hz > 0 ? needs.contact_hz : config.servo_hz;
  const double bone_hz = needs.simulation_hz > 0 ? needs.simulation_hz : 0.25 * config.servo_hz;
  return 1.0 / contact_hz + 2.0 / bone_hz;
}

Affine shifted(const Affine& index_from_tool, const Vec3& by) { return {index_from_tool.linear, index_from_tool.offset + by}; }

}  // namespace

VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin) {
  const auto [lo, hi] = bounds_under(index_from_tool, {tool.bound_lo, tool.bound_hi});
  return {floor_int(lo) - margin, floor_int(hi) + 2 + margin};
}

BoneStep::BoneStep(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap, StepGraph& graph,
                   const CoarseDistance* coarse)
    : tool_(&tool),
      voxmap_(&voxmap),
      graph_(&graph),
      bone_from_index_(voxmap.bone().bone_from_index()),
      index_from_world_((Affine::from_pose(config.volume.world_from_bone) * voxmap.bone().bone_from_index()).inverse()),
      margins_(window_margins(needs.fields, voxmap.bone().bone_from_index())),
      coarse_(coarse),
      cover_(tool.shell.positions),
      near_(kNear * voxmap.bone().bone_from_index().mean_edge()),
      foresight_(foresight_of(config, needs)),
      spin_(config.tool.spin),
      stretch_(needs.coupling_stiffness > 0.0 ? config.hand.push / needs.coupling_stiffness : 0.0) {}

Result<BoneStep> BoneStep::create(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap,
                                  const Pose& world_from_tool, StepGraph& graph, const Approach& approach, const CoarseDistance* coarse,
                                  bool one_thread) {
  BoneStep out(config, needs, tool, voxmap, graph, coarse);
  if (needs.cutting_field)
    out.lead_.emplace(voxmap.bone().bone_from_index().mean_edge());  // faces move by the overlap, whole voxels do not
  out.last_ = world_from_tool;
  if (Status placed = out.place_window(tool, world_from_tool); !placed) return placed.error();
  if (needs.paper_grids) {
    out.grids_ = std::make_unique<VdbContactGrids>(voxmap);
  } else if (needs.reads_window) {
    out.publisher_ = std::make_unique<ContactWindowPublisher>(voxmap, needs.fields, one_thread);
    out.publisher_->reserve(grown_window_voxels(out.most_));
  } else {
    out.axis_ = std::make_unique<AxisBone>(approach);
  }
  return out;
}

Status BoneStep::place_window(const Tool& tool, const Pose& world_from_tool) {
  const Affine at = index_from_tool(world_from_tool);
  const VoxelBox box = tool_box(tool, at, margins_.placed);
  // The window grows with the thrust. Arrays that grow with it would leave their former memory behind.
  const Vec3 stretch = world_from_tool.rotate(Vec3(0.0, 0.0, -stretch_));
  const VoxelBox pressed = box.unite(tool_box(tool, shifted(at, index_from_world_.linear * stretch), margins_.placed));
  for (const VoxelBox& one : {box, pressed})
    if (fits_window(one.size())) most_ = std::max(most_, one.count());
  voxmap_->reserve(grown_window_voxels(most_), 0);
  if (Status placed = voxmap_->place_window(box); !placed) {
    if (placed.error().code != ErrorCode::out_of_range) return placed;
    const Vec3 size(box.size());
    const double larger = std::max({size.x / kMaxWindowEdge, size.y / kMaxWindowEdge, size.z / kMaxWindowEdge,
                                    std::cbrt(size.x * size.y * size.z / static_cast<double>(kMaxWindowVoxels))});
    const double fits = std::ceil(larger * voxmap_->bone().bone_from_index().mean_edge() / kMillimetre * 100.0) / 100.0;
    return Error{
        placed.error().code,
        fmt::format("tool \"{}\" is too large for this bone's voxels: {}; in this direction it fits voxels of {:g} mm (spacing_mm)",
                    tool.name, placed.error().message, fits),
        {}};
  }
  return {};
}

void BoneStep::bind() {
  cut_ = graph_->provide(Clock::simulation, slots::kCut);
  spin_asked_ = graph_->provide(Clock::simulation, slots::kSpinAsked);
  own_spin_ = graph_->is_written(slots::kSpin.name) ? nullptr : graph_->provide(Clock::simulation, slots::kSpin);
  spin_now_ = graph_->is_written(slots::kDrillSpin.name) ? graph_->find(slots::kDrillSpin) : graph_->find(slots::kSpin);
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

bool BoneStep::is_near(const Affine& index_from_tool) const noexcept { return cover_.clearance(*coarse_, index_from_tool) < near_; }

std::optional<double> BoneStep::first_near(const ErosionPath& path) const noexcept {
  // The farthest that a point of the tool moves over the whole path: at a corner of the box round the tool.
  double longest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) != 0 ? tool_->bound_hi.x : tool_->bound_lo.x, (corner & 2) != 0 ? tool_->bound_hi.y : tool_->bound_lo.y,
                 (corner & 4) != 0 ? tool_->bound_hi.z : tool_->bound_lo.z);
    longest = std::max(longest, glm::length(bone_from_index_.linear * (path.to * p - path.from * p)));
  }
  for (double t = 0.0;;) {
    const double clearance = cover_.clearance(*coarse_, path.at(t));
    if (clearance < near_) return t;
    if (t == 1.0) return std::nullopt;
    t = longest > 0.0 ? std::min(1.0, t + (clearance - 0.5 * near_) / longest) : 1.0;
  }
}

void BoneStep::trim(Cut& cut) const noexcept {
  if (coarse_ == nullptr || is_near(cut.path.from)) return;
  const auto near = first_near(cut.path);
  cut.far = !near;
  cut.path.from = cut.path.at(near.value_or(1.0));
}

ErosionPath BoneStep::foreseen(const Cut& cut, const ContactState& found) const noexcept {
  if (coarse_ == nullptr) return cut.path;
  // Where bone ends, the spring to the hand takes the tool there at once.
  const Vec3 stretch = found.world_from_hand.translation - found.world_from_tool.translation;
  const ErosionPath way{cut.path.to, shifted(cut.path.to, index_from_world_.linear * (stretch + found.hand_velocity * foresight_))};
  if (!cut.far) return {cut.path.from, way.to};
  const auto near = first_near(way);
  return near ? ErosionPath{way.at(*near), way.to} : ErosionPath{way.from, way.from};
}

Status BoneStep::keep_window(const ErosionPath& path) {
  const auto box = [&](const Affine& to, int margin) { return tool_box(*tool_, path.from, margin).unite(tool_box(*tool_, to, margin)); };
  // A window that reaches far ahead is shortened to what the reserved memory holds.
  const std::size_t most = most_window_voxels(tool_box(*tool_, path.from, margins_.placed).count());
  const auto fits = [&](const VoxelBox& b) { return b.count() <= most && fits_window(b.size()); };
  double share = 1.0;
  while (share > 0.1 && !fits(box(path.at(share), margins_.placed))) share *= 0.8;
  const Affine to = path.at(share);
  const VoxelBox& window = voxmap_->window().box;
  if (window.contains(box(to, margins_.least))) return {};
  const VoxelBox wanted = box(to, margins_.placed);
  const Vec3i slides = wanted.lo + wanted.hi - window.lo - window.hi;
  const bool returns = glm::dot(Vec3(slides), Vec3(slid_)) < 0.0;
  slid_ = slides;
  // A window that slides back keeps what lies beside its new place, so that it does not slide to and fro under a tool that swings.
  const auto with_old = [&](int beyond) { return wanted.unite(window.intersect(box(to, margins_.placed + beyond))); };
  const std::size_t room = grown_window_voxels(tool_box(*tool_, path.from, margins_.placed).count());
  const auto has_room = [&](const VoxelBox& b) { return b.count() <= room && fits_window(b.size()); };
  int kept = returns ? kKept : 0;
  while (kept > 0 && !has_room(with_old(kept))) kept /= 2;
  return voxmap_->place_window(kept > 0 ? with_old(kept) : wanted);
}

Status BoneStep::place(const Pose& world_from_tool) {
  last_ = world_from_tool;
  if (Status placed = voxmap_->place_window(tool_box(*tool_, index_from_tool(last_), margins_.placed)); !placed) return placed;
  publish();
  return {};
}

void BoneStep::move_bone(const Pose& world_from_bone) {
  index_from_world_ = (Affine::from_pose(world_from_bone) * bone_from_index_).inverse();
}

Status BoneStep::change_tool(const Tool& tool) {
  if (Status placed = place_window(tool, last_); !placed) return placed;
  if (publisher_) publisher_->reserve(grown_window_voxels(most_));
  tool_ = &tool;
  cover_ = ShellCover(tool.shell.positions);
  publish();
  return {};
}

void BoneStep::publish() {
  if (publisher_) publisher_->publish(*voxmap_);
  if (grids_) grids_->update(*voxmap_);
  if (axis_) axis_->publish(*voxmap_);
  published_window_ = voxmap_->window_epoch();
  ++published_;
}

void BoneStep::operator()(const ContactState& found, double thrust, double dt) {
  const double force = glm::length(found.on_hand.force);
  const Vec3 away = force > kLeastForce ? found.on_hand.force / force : Vec3(0.0);
  const Vec3 reaction = force > kLeastForce ? glm::conjugate(found.world_from_tool.rotation) * away : cut_->reaction;
  const Vec3 before = ahead_;
  if (lead_) ahead_ = index_from_world_.linear * (*lead_)(found, away);
  *cut_ = {.path = {shifted(index_from_tool(last_), before), shifted(index_from_tool(found.world_from_tool), ahead_)},
           .thrust = thrust,
           .reaction = reaction};
  trim(*cut_);
  last_ = found.world_from_tool;
  *spin_asked_ = spin_ * found.spin;
  if (own_spin_ != nullptr) *own_spin_ = *spin_asked_;
  // create() has checked the size of the tool. A rotated path may still not fit: then the window stays, and erosion counts the points
  // outside.
  (void)keep_window(foreseen(*cut_, found));
  bool changed = voxmap_->window_epoch() != published_window_;
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
