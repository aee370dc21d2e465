// The cells that the surface passes, and the voxels about them, by bits: 64 voxels of a row at once.
#include <bit>

#include "core/voxel/surface_tile.h"

namespace burrhole {
namespace {

/// Bits first..last - 1 of a row, as they lie in its word w.
std::uint64_t range_bits(int first, int last, int w) noexcept {
  const auto below = [&](int n) {
    return n <= 64 * w ? 0 : n >= 64 * (w + 1) ? ~std::uint64_t{0} : (std::uint64_t{1} << (n - 64 * w)) - 1;
  };
  return below(last) & ~below(first);
}

/// Word w of the cells of row (j, k) that have corners on both sides.
std::uint64_t cells_passed(const SurfaceTile& tile, int j, int k, int w) noexcept {
  const int height = tile.slab / tile.row;
  std::uint64_t any = 0, all = ~std::uint64_t{0}, next_any = 0, next_all = ~std::uint64_t{0};
  for (const int z : {k, k + 1})
    for (const int y : {j, j + 1}) {
      const std::uint64_t* const bits = tile.solid.data() + (z * height + y) * tile.words + w;
      any |= bits[0];
      all &= bits[0];
      if (w + 1 == tile.words) continue;
      next_any |= bits[1];
      next_all &= bits[1];
    }
  any |= (any >> 1) | (next_any << 63);
  all &= (all >> 1) | (next_all << 63);
  return any & ~all;
}

/// A record asks for gradients at the corners of cells up to one from that of its surfel: from -1 to +2 of it on each axis.
void want_about(SurfaceTile& tile, int j, int k, int w, std::uint64_t passed) noexcept {
  const int height = tile.slab / tile.row;
  const std::uint64_t here = passed | (passed << 1) | (passed << 2) | (passed >> 1);
  const std::uint64_t after = (passed >> 63) | (passed >> 62), before = passed << 63;
  for (int z = k - 1; z <= k + 2; ++z)
    for (int y = j - 1; y <= j + 2; ++y) {
      std::uint64_t* const bits = tile.wanted.data() + (z * height + y) * tile.words + w;
      bits[0] |= here;
      if (w + 1 < tile.words) bits[1] |= after;
      if (w > 0) bits[-1] |= before;
    }
}

}  // namespace

void find_cells(SurfaceTile& tile) noexcept {
  const VoxelBox cells{tile.cells.lo - tile.padded.lo, tile.cells.hi - tile.padded.lo};
  std::fill_n(tile.wanted.data(), tile.slab / tile.row * tile.words * tile.padded.size().z, 0);
  std::size_t found = 0;
  for (int k = cells.lo.z; k < cells.hi.z; ++k)
    for (int j = cells.lo.y; j < cells.hi.y; ++j)
      for (int w = 0; w < tile.words; ++w) {
        std::uint64_t passed = cells_passed(tile, j, k, w) & range_bits(cells.lo.x, cells.hi.x, w);
        if (passed == 0) continue;
        want_about(tile, j, k, w, passed);
        const std::size_t most = found + 64 + kMaxLanes;
        if (tile.surfels.size() < most) tile.surfels.resize(2 * most);
        for (; passed != 0; passed &= passed - 1) {
          const int i = 64 * w + std::countr_zero(passed), offset = i + j * tile.row + k * tile.slab;
          tile.cell_offsets[found] = offset;
          tile.surfels[found].cell = pack_position(i, j, k);
          tile.surfel_at[static_cast<std::size_t>(offset)] = static_cast<std::int32_t>(found);
          ++found;
        }
      }
  tile.found = found;
  if (found > 0) std::fill_n(tile.cell_offsets.data() + found, kMaxLanes, tile.cell_offsets[found - 1]);
}

}  // namespace burrhole
