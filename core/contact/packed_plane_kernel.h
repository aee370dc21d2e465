/// core/contact/packed_plane_kernel.h: the vector part of packed_plane: what it is told and what it gives.
///   Frame  places relative to the window's first voxel.   Units  1/16384 voxel where whole numbers, SI else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/contact_model.h"

/// Of a lambda in a kernel: code of the kernel's target, and no call. Left to itself GCC calls some, and passes vectors through memory.
#define BH_LANES HWY_ATTR __attribute__((always_inline))

namespace burrhole {

inline constexpr int kFractionBits = 14;
inline constexpr std::int32_t kVoxel = 1 << kFractionBits, kHalf = kVoxel / 2;
inline constexpr int kBatch = 64, kSums = 16, kPlanePad = 64;
inline constexpr int kPointBits = 20;  // of a queued tag; above it 0, or 1 + the corner of the cell that the walk starts from

/// Constants of one evaluation. Matrices row by row. Places are relative to the window's first voxel.
struct PackedJob {
  const std::int32_t* words;
  std::int32_t size[3], row, slab;
  std::array<const double*, 3> position{};
  std::array<const float*, 3> inward{};
  int count;
  double index_from_tool[3][4] = {}, world_from_index[3][4] = {}, origin[3] = {};
  float steps_from_tool[3][3] = {}, way_from_index[3][3] = {}, normal_from_gradient[3][3] = {}, world_from_tool[3][3] = {};
  std::int32_t solid;  // least density of a solid voxel
  bool trilinear;      // which rule says what collides
  std::int32_t max_march, max_ascent;
  const std::uint32_t* point;
  bool listed;  // contacts are wanted
};

/// Partial sums: force, torque, and xx xy xz yy yz zz of the normals of those under the plane.
struct PackedSums {
  alignas(64) double part[12][kSums] = {};
  alignas(64) float deepest[kSums] = {};  // [m]
  std::size_t touching = 0;
};

/// Points that touch and wait for their walk. Places as whole numbers, half a voxel added, so that a shift gives the voxel.
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

/// Adds to the sums, and to the flags and, where they are listed, the contacts of `out`.
void evaluate_packed(const PackedJob& job, PackedSums& sums, ContactResult& out) noexcept;

}  // namespace burrhole
