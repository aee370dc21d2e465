/// volumes/phantom/pore_field.h: the pores of diploe as the low parts of a smooth random field.
///   Frame  bone frame, any point.   Units  SI.   Errors  none.   Thread  any; immutable once calibrated.
///   The field depends on point and seed only, its threshold on the given samples: equal samples give equal pores on any grid.
///   Source own derivation (value noise on a rotated cubic lattice), shown in pore_field.cpp.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/geometry.h"
#include "core/base/random.h"

namespace burrhole {

class PoreField {
 public:
  /// Chooses the threshold so that a share `porosity` (0..1) of the sample points lies in pores. @param pore_size [m] > 0, mean width of a
  /// pore. With N samples the share has a standard error of about sqrt(porosity (1 - porosity) / N).
  [[nodiscard]] static PoreField calibrated(std::uint64_t seed, double pore_size, double porosity, std::span<const Vec3> samples);

  /// @returns the smooth field, 0..1, twice continuously differentiable.
  [[nodiscard]] double value(const Vec3& p_bone) const noexcept;
  [[nodiscard]] bool in_pore(const Vec3& p_bone) const noexcept { return value(p_bone) < threshold_; }
  /// @returns the share of pore in a voxel: 1 in a pore, 0 outside, a ramp of about `width` [m] > 0 between; 0.5 on the wall of the pore.
  [[nodiscard]] double share(const Vec3& p_bone, double width) const noexcept;

 private:
  PoreField(std::uint64_t seed, double lattice_edge) : seed_(seed), lattice_edge_(lattice_edge) {}

  std::uint64_t seed_;
  double lattice_edge_;  ///< [m]
  double threshold_ = 0.0;
};

}  // namespace burrhole
