/// app/engine/drill_monitor.h: watches the tip along the planned axis: cut front, breakthrough, plunge, tunnelling, peak force.
///   Units SI; depth along the axis from the entry, into bone.   Thread: contact (reads the window copy).
#pragma once

#include <optional>

#include "app/engine/approach.h"
#include "core/contact/contact_view.h"

namespace burrhole {

struct DrillProgress {
  double depth = 0.0;                        ///< [m] of the tip now
  double front = 0.0;                        ///< [m] of the first bone on the axis now; thickness once there is none
  double deepest = -1e9;                     ///< [m] furthest tip so far
  double peak_force = 0.0;                   ///< [N]
  double largest_ahead = -1e9;               ///< [m] greatest (tip - front - engagement) before breakthrough: over a voxel is tunnelling
  std::optional<double> breakthrough_time;   ///< [s] first tick with no bone ahead of the tip on the axis
  std::optional<double> breakthrough_depth;  ///< [m] of the tip then
  double removed_at_breakthrough = 0.0;      ///< share of the axis places as loaded that are below the surface level then
};

class DrillMonitor {
 public:
  explicit DrillMonitor(const Approach& approach) : approach_(&approach) {}
  /// One contact tick.
  void look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept;
  [[nodiscard]] const DrillProgress& progress() const noexcept { return progress_; }

 private:
  const Approach* approach_;
  DrillProgress progress_;
};

}  // namespace burrhole
