/// core/drill/engaged_removal.h: erosion by way of a list of engaged voxels: law `energy`, and sub-voxel removal with `rate` or `energy`.
///   Units SI.   Thread simulation.   Source  own derivation:
///   In a sub-step the part a of a voxel's remaining that may go (all of it, or what core/drill/coverage.h leaves) falls to
///   a exp(-k x / h), x [1/rev] its exposure, h = max(hardness, 0.1), and k [rev] the same for all voxels: law `rate` spin x dt, law
///   `energy` as many turns as the work at hand is worth (core/drill/energy.h).
///   The part left becomes 0 where occupancy x a is below minimum_density x the share of the voxel covered; in a voxel covered
///   in part below clear_below x that share, if that is more. At 0.5 the covered part goes when it leaves the felt surface, as whole voxels
///   leave it; the exponential's tail would keep the surface half a voxel inside the wall for several times as long, and the wall would
///   hold the tool back. The price is mass: walls go early in unsaturated runs (17 % of all that is removed at a radius of 3 voxels).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/drill/coverage.h"
#include "core/drill/energy.h"
#include "core/drill/erosion.h"

namespace burrhole {

/// One per Erosion; made and called by it.
class EngagedRemoval {
 public:
  /// out_of_range when energies are not above 0, `subvoxel` has no field or goes with law `per_update`.
  [[nodiscard]] static Result<EngagedRemoval> create(const ErosionConfig& config, const ErosionPoints& points,
                                                     std::shared_ptr<const CuttingField> field);
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);
  /// Null without `subvoxel`.
  [[nodiscard]] const Coverage* coverage() const noexcept { return coverage_ ? &*coverage_ : nullptr; }

 private:
  EngagedRemoval(const ErosionConfig& config, const ErosionPoints& points) : config_(config), points_(points) {}
  /// Turns k of this sub-step.
  [[nodiscard]] double turns(const MasterWindow& window, double cell_volume, double spin_time, double work);
  void apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome);

  ErosionConfig config_;
  ErosionPoints points_;
  std::optional<Coverage> coverage_;
  std::vector<Engaged> engaged_;   // of this sub-step
  std::vector<EnergyTerm> terms_;  // the same, for law `energy`
  EngagedScatter scatter_;
  TileMarks marks_;    // of voxels changed in the step at hand
  double debt_ = 0.0;  // [J] of work done beyond what the load brought, by clearing what the minimum density leaves
};

}  // namespace burrhole
