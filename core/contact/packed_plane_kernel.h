/// core/contact/packed_plane_kernel.h: inputs and outputs of the vector kernel of packed_plane.
///   Frame  positions relative to the window's first voxel.   Units  1/16384 voxel for whole numbers, SI otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/penalty_model.h"

/// Attributes of a lambda in a kernel: compiled for the kernel's target and inlined. Without them GCC calls some and passes vectors through
/// memory.
#define BH_LANES HWY_ATTR __attribute__((always_inline))

namespace burrhole {

inline constexpr int kFractionBits = 14;
inline constexpr std::int32_t kVoxel = 1 << kFractionBits, kHalf = kVoxel / 2;
inline constexpr int kBatch = 64, kSums = 16, kPlanePad = 64;
inline constexpr int kPointBits = 20;  // of a queued tag; above it 0, or 1 + the corner of the cell that the walk starts from

/// Constants of one evaluation. Matrices are row by row. Positions are relative to the window's first voxel.
struct PackedJob {
  const std::int32_t* words;
  std::int32_t size[3], row, slab;
  std::array<const double*, 3> position{};
  std::array<const float*, 3> inward{};
  int count;
  double index_from_tool[3][4] = {}, world_from_index[3][4] = {}, origin[3] = {};  // [voxels/m], [m/voxel], [m]
  // Rotations and scales of directions, [voxels/m], [m/voxel], [voxels/m], [-].
  float steps_from_tool[3][3] = {}, way_from_index[3][3] = {}, normal_from_gradient[3][3] = {}, world_from_tool[3][3] = {};
  std::int32_t solid;                  // least density of a solid voxel
  bool trilinear;                      // whether collision uses the trilinear density
  std::int32_t max_march, max_ascent;  // [voxels]
  const std::uint32_t* point;
  bool listed;  // contacts are requested
};

/// Partial sums: force, torque, and xx xy xz yy yz zz of the normals of points below their plane.
struct PackedSums {
  alignas(64) double part[12][kSums] = {};
  alignas(64) float deepest[kSums] = {};  // [m]
  std::size_t touching = 0;
};

/// Touching points before their march. Positions are whole numbers plus half a voxel, so that a shift gives the voxel.
struct TouchQueue {
  static constexpr int kRoom = kBatch + 16;
  alignas(64) std::int32_t x[kRoom], y[kRoom], z[kRoom], word[kRoom], tag[kRoom];
  alignas(64) float inward[3][kRoom];
  int size = 0;
};

struct PackedPlanes {
  alignas(64) double position[3][kBatch];
  alignas(64) float way[3][kBatch], normal[3][kBatch], depth[kBatch];
  alignas(64) std::int32_t found[kBatch];
};

/// Adds to the sums, to the flags of `out`, and, if requested, to its contacts.
void evaluate_packed(const PackedJob& job, PackedSums& sums, ContactResult& out) noexcept;

}  // namespace burrhole
