#include "app/engine/drill_monitor.h"

namespace burrhole {

void DrillMonitor::look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept {
  const Approach& a = *approach_;
  progress_.depth = -(a.bone_from_approach.inverse() * tip_bone).z;
  progress_.deepest = std::max(progress_.deepest, progress_.depth);
  progress_.peak_force = std::max(progress_.peak_force, glm::length(force));
  if (progress_.breakthrough_time) return;

  // The window follows the tool: bone that it does not know lies out of reach and is as loaded.
  const auto solid = [&](std::size_t n) { return !bone.knows(voxel_of(a.axis_index[n])) || bone.sample(a.axis_index[n]) >= kSurfaceLevel; };
  std::size_t front = 0;
  while (front < a.axis_index.size() && !solid(front)) ++front;
  progress_.front = front < a.axis_index.size() ? a.axis_depth[front] : a.thickness;
  progress_.largest_ahead = std::max(progress_.largest_ahead, progress_.depth - progress_.front - engagement);

  for (std::size_t n = a.axis_index.size(); n-- > 0 && a.axis_depth[n] > progress_.depth;)
    if (solid(n)) return;
  progress_.breakthrough_time = time;
  progress_.breakthrough_depth = progress_.depth;
  std::size_t removed = 0;
  for (std::size_t n = 0; n < a.axis_index.size(); ++n) removed += solid(n) ? 0 : 1;
  progress_.removed_at_breakthrough = static_cast<double>(removed) / static_cast<double>(a.axis_index.size());
}

}  // namespace burrhole
