/// app/job/summary.h: results of a run and their JSON form, summary.json.
///   Frame  none: lengths are along the axis of drilling, from the entry.   Units  in the names.   A figure that does not apply is null.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/job/plan.h"
#include "app/job/provenance.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "core/measure/outcome.h"

namespace burrhole {

inline constexpr int kSummarySchema = 1;

/// Figures of one finished or interrupted run.
struct RunSummary {
  std::string scene;  ///< file name, without folder
  std::string title;  ///< run_title()
  std::string tool;
  std::optional<RunProvenance> provenance{};  ///< filled by drill()
  std::string end;                            ///< "done", "duration" or "stopped"
  OutcomeLimits limits;                       ///< of the scene
  std::vector<std::string> latched_faults{};  ///< one line for each servo fault that was latched
  bool brought_back = false;                  ///< a breakthrough was taken back by an undo, a reset or a restore
  double spin_rpm = 0.0, push_N = 0.0;
  bool bench = false;                 ///< hand.kind = "feed"
  bool by_user = false;               ///< a user moved the hand and ended the run
  bool bone_moves = false;            ///< by [motion]
  std::vector<std::string> warnings;  ///< of the plan; drill() appends those of the run
  Vec3i dims{0};
  double spacing_mm = 0.0;
  std::string volume_format;             ///< "phantom:NAME", or the format of the scan
  std::vector<std::string> assumed;      ///< of the volume, one line each
  std::optional<double> enclosed_share;  ///< [-] Enclosure::share of a scan
  std::uint64_t bone_voxels = 0, volume_bytes = 0, haptic_points = 0, erosion_points = 0;
  double duration_s = 0.0, wall_s = 0.0;
  double removed_mm3 = 0.0, removed_mass_mm3 = 0.0, thickness_mm = 0.0, angle_deg = 0.0, peak_force_N = 0.0;
  Vec3 entry_mm{0.0}, axis{0.0};  ///< of the approach, world frame
  bool open_axis = false;         ///< no bone was on the axis at the start: it was drilled before the run
  double reached_mm = 0.0;        ///< deepest position of the tip, along the axis from the entry
  double aside_mm = 0.0;          ///< greatest distance of the tip from the axis, in contact, until the tip passed the bone
  double section_mm2 = 0.0,
         section_radius_mm = 0.0;  ///< [mm^2], [mm] of the bit's cross-section (cross_section.h); 0 without erosion points
  bool section_on_axis = true;     ///< false for a crown
  std::optional<double> cleared_share, uncut_share;  ///< [-] SectionMeasure
  std::optional<double> hole_diameter_mm, inner_diameter_mm, depth_mm, breakthrough_s, passed_s, tip_out_s, removed_at_passing;
  std::optional<double> largest_ahead_mm;
  std::optional<double> plunge_mm, support_lost_s, support_lost_mm;  ///< SupportLoss
  std::optional<double> beyond_mm;                         ///< deepest position of the tip beyond the bone, of a bit that passed it
  std::vector<std::pair<std::string, StepTiming>> timing;  ///< in the order of the JSON
  std::uint64_t missed = 0;                                ///< servo ticks; 0 in lockstep
  struct Live {
    std::uint64_t contact_missed = 0, bone_missed = 0, unrecorded = 0;
    std::vector<MissedSteps> steps{};  ///< servo, contact, simulation
    std::uint32_t faults = 0;          ///< bits of ServoFault that occurred
    std::optional<double> force_left;  ///< [N] that the simulated device renders after the end of the run
  };
  std::optional<Live> live;                      ///< of a live run
  std::uint64_t peak_bytes = 0;                  ///< [bytes] largest resident memory of the process so far
  std::uint64_t predicted_bytes = 0;             ///< [bytes] the same as the plan predicts it
  std::optional<std::uint64_t> bone_file_bytes;  ///< [bytes] of the temporary file of a paged bone
  std::uint64_t uploaded_texels = 0, window_copies = 0, points_outside = 0;
  std::uint32_t contact_flags = 0;
  std::uint64_t contact_degraded = 0, contact_evaluations = 0;  ///< figures of the effect contact
  /// A layer of bone: on the planned axis, or removed beside it.
  struct Layer {
    std::string name;
    double thickness_mm = 0.0;                          ///< on the axis; 0: it is not on the axis
    double time_s = 0.0;                                ///< with the tip in it and a force on the hand
    std::optional<double> mean_N, peak_N;               ///< of that force; absent: the tip was not in it
    double removed_mass_mm3 = 0.0;                      ///< of all of its bone; the sum over the layers is that of the run
    std::vector<std::pair<double, double>> spans_mm{};  ///< depths on the axis
  };
  std::vector<Layer> layers;  ///< outermost first
  struct EffectCost {
    std::string name, step;
    double time_us = 0.0;
    std::uint64_t bytes = 0;
    Figures figures;  ///< reported by the effect
  };
  std::vector<EffectCost> effects;
  std::string voxel_hash, force_hash, image_hash;
  /// Renderer of a scene with [display]; filled by drill().
  struct Display {
    std::string backend, version, renderer;  ///< the last two as reported by the driver
    DrawingQuality quality;
    std::optional<double> budget_ms, expected_ms;  ///< of a quality chosen by a budget
  };
  std::optional<Display> display;
};

/// @returns result, reason and flags of a run (core/measure/outcome.h).
[[nodiscard]] RunOutcome outcome_of(const RunSummary& summary);
/// @returns a line of progress: the time [s], and the depth [m] of the tip in bone or its height above it.
[[nodiscard]] std::string progress_text(double time, double depth);
/// @returns one sentence on how the run ended.
[[nodiscard]] std::string outcome_text(const RunSummary& summary);
/// @returns "RESULT: REASON", and the flags if there are any: one line.
[[nodiscard]] std::string result_line(const RunSummary& summary);
/// @returns one warning for each condition of a run that its outcome does not show by itself, or that its user must know: missed steps,
/// degraded contact, a plunge beyond its limit, and a run that drills and is not through.
[[nodiscard]] std::vector<std::string> outcome_warnings(const RunSummary& summary);
/// @returns a warning if a run that drills (erosion, spin above 0) ended before the bit was through the bone. Nothing if a feed reached its
/// stop, or if a person ended the run.
[[nodiscard]] std::optional<std::string> unfinished_warning(const RunSummary& summary);
/// @returns one line for each latched servo fault of the run.
[[nodiscard]] std::vector<std::string> fault_warnings(const Simulation& simulation);
/// Collects the figures of a run and measures the hole. @param wall_s [s] duration of the run, measured by the caller.
[[nodiscard]] RunSummary make_summary(const LoadedScene& loaded, Simulation& simulation, const Plan& plan, double wall_s);
[[nodiscard]] std::string summary_json(const RunSummary& summary);
/// @returns JSON {schema, scene, effects[{name, steps[], clock, rate_hz, needs, gives, detail, time_us, bytes}], not_built[],
/// memory{predicted_bytes}, warnings[]}. rate_hz is null for steps that run at events only. @param measured a run of the same plan, for
/// time_us; null: time_us is null.
[[nodiscard]] std::string plan_json(const LoadedScene& loaded, const Plan& plan, const RunSummary* measured);

}  // namespace burrhole
