// The tiles with edges, beside a plain search of all pixels.
#include "app/render/edge_tiles.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "app/render/renderer.h"

using namespace burrhole;

namespace {

/// Mostly smooth, with a few dots.
Image dotted(const Vec2i& size, unsigned seed) {
  std::mt19937 random(seed);
  Image image{size.x, size.y, {}};
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const auto level = static_cast<std::uint8_t>(100 + x / 3 + random() % 4);
      const bool dot = random() % 90 == 0;
      image.pixels.push_back({level, static_cast<std::uint8_t>(dot ? level + 9 : level), level, 255});
    }
  return image;
}

Image cut_out(const Image& image, const PixelRect& rect) {
  Image out{rect.size().x, rect.size().y, {}};
  for (int y = rect.hi.y - 1; y >= rect.lo.y; --y)
    for (int x = rect.lo.x; x < rect.hi.x; ++x)
      out.pixels.push_back(image.pixels[static_cast<std::size_t>((image.height - 1 - y) * image.width + x)]);
  return out;
}

/// Whether a pixel within the tile of (x, y) differs from one around it.
bool has_edge(const Image& image, const Vec2i& at, int threshold) {
  const auto pixel = [&](int x, int y) { return image.pixels[static_cast<std::size_t>((image.height - 1 - y) * image.width + x)]; };
  const PixelRect all{Vec2i(0), {image.width, image.height}};
  const Vec2i lo = at / kEdgeTile * kEdgeTile;
  const PixelRect tile = PixelRect{lo, lo + kEdgeTile}.intersect(all);
  for (int y = tile.lo.y; y < tile.hi.y; ++y)
    for (int x = tile.lo.x; x < tile.hi.x; ++x) {
      const PixelRect around = PixelRect{{x - 1, y - 1}, {x + 2, y + 2}}.intersect(all);
      for (std::uint8_t Rgba8::*channel : {&Rgba8::r, &Rgba8::g, &Rgba8::b}) {
        int least = 255, most = 0;
        for (int v = around.lo.y; v < around.hi.y; ++v)
          for (int u = around.lo.x; u < around.hi.x; ++u) {
            least = std::min<int>(least, pixel(u, v).*channel);
            most = std::max<int>(most, pixel(u, v).*channel);
          }
        if (most - least > threshold) return true;
      }
    }
  return false;
}

/// @returns how often each pixel, row 0 at the bottom, is in the rectangles.
std::vector<int> covered(const std::vector<PixelRect>& rects, const Vec2i& size) {
  std::vector<int> out(static_cast<std::size_t>(size.x * size.y), 0);
  for (const PixelRect& r : rects)
    for (int y = r.lo.y; y < r.hi.y; ++y)
      for (int x = r.lo.x; x < r.hi.x; ++x) ++out[static_cast<std::size_t>(y * size.x + x)];
  return out;
}

}  // namespace

TEST_CASE("edge tiles: those that a plain search of 3 x 3 pixels finds, whole or part by part") {
  constexpr int kThreshold = 8;
  for (const Vec2i size : {Vec2i(64, 48), Vec2i(37, 29), Vec2i(3, 5)}) {
    const Image image = dotted(size, 7u);
    const PixelRect all{Vec2i(0), size};
    std::vector<PixelRect> parts{all};
    if (size.x > 8) parts.insert(parts.begin(), {PixelRect{{0, 8}, {size.x, 16}}, PixelRect{{4, 4}, {12, size.y}}});
    EdgeTiles whole, piecewise;
    whole.resize(size);
    piecewise.resize(size);
    for (const PixelRect& part : parts) piecewise.mark(part, cut_out(image, part.grown(1).intersect(all)), kThreshold);
    whole.mark(all, image, kThreshold);
    for (const EdgeTiles* tiles : {&whole, &piecewise}) {
      std::vector<PixelRect> marked, others;
      tiles->append(all, true, marked);
      tiles->append(all, false, others);
      const auto in_marked = covered(marked, size), in_others = covered(others, size);
      int wrong = 0, edges = 0;
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const auto n = static_cast<std::size_t>(y * size.x + x);
          const bool edge = has_edge(image, {x, y}, kThreshold);
          edges += edge ? 1 : 0;
          wrong += in_marked[n] == (edge ? 1 : 0) && in_others[n] == (edge ? 0 : 1) ? 0 : 1;
        }
      CHECK(wrong == 0);
      if (size.x > 8) CHECK((edges > 0 && edges < size.x * size.y));
    }
  }
}

TEST_CASE("edge tiles: a mark that is no longer an edge goes, and a part of a picture gives its own pixels alone") {
  const Vec2i size(32, 16);
  Image image{size.x, size.y, std::vector<Rgba8>(512, Rgba8{90, 90, 90, 255})};
  EdgeTiles tiles;
  tiles.resize(size);
  const PixelRect all{Vec2i(0), size};
  const auto marked = [&](const PixelRect& rect) {
    std::vector<PixelRect> out;
    tiles.append(rect, true, out);
    return out;
  };
  image.pixels[0].g = 99;  // the upper left pixel
  tiles.mark(all, image, 8);
  CHECK(marked(all) == std::vector{PixelRect{{0, 12}, {4, 16}}});
  CHECK(marked({{1, 0}, {20, 14}}) == std::vector{PixelRect{{1, 12}, {4, 14}}});
  image.pixels[0].g = 98;
  tiles.mark(all, image, 8);
  CHECK(marked(all).empty());
}

TEST_CASE("edge tiles: only surfaces with several rays a pixel have them") {
  CHECK(tile_side({.supersample = 2, .edge_threshold = 8}) == kEdgeTile);
  CHECK(tile_side({.supersample = 2, .edge_threshold = 0}) == 0);
  CHECK(tile_side({.supersample = 1, .edge_threshold = 8}) == 0);
  CHECK(tile_side({.supersample = 2, .edge_threshold = 8, .slices = SliceOptions{}}) == 0);
  CHECK(tile_side({.supersample = 2, .edge_threshold = 8, .translucent = TransferFunction{}}) == 0);
}
