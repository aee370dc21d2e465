/// core/drill/energy.h: removal by cutting power, law `energy`.
///   Units SI.   Source  facts of abrasive cutting Q = E_f F v_rel, E_f = mu / u; own derivation of its share among voxels:
///   A tool that rubs at v_rel = 2 pi r n under a normal force F does the work W = mu F v_rel dt on bone in dt, r the mean radius of what
///   is engaged, by exposure. Bone of hardness h takes u = u0 h [J/m^3] to remove, h = max(hardness, 0.1) as in law `rate`.
///   A voxel's remaining falls to r exp(-k x / h), x its exposure: the share of work that it gets goes with its exposure and with the bone
///   that it has left, and the loss per work with 1 / u. k >= 0 solves  sum of u0 h occ cell r (1 - exp(-k x / h)) = W;  the sum rises with
///   k from 0 to all the bone is worth. Exponentials compose: two half steps are one step, but for what the tool's way changes; so Q = W /
///   (u dt) does not hang on rate, grid or points.
///   What falls below the minimum density is cleared, which takes work too: that is held against the next steps.
#pragma once

#include <span>
#include <vector>

#include "core/drill/coverage.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct EnergyTerm {
  double worth;  ///< [J] >= 0 to remove all of it
  double rate;   ///< [1/rev] > 0: x / h
};

/// k [rev]: 0 for work <= 0, +infinity when the terms are worth no more than the work. By Newton's method from 0: the sum is concave, so
/// every iterate stays below the root and rises; at most 100 steps, relative residual 1e-12.
[[nodiscard]] double turns_for_work(std::span<const EnergyTerm> terms, double work) noexcept;

/// Mean radius [m] by exposure.
class RubbingRadius {
 public:
  void add(const Engaged& one) noexcept {
    const double weight = static_cast<double>(one.exposure) * static_cast<double>(one.share);
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

/// The same of a whole tool, for laws without a list of engaged voxels. 0 when nothing cuts.
[[nodiscard]] double rubbing_radius(const ErosionPoints& points) noexcept;

/// M = mu F r [N m]. Power 2 pi n M is the power of the law; the feed's, F times its speed, is left out: a thousandth of it or less.
/// @param cutting_ratio mu [-]. @param force F [N]. @param radius r [m].
[[nodiscard]] double cutting_torque(double cutting_ratio, double force, double radius) noexcept;

/// Engaged voxels by erosion points, for removal without coverage.
class EngagedScatter {
 public:
  /// Appends the voxels with bone that points lie in, in the order met. `cell_share`: (pitch of points / voxel edge)^3.
  /// @returns points beyond the erodible box.
  std::uint32_t gather(const Voxmap& voxmap, const ErosionPoints& points, const Affine& index_from_tool, double cell_share,
                       std::vector<Engaged>& engaged);

 private:
  std::vector<std::uint32_t> slot_;  // of the window's voxels in `sums_`, plus 1; 0: none
  struct Sum {
    std::uint32_t at;
    double exposure, moment;
  };
  std::vector<Sum> sums_;
};

}  // namespace burrhole
