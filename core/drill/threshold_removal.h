/// core/drill/threshold_removal.h: law `threshold`: whole voxels are cut out of the bone where the stress under the bit reaches the strength
///   of the material.
///   Frame  index coordinates of the bone; the ball in the tool frame.   Units  SI.   Errors  out_of_range from create().
///   Thread simulation.
///   Source [TellesONeill10] section 4.3.4: a voxel is cut whose distance to the centre of the burr is at most 3/4 of its radius; table 1:
///          ultimate strength, the largest stress that a material withstands. The paper has no condition on the stress. Ours, own
///          derivation: the bit bears on bone with the share `bearing_share` of the contact area, the projection along the reaction of the
///          solid voxels inside the ball of the bit, so the stress is force / (share x area).
#pragma once

#include <vector>

#include "core/drill/erosion.h"

namespace burrhole {

/// The ball at the end of a bit: it touches the lowest plane of the cutting part and is as wide as the cutting part.
struct CuttingBall {
  Vec3 centre{0.0};     ///< [m] tool frame
  double radius = 0.0;  ///< [m] 0: the bit does not cut
};
[[nodiscard]] CuttingBall cutting_ball(const ErosionPoints& points);

class ThresholdRemoval {
 public:
  /// out_of_range: a number of the config is outside its range.
  [[nodiscard]] static Result<ThresholdRemoval> create(const ThresholdConfig& config, const ErosionPoints& points);

  /// As Erosion::step(). Removed voxels have no bone left. The stress is that at the end of the path, before removal; below the ultimate
  /// strength nothing is removed.
  [[nodiscard]] ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load);

 private:
  ThresholdRemoval(const ThresholdConfig& config, const ErosionPoints& points) : config_(config), ball_(cutting_ball(points)) {}
  [[nodiscard]] double contact_area(const Voxmap& voxmap, const Affine& index_from_tool, const Vec3& reaction);
  void remove(Voxmap& voxmap, const Affine& index_from_tool, ErosionOutcome& outcome);

  ThresholdConfig config_;
  CuttingBall ball_;
  TileMarks marks_;
  std::vector<Vec3> solid_;           // scratch: centres [m] of solid voxels inside the ball
  std::vector<std::uint64_t> cells_;  // scratch
};

}  // namespace burrhole
