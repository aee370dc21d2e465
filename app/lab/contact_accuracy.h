/// app/lab/contact_accuracy.h: error and cost of gradient-plane and mesh contact. Their force is compared with closed forms on level, tilted and
///   curved bone, clean and noisy, at several depths, with the shipped tools.
///   Frame  world = bone frame.   Units  SI here; rows state theirs.   Errors  out_of_range, unavailable, errors of tools and phantoms.
///   Source  [AcostaLiu07] section 2 for the law; references in contact_reference.h.
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "app/lab/study.h"
#include "core/contact/gradient_plane.h"

namespace burrhole {

struct ContactAccuracyOptions {
  std::string tool_folder;  ///< of the tool files
  /// Names of tool files in that folder, without the extension; or paths of tool files, which end in .toml.
  std::vector<std::string> tools{"acosta_liu_round", "acosta_liu_perforator", "round_burr_4mm"};
  std::vector<double> depths_voxel{0.25, 0.5, 1.0, 2.0, 4.0, 6.0};  ///< [voxels] of the tip below the surface
  double pitch = 0.25e-3;                                           ///< [m] voxel edge of the bones
  double noise = 0.04;        ///< [-] of a noisy copy of each bone, as PhantomSpec::noise; 0: no copies
  int placements = 16;        ///< random positions, and rotations about the tool's axis, per setting
  int repeats = 4;            ///< timed evaluations per placement
  std::int64_t seed = 1;      ///< of noise and placements
  GradientPlaneConfig model;  ///< the shipped default; its stiffness is k below
  Study* study = nullptr;     ///< runs the trials: one per tool, bone, depth and form, then one curve per tool; null: nothing is kept
};
/// @returns the trials of rows and curves.
[[nodiscard]] std::size_t count_of_trials(const ContactAccuracyOptions& options);

/// Force along the outward normal while a tool is pressed into a level plate; all vectors have the same size.
struct ForceCurve {
  std::string tool;                   ///< as ContactAccuracyOptions::tools
  std::vector<double> depth_mm;       ///< [mm] of the tip below the surface, increasing
  std::vector<double> model_N;        ///< [N] of the model
  std::vector<double> mesh_N;         ///< [N] of the model `mesh`, deepest
  std::vector<double> law_N;          ///< [N] of its own law with closed-form depths
  std::vector<double> translation_N;  ///< [N] k x the translation distance
};
/// @returns one curve per tool, to a depth of 1.9 mm in steps of 5 um; errors of tools and phantoms.
[[nodiscard]] Result<std::vector<ForceCurve>> measure_force_curves(const ContactAccuracyOptions& options);

struct ContactAccuracy {
  std::vector<CostRow> rows;
  std::vector<ForceCurve> curves;
};
/// Let f be the force of the model. The two reference forces are
///   own law      from the closed form of the bone; k x the average of depth x outward normal over the colliding points;
///                mesh, deepest: k x the largest depth along the outward normal there;
///   translation  k x the translation distance: the distance along the outward normal after which no shell point is in bone.
/// For each tool, bone (clean and noisy), depth, and form of the bone (packed words as published by a run, floats, OpenVDB grids, and the mesh
/// for the model of that name) there is
/// one row per error, with the median or the largest value over the placements:
///   own_law_median, own_law_worst          [%] |f - own law| over |own law|
///   own_law_worst_length                   [voxel] |f - own law| over k, in voxel edges: error of the surface position in the model
///   translation_median, translation_worst  [%] |f - translation| over |translation|
/// and for each tool one row for each model and one for the law of gradient-plane, force_lost [%]: largest decrease of the force while the depth in a
/// level plate increases. @returns errors of tools and phantoms; out_of_range if there is no tool, depth, placement or repetition, or a
/// depth is not between 0 and 2 mm, the middle of the plate.
[[nodiscard]] Result<ContactAccuracy> measure_contact_accuracy(const ContactAccuracyOptions& options);

/// @returns the largest decrease below an earlier value, in percent of that value.
[[nodiscard]] double largest_loss_percent(const std::vector<double>& force) noexcept;

/// Writes cost.csv, contact_error.svg and contact_force.svg into a folder; without gnuplot cost.csv only, and it returns `unavailable`.
[[nodiscard]] Status write_contact_accuracy(const std::vector<CostRow>& rows, const std::vector<ForceCurve>& curves,
                                            const std::string& folder);

}  // namespace burrhole
