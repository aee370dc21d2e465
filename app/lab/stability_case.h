/// app/lab/stability_case.h: a hard case as data: scene, hand motion, disturbances, bounds that must hold, and a sabotage that must violate
/// one.
///   Frames  path of the hand: approach frame (origin on the surface, +z out of bone).   Units SI; bounds in the unit of their measure.
///   Errors  none.   Thread  any: values.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/lab/stability_trace.h"
#include "volumes/phantom/shapes.h"

namespace burrhole {

enum class StabilityMeasure {
  not_finite,          ///< [ticks]
  force,               ///< [N]
  force_step,          ///< [N/tick]
  attractive_force,    ///< [N]
  force_without_bone,  ///< [ms]
  passivity_deficit,   ///< [mJ]
  cycle,               ///< [mm]
  ripple,              ///< [%]
  penetration,         ///< [voxel]
  far_side,            ///< [mm]
  rest_speed,          ///< [mm/s]
  drag,                ///< [mJ/mm]
  lateral_force,       ///< [N]
  force_in_fault,      ///< [N]
  ticks_missed,        ///< [%] of ticks with a servo fault that did not report it
};
/// @returns the name of a measure with its unit: "passivity_deficit_mJ", ...
[[nodiscard]] std::string_view name_of(StabilityMeasure measure) noexcept;

/// Models to which a bound applies.
enum class ForModels {
  all,
  constrained,  ///< models that constrain a tool only: a penalty model permits penetration by its law
};

struct StabilityCheck {
  StabilityMeasure measure;
  double bound;  ///< [unit of `measure`] upper bound
  TimeSpan span{};
  ForModels models = ForModels::all;
  std::uint32_t faults = 0;  ///< servo fault bits of the last two measures
};

/// A point of the goal path of the hand. Linear between points, constant before the first and after the last.
struct Waypoint {
  double time;  ///< [s]
  Vec3 at;      ///< [m] goal of the hand in the world's scale, approach frame
};

/// Disturbances of the loop during a run.
struct StabilityTrouble {
  std::vector<TimeSpan> contact_stalls;     ///< contact is not evaluated
  std::optional<TimeSpan> hand_not_number;  ///< the device reports NaN
  std::optional<TimeSpan> hand_infinite;    ///< the device reports infinity
  double reset_at = -1.0;                   ///< [s] time at which the user resets the latched fault; < 0: never
  int servo_jitter = 0;                     ///< [ticks] a servo tick takes 1 to 1 + servo_jitter ticks, random with a fixed seed
  double servo_stall_every = 0.0;           ///< [s] period of servo ticks that take 20 ticks; 0: never
  std::vector<Waypoint> teleports;          ///< the position of the grip jumps there
};

/// A deliberate error that must violate `must_fail`.
struct StabilitySabotage {
  std::string what{};
  StabilityMeasure must_fail = StabilityMeasure::not_finite;
  std::vector<std::string> sets{};  ///< scene keys, as for --set
  bool flip = false;                ///< the sign of the force on the grip is inverted
  int late = 0;                     ///< [ticks] additional latency of the force on the grip
  bool does_not_stop = false;       ///< where the force should be zero, the largest force so far acts
  double turned = 0.0;              ///< [rad] the force on the grip is rotated about y, as if bone had friction
  bool only_window = false;         ///< contact knows bone in the window only
  bool points_only = false;         ///< contact knows the tool by its shell points, not by its surface
  bool dead_contact = false;        ///< contact is not evaluated after the first touch: force and gradient stay constant
};

struct StabilityCase {
  std::string name;
  std::string shows;        ///< description, one sentence
  std::string scene;        ///< TOML, without the contact model
  std::string tool;         ///< TOML
  int rate_hz = 1000;       ///< [Hz] of contact
  double duration = 2.0;    ///< [s]
  std::uint64_t ticks = 0;  ///< if not 0, used instead of the duration; the trace is evaluated in parts
  std::vector<Waypoint> path;
  Vec3 start{0.0, 0.0, 1e-3};      ///< [m] of grip and tool
  Vec3 start_velocity{0.0};        ///< [m/s]
  double far_side = 0.0;           ///< [m] approach frame: a tip below this height is on the far side; 0: not tested
  double slot_half_width = 0.0;    ///< [m] a slot along y through the bone as loaded; 0: none
  double swing = 0.0, turn = 0.0;  ///< [m] along x, [rad] about y: amplitudes of the bone's motion at 1 Hz
  double loose_drag = 0.0;         ///< [N s/m] free bone that moves with velocity F / loose_drag; 0: the bone is fixed
  StabilityTrouble trouble;
  std::vector<StabilityCheck> checks;
  StabilitySabotage sabotage;
};

/// A contact model of the comparison: keys of [contact].
struct StabilityModel {
  std::string name;
  std::string keys;          ///< TOML
  bool constrained = false;  ///< bone constrains a tool with its own pose
};

/// @returns the models, the default model first.
[[nodiscard]] std::span<const StabilityModel> stability_models();
/// @param long_runs the longest case runs ten times as long.
[[nodiscard]] std::vector<StabilityCase> stability_cases(bool long_runs = false);

/// Parameters of the evaluation of a check.
struct TraceContext {
  Dissipation dissipation;
  double voxel_edge = 0.25e-3;  ///< [m]
  double grace = 0.0;           ///< [s] for which a force may remain without bone: one contact period and the latency of the loop
};
[[nodiscard]] double measure(const StabilityTrace& trace, const StabilityCheck& check, const TraceContext& context);
/// @returns the bound of the check; for a time without bone, plus the grace of the loop.
[[nodiscard]] double bound_of(const StabilityCheck& check, const TraceContext& context) noexcept;

}  // namespace burrhole
