/// core/voxel/surface_tile.h: the steps from density to records over one tile, and their scratch memory. Private to surface_records.cpp.
///   Layout  every field is dense over `padded`, i fastest, so an offset means the same voxel in all of them. The cell of an offset is the
///           cube between that voxel and its upper neighbours; a surfel is a point of the 0.5 surface in a cell, at most one per cell.
///   Frame   index, unless stated.   Errors  none.
///   Bits    positions are relative to their cell and differences of cells are integers, so results do not depend on the tile's position.
///   Thread  one.   Source  own derivation, shown in surface_records.cpp.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/surface_records.h"

namespace burrhole {

inline constexpr std::size_t kMostLanes = 16;  ///< of a vector, at any level
inline constexpr float kBand2 = static_cast<float>(kRecordBand * kRecordBand);

/// Row-major maps between index axes and metric axes in units of voxel edges, and the range of a surfel's influence.
struct SurfaceMap {
  explicit SurfaceMap(const Affine& bone_from_index);

  std::array<std::array<float, 3>, 3> metric_from_index{}, index_from_metric{};  ///< [-]
  float fan = 1.0f;   ///< [voxel unit] radius, in edges, of the surface patch that a surfel represents; beyond it, the surfel is an edge
  Vec3i spread{3};    ///< [voxels] a surfel of cell c is in the band of voxels c - spread .. c + 1 + spread only
  int code_bits = 3;  ///< [bits] per axis of the code of a cell's position relative to a voxel: -spread - 1 .. spread

  /// @returns the distance up to which densities affect a record: spread, the cell's far corner, gradients one cell further, their stencil
  /// of two.
  [[nodiscard]] Vec3i reach() const noexcept { return spread + 4; }
  /// @returns the mask of the position code in a key. The upper bits are those of the squared distance as a float, which sort like its
  /// value.
  [[nodiscard]] std::uint32_t code_mask() const noexcept { return (1u << (3 * code_bits)) - 1u; }
  /// @returns the key of a voxel without a surfel in the band: the half width of the band.
  [[nodiscard]] std::uint32_t far_key() const noexcept { return std::bit_cast<std::uint32_t>(kBand2) & ~code_mask(); }
};

struct Surfel {
  float x, y, z;      ///< [-] position in its cell, 0..1
  std::int32_t cell;  ///< packed position in the tile, pack_position()
  float nx, ny, nz;   ///< [-] outward unit normal, metric axes; zero where the gradient is zero
  float bend;         ///< [1/voxel] change of the normal across its cell, per voxel edge
};
static_assert(sizeof(Surfel) == 32);

/// Gradient of the smoothed density, and the density.
struct FieldSample {
  float gx, gy, gz, density;  ///< [1/voxel] index axes; density [-]
};

struct SurfaceTile {
  VoxelBox records;  ///< records to be computed
  VoxelBox cells;    ///< cells of the window whose surfels may affect these records
  VoxelBox padded;
  int row = 0, slab = 0;  ///< strides
  int words = 0;          ///< of 64 voxels a row, in the fields of bits below

  std::vector<float> density, plane;       ///< [-] plane: five slabs, for the smoothing
  std::vector<FieldSample> samples;        // where `wanted` only
  std::vector<std::uint64_t> solid;        // bits of voxels of density 0.5 and more
  std::vector<std::uint64_t> wanted;       // bits of voxels whose gradient is required: those near a cell that contains the surface
  std::vector<std::uint64_t> widened;      // scratch: one slab of bits, twice, for the smoothing
  std::size_t found = 0;                   // number of cells that contain the surface, and of surfels
  std::vector<std::int32_t> cell_offsets;  // `found`, then the last again for a vector's length
  std::vector<Surfel> surfels;             // likewise; `cell` from find_cells(), all else from make_surfels()
  std::vector<std::int32_t> surfel_at;     // by cell; of those found only
  std::vector<std::uint32_t> nearest;      // by voxel: squared distance above, place of the cell as code below, so the least is the nearest

  std::size_t near = 0;                  // voxels within the band
  std::vector<std::int32_t> voxels;      // their packed positions, the last repeated as above
  std::vector<std::uint32_t> low, high;  // their records: distance and x, y and z (16 bits each); all four (8 bits each)

  /// Sets the boxes and resizes the fields; allocates only for a tile larger than all before.
  void lay_out(const VoxelBox& to_make, const VoxelBox& window, const SurfaceMap& map);
  [[nodiscard]] int offset_of(const Vec3i& v) const noexcept {
    return (v.x - padded.lo.x) + row * (v.y - padded.lo.y) + slab * (v.z - padded.lo.z);
  }
};

/// Position in the padded box, ten bits an axis.
[[nodiscard]] inline std::int32_t pack_position(int i, int j, int k) noexcept { return i | (j << 10) | (k << 20); }
[[nodiscard]] inline Vec3i unpack_position(std::int32_t p) noexcept { return {p & 1023, (p >> 10) & 1023, p >> 20}; }

/// Copies the density of the padded box and marks solid voxels. Outside of the window the nearest voxel of the window is used.
void copy_density(const MasterWindow& window, SurfaceTile& tile) noexcept;
/// Finds the cells that contain the surface, sorted by k, j, i, and marks the voxels whose gradients are required.
void find_cells(SurfaceTile& tile) noexcept;
/// Computes `samples` at the marked voxels.
void smooth_gradient(SurfaceTile& tile) noexcept;
/// Computes one surfel per cell found.
void make_surfels(const SurfaceMap& map, SurfaceTile& tile) noexcept;
/// Finds the nearest surfel of each voxel in the band.
void find_nearest(const SurfaceMap& map, SurfaceTile& tile) noexcept;
/// Fills `voxels` and their records, `low` and `high`.
void make_records(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) noexcept;
/// Fills one row with the record of voxels outside of the band, with the sign given by `density`.
void fill_far(const float* density, std::size_t length, Record8* out) noexcept;
void fill_far(const float* density, std::size_t length, Record16* out) noexcept;

}  // namespace burrhole
