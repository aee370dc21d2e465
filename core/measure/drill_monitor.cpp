#include "core/measure/drill_monitor.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

// A bit that breaks through has cut everything except the bone it is engaged in. A bit engaged in most of the bone was pushed through it.
constexpr double kLeastCut = 0.5;
// [s] Erosion period unless a scene sets another. A fast tip is ahead of the cut bone by the distance of one period.
constexpr double kCutLag = 0.01;

}  // namespace

template <class Solid>
void DrillMonitor::follow(const Tip& tip, double voxel_edge, const Solid& solid) noexcept {
  const Approach& a = *approach_;
  const Vec3 at = a.bone_from_approach.inverse() * tip.place;
  const double depth = -at.z;
  const double speed = tip.time > last_time_ ? std::max(0.0, depth - progress_.depth) / (tip.time - last_time_) : 0.0;
  last_time_ = tip.time;
  progress_.depth = depth;
  progress_.deepest = std::max(progress_.deepest, progress_.depth);
  progress_.peak_force = std::max(progress_.peak_force, tip.force);
  if (!progress_.breakthrough_time) follow_axis(tip, at, voxel_edge, speed, solid);
  if (progress_.passed_time && !progress_.out_time && depth > a.thickness) progress_.out_time = tip.time;
  support_.look(tip.time, depth, tip.thrust, progress_.passed_time.has_value());
  progress_.loss = support_.worst();
}

template <class Solid>
void DrillMonitor::follow_axis(const Tip& tip, const Vec3& at, double voxel_edge, double speed, const Solid& solid) noexcept {
  const Approach& a = *approach_;
  if (!progress_.passed_time && tip.force > kAsideForce)
    progress_.largest_aside = std::max(progress_.largest_aside, std::hypot(at.x, at.y));

  std::size_t front = 0;
  while (front < a.axis_index.size() && !solid(front)) ++front;
  progress_.front = front < a.axis_index.size() ? a.axis_depth[front] : a.thickness;
  if (progress_.open_axis) return;
  progress_.largest_ahead = std::max(progress_.largest_ahead, progress_.depth - progress_.front - tip.engagement);

  for (std::size_t n = a.axis_index.size(); n-- > 0 && a.axis_depth[n] > progress_.depth;)
    if (solid(n)) return;
  std::size_t cut = 0, all = 0;
  for (std::size_t n = 0; n < a.axis_index.size(); ++n) {
    all += start_[n];
    cut += start_[n] != 0 && !solid(n) ? 1 : 0;
  }
  const double share = static_cast<double>(cut) / static_cast<double>(all);
  if (!progress_.passed_time) {
    progress_.passed_time = tip.time;
    progress_.removed_at_passing = share;
  }
  const bool drilled = progress_.depth - progress_.front <= tip.engagement + voxel_edge + speed * kCutLag && share >= kLeastCut;
  if (front < a.axis_index.size() && !drilled) return;
  progress_.breakthrough_time = tip.time;
  progress_.breakthrough_depth = progress_.depth;
}

void DrillMonitor::start(std::span<const std::uint8_t> bone) noexcept {
  for (std::size_t n = 0; n < start_.size() && n < bone.size(); ++n) {
    start_[n] = first_[n] = bone[n] != 0 ? 1 : 0;
    cut_[n] = bone[n] != 0 ? 0 : 1;
  }
  progress_.open_axis = std::ranges::find(start_, std::uint8_t{1}) == start_.end();
}

void DrillMonitor::bone_grew(std::span<const std::uint8_t> bone) noexcept {
  bool grew = false;
  for (std::size_t n = 0; n < cut_.size() && n < bone.size(); ++n) {
    grew = grew || (cut_[n] != 0 && bone[n] != 0);
    cut_[n] = bone[n] != 0 ? 0 : 1;
    start_[n] = first_[n] != 0 || bone[n] != 0 ? 1 : 0;  // a reset may bring back more than the run removed, and an undo take it away
  }
  progress_.open_axis = std::ranges::find(start_, std::uint8_t{1}) == start_.end();
  if (!grew) return;
  const auto first = static_cast<std::size_t>(std::ranges::find(cut_, std::uint8_t{0}) - cut_.begin());
  support_.forget();
  DrillProgress now;
  now.depth = progress_.depth;
  now.undone = std::max(progress_.undone, progress_.deepest);
  now.front = first < cut_.size() ? approach_->axis_depth[first] : approach_->thickness;
  now.peak_force = progress_.peak_force;
  now.largest_ahead = progress_.largest_ahead;
  now.largest_aside = progress_.largest_aside;
  progress_ = now;
}

void DrillMonitor::look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept {
  const double thrust = glm::dot(force, approach_->bone_from_approach.rotate(Vec3(0.0, 0.0, 1.0)));
  follow({tip_bone, glm::length(force), thrust, engagement, time}, bone.voxel_edge(), [&](std::size_t n) {
    const Vec3& index = approach_->axis_index[n];
    if (bone.knows(voxel_of(index))) cut_[n] = bone.sample(index) < kSurfaceLevel ? 1 : 0;
    return cut_[n] == 0;
  });
}

void DrillMonitor::look(const AxisSamples& axis, double voxel_edge, const Vec3& tip_bone, double time) noexcept {
  follow({tip_bone, 0.0, 0.0, 0.0, time}, voxel_edge, [&](std::size_t n) { return axis.bone[n] != 0; });
}

}  // namespace burrhole
