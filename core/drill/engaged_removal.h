/// core/drill/engaged_removal.h: erosion with a list of engaged voxels: law `energy`, and sub-voxel removal with `rate` or `energy`.
///   Frame  index coordinates of the bone.   Units  SI.   Errors  out_of_range.   Thread  simulation.   Source  own derivation:
///   In a sub-step the removable part a of a voxel's remaining (all of it, or what core/drill/coverage.h permits) falls to a exp(-k x / h).
///   x [1/rev] is the exposure, h = max(hardness, 0.1), and k [rev] is the same for all voxels: spin x dt for law `rate`; for law `energy`
///   the k that uses the work of the sub-step (core/drill/energy.h).
///   The rest of a becomes 0 where occupancy x a is below minimum_density x the covered share of the voxel; in a partly covered voxel,
///   below clear_below x that share if this is more. With 0.5 the covered part is cleared when it leaves the felt surface, as whole voxels
///   are. Without it the tail of the exponential keeps the surface half a voxel inside the wall for several times as long, and the wall
///   holds the tool back. The cost is mass: in unsaturated runs walls are cleared early (17 % of the total removed at a radius of 3
///   voxels).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/drill/coverage.h"
#include "core/drill/energy.h"
#include "core/drill/erosion.h"

namespace burrhole {

/// One per Erosion, which makes and calls it.
class EngagedRemoval {
 public:
  /// @returns out_of_range if energies are not > 0, or if `subvoxel` has no field or is used with law `per_update`.
  [[nodiscard]] static Result<EngagedRemoval> create(const ErosionConfig& config, const ErosionPoints& points,
                                                     std::shared_ptr<const CuttingField> field);
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);
  /// Null without `subvoxel`.
  [[nodiscard]] const Coverage* coverage() const noexcept { return coverage_ ? &*coverage_ : nullptr; }

 private:
  EngagedRemoval(const ErosionConfig& config, const ErosionPoints& points) : config_(config), points_(points) {}
  /// @returns k [rev] of this sub-step.
  [[nodiscard]] double turns(const MasterWindow& window, double cell_volume, double spin_time, double work);
  void apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome);

  ErosionConfig config_;
  ErosionPoints points_;
  std::optional<Coverage> coverage_;
  std::vector<Engaged> engaged_;   // of the current sub-step
  std::vector<EnergyTerm> terms_;  // the same, for law `energy`
  EngagedScatter scatter_;
  TileMarks marks_;    // of voxels changed in the current step
  double debt_ = 0.0;  // [J] work of clearing below the minimum density that exceeds the work of the load so far
};

}  // namespace burrhole
