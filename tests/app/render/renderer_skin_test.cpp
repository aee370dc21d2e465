// Skin as a translucent shell: silhouette and transmitted light of a ball in closed form, its opening, and its order with bone and tool.
#include <doctest/doctest.h>

#include <cmath>

#include "app/view/camera.h"
#include "app/view/site_window.h"
#include "app/view/surface_nets.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 200;
constexpr double kOpacity = 0.4;
const Vec3 kColor(0.9, 0.65, 0.5), kBackground(0.2, 0.3, 0.4);

/// A ball round the origin; with an opening of that width round +z.
std::shared_ptr<const SkinView> ball_skin(double radius, std::optional<double> opening = {}) {
  SkinView out;
  out.shell = make_surface_mesh([radius](const Vec3& p) { return glm::length(p) - radius; }, {Vec3(-1.2 * radius), Vec3(1.2 * radius)},
                                radius / 40.0);
  out.color = kColor;
  out.opacity = kOpacity;
  for (const Vec3f& p : out.shell.positions)
    out.beyond.push_back(opening && p.z > 0.0f ? static_cast<float>(SiteWindow{*opening, true}.beyond(Vec3(p))) : 1.0f);
  return std::make_shared<const SkinView>(std::move(out));
}

VolumeView no_bone() {
  return make_volume({.dims = Vec3i(8),
                      .bone_from_index = half_millimetre_cube(Vec3i(8)),
                      .bone = [](const Vec3&) { return -1.0; },
                      .soft = {},
                      .color = {}});
}

/// Evenly lit: the skin has 0.7 of its colour, below the bend of the tone curve.
FrameView even_view(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = Vec3(0.0), .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.4};
  view.light = {.ambient = 0.7, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  view.background = {.bottom = kBackground, .top = kBackground};
  return view;
}

Image picture_of(Renderer& renderer, const FrameView& view) {
  auto image = renderer.draw(view, kSize, kSize);
  REQUIRE(image.ok());
  return std::move(image).value();
}

struct PixelRay {
  Vec3 eye, way;  // way of length 1
};
PixelRay ray_at(const FrameView& view, int x, int y) {
  const CameraRays rays = make_camera_rays(view.camera, 1.0).value();
  return {rays.eye, glm::normalize(rays.direction(2.0 * (x + 0.5) / kSize - 1.0, 1.0 - 2.0 * (y + 0.5) / kSize))};
}
/// @returns the distance of the ray from the origin.
double off_origin(const PixelRay& ray) { return glm::length(glm::cross(ray.eye, ray.way)); }

Vec3 stored(const Rgba8& p) { return Vec3(p.r, p.g, p.b); }
std::size_t index_of(int x, int y) { return static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x); }
double opacity_at(double cosine) { return 1.0 - std::pow(1.0 - kOpacity, 1.0 / cosine); }

}  // namespace

TEST_CASE("skin: a ball has the silhouette and the transmitted light of its closed form; opacity without the angle does not") {
  constexpr double kRadius = 40e-3;
  Renderer renderer = require_renderer();
  VolumeView volume = no_bone();
  volume.skin = ball_skin(kRadius);
  REQUIRE(renderer.set_volume(volume).ok());
  const FrameView view = even_view({0.05, -0.28, 0.06});
  const Image image = picture_of(renderer, view);
  int outside = 0, inside = 0, wrong_outside = 0, wrong = 0, wrong_flat = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double off = off_origin(ray_at(view, x, y));
      const Vec3 seen = stored(image.pixels[index_of(x, y)]);
      // Of a pixel, at most half its diagonal: its ray is the one through its centre. Facets are up to 10 um inside.
      if (off > kRadius + 1e-5) {
        ++outside;
        wrong_outside += glm::length(seen - 255.0 * kBackground) > 1.0;
        continue;
      }
      const double cosine = std::sqrt(std::max(0.0, 1.0 - off * off / (kRadius * kRadius)));
      if (cosine < 0.25) continue;
      ++inside;
      const auto expected = [&](double opacity) { return 255.0 * glm::mix(kBackground, 0.7 * kColor, opacity); };
      // The background and the sum are rounded to 8 bits, and a driver may blend with an opacity of 8 bits: 3 of 255 levels.
      const auto off_by = [&](double opacity) {
        const Vec3 d = glm::abs(seen - expected(opacity));
        return std::max({d.x, d.y, d.z});
      };
      wrong += off_by(opacity_at(cosine)) > 3.0;
      wrong_flat += off_by(kOpacity) > 3.0;
    }
  CHECK(outside > 5'000);
  CHECK(inside > 5'000);
  CHECK(wrong_outside == 0);
  CHECK(wrong == 0);
  CHECK(wrong_flat > inside / 4);
}

TEST_CASE("skin: in the fog of a microscope a ball has the share of its depth in closed form; without fog it does not") {
  constexpr double kRadius = 40e-3;
  const FogView fog{.depth = 30e-3, .color = {0.1, 0.05, 0.2}};
  Renderer renderer = require_renderer();
  VolumeView volume = no_bone();
  volume.skin = ball_skin(kRadius);
  REQUIRE(renderer.set_volume(volume).ok());
  FrameView view = even_view({0.05, -0.28, 0.06});
  view.camera.target = 0.15 * view.camera.eye;  // the plane of focus is just before the ball
  view.camera.fog = fog;
  const Vec3 forward = glm::normalize(view.camera.target - view.camera.eye);
  const double focus = glm::length(view.camera.target - view.camera.eye);
  const Image image = picture_of(renderer, view);
  int inside = 0, wrong = 0, wrong_clear = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const PixelRay ray = ray_at(view, x, y);
      const double off = off_origin(ray), cosine = std::sqrt(std::max(0.0, 1.0 - off * off / (kRadius * kRadius)));
      if (cosine < 0.25) continue;
      ++inside;
      const double along = -glm::dot(ray.eye, ray.way) - kRadius * cosine;
      const double beyond = (along * glm::dot(ray.way, forward) - focus) / fog.depth;
      const auto off_by = [&](double clear) {
        const Vec3 skin = glm::mix(fog.color, 0.7 * kColor, clear);
        const Vec3 d = glm::abs(stored(image.pixels[index_of(x, y)]) - 255.0 * glm::mix(fog.color, skin, opacity_at(cosine)));
        return std::max({d.x, d.y, d.z});
      };
      // Rounding as without fog.
      wrong += off_by(std::exp(-beyond * beyond)) > 3.0;
      wrong_clear += off_by(1.0) > 3.0;
    }
  CHECK(inside > 5'000);
  CHECK(wrong == 0);
  CHECK(wrong_clear > inside / 4);
}

TEST_CASE("skin: the opening is free of it, to the byte, and elsewhere the bone shows through") {
  constexpr double kRadius = 20e-3, kOpening = 18e-3;
  const FrameView view = even_view({0.02, -0.06, 0.16});
  VolumeView volume = ball_on_plate();
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(volume).ok());
  const Image plain = picture_of(renderer, view);
  const auto probe = renderer.probe(view, kSize, kSize);
  REQUIRE(probe.ok());
  volume.skin = ball_skin(kRadius, kOpening);
  REQUIRE(renderer.set_volume(volume).ok());
  const Image covered = picture_of(renderer, view);
  int free = 0, changed = 0, under = 0, shown = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::size_t n = index_of(x, y);
      const PixelRay ray = ray_at(view, x, y);
      const double off = off_origin(ray);
      if (probe->hit[n] == 0 || off > kRadius) continue;
      const double along = -glm::dot(ray.eye, ray.way) - std::sqrt(kRadius * kRadius - off * off);
      const Vec3 p = ray.eye + along * ray.way;
      const Vec3 hit = volume.bone_from_index * Vec3(probe->hit_index[n]);
      const double beyond = SiteWindow{kOpening, true}.beyond(p), gap = glm::length(hit - ray.eye) - along;
      if (p.z > 0.0 && beyond < -0.1e-3 && glm::length(hit) < kRadius - 0.5e-3) {
        ++free;
        changed += covered.pixels[n] != plain.pixels[n];
      } else if (beyond > 0.1e-3 && gap > 0.5e-3) {
        ++under;
        const double cosine = std::sqrt(1.0 - off * off / (kRadius * kRadius));
        const Vec3 expected = glm::mix(stored(plain.pixels[n]), 255.0 * 0.7 * kColor, opacity_at(std::max(cosine, 0.05)));
        shown += glm::length(glm::abs(stored(covered.pixels[n]) - expected)) < 6.0;
      }
    }
  CHECK(free > 500);
  CHECK(changed == 0);
  CHECK(under > 500);
  CHECK(shown > under * 99 / 100);  // at grazing angles facets show
  volume.skin.reset();
  REQUIRE(renderer.set_volume(volume).ok());
  CHECK(picture_of(renderer, view).pixels == plain.pixels);
}

TEST_CASE("skin: a tool in front of it keeps its bytes, a tool behind it shows through it, whatever is drawn first") {
  constexpr double kRadius = 20e-3;
  const FrameView view = [] {
    FrameView out = even_view({0.0, 0.0, 0.2});
    out.camera.up = {0.0, 1.0, 0.0};
    return out;
  }();
  for (const double height : {25e-3, 10e-3}) {
    CAPTURE(height);
    FrameView with_tool = view;
    with_tool.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, height)};
    Renderer renderer = require_renderer();
    REQUIRE(renderer.set_tool(square(6e-3, 0.0)).ok());
    VolumeView volume = no_bone();
    REQUIRE(renderer.set_volume(volume).ok());
    const Image bare = picture_of(renderer, with_tool);
    volume.skin = ball_skin(kRadius);
    REQUIRE(renderer.set_volume(volume).ok());
    const Image covered = picture_of(renderer, with_tool);
    const Rgba8 before = bare.pixels[index_of(kSize / 2, kSize / 2)], after = covered.pixels[index_of(kSize / 2, kSize / 2)];
    CHECK(glm::length(stored(before) - 255.0 * kBackground) > 20.0);  // the tool
    if (height > kRadius)
      CHECK(after == before);
    else
      CHECK(glm::length(stored(after) - glm::mix(stored(before), 255.0 * 0.7 * kColor, kOpacity)) < 4.0);
  }
}

TEST_CASE("skin: a cut removes it, and the opaque edge of an opening hides what is behind it") {
  constexpr double kRadius = 20e-3;
  Renderer renderer = require_renderer();
  VolumeView volume = no_bone();
  SkinView skin = *ball_skin(kRadius);
  skin.rim = square(5e-3, 0.0);
  skin.depth.assign(skin.rim.positions.size(), 0.0f);
  volume.skin = std::make_shared<const SkinView>(skin);
  REQUIRE(renderer.set_volume(volume).ok());
  FrameView view = even_view({0.0, 0.0, 0.2});
  view.camera.up = {0.0, 1.0, 0.0};
  const auto middle = [&] { return stored(picture_of(renderer, view).pixels[index_of(kSize / 2, kSize / 2)]); };
  // Edge and shell have the same colour: 0.7 of it.
  CHECK(glm::length(middle() - 255.0 * 0.7 * kColor) < 3.0);
  view.cut = FrameView::Cut{{0.0, 0.0, 1.0}, 10e-3};  // off with the upper side of the shell
  CHECK(glm::length(middle() - 255.0 * 0.7 * kColor) < 3.0);
  view.cut->offset = -10e-3;  // and with the edge: the lower side of the shell
  CHECK(glm::length(middle() - 255.0 * glm::mix(kBackground, 0.7 * kColor, kOpacity)) < 4.0);
  view.cut->offset = -30e-3;
  CHECK(glm::length(middle() - 255.0 * kBackground) < 1.0);
}

TEST_CASE("skin: only what changed is drawn again, with the bytes of whole pictures") {
  for (const int supersample : {1, 2}) {
    RenderOptions options{.supersample = supersample};
    Renderer kept = require_renderer(options);
    options.keep_picture = false;
    Renderer whole = require_renderer(options);
    VolumeView volume = ball_on_plate();
    volume.skin = ball_skin(18e-3, 16e-3);
    for (Renderer* one : {&kept, &whole}) {
      REQUIRE(one->set_volume(volume).ok());
      REQUIRE(one->set_tool(square(4e-3, 6e-3)).ok());
    }
    FrameView view = oblique_view();
    const auto same = [&](const std::string& name) {
      CHECK(pictures_agree("skin-redraw-" + name, picture_of(kept, view), picture_of(whole, view), {}));
    };
    same("first");
    view.world_from_tool = Pose{Quat(0.98, 0.1, 0.05, 0.0), Vec3(1e-3, 0.0, 9e-3)};
    same("tool");
    view.world_from_tool->translation.x -= 5e-3;
    const VoxelBox pit{{32, 16, 40}, {42, 26, 52}};
    for (Renderer* one : {&kept, &whole})
      one->update({pit, std::vector<Rgba8>(pit.count(), Rgba8{128, 128, 255, 0}), std::vector<std::uint16_t>(pit.count(), 0)});
    const std::uint64_t before = kept.counters().drawn_pixels;
    same("both");
    CHECK(kept.counters().drawn_pixels - before < std::uint64_t{kSize} * kSize / 2);
    view.world_from_tool.reset();
    same("gone");
  }
}

TEST_CASE("skin: what is no shell is refused in words, and the old volume is kept") {
  Renderer renderer = require_renderer();
  VolumeView volume = ball_on_plate();
  REQUIRE(renderer.set_volume(volume).ok());
  const Image before = picture_of(renderer, oblique_view());
  const auto refused = [&](const std::function<void(SkinView&)>& spoil, const std::string& words) {
    SkinView skin = *ball_skin(10e-3);
    spoil(skin);
    volume.skin = std::make_shared<const SkinView>(std::move(skin));
    const Status set = renderer.set_volume(volume);
    REQUIRE_FALSE(set.ok());
    CHECK_MESSAGE(set.error().text().find(words) != std::string::npos, set.error().text());
  };
  refused([](SkinView& skin) { skin.beyond.pop_back(); }, "one place a vertex");
  refused([](SkinView& skin) { skin.shell.indices.pop_back(); }, "whole triangles");
  refused([](SkinView& skin) { skin.shell.indices[0] = 1'000'000; }, "beyond its vertices");
  refused([](SkinView& skin) { skin.opacity = 1.5; }, "0..1");
  refused([](SkinView& skin) { skin.shell.positions[0].x = std::nanf(""); }, "not finite");
  CHECK(picture_of(renderer, oblique_view()).pixels == before.pixels);
}
