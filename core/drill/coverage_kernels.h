/// core/drill/coverage_kernels.h: voxels and samples looked up in a cutting field, a vector of them at a time; inside of coverage.cpp.
///   Frame  nodes of the cutting field.   Bits  those of FieldSampler and of the plain form in coverage.cpp, at every SIMD level.
#pragma once

#include <cstddef>
#include <cstdint>

namespace burrhole {

/// Lists of places are read and written in whole vectors: this many entries beyond the last.
inline constexpr std::size_t kPlacePad = 8;

/// A cutting field and the pose of voxels in it.
struct PlaceJob {
  const float *distance, *factor;  ///< [m], [1/rev] of the field's nodes
  std::int32_t row, slab;          ///< strides
  float end[3];                    ///< [nodes] last node of each axis
  double linear[3][3], offset[3];  ///< nodes from index, column by column
  double margin, pitch;            ///< [m] of the field
  double origin[3];                ///< [m] of the field
  double ramp;                     ///< [m] see coverage.h
};

/// Voxels side by side.
struct VoxelList {
  std::size_t count;
  const std::int32_t *i, *j, *k;
};

/// Where they lie.
struct PlaceList {
  float *x, *y, *z;  ///< [nodes]
  float* distance;   ///< [m]
};

/// What follows from coverage: of each place the share covered and what of it is new, to its exposure and radius.
struct WeighList {
  std::size_t count;
  PlaceList at;
  const float *share, *grown;
  float *exposure, *radius;  ///< [1/rev] 0 where nothing is exposed; [m]
};

/// One voxel and 64 of its samples in one sub-step. Arrays hold kCoverageSamples values.
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
  float nearest = 0.0f;      ///< [m] in the middle of the sub-step no other sample asked for is nearer; infinite when there is none
};

/// FieldSampler::distance of each voxel's centre.
void measure_places(const PlaceJob& job, const VoxelList& voxels, const PlaceList& out) noexcept;
void weigh_places(const PlaceJob& job, const WeighList& list) noexcept;
/// @param asked bits of the samples to look at.
[[nodiscard]] MeetMasks meet_samples(const MeetJob& job, std::uint64_t asked) noexcept;

}  // namespace burrhole
