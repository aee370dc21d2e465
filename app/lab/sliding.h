/// app/lab/sliding.h: how smooth a model feels: a bit slides over a flat plate at constant depth, where the true force is constant, so that
/// every change from one step to the next is the model's own.
///   Frame  world = bone frame; poses are of the tool.   Units  SI; rows name theirs.
///   Source own derivation; the effect is [AcostaLiu07] section 2, figure 4.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "core/contact/constrained_tool.h"
#include "core/contact/contact_view.h"

namespace burrhole {

inline constexpr double kSlidingStiffness = 2000.0;  ///< [N/m] of every model that is compared

/// Force [N] on the tool at a pose.
using ForceAt = std::function<Vec3(const Pose&)>;

/// One bone, as the penalty models and as the constrained tool read it.
struct SlidingBone {
  ContactView voxels;
  SurfaceView surface;
};

/// What is compared: a model by name, and how to ask it on one bone. The bone outlives the ForceAt made from it. A model with a state (a
/// tool tied to a hand) takes the poses of a lane in order; a lane begins a new ForceAt.
struct SlidingSubject {
  std::string model;
  std::function<ForceAt(const SlidingBone&)> on;
};

struct SlidingOptions {
  std::string tool_folder;              ///< of the tool files
  std::string tool = "round_burr_4mm";  ///< for sliding_subjects()
  std::vector<double> tilts_deg{0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0};
  /// Of the tip under the surface. 0.8: the first layer, where the original's plane is; 2.8: as far as a stiff hand presses. Off whole
  /// and half voxels, where the choice of a voxel would hang on roundings.
  std::vector<double> depths_voxel{0.8, 2.8};
  double pitch = 0.25e-3;  ///< [m]
  double step = 10e-6;     ///< [m]
  double length = 6e-3;    ///< [m] in (0, 8 mm], down the plate's slope, through the origin
  int lanes = 4;           ///< seeded turns about the axis and places up to half a voxel aside
  std::int64_t seed = 1;   ///< of the lanes
};

/// Over all lanes of one setting.
struct SlidingRow {
  double tilt_deg = 0.0;
  double depth_voxel = 0.0;
  std::string model;
  double true_N = 0.0;          ///< stiffness times depth: the way out of the plate along its normal
  double mean_N = 0.0;          ///< along the normal; steps are read beside it, as stacking alone may scale both
  double largest_step_N = 0.0;  ///< length of the largest change of the force vector in one step
  double rms_step_N = 0.0;
  double ripple = 0.0;  ///< [-] highest less lowest force along the normal, over its mean, of the worst lane; NaN without force
  double median_us = 0.0, p99_us = 0.0;
};

/// Figures of one lane: forces a step apart.
struct SlideFigures {
  double mean = 0.0, largest_step = 0.0, rms_step = 0.0, ripple = 0.0;
};
[[nodiscard]] SlideFigures slide_figures(std::span<const Vec3> forces, const Vec3& normal) noexcept;

/// One row a tilt, depth and subject, in this order. out_of_range when an option is; faults of phantoms pass through.
[[nodiscard]] Result<std::vector<SlidingRow>> measure_sliding(const SlidingOptions& options, std::span<const SlidingSubject> subjects);

/// The models with the options' tool at 2000 N/m: surface, its turning locked and without damping, so that the force is of the pose alone;
/// gradient-plane; voxmap with the point's own voxel and sum_limited (average
/// is a tenth of it wherever ten points touch); voxmap with the surface's voxel, average and deepest.
[[nodiscard]] Result<std::vector<SlidingSubject>> sliding_subjects(const SlidingOptions& options);

/// Four rows of cost.csv each, against tilt: mean_force_off (mean less the true force, below 0 where a model gives less), largest_step and
/// rms_step [N], ripple [-].
[[nodiscard]] std::vector<CostRow> sliding_cost_rows(const std::vector<SlidingRow>& rows, const std::string& tool);
/// Writes sliding.svg into a folder: largest step over mean force, and ripple, against tilt, two panels a depth. `unavailable` without
/// gnuplot.
[[nodiscard]] Status write_sliding(const std::vector<SlidingRow>& rows, const std::string& folder);

}  // namespace burrhole
