/// core/drill/face_removal.h: sub-voxel erosion by the laws `rate` and `energy`: moves the face of bone (core/drill/cut_face.h).
///   Frame  index coordinates.   Units  SI.   Errors  out_of_range.   Thread  simulation.   Source  own derivation:
///   In a sub-step a face recedes by the share 1 - exp(-k e / h) of its overlap with the tool, with e the erosion factor [1/rev] and
///   h = max(hardness, 0.1). The turns k [rev] are the same for all voxels. Law `rate`: k = spin x duration of the sub-step. Law `energy`:
///   k is such that the removal takes the work of the sub-step, u0 h [J/m^3] per volume of bone (core/drill/energy.h). It is estimated from
///   the work of one trial removal; the difference in work is carried to the next sub-step.
///   Each sub-step uses the pose of the tool at its end.
#pragma once

#include <memory>
#include <vector>

#include "core/drill/cut_face.h"
#include "core/drill/energy.h"
#include "core/drill/erosion.h"

namespace burrhole {

/// One per Erosion, which makes and calls it.
class FaceRemoval {
 public:
  /// @returns out_of_range if the law is `per_update`, if `field` is null, or if specific_energy or cutting_ratio of law `energy` is not
  /// finite and > 0.
  [[nodiscard]] static Result<FaceRemoval> create(const ErosionConfig& config, std::shared_ptr<const CuttingField> field);
  /// Erosion::step() with `substeps` sub-steps. @param dt [s] of the whole path.
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);

 private:
  FaceRemoval(const ErosionConfig& config, std::shared_ptr<const CuttingField> field) : config_(config), face_(std::move(field)) {}
  struct Sum {
    double mass = 0.0;    // [voxels] occupancy x loss of remaining
    double energy = 0.0;  // [J/m^3 voxels] mass x u0 h
    double moment = 0.0;  // [voxels m] mass x radius
  };
  /// @returns the removal at `turns` [rev], computed without a change of bone.
  [[nodiscard]] Sum weigh(const MasterWindow& window, double turns);
  void add(const MasterWindow& window, std::uint32_t at, float before, float after, double radius, Sum& sum) const noexcept;
  /// Calls use(offset into the window, remaining [-] after, radius [m] from the tool's axis) for each voxel that loses bone at its face in
  /// `turns` [rev].
  template <class Use>
  void for_each_loss(const MasterWindow& window, double turns, const Use& use);
  Sum apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome);
  [[nodiscard]] double turns_for(const MasterWindow& window, double cell_volume, double spin_time, double work);

  ErosionConfig config_;
  CutFace face_;
  TileMarks marks_;      // of voxels changed in the current step
  double radius_ = 0.0;  // [m] mean radius at which bone was removed last, weighted by mass
  double trial_ = 0.0;   // [rev] k of the last sub-step of law `energy`
  double debt_ = 0.0;    // [J] work of removal less work of the load so far; below 0: work of the last sub-step that was not used
};

}  // namespace burrhole
