/// core/drill/erosion.h: erosion points remove bone from the master window.
///   Frame  index coordinates of the bone.   Units  SI; remaining 0..1, float.   Errors  out_of_range from create().
///   Thread simulation, the only writer of bone.
///   Pose   a step is divided into sub-steps. Removal by whole voxels uses the pose at the middle of each sub-step, sub-voxel removal the
///          pose at its end.
///   Source [AcostaLiu07] section 3, eq. 4 (`per-update`); law `rate` is our own continuous form of it (see ErosionLaw).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/drill/exposure.h"
#include "core/drill/strength_field.h"
#include "core/drill/stress_strain.h"
#include "core/tool/tool.h"
#include "core/voxel/tile_marks.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

enum class ErosionLaw {
  /// db/dt = -(lambda / h) b for remaining b, h = max(hardness, 0.1), lambda [1/s] = spin [rev/s] x sum over the points in the voxel of
  /// e x (point pitch / voxel edge)^3, e [1/rev] the erosion factor. The removed bone does not depend on the update rate or the pitch of
  /// the points. With `subvoxel` the same mass inside the tool is taken off the face of bone (cut_face.h).
  rate,
  /// [AcostaLiu07] eq. 4 as printed: at each update every erosion point in a voxel changes its remaining b to b (1 - e s), with e the
  /// erosion factor and s the spin in rev/s; 0 if e s >= 1. Neither hardness nor the duration of the update has an effect. The product over
  /// the points of a voxel is computed as exp(sum of ln(1 - e s)), which differs by the rounding of doubles.
  per_update,
  /// Cutting power (energy.h): the force F and the rubbing speed v_rel do the work mu F v_rel dt in a step, and removal takes u0 h per
  /// volume of bone, so the volume rate is mu F v_rel / (u0 h).
  energy,
  /// Whole voxels whose centres lie in a ball inside the cutting part, where the stress under it reaches the strength of the material
  /// (threshold_removal.h); [TellesONeill10] section 4.3.4 and table 1.
  threshold,
  /// Bone under the bit is damaged by the work of cutting, as far as the stress there gets on the stress-strain curve of the bone, and is gone
  /// when it has taken the work under the whole curve (progressive_removal.h).
  progressive,
};

/// Parameters of law `energy`.
struct EnergyConfig {
  double specific_energy = 1e8;  ///< [J/m^3] > 0: u0, at hardness 1; cortical bone: about 0.1 J/mm^3 (not verified)
  double cutting_ratio = 0.5;    ///< [-] > 0: mu, cutting force over normal force (an assumption)
};

/// Parameters of law `threshold`.
struct ThresholdConfig {
  double ultimate_strength = 170e6;  ///< [Pa] > 0: largest stress that the material withstands; [TellesONeill10] table 1, bone (limb)
  double reach = 0.75;               ///< [-] in (0, 1]: radius of the ball of removed voxels over that of the bit's; sec. 4.3.4
  double bearing_share = 0.002;      ///< [-] in (0, 1]: share of the projected contact area on which cutting edges bear (an assumption)
};

/// Parameters of law `progressive`, with the cutting ratio of EnergyConfig.
struct ProgressiveConfig {
  StressStrainCurve curve;  ///< at hardness 1
  /// [-] in (0, 1]: of the cutting work, what deforms bone; the rest is friction. Default: cortical bone takes 0.1 J/mm^3 of cutting work, the
  /// specific energy of law `energy` (an assumption).
  double work_share = 0.034;
  double bearing_share = 0.001;  ///< [-] in (0, 1]: as that of ThresholdConfig (an assumption)
};

/// How the exposure of voxels is computed from points, for the laws `rate` and `per_update` by whole voxels; not used otherwise.
enum class ErosionForm {
  scatter,  ///< each point adds to the voxel that contains it: exact
  gather,  ///< each voxel reads a table of the tool (strength_field.h): an approximation whose cost does not depend on the number of points
};

struct ErosionConfig {
  ErosionLaw law = ErosionLaw::rate;
  ErosionForm form = ErosionForm::scatter;
  float minimum_density = 0.05f;  ///< [-] in [0, 0.5): lower densities become 0 (as in [AcostaLiu07]); not used with `subvoxel`
  double longest_substep = 0.5;   ///< [voxels] in (0, 1]: longest path of a point of the tool in a sub-step, so that no bone is skipped
  bool subvoxel = false;          ///< laws `rate` and `energy`: the face of bone, which may lie inside a voxel, recedes (cut_face.h)
  EnergyConfig energy{};
  ThresholdConfig threshold{};
  ProgressiveConfig progressive{};
};

/// Result of one step.
struct ErosionOutcome {
  double removed_mass = 0.0;  ///< [m^3] integral of occupancy x (loss of remaining)
  std::uint32_t substeps = 0;
  std::uint32_t touched = 0;  ///< voxels whose remaining changed, counted once a sub-step
  std::uint32_t outside = 0;  ///< points (sub-voxel: voxels) beyond the window's edge, where bone is not eroded; should be 0
  /// [J] laws `energy` and `progressive`: work of the removal. With `energy` it may exceed the work of the load; the excess is subtracted from
  /// the work of later sub-steps.
  double energy = 0.0;
  /// [m] mean radius from the tool's axis at which bone is rubbed. Law `energy` by whole voxels: of the engaged voxels, weighted by
  /// exposure; 0 if none is engaged. Sub-voxel removal: of the removed bone, weighted by mass; if nothing was removed, that of the last
  /// removal, 0 before the first. Law `progressive`: of the voxels that took work. Other laws by whole voxels: always 0.
  double rubbing_radius = 0.0;
  double stress = 0.0;  ///< [Pa] laws `threshold` and `progressive`: the largest under the bit in this step; 0 without contact
  VoxelBoxes changed;   ///< disjoint boxes of all changed voxels; the caller passes them to Voxmap::commit()
};

/// The straight path of one step; tool poses in index coordinates of the bone: p_index = linear * p_tool + offset.
struct ErosionPath {
  Affine from;
  Affine to;
  /// @returns the pose at a share `t` of the path [-], 0..1.
  [[nodiscard]] Affine at(double t) const noexcept {
    return {from.linear + (to.linear - from.linear) * t, from.offset + (to.offset - from.offset) * t};
  }
};

/// Load on the tool.
struct CuttingLoad {
  double spin = 0.0;   ///< [rev/s] 0 removes nothing
  double force = 0.0;  ///< [N] normal force on the cutting part; not used by the laws `rate` and `per_update`; else 0 removes nothing
  Vec3 reaction{
      0.0, 0.0,
      1.0};  ///< [-] unit, tool frame: direction of the force of bone on the tool; used by `subvoxel` and the laws `threshold` and `progressive`
};

class EngagedRemoval;
class FaceRemoval;
class ThresholdRemoval;
class ProgressiveRemoval;
struct CuttingField;

/// Applies the erosion points of a tool. One instance per tool and window; scratch memory is kept between steps.
class Erosion {
 public:
  /// @returns out_of_range if a number of the config is outside its range or the points of the tool are not finite.
  /// @param field the cutting part of the tool, Tool::cutting; required by `subvoxel`, not used otherwise.
  [[nodiscard]] static Result<Erosion> create(const ErosionConfig& config, const ErosionPoints& points,
                                              std::shared_ptr<const CuttingField> field = nullptr);
  Erosion(Erosion&&) noexcept;
  Erosion& operator=(Erosion&&) noexcept;
  ~Erosion();

  /// Erodes along the path for `dt` [s] at `spin` [rev/s] (>= 0; 0 removes nothing). The caller commits `changed`. For `per_update` each
  /// sub-step is one update.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, double spin, double dt);
  /// The same with a load, for law `energy`.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, const CuttingLoad& load, double dt);

  /// Replaces the erosion factors [1/rev] of the points, in their order: regions of the tool have speeds of their own (region_spin.h). With
  /// `subvoxel` the factors are those of the cutting field, and this does nothing. May allocate. @pre finite, >= 0, one for each point.
  void set_factors(std::span<const float> factors);

  [[nodiscard]] const ErosionConfig& config() const noexcept { return config_; }
  [[nodiscard]] int substeps_for(const ErosionPath& path) const noexcept;

 private:
  Erosion(const ErosionConfig& config, const ErosionPoints& points, bool by_points);
  void weigh_points(double spin, double voxel_edge);
  std::uint32_t expose(const MasterWindow& window, const Affine& index_from_tool);

  ErosionConfig config_;
  std::size_t count_;                        // points of the tool
  ErosionPoints points_;                     // of `rate` and `per_update` by whole voxels; empty with face_ or engaged_
  PointScatter scatter_;                     // of points_
  StrengthField strength_;                   // of form gather, made at the first step
  Bounds tool_bounds_;                       // of the points, tool frame
  double weighed_for_ = 0.0;                 // [rev/s] spin for which the weights of eq. 4 were computed; 0: the weights are the factors
  ExposureField exposure_;                   // zero between sub-steps
  TileMarks marks_;                          // of voxels changed in the current step
  std::unique_ptr<FaceRemoval> face_;        // sub-voxel removal; null otherwise
  std::unique_ptr<EngagedRemoval> engaged_;  // law `energy` by whole voxels; null otherwise
  std::unique_ptr<ThresholdRemoval> ball_;   // law `threshold`; null otherwise
  std::unique_ptr<ProgressiveRemoval> progressive_;  // law `progressive`; null otherwise
};

}  // namespace burrhole
