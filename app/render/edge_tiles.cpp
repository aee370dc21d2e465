#include "app/render/edge_tiles.h"

#include <algorithm>
#include <cstring>

#include "app/render/renderer.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

/// Least and largest value of each channel in three rows of pixels, one above the other.
struct RowRange {
  std::vector<std::uint8_t> least, most;

  void set(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, std::size_t bytes) {
    least.resize(bytes);
    most.resize(bytes);
    for (std::size_t i = 0; i < bytes; ++i) {
      least[i] = std::min(std::min(above[i], row[i]), below[i]);
      most[i] = std::max(std::max(above[i], row[i]), below[i]);
    }
  }
};

}  // namespace

int tile_side(const RenderOptions& options) noexcept {
  return options.supersample > 1 && options.edge_threshold > 0 && !options.slices && !options.translucent ? kEdgeTile : 0;
}

void EdgeTiles::resize(const Vec2i& size) {
  if (size == size_) return;
  size_ = size;
  columns_ = (size.x + kEdgeTile - 1) / kEdgeTile;
  const int rows = (size.y + kEdgeTile - 1) / kEdgeTile;
  marked_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), 0);
}

void EdgeTiles::mark(const PixelRect& tiles, const Image& part, int threshold) {
  const PixelRect around = tiles.grown(1).intersect({Vec2i(0), size_});
  BH_ASSERT(part.width == around.size().x && part.height == around.size().y);
  static_assert(sizeof(Rgba8) == 4);
  const auto bytes = static_cast<std::size_t>(4 * part.width);
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(part.pixels.data());
  const auto row_at = [&](int y) {  // of the picture; beyond its edge that of the edge
    return pixels + bytes * static_cast<std::size_t>(around.hi.y - 1 - std::clamp(y, around.lo.y, around.hi.y - 1));
  };
  RowRange range;
  std::vector<std::uint8_t> differs(bytes);
  for (int y = tiles.lo.y; y < tiles.hi.y; ++y) {
    std::uint8_t* const line = marked_.data() + static_cast<std::ptrdiff_t>(y / kEdgeTile) * columns_;
    if (y % kEdgeTile == 0) std::fill(line + tiles.lo.x / kEdgeTile, line + (tiles.hi.x + kEdgeTile - 1) / kEdgeTile, std::uint8_t{0});
    range.set(row_at(y + 1), row_at(y), row_at(y - 1), bytes);
    const std::uint8_t *least = range.least.data(), *most = range.most.data();
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t left = i < 4 ? i : i - 4, right = i + 4 < bytes ? i + 4 : i;
      const int high = std::max(std::max(most[left], most[i]), most[right]), low = std::min(std::min(least[left], least[i]), least[right]);
      differs[i] = static_cast<std::uint8_t>(high - low > threshold);
    }
    for (int x = tiles.lo.x; x < tiles.hi.x; ++x) {
      std::uint32_t any = 0;
      std::memcpy(&any, differs.data() + 4 * (x - around.lo.x), 4);
      if (any != 0) line[x / kEdgeTile] = 1;
    }
  }
}

void EdgeTiles::append(const PixelRect& rect, bool marked, std::vector<PixelRect>& out) const {
  const PixelRect inside = rect.intersect({Vec2i(0), size_});
  if (inside.empty()) return;
  const Vec2i first = inside.lo / kEdgeTile, last = (inside.hi - 1) / kEdgeTile;
  for (int row = first.y; row <= last.y; ++row) {
    const std::uint8_t* const line = marked_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
    for (int column = first.x; column <= last.x;) {
      int end = column;
      while (end <= last.x && (line[end] != 0) == marked) ++end;
      if (end > column) out.push_back(PixelRect{kEdgeTile * Vec2i(column, row), kEdgeTile * Vec2i(end, row + 1)}.intersect(inside));
      column = std::max(end, column + 1);
    }
  }
}

}  // namespace burrhole
