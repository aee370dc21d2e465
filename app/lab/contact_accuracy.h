/// app/lab/contact_accuracy.h: how far gradient-plane contact is from the truth, and what it costs: force against closed forms, on level,
/// tilted and curved bone, clean and noisy, at several depths, with the shipped tools.
///   Frame  world = bone frame.   Units  SI here; rows name theirs.
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
  std::vector<double> depths_voxel{0.25, 0.5, 1.0, 2.0, 4.0, 6.0};  ///< of the tip under the surface
  double pitch = 0.25e-3;                                           ///< [m]
  double noise = 0.04;                                              ///< of the noisy twin of each bone
  int placements = 16;                                              ///< seeded places and turns a setting
  int repeats = 4;                                                  ///< timed evaluations a placement
  std::int64_t seed = 1;                                            ///< of noise and placements
  GradientPlaneConfig model;                                        ///< the shipped default
};

/// For each tool, bone (clean and noisy), depth and form of the bone (packed words as a run publishes them, floats, OpenVDB grids), errors
///   over the placements, of the vector difference of forces: own_law_median, own_law_worst          [%] of the average over colliding
///   points of exact depths own_law_worst_length                   [voxel] the same difference over the stiffness: how far off the model
///   puts the surface translation_median, translation_worst  [%] of k x the way out along the push
/// and one row a tool and law, force_lost [%]: how far force falls below what it was at a lesser depth, pressed into a level plate.
/// Faults of tools and phantoms pass through; out_of_range when there is nothing to measure or a depth passes the middle of the plate.
[[nodiscard]] Result<std::vector<CostRow>> measure_contact_accuracy(const ContactAccuracyOptions& options);

/// Force along the normal while a tool is pressed into a level plate; sizes agree.
struct ForceCurve {
  std::string tool;
  std::vector<double> depth_mm, model_N, law_N, translation_N;
};
[[nodiscard]] Result<std::vector<ForceCurve>> measure_force_curves(const ContactAccuracyOptions& options);

/// @returns the largest fall below an earlier value, in percent of it.
[[nodiscard]] double largest_loss_percent(const std::vector<double>& force) noexcept;

/// Writes cost.csv, contact_error.svg and contact_force.svg into a folder. `unavailable` without gnuplot (the table is then written).
[[nodiscard]] Status write_contact_accuracy(const std::vector<CostRow>& rows, const std::vector<ForceCurve>& curves,
                                            const std::string& folder);

}  // namespace burrhole
