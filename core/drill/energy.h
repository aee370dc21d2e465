/// core/drill/energy.h: removal by cutting power, law `energy`.
///   Frame  index coordinates of the bone.   Units  SI.   Errors  none.   Thread  simulation.
///   Source  abrasive cutting, volume rate Q = E_f F v_rel with E_f = mu / u; the distribution over voxels is our own derivation:
///   A tool that rubs at the speed v_rel = 2 pi r n [m/s] under a normal force F [N] does the work W = mu F v_rel dt [J] on bone in dt; n
///   is the spin [rev/s], r the mean radius [m] of the engaged voxels, weighted by exposure, and mu the ratio of cutting force to F.
///   Removal of a volume takes u = u0 h [J/m^3], h = max(hardness, 0.1) as in law `rate`.
///   Removal by whole voxels: remaining b of a voxel becomes b exp(-k x / h), x [1/rev] its exposure. A voxel receives work in proportion
///   to its exposure and to the bone left in it, and loses volume in proportion to work / u. k >= 0 [rev] is the same for all voxels and
///   solves
///     sum over voxels of u0 h occupancy cell_volume b (1 - exp(-k x / h)) = W.
///   The sum increases with k from 0 to the work that removes all the bone. Exponentials compose, so two half steps equal one step except
///   for the motion of the tool; Q = W / (u dt) does not depend on rate, grid or number of points.
///   A voxel whose density falls below the minimum density becomes empty. The work for this is subtracted from that of the next steps.
///   Sub-voxel removal: face_removal.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// A voxel that contains erosion points in one sub-step.
struct Engaged {
  std::uint32_t at;  ///< offset into the window
  float exposure;    ///< [1/rev] x: sum of the erosion factors times (point pitch / voxel edge)^3; lambda of law `rate` is spin x exposure
  float radius;      ///< [m] from the tool's axis
};

/// One voxel in the equation for k.
struct EnergyTerm {
  double worth;  ///< [J] >= 0 work that removes all bone of the voxel
  double rate;   ///< [1/rev] > 0: x / h
};

/// @param work [J]. @returns k [rev]; 0 for work <= 0, +infinity if the work suffices to remove the bone of all terms. Newton's method from
/// 0: the sum is concave, so the iterates increase and stay below the root. At most 100 steps, relative residual 1e-12.
[[nodiscard]] double turns_for_work(std::span<const EnergyTerm> terms, double work) noexcept;

/// Mean radius [m], weighted by exposure.
class RubbingRadius {
 public:
  void add(const Engaged& one) noexcept {
    const double weight = static_cast<double>(one.exposure);
    weight_ += weight;
    moment_ += weight * static_cast<double>(one.radius);
  }
  void add(const RubbingRadius& other) noexcept {
    weight_ += other.weight_;
    moment_ += other.moment_;
  }
  [[nodiscard]] double value() const noexcept { return weight_ > 0.0 ? moment_ / weight_ : 0.0; }

 private:
  double weight_ = 0.0, moment_ = 0.0;
};

/// @returns the mean radius [m] of all erosion points of a tool, weighted by erosion factor: the radius of the cutting torque where a step
/// gives none (ErosionOutcome::rubbing_radius); 0 if nothing cuts.
[[nodiscard]] double rubbing_radius(const ErosionPoints& points) noexcept;

/// @returns M = mu F r [N m]. 2 pi n M is the power of the law. The power of the feed, F times the feed speed, is neglected: it is a
/// thousandth of 2 pi n M or less. @param cutting_ratio mu [-]. @param force F [N]. @param radius r [m].
[[nodiscard]] double cutting_torque(double cutting_ratio, double force, double radius) noexcept;

/// Index coordinates of voxels from their offsets; fast for consecutive voxels of one row.
class VoxelsOfOffsets {
 public:
  explicit VoxelsOfOffsets(const VoxelBox& box) noexcept
      : row_(static_cast<std::size_t>(box.size().x)), slab_(row_ * static_cast<std::size_t>(box.size().y)) {}
  /// Relative to the box.
  [[nodiscard]] Vec3i at(std::size_t n) noexcept {
    if (n - start_ >= row_) {  // also true for offsets before the row: the difference wraps
      y_ = static_cast<int>(n % slab_ / row_);
      z_ = static_cast<int>(n / slab_);
      start_ = n - n % row_;
    }
    return {static_cast<int>(n - start_), y_, z_};
  }

 private:
  std::size_t row_, slab_, start_ = 0;
  int y_ = 0, z_ = 0;
};

/// Lists the engaged voxels of a pose from the erosion points, for removal by whole voxels.
class EngagedScatter {
 public:
  /// Appends the voxels with bone that contain points, in the order of the first point in each. @param cell_share [-] (point pitch / voxel
  /// edge)^3.
  /// @returns the number of points outside the erodible box.
  std::uint32_t gather(const Voxmap& voxmap, const ErosionPoints& points, const Affine& index_from_tool, double cell_share,
                       std::vector<Engaged>& engaged);

 private:
  std::vector<std::uint32_t> slot_;  // per voxel of the window: index into `sums_` plus 1; 0: none
  struct Sum {
    std::uint32_t at;
    double exposure, moment;
  };
  std::vector<Sum> sums_;
};

}  // namespace burrhole
