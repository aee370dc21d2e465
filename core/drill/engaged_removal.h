/// core/drill/engaged_removal.h: erosion with a list of engaged voxels: law `energy` by whole voxels.
///   Frame  index coordinates.   Units  SI.   Errors  out_of_range.   Thread  simulation.   Source  own derivation:
///   In a sub-step remaining r of a voxel falls to r exp(-k x / h). x [1/rev] is the exposure, h = max(hardness, 0.1), and k [rev] is the
///   same for all voxels: the k that uses the work of the sub-step (core/drill/energy.h). Bone below minimum_density becomes 0.
#pragma once

#include <span>
#include <vector>

#include "core/drill/energy.h"
#include "core/drill/erosion.h"

namespace burrhole {

/// One per Erosion, which makes and calls it.
class EngagedRemoval {
 public:
  /// @returns out_of_range if energies are not > 0.
  [[nodiscard]] static Result<EngagedRemoval> create(const ErosionConfig& config, const ErosionPoints& points);
  /// As Erosion::set_factors().
  void set_factors(std::span<const float> factors) { points_.factors.assign(factors.begin(), factors.end()); }
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);

 private:
  EngagedRemoval(const ErosionConfig& config, const ErosionPoints& points) : config_(config), points_(points) {}
  /// @returns k [rev] of this sub-step.
  [[nodiscard]] double turns(const MasterWindow& window, double cell_volume, double work);
  void apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome);

  ErosionConfig config_;
  ErosionPoints points_;
  std::vector<Engaged> engaged_;   // of the current sub-step
  std::vector<EnergyTerm> terms_;  // the same
  EngagedScatter scatter_;
  TileMarks marks_;    // of voxels changed in the current step
  double debt_ = 0.0;  // [J] work of clearing below the minimum density that exceeds the work of the load so far
};

}  // namespace burrhole
