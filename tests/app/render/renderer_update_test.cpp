// Parts of the volume sent later, what they cost, and skipping empty space: all must leave the picture as a full upload gives it.
#include <doctest/doctest.h>

#include <cmath>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;

Image drawn(Renderer& renderer, const FrameView& view = oblique_view()) {
  auto image = renderer.draw(view, kWidth, kHeight);
  REQUIRE(image.ok());
  return std::move(image).value();
}

/// The ball on its plate with the texels of `box` replaced by ones of that opacity.
VolumeView changed(const VoxelBox& box, std::uint8_t opacity) {
  VolumeView volume = ball_on_plate();
  const VoxelBox all{Vec3i(0), volume.dims};
  for_each_voxel(box, [&](const Vec3i& v) { volume.normal_opacity[all.offset_of(v)] = {128, 128, 255, opacity}; });
  return volume;
}

}  // namespace

TEST_CASE("update: a partial upload draws the same bytes as a full one") {
  const VoxelBox box{{22, 24, 30}, {42, 44, 50}};
  const VolumeView after = changed(box, 0);
  Renderer partly = require_renderer();
  REQUIRE(partly.set_volume(ball_on_plate()).ok());
  const Image before = drawn(partly);
  partly.update(texels_of(after, box));
  Renderer fully = require_renderer();
  REQUIRE(fully.set_volume(after).ok());
  CHECK(pictures_agree("partial-update", drawn(partly), drawn(fully), {}));
  CHECK(compare_pictures(drawn(partly), before, 0).differing_share > 0.005);
}

TEST_CASE("update: a box of 20^3 sends 20^3 texels of six bytes and nothing else") {
  Renderer renderer = require_renderer({.finish = false});
  const VolumeView volume = ball_on_plate();
  REQUIRE(renderer.set_volume(volume).ok());
  CHECK(renderer.counters().volume_bytes == (4u + 2u + 4u) * 64u * 64u * 64u);
  const std::uint64_t skip_map = renderer.counters().skip_map_bytes;
  CHECK(skip_map == 64u * 64u * 64u);
  const VoxelBox box{{22, 24, 30}, {42, 44, 50}};
  renderer.update(texels_of(changed(box, 0), box));
  CHECK(renderer.counters().update_bytes == 20u * 20u * 20u * (4u + 2u));
  CHECK(renderer.counters().update_boxes == 1u);
  CHECK(renderer.counters().skip_map_bytes == skip_map);
}

TEST_CASE("update: through mapped buffers the same bytes arrive and are read, however often the ring turns and where a box does not fit") {
  Renderer ring = require_renderer({.growth_is_reported = true, .mapped_buffers = true});
  Renderer plain = require_renderer({.growth_is_reported = true, .mapped_buffers = false});
  for (Renderer* renderer : {&ring, &plain}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  Image before = drawn(plain);
  const auto both = [&](const VoxelBox& box) {
    const TexelBox texels = texels_of(changed(box, 0), box);
    for (Renderer* renderer : {&ring, &plain}) renderer->update(texels);
    const Image now = drawn(plain);
    CHECK(pictures_agree("ring", drawn(ring), now, {}));
    const bool differs = compare_pictures(now, before, 0).differing_share > 0.0;
    before = now;
    return differs;
  };
  // Several boxes a picture and several pictures: each of the three slots is filled again and again.
  int seen = 0;
  for (int n = 0; n < 10; ++n) seen += both({{22 + 2 * n, 20, 30}, {24 + 2 * n, 40, 52}}) ? 1 : 0;
  CHECK(seen > 5);
  for (int n = 0; n < 8; ++n)
    for (Renderer* renderer : {&ring, &plain})
      renderer->update(texels_of(changed({{20, 22 + 2 * n, 30}, {44, 24 + 2 * n, 52}}, 0), {{20, 22 + 2 * n, 30}, {44, 24 + 2 * n, 52}}));
  CHECK(pictures_agree("ring-many", drawn(ring), drawn(plain), {}));
  CHECK(both({{2, 2, 2}, {62, 62, 62}}));  // 216,000 texels of 6 bytes, more than a slot holds
  CHECK(ring.counters().update_bytes == plain.counters().update_bytes);
}

TEST_CASE("update: bone that grows in empty space appears, though that space was being skipped") {
  const VoxelBox box{{4, 5, 50}, {12, 14, 60}};
  const VolumeView grown = changed(box, 255);
  Renderer skipping = require_renderer();
  REQUIRE(skipping.set_volume(ball_on_plate()).ok());
  skipping.update(texels_of(grown, box));
  Renderer plain = require_renderer({.skip_empty = false, .finish = false});
  REQUIRE(plain.set_volume(grown).ok());
  CHECK(pictures_agree("grown", drawn(skipping), drawn(plain), {}));
}

TEST_CASE("update: bone that grows appears once its growth is reported, and is missing when it was not") {
  const VoxelBox box{{4, 5, 50}, {12, 14, 60}};
  const VolumeView grown = changed(box, 255);
  Renderer plain = require_renderer({.skip_empty = false, .finish = false});
  REQUIRE(plain.set_volume(grown).ok());
  for (const bool told : {true, false}) {
    Renderer trusting = require_renderer({.finish = false, .growth_is_reported = true});
    REQUIRE(trusting.set_volume(ball_on_plate()).ok());
    const std::uint64_t skip_map = trusting.counters().skip_map_bytes;
    drawn(trusting);
    if (told) trusting.forget();
    trusting.update(texels_of(grown, box));
    const PictureDifference difference = compare_pictures(drawn(trusting), drawn(plain), 0);
    CHECK((difference.differing_share == 0.0) == told);
    CHECK((trusting.counters().skip_map_bytes > skip_map) == told);
  }
}

TEST_CASE("skipping: the same bytes with and without, at a fraction of the samples") {
  Renderer skipping = require_renderer({.skip_empty = true, .finish = false});
  Renderer plain = require_renderer({.skip_empty = false, .finish = false});
  REQUIRE(skipping.set_volume(ball_on_plate()).ok());
  REQUIRE(plain.set_volume(ball_on_plate()).ok());
  CHECK(pictures_agree("skipping", drawn(skipping), drawn(plain), {}));
  REQUIRE(skipping.probe(oblique_view(), kWidth, kHeight).ok());
  REQUIRE(plain.probe(oblique_view(), kWidth, kHeight).ok());
  CHECK(plain.counters().probe_samples > 100'000u);
  CHECK(3 * skipping.counters().probe_samples < plain.counters().probe_samples);
}

TEST_CASE("drawing: the same view gives the same bytes, again and in another renderer") {
  Renderer first = require_renderer({.finish = true});
  Renderer second = require_renderer({.finish = true});
  for (Renderer* renderer : {&first, &second}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  const Image once = drawn(first);
  CHECK(pictures_agree("again", drawn(first), once, {}));
  CHECK(pictures_agree("other-renderer", drawn(second), once, {}));
}

TEST_CASE("drawing: the probe's picture is the picture") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  const auto probe = renderer.probe(oblique_view(), kWidth, kHeight);
  REQUIRE(probe.ok());
  CHECK(pictures_agree("probe", probe.value().image, drawn(renderer), {}));
}

TEST_CASE("drawing: two rays along each side of a pixel give the mean of the picture drawn twice as large") {
  Renderer fine = require_renderer({.finish = false, .supersample = 2});
  Renderer large = require_renderer();
  for (Renderer* renderer : {&fine, &large}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  const Image small = drawn(fine);
  const auto twice = large.draw(oblique_view(), 2 * kWidth, 2 * kHeight);
  REQUIRE(twice.ok());
  Image mean{kWidth, kHeight, {}};
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const auto at = [&](int y, int x) {
        return twice.value().pixels[static_cast<std::size_t>((2 * row + y) * 2 * kWidth + 2 * column + x)];
      };
      const Rgba8 p[] = {at(0, 0), at(0, 1), at(1, 0), at(1, 1)};
      const auto channel = [&](auto member) {
        return static_cast<std::uint8_t>((p[0].*member + p[1].*member + p[2].*member + p[3].*member + 2) / 4);
      };
      mean.pixels.push_back({channel(&Rgba8::r), channel(&Rgba8::g), channel(&Rgba8::b), 255});
    }
  CHECK(pictures_agree("supersampled", small, mean, {}));
}

TEST_CASE("drawing: row 0 is the top of the picture and every pixel is opaque") {
  Renderer renderer = require_renderer();
  const Image image = drawn(renderer);  // no volume, no tool: the background, darker at the top
  CHECK(image.width == kWidth);
  CHECK(image.pixels.size() == std::size_t{kWidth} * kHeight);
  CHECK(image.pixels.front().b < image.pixels.back().b);
  for (const Rgba8& pixel : image.pixels) REQUIRE(pixel.a == 255);
}

TEST_CASE("shaders: every variant compiles and links in the driver") {
  Renderer renderer = require_renderer();
  const Status linked = renderer.link_every_variant();
  CHECK_MESSAGE(linked.ok(), (linked.ok() ? "" : linked.error().text()));
  // 322 of volumes, tool, skin and background; a mesh has seven options, each on or off; 24 of what effects add.
  CHECK(all_shader_variants().size() == 322 + 128 + 24);
}

TEST_CASE("quality: knobs set later draw what a renderer made with them draws, and bad ones change nothing") {
  Renderer changing = require_renderer();
  REQUIRE(changing.set_volume(ball_on_plate()).ok());
  const Image first = drawn(changing);
  for (const DrawingQuality& quality :
       {DrawingQuality{.step_voxels = 1.0, .bisections = 0, .finish = false}, DrawingQuality{.finish = true, .supersample = 2},
        DrawingQuality{.finish = false, .resolution = 0.5}}) {
    REQUIRE(changing.set_quality(quality).ok());
    Renderer made = require_renderer({.step_voxels = quality.step_voxels,
                                      .bisections = quality.bisections,
                                      .finish = quality.finish,
                                      .supersample = quality.supersample,
                                      .resolution = quality.resolution});
    REQUIRE(made.set_volume(ball_on_plate()).ok());
    const Image here = drawn(changing);
    CHECK(pictures_agree("quality", here, drawn(made), {}));
    CHECK(here.pixels != first.pixels);
    CHECK((here.width == kWidth && here.height == kHeight));
    for (const DrawingQuality& bad :
         {DrawingQuality{.step_voxels = 0.0}, DrawingQuality{.supersample = 5}, DrawingQuality{.resolution = 0.1}})
      CHECK(changing.set_quality(bad).error().code == ErrorCode::out_of_range);
    CHECK(drawn(changing).pixels == here.pixels);
  }
}

TEST_CASE("texels in floats draw what their bytes draw, except for what bytes round") {
  VolumeView volume = ball_on_plate();
  Renderer bytes = require_renderer(), floats = require_renderer();
  REQUIRE(bytes.set_volume(volume).ok());
  for (const Rgba8& t : volume.normal_opacity) {
    volume.precise.normal_opacity.emplace_back(t.r / 255.0f, t.g / 255.0f, t.b / 255.0f, t.a / 255.0f);
    volume.precise.field.push_back(t.a / 255.0f);
  }
  REQUIRE(floats.set_volume(volume).ok());
  const auto a = bytes.draw(oblique_view(), 160, 120), b = floats.draw(oblique_view(), 160, 120);
  REQUIRE((a.ok() && b.ok()));
  // Filters of bytes weigh in 8 bits, those of floats do not: a level here and there, and a pixel of a silhouette.
  CHECK(pictures_agree("float-texels", *a, *b, {.level = 3, .share = 0.01}));
  for (float& seen : volume.precise.field) seen *= 0.6f;  // the surface moves inwards: that the floats are what is drawn is seen
  REQUIRE(floats.set_volume(volume).ok());
  const auto moved = floats.draw(oblique_view(), 160, 120);
  REQUIRE(moved.ok());
  CHECK(compare_pictures(*moved, *a, 8).differing_share > 0.005);
}
