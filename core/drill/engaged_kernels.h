/// core/drill/engaged_kernels.h: SIMD kernel for the remaining part of engaged voxels. Internal to engaged_removal.cpp.
///   Units  SI.   Errors  none.
#pragma once

#include <cstddef>

namespace burrhole {

/// left = available x exp(-turns x exposure / hardness), with the bits of portable_exp; 0 where the exponential is below 1e-307. Up to 7
/// entries beyond `count` are read and written.
struct DecayJob {
  std::size_t count;
  double turns;                                  ///< [rev]
  const float *available, *exposure, *hardness;  ///< [-], [1/rev], [-]
  float* left;                                   ///< [-]
};

void decay(const DecayJob& job) noexcept;

}  // namespace burrhole
