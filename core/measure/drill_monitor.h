/// core/measure/drill_monitor.h: progress of the tip along the planned axis: cutting front, breakthrough, loss of support, tunnelling, peak force.
///   Frame  bone frame; depth along the axis from the entry, into bone.   Units  SI.   Errors  none.
///   Thread  contact (reads the copy of bone that contact reads, or the axis alone).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact_view.h"
#include "core/measure/approach.h"
#include "core/measure/axis_bone.h"
#include "core/measure/support_loss.h"

namespace burrhole {

/// After breakthrough only depth, deepest, peak_force, out_time and loss are updated.
struct DrillProgress {
  double depth = 0.0;           ///< [m] of the tip now
  double front = 0.0;           ///< [m] cutting front: depth of the first remaining bone on the axis; the thickness if none is left
  double deepest = -1e9;        ///< [m] greatest depth of the tip since bone last grew on the axis
  double undone = -1e9;         ///< [m] greatest depth of the tip before bone last grew on the axis
  double peak_force = 0.0;      ///< [N] largest force of contact so far, before the limits of the servo
  double largest_ahead = -1e9;  ///< [m] greatest (tip - cutting front - engagement) up to breakthrough; more than a voxel is tunnelling
  /// [s] first tick with no bone left on the axis, or with the tip beyond the last bone and only the bone left in which the bit is engaged
  std::optional<double> breakthrough_time;
  std::optional<double> breakthrough_depth;  ///< [m] of the tip at breakthrough_time
  std::optional<double> passed_time;  ///< [s] first tick with the tip beyond the last bone that is left on the axis, by cutting or not
  std::optional<double> out_time;     ///< [s] first tick from passed_time on with the tip beyond the bone on the axis as loaded
  double removed_at_passing = 0.0;    ///< [-] share of the axis samples of bone at the start that were cut at passed_time
  bool open_axis = false;             ///< no bone was on the axis at the start: there is no breakthrough, and nothing to pass
  std::optional<SupportLoss> loss;    ///< of support beyond the bone, that with the greatest plunge; never with open_axis
  double largest_aside = 0.0;         ///< [m] greatest distance of the tip from the axis, in contact, up to passed_time
};

/// [N] Force on the hand above which the tip counts as in contact for DrillProgress::largest_aside.
inline constexpr double kAsideForce = 1.0;

class DrillMonitor {
 public:
  explicit DrillMonitor(const Approach& approach)
      : approach_(&approach), cut_(approach.axis_index.size(), 0), start_(approach.axis_index.size(), 1), first_(start_) {}
  /// Bone on the axis was drilled before the run: what is gone is not of this run. Call it before the first tick.
  /// @param bone as bone_on_axis().
  void start(std::span<const std::uint8_t> bone) noexcept;
  /// Processes one contact tick. @param tip_bone [m] position of the tip, bone frame. @param force [N] on the hand, bone frame. @param engagement [m]
  /// engaged depth of the bit. @param time [s].
  void look(const ContactView& bone, const Vec3& tip_bone, const Vec3& force, double engagement, double time) noexcept;
  /// The same in a scene without contact: force and engagement are 0. @param voxel_edge [m].
  void look(const AxisSamples& axis, double voxel_edge, const Vec3& tip_bone, double time) noexcept;
  /// Bone may have grown, as by an undo. If it did on the axis, it is not drilled through any more, and the greatest depth counts from the
  /// next tick on; depth and force stay. Call it while no clock runs.
  /// @param bone as bone_on_axis().
  void bone_grew(std::span<const std::uint8_t> bone) noexcept;
  [[nodiscard]] const DrillProgress& progress() const noexcept { return progress_; }

 private:
  struct Tip {
    Vec3 place;         // [m] bone frame
    double force;       // [N] magnitude
    double thrust;      // [N] that bone carries along the axis
    double engagement;  // [m]
    double time;        // [s]
  };
  /// @param solid(n) is whether sample n of the axis is bone now.
  template <class Solid>
  void follow(const Tip& tip, double voxel_edge, const Solid& solid) noexcept;

  /// The part that follows bone on the axis, up to breakthrough. @param at [m] tip in the approach frame. @param speed [m/s] of the tip.
  template <class Solid>
  void follow_axis(const Tip& tip, const Vec3& at, double voxel_edge, double speed, const Solid& solid) noexcept;

  const Approach* approach_;
  double last_time_ = 0.0;           // [s]
  std::vector<std::uint8_t> cut_;    // 1: the axis sample is without bone; outside the window the last known state holds
  std::vector<std::uint8_t> start_;  // 1: the axis sample was bone before what the run removed
  std::vector<std::uint8_t> first_;  // the same at the start of the run
  SupportMonitor support_;
  DrillProgress progress_;
};

}  // namespace burrhole
