// Translucent bone: against Beer and Lambert, a finer run, and itself without skipping.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kEdge = 0.5e-3;

Renderer translucent(const TransferFunction& transfer, double step = 1.0, bool skip = true) {
  return require_renderer({.step_voxels = step, .skip_empty = skip, .finish = false, .translucent = transfer});
}

Image drawn(Renderer& renderer, const FrameView& view = oblique_view()) {
  auto image = renderer.draw(view, kWidth, kHeight);
  REQUIRE(image.ok());
  return std::move(image).value();
}

const Rgba8& middle(const Image& image) { return image.pixels[static_cast<std::size_t>(image.height / 2 * image.width + image.width / 2)]; }

FrameView flatly_lit(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = {0.0, 0.0, 0.0}, .up = {0.1, 0.2, 1.0}, .vertical_fov = 0.4};
  view.light = {.ambient = 1.0, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  return view;
}

VolumeView haze(std::uint8_t opacity) {
  VolumeView volume;
  volume.dims = Vec3i(64);
  volume.bone_from_index = half_millimetre_cube();
  volume.normal_opacity.assign(64u * 64u * 64u, Rgba8{128, 128, 128, opacity});
  volume.color.assign(64u * 64u * 64u, Rgba8{255, 255, 255, 0});
  return volume;
}

/// Nothing up to a third, then rising: a bone that is seen through.
TransferFunction ramp(double extinction = 300.0) {
  return {{.density = 0.33, .extinction = 0.0}, {.density = 1.0, .extinction = extinction}};
}

double psnr(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t n = 0; n < a.pixels.size(); ++n) {
    const Vec3 d = Vec3(a.pixels[n].r, a.pixels[n].g, a.pixels[n].b) - Vec3(b.pixels[n].r, b.pixels[n].g, b.pixels[n].b);
    sum += glm::dot(d, d);
  }
  return 10.0 * std::log10(255.0 * 255.0 / std::max(1e-9, sum / (3.0 * static_cast<double>(a.pixels.size()))));
}

}  // namespace

TEST_CASE("translucent: a slab lets through what Beer and Lambert say, at every step and from every side") {
  constexpr std::uint8_t kDensity = 102;  // 0.4, so the extinction is 0.4 of the last corner's
  constexpr double kExtinction = 0.4 * 90.0;
  Renderer bare = require_renderer();
  for (const Vec3& eye : {Vec3(0.0, 0.0, 0.12), Vec3(0.04, -0.05, 0.1), Vec3(-0.1, 0.03, 0.05)}) {
    const double behind = middle(drawn(bare, flatly_lit(eye))).r;
    const Vec3 d = glm::abs(glm::normalize(eye));
    const double way = 64.0 * kEdge / std::max({d.x, d.y, d.z});
    for (const double step : {0.3, 1.0}) {
      Renderer renderer = translucent({{.density = 0.0, .extinction = 0.0}, {.density = 1.0, .extinction = 90.0}}, step);
      REQUIRE(renderer.set_volume(haze(kDensity)).ok());
      const double passes = std::exp(-kExtinction * way);
      const double seen = middle(drawn(renderer, flatly_lit(eye))).r;
      // Rounding of background, of opacity and of the sum: half a level each.
      CHECK(std::abs(seen - (255.0 * (1.0 - passes) + passes * behind)) <= 1.5);
      // A way that is a step off would be seen.
      const double longer = std::exp(-kExtinction * 1.1 * way);
      CHECK(std::abs(seen - (255.0 * (1.0 - longer) + longer * behind)) > 3.0);
    }
  }
}

TEST_CASE("translucent: the tint is that of the density, times the tissue's colour") {
  VolumeView volume = haze(204);
  for (Rgba8& color : volume.color) color = {200, 100, 50, 0};
  // At 0.8 three quarters of the way from the first corner to the second; so dense that nothing shines through.
  Renderer renderer = translucent(
      {{.density = 0.2, .extinction = 1e5, .tint = {0.0, 0.4, 1.0}}, {.density = 1.0, .extinction = 1e5, .tint = {1.0, 0.8, 0.0}}});
  REQUIRE(renderer.set_volume(volume).ok());
  const Rgba8 seen = middle(drawn(renderer, flatly_lit({0.0, 0.0, 0.12})));
  CHECK(std::abs(seen.r - 0.75 * 200.0) <= 1.5);
  CHECK(std::abs(seen.g - 0.7 * 100.0) <= 1.5);
  CHECK(std::abs(seen.b - 0.25 * 50.0) <= 1.5);
}

TEST_CASE("translucent: the same bytes with and without skipping, at a fraction of the samples") {
  for (const double step : {0.5, 1.0}) {
    Renderer skipping = translucent(ramp(), step, true);
    Renderer plain = translucent(ramp(), step, false);
    for (Renderer* renderer : {&skipping, &plain}) {
      REQUIRE(renderer->set_volume(ball_on_plate()).ok());
      REQUIRE(renderer->probe(oblique_view(), kWidth, kHeight).ok());
    }
    CHECK(pictures_agree("translucent-skipping", drawn(skipping), drawn(plain), {}));
    CHECK(2 * skipping.counters().probe_samples < plain.counters().probe_samples);
  }
}

TEST_CASE("translucent: a ray whose light is spent takes no more samples") {
  Renderer thin = translucent(ramp(30.0), 1.0, false);
  Renderer dense = translucent(ramp(1e4), 1.0, false);
  for (Renderer* renderer : {&thin, &dense}) {
    REQUIRE(renderer->set_volume(haze(255)).ok());
    REQUIRE(renderer->probe(oblique_view(), kWidth, kHeight).ok());
  }
  // A voxel of the dense one passes exp(-5): two are enough.
  CHECK(10 * dense.counters().probe_samples < thin.counters().probe_samples);
}

TEST_CASE("translucent: a step of a voxel is within 42 dB of an eighth of it") {
  Renderer coarse = translucent(ramp(), 1.0);
  Renderer fine = translucent(ramp(), 0.125);
  for (Renderer* renderer : {&coarse, &fine}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  const Image reference = drawn(fine);
  const double found = psnr(drawn(coarse), reference);
  MESSAGE("step 1 against 1/8: " << found << " dB");
  CHECK(found >= 42.0);
  Renderer wrong = translucent(ramp(330.0), 1.0);  // a tenth more extinction, as if steps were a tenth longer
  REQUIRE(wrong.set_volume(ball_on_plate()).ok());
  CHECK(psnr(drawn(wrong), reference) < found - 3.0);
}

TEST_CASE("translucent: a tool in front is as it is, one behind is veiled, one inside by what lies before it") {
  const double extinction = 60.0;
  Renderer renderer = translucent({{.density = 0.0, .extinction = extinction}});
  REQUIRE(renderer.set_volume(haze(255)).ok());
  REQUIRE(renderer.set_tool(square(6e-3, 0.0)).ok());
  Renderer bare = require_renderer();
  REQUIRE(bare.set_tool(square(6e-3, 0.0)).ok());
  FrameView view = flatly_lit({0.0, 0.0, 0.12});
  for (const double z : {20e-3, 10e-3, 0.0, -20e-3}) {
    view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, z)};
    const double steel = middle(drawn(bare, view)).r;
    const double passes = std::exp(-extinction * std::clamp(16e-3 - z, 0.0, 32e-3));
    CHECK(std::abs(middle(drawn(renderer, view)).r - (255.0 * (1.0 - passes) + passes * steel)) <= 1.5);
  }
}

TEST_CASE("translucent: soft tissue is seen through the bone, as a surface") {
  const auto layers = [](bool soft) {
    return make_volume({.dims = Vec3i(64),
                        .bone_from_index = half_millimetre_cube(),
                        .bone = [](const Vec3& p) { return std::min(4e-3 - p.z, p.z); },
                        .soft = soft ? Distance([](const Vec3& p) { return -4e-3 - p.z; }) : Distance(),
                        .color =
                            [](const Vec3& p) {
                              return p.z > -2e-3 ? Rgba8{255, 255, 255, 0} : Rgba8{200, 20, 20, 0};
                            }});
  };
  Renderer renderer = translucent(ramp(100.0), 0.25);
  const FrameView view = flatly_lit({0.0, 0.0, 0.12});
  REQUIRE(renderer.set_volume(layers(true)).ok());
  const Rgba8 with = middle(drawn(renderer, view));
  REQUIRE(renderer.set_volume(layers(false)).ok());
  const Rgba8 without = middle(drawn(renderer, view));
  // About a third of the light passes 4 mm of bone: green falls from that share of the background to that of the tissue.
  CHECK(with.r > with.g + 30);
  CHECK(without.r <= without.b);
}

TEST_CASE("translucent: a partial upload draws the same bytes as a full one, where bone goes and where it grows") {
  for (const std::uint8_t opacity : {std::uint8_t{0}, std::uint8_t{255}}) {
    const VoxelBox box{{10, 12, 14}, {30, 32, 50}};
    VolumeView after = ball_on_plate();
    for_each_voxel(box, [&](const Vec3i& v) {
      after.normal_opacity[VoxelBox{Vec3i(0), after.dims}.offset_of(v)] = {128, 128, 255, opacity};
    });
    Renderer partly = translucent(ramp());
    REQUIRE(partly.set_volume(ball_on_plate()).ok());
    const Image before = drawn(partly);
    partly.update(texels_of(after, box));
    Renderer fully = translucent(ramp());
    REQUIRE(fully.set_volume(after).ok());
    CHECK(pictures_agree("translucent-update", drawn(partly), drawn(fully), {}));
    CHECK(compare_pictures(drawn(partly), before, 0).differing_share > 0.005);
  }
}

TEST_CASE("translucent: a cut takes away what lies beyond it, and every pixel is opaque") {
  Renderer renderer = translucent({{.density = 0.0, .extinction = 60.0}});
  Renderer bare = require_renderer();
  REQUIRE(renderer.set_volume(haze(255)).ok());
  FrameView view = flatly_lit({0.0, 0.0, 0.12});
  const double behind = middle(drawn(bare, view)).r;
  view.cut = FrameView::Cut{Vec3(0.0, 0.0, 1.0), 4e-3};
  const double passes = std::exp(-60.0 * 20e-3);
  const Image image = drawn(renderer, view);
  CHECK(std::abs(middle(image).r - (255.0 * (1.0 - passes) + passes * behind)) <= 1.5);
  for (const Rgba8& pixel : image.pixels) REQUIRE(pixel.a == 255);
}

TEST_CASE("translucent: nothing of it is in the shader of a surface") {
  int with = 0, without = 0;
  for (const ShaderVariant& variant : all_shader_variants()) {
    ++(variant.fragment == "translucent.frag" ? with : without);
    const auto text = expand_shader(embedded_shaders(), variant.fragment, variant.defines);
    REQUIRE(text.ok());
    CHECK((text.value().find("sampler1D transfer") != std::string::npos) == (variant.fragment == "translucent.frag"));
  }
  CHECK(with > 0);
  CHECK(without > 0);
}

TEST_CASE("translucent: faulty transfer functions are refused") {
  static_cast<void>(require_renderer());
  const auto refused = [](const TransferFunction& transfer) {
    const auto renderer = Renderer::create({.translucent = transfer, .gl = tested_backend()});
    return !renderer.ok() && renderer.error().code == ErrorCode::out_of_range;
  };
  CHECK(refused({}));
  CHECK(refused({{.density = 0.5}, {.density = 0.5}}));
  CHECK(refused({{.density = 1.5}}));
  CHECK(refused({{.density = 0.5, .extinction = -1.0}}));
  CHECK(refused({{.density = 0.5, .extinction = std::nan("")}}));
  CHECK(refused({{.density = 0.5, .extinction = 1.0, .tint = {0.0, 1.1, 0.0}}}));
  CHECK(Renderer::create({.slices = SliceOptions{}, .translucent = ramp(), .gl = tested_backend()}).error().code ==
        ErrorCode::out_of_range);
}
