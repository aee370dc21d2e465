/// core/drill/engaged_kernels.h: what is left of engaged voxels, a vector of them at a time; inside of engaged_removal.cpp.
#pragma once

#include <cstddef>

namespace burrhole {

/// left = available x exp(-turns x exposure / hardness), the bits of portable_exp; 0 where that is under 1e-307. Arrays hold whole vectors:
/// up to 7 entries past `count` are read and written.
struct DecayJob {
  std::size_t count;
  double turns;
  const float *available, *exposure, *hardness;
  float* left;
};

void decay(const DecayJob& job) noexcept;

}  // namespace burrhole
