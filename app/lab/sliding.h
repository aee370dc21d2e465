/// app/lab/sliding.h: smoothness of a contact model: a bit slides over a flat plate at constant depth. The true force is constant, so every
///   change from one step to the next is an error of the model.
///   Frame  world = bone frame; poses are those of the tool.   Units  SI; rows state theirs.   Errors  out_of_range, errors of phantoms.
///   Source own derivation; the effect is that of [AcostaLiu07] section 2, figure 4.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/study.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/contact_view.h"

namespace burrhole {

inline constexpr double kSlidingStiffness = 2000.0;  ///< [N/m] of every compared model

/// Force [N] on the tool at a pose.
using ForceAt = std::function<Vec3(const Pose&)>;

/// One bone in the forms that the penalty models (of voxels, of the mesh) and the constrained tool read.
struct SlidingBone {
  ContactView voxels;
  ContactView mesh;
  SurfaceView surface;
};

/// A compared model: its name, and a function that evaluates it on one bone. The bone outlives the ForceAt made from it. A model with state
/// (the constrained tool) gets the poses of a lane in order; each lane uses a new ForceAt.
struct SlidingSubject {
  std::string model;
  std::function<ForceAt(const SlidingBone&)> on;
};

struct SlidingOptions {
  std::string tool_folder;              ///< of the tool files
  std::string tool = "round_burr_4mm";  ///< for sliding_subjects()
  std::vector<double> tilts_deg{0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0};
  /// [voxels] Depths of the tip below the surface. 0.8: the first layer, where the plane of the paper lies; 2.8: the depth of a stiff hand.
  /// Not whole or half voxels, where rounding would select the voxel.
  std::vector<double> depths_voxel{0.8, 2.8};
  double pitch = 0.25e-3;  ///< [m] voxel edge
  double step = 10e-6;     ///< [m]
  double length = 6e-3;    ///< [m] in (0, 8 mm], down the slope of the plate, through the origin
  int lanes = 4;           ///< random rotations about the axis and offsets up to half a voxel
  std::int64_t seed = 1;   ///< of the lanes
  Study* study = nullptr;  ///< runs the trials, one per tilt, depth and subject; null: nothing is kept
};
[[nodiscard]] std::size_t count_of_trials(const SlidingOptions& options, std::span<const SlidingSubject> subjects) noexcept;

/// Results over all lanes of one setting.
struct SlidingRow {
  double tilt_deg = 0.0;
  double depth_voxel = 0.0;  ///< [voxels]
  std::string model;
  double true_N = 0.0;          ///< stiffness times depth: the translation distance along the plate's normal
  double mean_N = 0.0;          ///< along the normal; compare steps with it, since stacking of points may scale both
  double largest_step_N = 0.0;  ///< length of the largest change of the force vector in one step
  double rms_step_N = 0.0;
  double ripple = 0.0;  ///< [-] (highest - lowest force along the normal) / mean, of the worst lane; NaN without force
  double median_us = 0.0, p99_us = 0.0;
};

/// Results of one lane: forces at successive steps.
struct SlideFigures {
  double mean = 0.0, largest_step = 0.0, rms_step = 0.0, ripple = 0.0;  ///< [N], [N], [N], [-]
};
[[nodiscard]] SlideFigures slide_figures(std::span<const Vec3> forces, const Vec3& normal) noexcept;

/// @returns one row per tilt, depth and subject, in this order; out_of_range for an option, or errors of phantoms.
[[nodiscard]] Result<std::vector<SlidingRow>> measure_sliding(const SlidingOptions& options, std::span<const SlidingSubject> subjects);

/// The models with the tool of the options at 2000 N/m: surface, with rotation locked and without damping, so that the force depends on the
/// pose only; gradient-plane; voxmap with the point's own voxel and sum_limited (average is a tenth of it where ten points touch); voxmap
/// with the surface voxel, average and deepest; mesh with the tool at the hand, deepest and average, and as a constrained tool, as surface.
[[nodiscard]] Result<std::vector<SlidingSubject>> sliding_subjects(const SlidingOptions& options);

/// Four rows of cost.csv each, against tilt: mean_force_off (mean minus true force, < 0 if a model returns less), largest_step and rms_step
/// [N], ripple [-].
[[nodiscard]] std::vector<CostRow> sliding_cost_rows(const std::vector<SlidingRow>& rows, const std::string& tool);
/// Writes sliding.svg into a folder: largest step over mean force, and ripple, against tilt, two panels per depth. `unavailable` without
/// gnuplot.
[[nodiscard]] Status write_sliding(const std::vector<SlidingRow>& rows, const std::string& folder);

}  // namespace burrhole
