// Pictures that have all rays at edges only, beside pictures that have them everywhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <tuple>

#include "app/render/edge_tiles.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 400, kHeight = 300, kThreshold = 8;
constexpr std::uint64_t kAll = std::uint64_t{kWidth} * kHeight;
/// Were the picture of one ray a pixel linear between pixels, the mean of four rays would differ from it by at most 7/16 of the threshold
/// (docs/drawing.md), 3.5 levels; rounding adds half a level.
constexpr int kMostLevels = 4;

struct Difference {
  double mean = 0.0;    ///< [levels] of the channel that differs most
  double beyond = 0.0;  ///< [-] share of pixels that differ by more than kMostLevels
};

Difference differ(const Image& a, const Image& b) {
  Difference out;
  for (std::size_t n = 0; n < a.pixels.size(); ++n) {
    const Rgba8 &p = a.pixels[n], &q = b.pixels[n];
    const int most = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
    out.mean += most;
    out.beyond += most > kMostLevels ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(a.pixels.size());
  return {out.mean / count, out.beyond / count};
}

/// One with a threshold for edges and one without, drawn alike.
struct Twins {
  Renderer edges, full;
  FrameView view = oblique_view();
  Image by_edges, everywhere;
  std::uint64_t edge_pixels = 0;

  Twins(const Appearance& appearance, int side, int threshold = kThreshold)
      : edges(require_renderer(options(appearance, side, threshold))), full(require_renderer(options(appearance, side, 0))) {
    for (Renderer* one : {&edges, &full}) {
      VolumeRecipe recipe{.bone_from_index = half_millimetre_cube()};
      // A ball over a plate, and another in its shadow, of three colours.
      recipe.bone = [](const Vec3& p) {
        return std::max({8e-3 - glm::length(p - Vec3(0.0, 0.0, 2e-3)), 4e-3 - glm::length(p - Vec3(9e-3, 6e-3, -3e-3)),
                         std::min(-6e-3 - p.z, p.z + 12e-3)});
      };
      recipe.color = [](const Vec3& p) {
        if (p.z < -6e-3) return p.x > 0.0 ? Rgba8{150, 70, 60, 255} : Rgba8{230, 220, 190, 255};
        return Rgba8{200, 190, 180, 255};
      };
      REQUIRE(one->set_volume(make_volume(recipe)).ok());
      REQUIRE(one->set_tool(square(4e-3, 0.0)).ok());
    }
  }
  static RenderOptions options(const Appearance& appearance, int side, int threshold) {
    return {.finish = true, .appearance = appearance, .supersample = side, .edge_threshold = threshold};
  }
  Difference draw() {
    const std::uint64_t before = edges.counters().edge_pixels;
    const auto fast = edges.draw(view, kWidth, kHeight), slow = full.draw(view, kWidth, kHeight);
    REQUIRE((fast.ok() && slow.ok()));
    edge_pixels = edges.counters().edge_pixels - before;
    by_edges = *fast;
    everywhere = *slow;
    return differ(by_edges, everywhere);
  }
};

/// A tool that stands in the plate, aslant.
Pose in_plate() { return {glm::normalize(Quat(0.8, 0.45, 0.2, 0.1)), Vec3(-7e-3, -6e-3, -6e-3)}; }

void check(const char* name, const Difference& difference) {
  CAPTURE(name);
  MESSAGE(name << ": mean " << difference.mean << " of 255, beyond 4: " << difference.beyond);
  CHECK(difference.mean <= 1.0);
  CHECK(difference.beyond <= 0.002);
}

}  // namespace

TEST_CASE("edges: silhouettes, colours, a cut, occlusion, shadows and a tool in bone are those of all rays within 4 of 255 levels") {
  const Appearance plain{}, occlusion{.occlusion = true}, all{.occlusion = true, .shadow = true, .specular = true};
  for (const auto& [name, appearance, side] : {std::tuple("plain", plain, 2), std::tuple("occlusion", occlusion, 2),
                                               std::tuple("shadow", all, 2), std::tuple("nine rays", occlusion, 3)}) {
    Twins twins(appearance, side);
    check(name, twins.draw());
    // Edges are few, and are drawn.
    CHECK(twins.edge_pixels > kAll / 100);
    CHECK(twins.edge_pixels < kAll / 3);
    twins.view.world_from_tool = in_plate();
    check("tool", twins.draw());
    twins.view.cut = FrameView::Cut{{0, -1, 0}, 0.0};
    check("cut", twins.draw());
  }
}

TEST_CASE("edges: a threshold of 255 levels, which finds none, is noticed; one of 1 level gives the bytes of all rays at silhouettes") {
  Twins blind({.occlusion = true}, 2, 255);
  const Difference none = blind.draw();
  CHECK(blind.edge_pixels == 0);
  CHECK(none.beyond > 0.002);
  Twins fine({.occlusion = true}, 2, 1);
  CHECK(fine.draw().beyond == 0.0);
  const auto differing = compare_pictures(fine.by_edges, fine.everywhere, 1).differing_share;
  CHECK(differing == 0.0);
}

TEST_CASE("edges: tiles that are marked have the bytes of a picture with all rays") {
  Renderer single = require_renderer({.finish = true, .appearance = {.occlusion = true}});
  REQUIRE(single.set_volume(ball_on_plate()).ok());
  Renderer edges = require_renderer(Twins::options({.occlusion = true}, 2, kThreshold));
  Renderer full = require_renderer(Twins::options({.occlusion = true}, 2, 0));
  for (Renderer* one : {&edges, &full}) REQUIRE(one->set_volume(ball_on_plate()).ok());
  const FrameView view = oblique_view();
  const auto rays = single.draw(view, kWidth, kHeight), some = edges.draw(view, kWidth, kHeight), every = full.draw(view, kWidth, kHeight);
  REQUIRE((rays.ok() && some.ok() && every.ok()));
  EdgeTiles tiles;
  tiles.resize({kWidth, kHeight});
  tiles.mark({Vec2i(0), {kWidth, kHeight}}, *rays, kThreshold);
  std::uint64_t marked_pixels = 0;
  for (const bool marked : {true, false}) {
    std::vector<PixelRect> rects;
    tiles.append({Vec2i(0), {kWidth, kHeight}}, marked, rects);
    std::uint64_t differing = 0;
    for (const PixelRect& r : rects)
      for (int y = r.lo.y; y < r.hi.y; ++y)
        for (int x = r.lo.x; x < r.hi.x; ++x) {
          const auto n = static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x);
          differing += some->pixels[n] == (marked ? *every : *rays).pixels[n] ? 0u : 1u;
          marked_pixels += marked ? 1u : 0u;
        }
    CHECK(differing == 0);
  }
  CHECK(marked_pixels == edges.counters().edge_pixels);
}
