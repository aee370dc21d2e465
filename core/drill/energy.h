/// core/drill/energy.h: removal by cutting power, law `energy`.
///   Frame  index coordinates of the bone.   Units  SI.   Errors  none.   Thread  simulation.
///   Source  abrasive cutting Q = E_f F v_rel, E_f = mu / u; the distribution over voxels is our own derivation:
///   A tool that rubs at v_rel = 2 pi r n under a normal force F does the work W = mu F v_rel dt on bone in dt; r is the mean radius of the
///   engaged voxels, weighted by exposure. Removal of bone of hardness h takes u = u0 h [J/m^3], h = max(hardness, 0.1) as in law `rate`.
///   Remaining falls from r to r exp(-k x / h), x the exposure of the voxel: its share of the work is proportional to its exposure and to
///   the bone left in it, and the loss per work is proportional to 1 / u. k >= 0 solves  sum of u0 h occ cell r (1 - exp(-k x / h)) = W.
///   The sum increases with k from 0 to the work that removes all the bone. Exponentials compose, so two half steps equal one step except
///   for the motion of the tool; Q = W / (u dt) does not depend on rate, grid or number of points.
///   Bone that falls below the minimum density is cleared. The work of clearing is subtracted from the next steps.
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
  float exposure;    ///< [1/rev] sum of the erosion factors, by volume; lambda of law `rate` is spin x exposure
  float radius;      ///< [m] from the tool's axis
};

struct EnergyTerm {
  double worth;  ///< [J] >= 0 work that removes all bone of the voxel
  double rate;   ///< [1/rev] > 0: x / h
};

/// @returns k [rev]; 0 for work <= 0, +infinity if the work removes all terms. Newton's method from 0: the sum is concave, so the iterates
/// increase and stay below the root. At most 100 steps, relative residual 1e-12.
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

/// @returns the mean radius [m] of a whole tool, weighted by exposure, for laws without a list of engaged voxels; 0 if nothing cuts.
[[nodiscard]] double rubbing_radius(const ErosionPoints& points) noexcept;

/// @returns M = mu F r [N m]. The power 2 pi n M is the power of the law. The power of the feed, F times the feed speed, is neglected: a
/// thousandth of it or less. @param cutting_ratio mu [-]. @param force F [N]. @param radius r [m].
[[nodiscard]] double cutting_torque(double cutting_ratio, double force, double radius) noexcept;

/// Engaged voxels from erosion points, for removal by whole voxels.
class EngagedScatter {
 public:
  /// Appends the voxels with bone that contain points, in the order met. @param cell_share [-] (pitch of points / voxel edge)^3.
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
