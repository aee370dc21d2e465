/// volumes/phantom/pore_field.h: the pores of diploe as the low parts of a smooth random field.
///   Frame  bone frame, any point.   Units  SI.
///   The field depends on the point and the seed alone, its threshold on the samples given: the same samples, the same pores on any grid.
///   Source own derivation (value noise on a turned cubic lattice), shown in pore_field.cpp.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/geometry.h"
#include "core/base/random.h"

namespace burrhole {

class PoreField {
 public:
  /// Chooses the threshold so that `porosity` (0..1) of the sample points lie in pores. @param pore_size [m] > 0, mean width of a pore.
  /// Fewer samples calibrate more coarsely: the share met is uncertain by about sqrt(porosity (1 - porosity) / N).
  [[nodiscard]] static PoreField calibrated(std::uint64_t seed, double pore_size, double porosity, std::span<const Vec3> samples);

  /// @returns the smooth field, 0..1, twice continuously differentiable.
  [[nodiscard]] double value(const Vec3& p_bone) const noexcept;
  [[nodiscard]] bool in_pore(const Vec3& p_bone) const noexcept { return value(p_bone) < threshold_; }
  /// @returns the pores' share of a voxel: 1 in a pore, 0 outside, a ramp about `width` [m] > 0 wide between; 0.5 on the pore's wall.
  [[nodiscard]] double share(const Vec3& p_bone, double width) const noexcept;

 private:
  PoreField(std::uint64_t seed, double lattice_edge) : seed_(seed), lattice_edge_(lattice_edge) {}

  std::uint64_t seed_;
  double lattice_edge_;  ///< [m]
  double threshold_ = 0.0;
};

}  // namespace burrhole
