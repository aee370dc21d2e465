/// app/lab/contact_accuracy.h: error and cost of gradient-plane contact: force against closed forms, on level, tilted and curved bone,
/// clean
///   and noisy, at several depths, with the shipped tools.
///   Frame  world = bone frame.   Units  SI here; rows state theirs.   Errors  out_of_range, unavailable, errors of tools and phantoms.
///   Source  [AcostaLiu07] section 2 for the law; references in contact_reference.h.
#pragma once

#include <string>
#include <vector>

#include "app/lab/cost_row.h"
#include "core/contact/gradient_plane.h"

namespace burrhole {

struct ContactAccuracyOptions {
  std::string tool_folder;  ///< of the tool files
  std::vector<std::string> tools{"acosta_liu_round", "acosta_liu_perforator", "round_burr_4mm"};
  std::vector<double> depths_voxel{0.25, 0.5, 1.0, 2.0, 4.0, 6.0};  ///< [voxels] of the tip below the surface
  double pitch = 0.25e-3;                                           ///< [m]
  double noise = 0.04;                                              ///< [-] of the noisy copy of each bone
  int placements = 16;                                              ///< random positions and orientations per setting
  int repeats = 4;                                                  ///< timed evaluations per placement
  std::int64_t seed = 1;                                            ///< of noise and placements
  GradientPlaneConfig model;                                        ///< the shipped default
};

/// For each tool, bone (clean and noisy), depth and form of the bone (packed words as published by a run, floats, OpenVDB grids): errors
/// over the placements, from the vector difference of forces:
///   own_law_median, own_law_worst           [%] of the average over colliding points with exact depths
///   own_law_worst_length                    [voxel] that difference over the stiffness: error of the surface position in the model
///   translation_median, translation_worst   [%] of k x the translation distance along the push
/// and one row per tool and law, force_lost [%]: largest decrease of the force with increasing depth, pressed into a level plate.
/// Errors of tools and phantoms are returned; out_of_range if there is nothing to measure or a depth exceeds the middle of the plate.
[[nodiscard]] Result<std::vector<CostRow>> measure_contact_accuracy(const ContactAccuracyOptions& options);

/// Force along the normal while a tool is pressed into a level plate; all vectors have the same size.
struct ForceCurve {
  std::string tool;
  std::vector<double> depth_mm, model_N, law_N, translation_N;
};
[[nodiscard]] Result<std::vector<ForceCurve>> measure_force_curves(const ContactAccuracyOptions& options);

/// @returns the largest decrease below an earlier value, in percent of that value.
[[nodiscard]] double largest_loss_percent(const std::vector<double>& force) noexcept;

/// Writes cost.csv, contact_error.svg and contact_force.svg into a folder. `unavailable` without gnuplot (the table is written).
[[nodiscard]] Status write_contact_accuracy(const std::vector<CostRow>& rows, const std::vector<ForceCurve>& curves,
                                            const std::string& folder);

}  // namespace burrhole
