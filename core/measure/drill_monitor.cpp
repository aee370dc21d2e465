#include "core/measure/drill_monitor.h"

namespace burrhole {
namespace {

// A bit that breaks through has cut everything except the bone it is engaged in. A bit engaged in most of the bone was pushed through it.
constexpr double kLeastCut = 0.5;
// [s] Erosion period unless a scene sets another. A fast tip is ahead of the cut bone by the distance of one period.
constexpr double kCutLag = 0.01;

}  // namespace

void DrillMonitor::look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept {
  const Approach& a = *approach_;
  const double depth = -(a.bone_from_approach.inverse() * tip_bone).z;
  const double speed = time > last_time_ ? std::max(0.0, depth - progress_.depth) / (time - last_time_) : 0.0;
  last_time_ = time;
  progress_.depth = depth;
  progress_.deepest = std::max(progress_.deepest, progress_.depth);
  progress_.peak_force = std::max(progress_.peak_force, glm::length(force));
  if (progress_.breakthrough_time) return;

  std::size_t front = 0;
  while (front < a.axis_index.size() && !solid(bone, front)) ++front;
  progress_.front = front < a.axis_index.size() ? a.axis_depth[front] : a.thickness;
  progress_.largest_ahead = std::max(progress_.largest_ahead, progress_.depth - progress_.front - engagement);

  for (std::size_t n = a.axis_index.size(); n-- > 0 && a.axis_depth[n] > progress_.depth;)
    if (solid(bone, n)) return;
  std::size_t cut = 0;
  for (std::size_t n = 0; n < a.axis_index.size(); ++n) cut += solid(bone, n) ? 0 : 1;
  const double share = static_cast<double>(cut) / static_cast<double>(a.axis_index.size());
  if (!progress_.passed_time) {
    progress_.passed_time = time;
    progress_.removed_at_passing = share;
  }
  const bool drilled = progress_.depth - progress_.front <= engagement + bone.voxel_edge() + speed * kCutLag && share >= kLeastCut;
  if (front < a.axis_index.size() && !drilled) return;
  progress_.breakthrough_time = time;
  progress_.breakthrough_depth = progress_.depth;
}

bool DrillMonitor::solid(const ContactView& bone, std::size_t place) noexcept {
  const Vec3& index = approach_->axis_index[place];
  if (bone.knows(voxel_of(index))) cut_[place] = bone.sample(index) < kSurfaceLevel ? 1 : 0;
  return cut_[place] == 0;
}

}  // namespace burrhole
