/// core/drill/coverage_kernels.h: SIMD evaluation of voxels and samples in a cutting field. Internal to coverage.cpp.
///   Frame  nodes of the cutting field.   Units  as each member states.   Errors  none.
///   Bits  equal to FieldSampler and to the scalar form in coverage.cpp, at every SIMD level.
#pragma once

#include <cstddef>
#include <cstdint>

namespace burrhole {

/// Lists are read and written in whole vectors: they need this many entries beyond the last one.
inline constexpr std::size_t kPlacePad = 8;

/// A cutting field and the transform from voxels to its nodes.
struct PlaceJob {
  const float *distance, *factor;  ///< [m], [1/rev] of the field's nodes
  std::int32_t row, slab;          ///< [nodes] offsets of a row and of a slab
  float end[3];                    ///< [nodes] last node of each axis
  double linear[3][3], offset[3];  ///< [nodes] nodes from index, column by column
  double margin, pitch;            ///< [m] of the field
  double origin[3];                ///< [m] of the field
  double ramp;                     ///< [m] w of coverage.h
};

/// Index coordinates of voxels, as arrays.
struct VoxelList {
  std::size_t count;
  const std::int32_t *i, *j, *k;  ///< [voxels]
};

/// Positions of voxels in the field, as arrays.
struct PlaceList {
  float *x, *y, *z;  ///< [nodes]
  float* distance;   ///< [m]
};

/// Input: covered share and its growth per voxel. Output: exposure and radius.
struct WeighList {
  std::size_t count;
  PlaceList at;
  const float *share, *grown;  ///< [-] covered share; [-] its growth in this sub-step
  float *exposure, *radius;    ///< [1/rev] 0 if not exposed; [m] from the tool's axis
};

/// One voxel and 64 of its samples in one sub-step. Arrays hold kCoverageSamples values.
struct MeetJob {
  const float* distance;    ///< [m] of the field's nodes
  std::int32_t row, slab;   ///< [nodes] offsets of a row and of a slab
  float end[3];             ///< [nodes] last node of each axis
  const float *x, *y, *z;   ///< [nodes] samples relative to the centre
  const float* far;         ///< [m] their distances from the centre
  float centre[3];          ///< [nodes] of the voxel, at the middle of the sub-step
  float slope[3];           ///< [m/nodes] gradient of the distance at the centre
  float deeper[3];          ///< [nodes] from the middle to the deeper end of the travel
  float closest;            ///< [m] distance of the centre
  float spare, bend, sway;  ///< [m], [1/m], [m/m]: lower bound of the distance of a sample, see coverage.cpp
  float half_way, slack;    ///< [m] half the travel; tolerance
  bool straight;            ///< the ends of the travel decide
};

struct MeetMasks {
  std::uint64_t met = 0;     ///< bits of samples that were inside the tool at some time
  std::uint64_t unsure = 0;  ///< bits to test one by one: outside the table, or on a travel whose ends do not decide
  float nearest = 0.0f;  ///< [m] least distance of the other requested samples at the middle of the sub-step; infinite if there are none
};

/// Evaluates FieldSampler::distance at each voxel's centre.
void measure_places(const PlaceJob& job, const VoxelList& voxels, const PlaceList& out) noexcept;
void weigh_places(const PlaceJob& job, const WeighList& list) noexcept;
/// @param asked bits of the samples to evaluate.
[[nodiscard]] MeetMasks meet_samples(const MeetJob& job, std::uint64_t asked) noexcept;

}  // namespace burrhole
