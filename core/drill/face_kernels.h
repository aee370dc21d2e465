/// core/drill/face_kernels.h: SIMD kernels of the receding face (cut_face.h, whose symbols they use).
///   Frame  places in nodes of the cutting field.   Units  as each member states; [voxel unit] in voxel edges.   Errors  none.
///   Thread  simulation.   Bits  equal at every SIMD level: lanes do not depend on each other, and nothing is summed.
///   Lists are read and written in whole vectors: each needs kFieldPad entries beyond its last one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/tool/field_kernels.h"
#include "core/voxel/cut_surface.h"

namespace burrhole {

/// A sub-step's tool.
struct FaceTool {
  FieldJob field;
  float edge;                        ///< [m] voxel edge
  std::array<float, 3> along;        ///< [nodes] u, per voxel edge
  float follow;                      ///< [voxel unit] from the tool, up to which faces are followed
  float free;                        ///< [voxel unit] a node without bone further out than this no longer changes
  float known;                       ///< [voxel unit] a node with phi <= -known has no known distance
  std::array<float, 9> normal_from;  ///< [-] rows: direction in the bone frame from a gradient in nodes
};

/// The voxels whose face overlaps the tool, as lists.
struct FaceNodes {
  std::size_t count = 0;
  std::vector<std::uint32_t> at;         ///< offset into the window
  std::vector<std::uint32_t> inside;     ///< place in the block
  std::vector<float> x, y, z;            ///< [nodes] place
  std::vector<float> tool;               ///< [voxel unit] D
  std::vector<float> cut, base;          ///< [voxel unit] phi, and the distance to the surface when the node was set
  std::vector<std::uint8_t> cut_before;  ///< 1: the voxel had lost bone then
  std::vector<float> wear;               ///< [1/rev] e / h
  std::vector<float> behind;             ///< [voxel unit] l; 0: there is none, and phi + a w applies
  std::vector<float> rest;               ///< [voxel unit] error of l: -D(p - l u) - phi
  /// Makes room for `more` entries beyond the last.
  void make_room(std::size_t more);
  [[nodiscard]] static constexpr std::size_t bytes_of_node() noexcept { return 2 * sizeof(std::uint32_t) + 9 * sizeof(float) + 1; }
};

/// One block of 8^3 voxels to be searched. Arrays of voxels begin at the block's first voxel.
struct BlockSearch {
  std::array<float, 3> first, step_i, step_j, step_k;  ///< [nodes] place of the first voxel; steps along the axes
  const float *occupancy, *remaining;                  ///< [-]
  std::size_t row, slab;                               ///< offsets of a row and a slab of these two
  std::uint32_t at;                                    ///< offset of the block's first voxel into the window
  std::uint32_t window_row, window_slab;               ///< offsets of a row and a slab of the window
  const float *base, *cut;                             ///< [voxel unit] of the block's nodes
  std::uint32_t parts;                                 ///< bit i + 2 j + 4 k: the part of 4^3 voxels is searched
  std::array<int, 3> lo, hi;                           ///< [voxels] range in the block
};

/// What a search found beside the nodes.
struct BlockFound {
  /// [voxel unit] per part, least D of the voxels that may change; FLT_MAX: there are none.
  std::array<float, 8> nearest;
  /// [voxel unit] per part, by how much D may fall before a further face overlaps the tool, nodes of `lacking` left out; FLT_MAX: no limit.
  std::array<float, 8> room;
  /// Place in the block of the nodes within `follow` of the tool without a known distance, and D [voxel unit].
  std::array<std::uint32_t, kBlockVoxels + kFieldPad> lacking;
  std::array<float, kBlockVoxels + kFieldPad> lacking_tool;  ///< [voxel unit]
  std::size_t lacking_count;
};

/// Appends the nodes of a block whose face overlaps the tool, ordered by k, j, i. Room for 512 entries must be there.
void search_block(const FaceTool& tool, const BlockSearch& block, FaceNodes& nodes, BlockFound& found) noexcept;

/// Fills `wear`. @param hardness [-] of the window. @param least [-] smallest hardness of the law.
void find_wear(const FaceTool& tool, const float* hardness, float least, FaceNodes& nodes) noexcept;

/// @param out a of each node, 1 - exp(-turns wear), with a relative error below 1e-6. @param turns [rev] >= 0.
void find_shares(const FaceNodes& nodes, float turns, float* out) noexcept;

/// Fills `behind` and `rest`. The search of each lag starts at `usual`. It is a secant, bounded below by the missing distance itself, since
/// distances change by at most the travel. A lag that does not settle belongs to a face along u, which the normal decides.
/// @param usual [voxel unit] usual lag. @param longest [voxel unit] largest lag that is searched for.
void find_lags(const FaceTool& tool, float usual, float longest, FaceNodes& nodes) noexcept;

/// Computes phi after a sub-step. @param shares a of each node. @param after [voxel unit] phi. @param back [voxel unit] along u, from the
/// node to the place whose normal the face has.
void recede_nodes(const FaceTool& tool, const FaceNodes& nodes, const float* shares, float* after, float* back) noexcept;

/// @param from [voxel unit] signed distances. @param steps [steps] of kRecord16Distance, within the band.
void quantise_distances(const float* from, const float* other, std::size_t count, std::int16_t* steps) noexcept;

/// Outward normals of the tool's surface, reversed: those of the face. @param normals [steps] of kRecord16Normal: arrays x, y, z; all zero
/// where the gradient is.
void find_normals(const FaceTool& tool, const PlaceList& places, std::array<std::int16_t*, 3> normals) noexcept;

}  // namespace burrhole
