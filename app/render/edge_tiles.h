/// app/render/edge_tiles.h: the tiles of a picture of one ray per pixel that contain edges, which get more rays. No OpenGL.
///   Frame  pixels, row 0 of rectangles at the bottom and of images at the top.   Units  pixels, levels of 255.   Errors  none.
///   Source own derivation: docs/drawing.md, "Rays at edges".
#pragma once

#include <cstdint>
#include <vector>

#include "app/render/footprint.h"
#include "app/view/view.h"

namespace burrhole {

struct RenderOptions;

/// [pixels] side of a tile. With two rays along a pixel's side a row of it is one vector of eight rays.
inline constexpr int kEdgeTile = 4;

/// @returns kEdgeTile if these options give edges more rays than other pixels, else 0.
[[nodiscard]] int tile_side(const RenderOptions& options) noexcept;

class EdgeTiles {
 public:
  /// No tile is marked afterwards if the size changes. @param size [pixels] of the picture.
  void resize(const Vec2i& size);
  /// Marks the tiles of `tiles` in which a pixel differs in a colour by more than `threshold` from another of the 3 x 3 around it, and
  /// unmarks the others. @param part the picture in `tiles` and the pixels around them, within the picture. @pre `tiles` is one of whole
  /// tiles, up to the edge of the picture.
  void mark(const PixelRect& tiles, const Image& part, int threshold);
  /// Appends the pixels of `rect` in tiles that are marked, or in those that are not, in disjoint rectangles.
  void append(const PixelRect& rect, bool marked, std::vector<PixelRect>& out) const;
  [[nodiscard]] const Vec2i& size() const noexcept { return size_; }

 private:
  Vec2i size_{0};
  int columns_ = 0;
  std::vector<std::uint8_t> marked_;
};

}  // namespace burrhole
