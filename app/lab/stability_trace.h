/// app/lab/stability_trace.h: what a run of a hard case left behind, tick by tick, and the figures that it is judged by: each a function of
///   the trace alone, so that a test can hand it a trace in closed form.
///   Frames  grip columns: the device's, as the grip truly is; all others: world.   Units SI.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/geometry.h"

namespace burrhole {

/// One tick.
struct StabilitySample {
  double time = 0.0;          ///< [s]
  Vec3 grip{0.0};             ///< [m] device frame, at the start of the tick
  Vec3 grip_velocity{0.0};    ///< [m/s]
  Vec3 shown{0.0};            ///< [N] on the grip, device frame, held until the next tick
  Vec3 carried{0.0};          ///< [m] device frame: by how much the bone under the tool was moved so far, by whoever moves it
  Vec3 force{0.0};            ///< [N] of the servo on the hand
  Vec3 hand{0.0}, tool{0.0};  ///< [m] where the hand would have the tool, and where it is
  Vec3 normal{0.0};     ///< outward, of the shape as loaded nearest to the tool's deepest point; where bone is cut, back along the axis
  double pull = 0.0;    ///< [N] of the force: what no bone that the tool touches can have pushed with (StabilityRig::pull_of)
  double depth = 0.0;   ///< [m] of that point under the 0.5 surface; below 0: clear of it
  double beyond = 0.0;  ///< [m] of the tool's tip past the plane that the case calls its far side; below 0: on the near side
  bool bone_between = true;  ///< bone as it is lies on the way from the tool to the hand, or within a voxel of the hand
  std::uint32_t faults = 0;  ///< ServoFault
};

struct StabilityTrace {
  double period = 1e-3;  ///< [s]
  std::vector<StabilitySample> samples;
};

/// Part of a run [s], both ends within.
struct TimeSpan {
  double from = 0.0, to = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool holds(double time) const noexcept { return time >= from && time <= to; }
};

/// Ticks in which a force, a pose or a velocity is not finite.
[[nodiscard]] double ticks_not_finite(const StabilityTrace& trace) noexcept;
/// [N] Largest force on the hand, in the world.
[[nodiscard]] double largest_force(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [N] Largest change of it from one tick to the next.
[[nodiscard]] double largest_force_step(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [N] Largest pull. Bone pushes; whatever pulls holds back a hand that leaves.
[[nodiscard]] double largest_pull(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [s] Longest time in a row for which more than `felt` [N] was given though no bone lay between tool and hand.
[[nodiscard]] double longest_force_without_bone(const StabilityTrace& trace, double felt) noexcept;

/// What device and hand swallow: viscous damping, and Coulomb friction along each axis.
struct Swallows {
  double damping = 0.0;   ///< [N s/m]
  double friction = 0.0;  ///< [N] a tick's part is friction times |moved|, never more than what it really takes
};
/// [J] The most that the wall has given out beyond what device and hand swallowed: -min E of EnergyObserver, in its exact form at the grip.
/// Work by whoever moves bone is an account of its own: the wall's work is that of the motion relative to bone.
[[nodiscard]] double energy_owed(const StabilityTrace& trace, const Swallows& swallows) noexcept;

/// [m] Greatest extent along an axis of where the grip was: the size of a limit cycle while the hand means to rest.
[[nodiscard]] double cycle_size(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [-] Largest distance of the force from its mean, both ways, over the mean's length or 0.5 N, whichever is more.
[[nodiscard]] double force_ripple(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [m] Deepest point of the tool under the 0.5 surface; 0: never in it.
[[nodiscard]] double deepest(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [m] How far the tool got past the far side's plane; 0: never.
[[nodiscard]] double furthest_beyond(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [m/s] Largest speed of the grip.
[[nodiscard]] double largest_speed(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [N] Work that the tool takes from the hand along the surface, over the way that it went along it (1 N is 1 mJ per mm): the drag that a
/// frictionless surface must not have.
[[nodiscard]] double drag_along(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [N] Largest force along the surface.
[[nodiscard]] double largest_lateral_force(const StabilityTrace& trace, const TimeSpan& span) noexcept;
/// [N] Largest force given in a tick with one of these faults.
[[nodiscard]] double largest_force_with(const StabilityTrace& trace, std::uint32_t faults) noexcept;
/// Share of the span's ticks, 0..1, that had one of these faults.
[[nodiscard]] double share_with(const StabilityTrace& trace, const TimeSpan& span, std::uint32_t faults) noexcept;

}  // namespace burrhole
