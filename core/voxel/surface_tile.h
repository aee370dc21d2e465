/// core/voxel/surface_tile.h: the steps from density to records over one tile, and the scratch they share; inside of surface_records.cpp.
///   Layout  every field lies over `padded`, i fastest, so one offset means one voxel in all of them. The cell of an offset is the cube
///           between that voxel and its next ones; a surfel is a point of the 0.5 surface in a cell, at most one a cell.
///   Bits    positions are kept within their cell and differences of cells are whole numbers, so no result depends on where a tile lies.
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

/// Index to metric voxel edges and back, rows first, and how far a surfel is felt.
struct SurfaceMap {
  explicit SurfaceMap(const Affine& bone_from_index);

  std::array<std::array<float, 3>, 3> metric_from_index{}, index_from_metric{};
  float fan = 1.0f;   ///< [voxel edges] a surfel speaks for the surface this far round it; further out it is the rim of what there is
  Vec3i spread{3};    ///< a surfel of cell c is within the band of voxels c - spread .. c + 1 + spread only
  int code_bits = 3;  ///< an axis of a cell's place as seen from a voxel: spread + 1 cells back to spread ahead

  /// A record depends on densities this far from it: spread, the cell's far corner, gradients one cell further, their stencil of two.
  [[nodiscard]] Vec3i reach() const noexcept { return spread + 4; }
  /// Bits of the code of a cell's place; the rest of a key is the squared distance, whose bits as a float are in its order.
  [[nodiscard]] std::uint32_t code_mask() const noexcept { return (1u << (3 * code_bits)) - 1u; }
  /// Key of a voxel that no surfel is near: the band's own distance.
  [[nodiscard]] std::uint32_t far_key() const noexcept { return std::bit_cast<std::uint32_t>(kBand2) & ~code_mask(); }
};

struct Surfel {
  float x, y, z;      ///< within its cell, 0..1
  std::int32_t cell;  ///< packed position in the tile, pack_position()
  float nx, ny, nz;   ///< outward, metric axes; zero where the field has no direction
  float bend;         ///< [1/voxel edge] how much the normal turns in its cell
};
static_assert(sizeof(Surfel) == 32);

/// Gradient of the smoothed density, index axes [1/voxel], and the density itself.
struct FieldSample {
  float gx, gy, gz, density;
};

struct SurfaceTile {
  VoxelBox records;  ///< to be made
  VoxelBox cells;    ///< whose surfels they may need: cells of the window
  VoxelBox padded;
  int row = 0, slab = 0;  ///< strides
  int words = 0;          ///< of 64 voxels a row, in the fields of bits below

  std::vector<float> density, plane;       // plane: five slabs, for the smoothing
  std::vector<FieldSample> samples;        // where `wanted` only
  std::vector<std::uint64_t> solid;        // bits of voxels of density 0.5 and more
  std::vector<std::uint64_t> wanted;       // bits of voxels whose gradient a record may ask for: those about a cell found
  std::vector<std::uint64_t> widened;      // scratch: one slab of bits, twice, for the smoothing
  std::size_t found = 0;                   // cells that the surface passes, and surfels
  std::vector<std::int32_t> cell_offsets;  // `found`, then the last again for a vector's length
  std::vector<Surfel> surfels;             // likewise; `cell` from find_cells(), all else from make_surfels()
  std::vector<std::int32_t> surfel_at;     // by cell; of those found only
  std::vector<std::uint32_t> nearest;      // by voxel: squared distance above, place of the cell as code below, so the least is the nearest

  std::size_t near = 0;                  // voxels within the band
  std::vector<std::int32_t> voxels;      // their packed positions, the last repeated as above
  std::vector<std::uint32_t> low, high;  // their records: distance and x, y and z (16 bits each); all four (8 bits each)

  /// Takes the boxes and makes room; allocates only for a tile larger than any before.
  void lay_out(const VoxelBox& to_make, const VoxelBox& window, const SurfaceMap& map);
  [[nodiscard]] int offset_of(const Vec3i& v) const noexcept {
    return (v.x - padded.lo.x) + row * (v.y - padded.lo.y) + slab * (v.z - padded.lo.z);
  }
};

/// Position in the padded box, ten bits an axis.
[[nodiscard]] inline std::int32_t pack_position(int i, int j, int k) noexcept { return i | (j << 10) | (k << 20); }
[[nodiscard]] inline Vec3i unpack_position(std::int32_t p) noexcept { return {p & 1023, (p >> 10) & 1023, p >> 20}; }

/// Density of the padded box, and what of it is solid; what lies outside the window is as the voxel next to it.
void copy_density(const MasterWindow& window, SurfaceTile& tile) noexcept;
/// Offsets of the cells that the surface passes, k, j, i rising, and where gradients are wanted.
void find_cells(SurfaceTile& tile) noexcept;
/// Samples where they are wanted.
void smooth_gradient(SurfaceTile& tile) noexcept;
/// One surfel per cell found.
void make_surfels(const SurfaceMap& map, SurfaceTile& tile) noexcept;
/// For each voxel within the band its nearest surfel.
void find_nearest(const SurfaceMap& map, SurfaceTile& tile) noexcept;
/// Fills `voxels` and their records, `low` and `high`.
void make_records(const SurfaceMap& map, RecordPrecision precision, SurfaceTile& tile) noexcept;
/// One row of "at least that far" by side, beside `density`.
void fill_far(const float* density, std::size_t length, Record8* out) noexcept;
void fill_far(const float* density, std::size_t length, Record16* out) noexcept;

}  // namespace burrhole
