/// app/engine/drill_monitor.h: watches the tip along the planned axis: cut front, breakthrough, plunge, tunnelling, peak force.
///   Units SI; depth along the axis from the entry, into bone.   Thread: contact (reads the window copy).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/engine/approach.h"
#include "core/contact/contact_view.h"

namespace burrhole {

struct DrillProgress {
  double depth = 0.0;                       ///< [m] of the tip now
  double front = 0.0;                       ///< [m] of the first bone on the axis now; thickness once there is none
  double deepest = -1e9;                    ///< [m] furthest tip so far
  double peak_force = 0.0;                  ///< [N]
  double largest_ahead = -1e9;              ///< [m] greatest (tip - front - engagement) before breakthrough: over a voxel is tunnelling
  std::optional<double> breakthrough_time;  ///< [s] first tick with no bone left on the axis but what the bit is engaged in as it comes out
  std::optional<double> breakthrough_depth;  ///< [m] of the tip then
  std::optional<double> passed_time;         ///< [s] first tick with the tip beyond the last bone on the axis, however it came there
  double removed_at_passing = 0.0;           ///< share of the axis places as loaded that were cut by then
};

class DrillMonitor {
 public:
  explicit DrillMonitor(const Approach& approach) : approach_(&approach), cut_(approach.axis_index.size(), 0) {}
  /// One contact tick.
  void look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept;
  [[nodiscard]] const DrillProgress& progress() const noexcept { return progress_; }

 private:
  /// Whether there is bone at a place of the axis, as far as is known; what is out of sight is as it was seen last.
  [[nodiscard]] bool solid(const ContactView& bone, std::size_t place) noexcept;

  const Approach* approach_;
  double last_time_ = 0.0;         // [s]
  std::vector<std::uint8_t> cut_;  // a place of the axis was seen without bone
  DrillProgress progress_;
};

}  // namespace burrhole
