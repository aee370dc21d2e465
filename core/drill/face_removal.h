/// core/drill/face_removal.h: sub-voxel erosion, laws `rate` and `energy`, on the receding face of core/drill/cut_face.h.
///   Frame  index coordinates.   Units  SI.   Errors  out_of_range.   Thread  simulation.   Source  own derivation:
///   A face recedes by the share 1 - exp(-k e / h) of its overlap, e the erosion factor [1/rev], h = max(hardness, 0.1). k [rev] is the same
///   for all voxels: spin x dt for law `rate`; for law `energy` the k whose removal takes the work of the sub-step, u0 h per volume of bone.
///   For `energy`, k is found from the removal at one trial value, and the difference of work is carried to the next sub-step.
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
  /// @returns out_of_range if energies are not > 0, the law is `per_update`, or there is no field.
  [[nodiscard]] static Result<FaceRemoval> create(const ErosionConfig& config, std::shared_ptr<const CuttingField> field);
  ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);

 private:
  FaceRemoval(const ErosionConfig& config, std::shared_ptr<const CuttingField> field) : config_(config), face_(std::move(field)) {}
  struct Sum {
    double mass = 0.0;    // [voxels] occupancy x loss of remaining
    double energy = 0.0;  // [J/m^3 voxels] mass x energy by volume
    double moment = 0.0;  // [voxels m] mass x radius
  };
  /// Removal at `turns` [rev], without a change of bone.
  [[nodiscard]] Sum weigh(const MasterWindow& window, double turns);
  template <class Node>
  void add(const MasterWindow& window, const Node& node, float before, float after, Sum& sum) const noexcept;
  [[nodiscard]] std::span<const float> recede(double turns);
  Sum apply(Voxmap& voxmap, double turns, ErosionOutcome& outcome);
  [[nodiscard]] double turns_for(const MasterWindow& window, double cell_volume, double spin_time, double work);

  ErosionConfig config_;
  CutFace face_;
  std::vector<float> shares_;  // of the nodes
  TileMarks marks_;            // of voxels changed in the current step
  double radius_ = 0.0;        // [m] at which bone was removed last
  double trial_ = 0.0;         // [rev] k of the last sub-step of law `energy`
  double debt_ = 0.0;          // [J] work of removal that exceeds the work of the load so far; below 0: work not used
};

}  // namespace burrhole
