/// core/voxel/surface_tile.h: the steps from density to records over one tile, and their scratch memory. Private to surface_records.cpp.
///   Layout  all arrays cover `padded`, i fastest, so one offset addresses the same voxel in each. The cell at an offset is the cube between
///           the centres of that voxel and of its next neighbours in i, j and k. A surfel is a point with a normal on the 0.5 surface in a
///           cell, at most one per cell.
///   Frame   index, unless stated.   Errors  none.
///   Reproducible  positions are relative to their cell and differences of cells are integers, so results do not depend on the tile's position.
///   Thread  one.   Source  own derivation, shown in surface_records.cpp.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/surface_records.h"

namespace burrhole {

inline constexpr std::size_t kMaxLanes = 16;  ///< floats of the largest SIMD vector
/// [voxel edges^2] squared half width of the band of records.
inline constexpr float kBand2 = static_cast<float>(kRecordBand * kRecordBand);

/// Row-major maps between index axes and metric axes, and the range of a surfel's influence. Unit of the metric axes: the mean voxel edge
/// (Affine::mean_edge()), "voxel edge" below.
struct SurfaceMap {
  explicit SurfaceMap(const Affine& bone_from_index);

  std::array<std::array<float, 3>, 3> metric_from_index{}, index_from_metric{};  ///< [-]
  float patch_radius = 1.0f;  ///< [voxel edges] of the flat disc that a surfel represents; farther points take the distance to its rim
  Vec3i spread{3};            ///< [voxels] only voxels c - spread .. c + 1 + spread can have the surfel of cell c within their band
  int code_bits = 3;          ///< [bits] per axis of the position code: cell minus voxel, -spread - 1 .. spread

  /// @returns the distance [voxels] up to which densities affect a record: spread + 1 (far corner of the cell) + 1 (neighbour of the gradient)
  /// + 2 (smoothing stencil).
  [[nodiscard]] Vec3i reach() const noexcept { return spread + 4; }
  /// Key of a voxel: the bits of the squared distance to a surfel as a float [voxel edges^2], the lowest replaced by the position code of the
  /// surfel's cell. Keys sort by distance. @returns the mask of the position code.
  [[nodiscard]] std::uint32_t code_mask() const noexcept { return (1u << (3 * code_bits)) - 1u; }
  /// @returns the key of a voxel without a surfel in the band: the squared half width of the band.
  [[nodiscard]] std::uint32_t far_key() const noexcept { return std::bit_cast<std::uint32_t>(kBand2) & ~code_mask(); }
};

struct Surfel {
  float x, y, z;      ///< [-] position in its cell, 0..1
  std::int32_t cell;  ///< packed position in the tile, pack_position()
  float nx, ny, nz;   ///< [-] outward unit normal, metric axes; zero where the gradient is zero
  float bend;         ///< [1/voxel edge] curvature: sine of the largest angle between this normal and those at the cell's corners
};
static_assert(sizeof(Surfel) == 32);

/// Gradient of the smoothed density, and the density.
struct FieldSample {
  float gx, gy, gz, density;  ///< gradient [1/voxel], index axes; density [-]
};

struct SurfaceTile {
  VoxelBox records;       ///< voxels whose records are computed
  VoxelBox cells;         ///< cells of the window whose surfels may affect these records
  VoxelBox padded;        ///< `cells` and their stencils
  int row = 0, slab = 0;  ///< [voxels] strides of j and k
  int words = 0;          ///< 64-bit words per row of the bit fields below

  std::vector<float> density, plane;       ///< [-] plane: scratch of the smoothing, a ring of five slabs
  std::vector<FieldSample> samples;        // valid at voxels marked in `wanted`
  std::vector<std::uint64_t> solid;        // bits of voxels of density 0.5 and more
  std::vector<std::uint64_t> wanted;       // bits of voxels whose gradient is required: those near a cell that contains the surface
  std::vector<std::uint64_t> widened;      // scratch of the smoothing: two slabs of bits
  std::size_t found = 0;                   // number of cells that contain the surface, and of surfels
  std::vector<std::int32_t> cell_offsets;  // `found` entries, padded to a full vector by repeating the last
  std::vector<Surfel> surfels;             // padded likewise; `cell` from find_cells(), the rest from make_surfels()
  std::vector<std::int32_t> surfel_at;     // index of the surfel of a cell; valid for the cells found
  std::vector<std::uint32_t> nearest;      // per voxel: smallest key, that of the nearest surfel

  std::size_t near = 0;                  // number of voxels within the band
  std::vector<std::int32_t> voxels;      // their packed positions, padded likewise
  std::vector<std::uint32_t> low, high;  // their records; bits16: low = distance, x and high = y, z; bits8: low = all four

  [[nodiscard]] std::uint64_t bytes() const noexcept;  ///< [bytes] of all arrays
  /// Sets the boxes and resizes the arrays; allocates only if the tile is larger than any earlier one. What the arrays held is lost.
  void lay_out(const VoxelBox& to_make, const VoxelBox& window, const SurfaceMap& map);
  [[nodiscard]] int offset_of(const Vec3i& v) const noexcept {
    return (v.x - padded.lo.x) + row * (v.y - padded.lo.y) + slab * (v.z - padded.lo.z);
  }
};

/// Position in the padded box, 0 .. 1023 per axis.
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
/// Fills a row of `length` voxels with the record of voxels outside the band, with the sign given by `density`.
void fill_far(const float* density, std::size_t length, Record8* out) noexcept;
void fill_far(const float* density, std::size_t length, Record16* out) noexcept;

}  // namespace burrhole
