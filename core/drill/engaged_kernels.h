/// core/drill/engaged_kernels.h: SIMD kernel for the remaining part of engaged voxels. Internal to engaged_removal.cpp.
///   Units  SI.   Errors  none.
#pragma once

#include <cstddef>

namespace burrhole {

/// left = available x exp(-turns x exposure / hardness) for `count` entries, with the bits of portable_exp; 0 where the exponential is
/// below 1e-307. @pre turns >= 0, exposure >= 0 and hardness > 0; turns may be infinite if exposure > 0. @pre the arrays do not overlap,
/// and each has memory for 7 entries beyond `count`: they are read, and those of `left` are overwritten.
struct DecayJob {
  std::size_t count;
  double turns;                                  ///< [rev]
  const float *available, *exposure, *hardness;  ///< [-] remaining before, [1/rev], [-]
  float* left;                                   ///< [-] remaining after
};

void decay(const DecayJob& job) noexcept;

}  // namespace burrhole
