/// core/drill/progressive_removal.h: law `progressive`: bone under the bit is damaged by the work of cutting, as far as the stress there gets on
///   the stress-strain curve of the bone, and is gone when it has taken the work under the whole curve.
///   Frame  index coordinates of the bone.   Units  SI.   Errors  out_of_range from create().   Thread  simulation.
///   Source stress_strain.h; work of cutting and engaged voxels as in energy.h. Our own derivation:
///   The bit bears on the share `bearing_share` of the area of the engaged voxels, projected along the reaction, so the stress is
///   force / (share x area). Bone of hardness h has h times the stress at each strain, h >= 0.1 as in the other laws, so it breaks after
///   u = h x toughness / work_share of cutting work per volume: only the share `work_share` of that work deforms bone, the rest is friction. A
///   bit with the stress s damages a voxel to d = damage_at(s / h) at most: the bone left in it falls to 1 - d. The work of a step goes to the
///   voxels in proportion to exposure and volume of bone; a voxel takes no more than brings it to its d. What no voxel takes removes nothing.
#pragma once

#include <span>
#include <vector>

#include "core/drill/energy.h"
#include "core/drill/erosion.h"

namespace burrhole {

/// A voxel that takes work.
struct WorkTaker {
  std::size_t at;   ///< offset into the window
  double weight;    ///< [m^3/rev] > 0: exposure times volume of bone, in proportion to which it takes work
  double capacity;  ///< [J] that brings it to its limit
};

/// @returns the work for each unit of weight [J] that every taker receives, up to its capacity, so that the sum is `work` [J] or, if that is
/// more than they can take, all their capacity. Orders the takers by capacity for their weight.
[[nodiscard]] double level_of_work(std::vector<WorkTaker>& takers, double work);

class ProgressiveRemoval {
 public:
  /// out_of_range: a number of the config is outside its range.
  [[nodiscard]] static Result<ProgressiveRemoval> create(const ErosionConfig& config, const ErosionPoints& points);

  /// As Erosion::step(). The stress is the largest of the sub-steps.
  [[nodiscard]] ErosionOutcome step(Voxmap& voxmap, const ErosionPath& path, int substeps, const CuttingLoad& load, double dt);
  /// As Erosion::set_factors().
  void set_factors(std::span<const float> factors) { points_.factors.assign(factors.begin(), factors.end()); }

 private:
  ProgressiveRemoval(const ErosionConfig& config, const ErosionPoints& points) : config_(config), points_(points) {}
  /// @returns the stress [Pa] on the engaged voxels.
  double stress_on(const Voxmap& voxmap, const Affine& index_from_tool, const CuttingLoad& load);
  /// Lists the engaged voxels that the stress can damage further. @returns their mean radius [m] from the tool's axis.
  double find_takers(const Voxmap& voxmap, double stress);
  void remove(Voxmap& voxmap, double stress, double work, ErosionOutcome& outcome);
  /// @returns the cutting work [J/m^3] that breaks bone of that hardness.
  [[nodiscard]] double specific_work(float hardness) const noexcept;
  [[nodiscard]] double limit(float hardness, double stress) const noexcept;

  ErosionConfig config_;
  ErosionPoints points_;
  EngagedScatter scatter_;
  TileMarks marks_;
  std::vector<Engaged> engaged_;  // scratch, as what follows
  std::vector<WorkTaker> takers_;
  std::vector<Vec3> places_;  // [m]
  std::vector<std::uint64_t> cells_;
};

}  // namespace burrhole
