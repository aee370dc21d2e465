/// app/lab/stability_case.h: a hard case as data: the scene, what the hand does, what goes wrong, what must hold, and how to break it.
///   Frames  the hand's way: approach frame (origin on the surface, +z out of bone).   Units SI; bounds in the measure's unit.
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
  force_step,          ///< [N] a tick
  pull,                ///< [N]
  force_without_bone,  ///< [ms]
  energy_owed,         ///< [mJ]
  cycle,               ///< [mm]
  ripple,              ///< [%]
  penetration,         ///< [voxel]
  far_side,            ///< [mm]
  rest_speed,          ///< [mm/s]
  drag,                ///< [mJ/mm]
  lateral_force,       ///< [N]
  force_in_fault,      ///< [N]
  ticks_missed,        ///< [%] of ticks that told no fault where there was one
};
/// "energy_owed_mJ", ...
[[nodiscard]] std::string_view name_of(StabilityMeasure measure) noexcept;

/// For whom a bound is meant.
enum class ForModels {
  all,
  held,  ///< the default model alone: a penalty lets a strong push through by its own law
};

struct StabilityCheck {
  StabilityMeasure measure;
  double bound;  ///< what the figure must not exceed
  TimeSpan span{};
  ForModels models = ForModels::all;
  std::uint32_t faults = 0;  ///< of the last two measures
};

/// Where the hand means to be, straight lines between; before the first and after the last as there.
struct Waypoint {
  double time;  ///< [s]
  Vec3 at;      ///< [m] of the grip's hand, in metres of the world, approach frame
};

/// What goes wrong with the loop during a run.
struct StabilityTrouble {
  std::vector<TimeSpan> contact_stalls;     ///< contact looks at nothing
  std::optional<TimeSpan> hand_not_number;  ///< the device tells NaN
  std::optional<TimeSpan> hand_infinite;    ///< the device tells infinity
  double reset_at = -1.0;                   ///< [s] the user takes the latched fault back; below 0: never
  int servo_jitter = 0;                     ///< [ticks] a servo tick takes 1 to 1 + so many, seeded
  double servo_stall_every = 0.0;           ///< [s] and that often one takes 20; 0: never
  std::vector<Waypoint> teleports;          ///< the grip is there all at once
};

/// What is broken on purpose, so that `must_fail` does.
struct StabilitySabotage {
  std::string what{};
  StabilityMeasure must_fail = StabilityMeasure::not_finite;
  std::vector<std::string> sets{};  ///< scene keys, as --set
  bool flip = false;                ///< the grip feels the force with its sign flipped
  int late = 0;                     ///< [ticks] the grip feels each force so much later
  bool does_not_stop = false;       ///< where the force should stop, the strongest so far is felt
  double turned = 0.0;              ///< [rad] the grip feels the force turned about y by so much: bone with friction
  bool dead_contact = false;        ///< contact looks no more once it has touched: force and gradient stay as they were
};

struct StabilityCase {
  std::string name;
  std::string shows;        ///< one sentence
  std::string scene;        ///< TOML, but for the model
  std::string tool;         ///< TOML
  int rate_hz = 1000;       ///< of contact
  double duration = 2.0;    ///< [s]
  std::uint64_t ticks = 0;  ///< instead of the duration; the trace is then judged in parts
  std::vector<Waypoint> path;
  Vec3 start{0.0, 0.0, 1e-3};      ///< [m] of the grip and the tool
  Vec3 start_velocity{0.0};        ///< [m/s]
  double far_side = 0.0;           ///< [m] approach frame: the tip below this height is on the far side; 0: not looked at
  double slot_half_width = 0.0;    ///< [m] a slot along y cut through the bone as loaded; 0: none
  double swing = 0.0, turn = 0.0;  ///< [m] along x, [rad] about y: amplitudes of the bone's own motion, at 1 Hz
  double loose_drag = 0.0;         ///< [N s/m] bone is loose: it moves with F over this; 0: it is fixed
  StabilityTrouble trouble;
  std::vector<StabilityCheck> checks;
  StabilitySabotage sabotage;
};

/// How a case is felt: rows of [contact].
struct StabilityModel {
  std::string name;
  std::string keys;   ///< TOML
  bool held = false;  ///< the default model
};

/// The default model first.
[[nodiscard]] std::span<const StabilityModel> stability_models();
/// @param long_runs the longest case runs ten times as long.
[[nodiscard]] std::vector<StabilityCase> stability_cases(bool long_runs = false);

/// The figure of one check, in the measure's unit.
struct TraceContext {
  Swallows swallows;
  double voxel_edge = 0.25e-3;  ///< [m]
  double grace = 0.0;           ///< [s] for which a force may outlive its bone: one slow period and the loop's latency
};
[[nodiscard]] double measure(const StabilityTrace& trace, const StabilityCheck& check, const TraceContext& context);
/// What that figure must not exceed: the check's bound, and where it is a time for which a force may stay, the loop's own grace besides.
[[nodiscard]] double bound_of(const StabilityCheck& check, const TraceContext& context) noexcept;

}  // namespace burrhole
