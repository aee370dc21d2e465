/// core/drill/coverage_kernels.h: which of a voxel's samples a tool has met, a vector of samples at a time; inside of coverage.cpp.
///   Frame  nodes of the cutting field.   Bits  those of FieldSampler and of the plain form in coverage.cpp, at every SIMD level.
#pragma once

#include <cstdint>

namespace burrhole {

/// One voxel in one sub-step. Arrays hold kCoverageSamples values.
struct MeetJob {
  const float* distance;    ///< [m] of the field's nodes
  std::int32_t row, slab;   ///< strides
  float end[3];             ///< [nodes] last node of each axis
  const float *x, *y, *z;   ///< [nodes] samples from the centre
  const float* far;         ///< [m] the same as lengths
  float centre[3];          ///< [nodes] of the voxel, in the middle of the sub-step
  float slope[3];           ///< [m] per node, of the distance there
  float deeper[3];          ///< [nodes] from the middle to the end of the way that lies deeper
  float closest;            ///< [m] distance of the centre
  float spare, bend, sway;  ///< [m], [1/m], [m/m]: lower bound of a sample's distance, see coverage.cpp
  float half_way, slack;    ///< [m]
  bool straight;            ///< whether the ends of the way tell all
};

struct MeetMasks {
  std::uint64_t met = 0;     ///< inside the tool at some time
  std::uint64_t unsure = 0;  ///< to be asked one by one: outside the table, or on a way whose ends do not tell
};

/// @param asked bits of the samples to look at.
[[nodiscard]] MeetMasks meet_samples(const MeetJob& job, std::uint64_t asked) noexcept;

}  // namespace burrhole
