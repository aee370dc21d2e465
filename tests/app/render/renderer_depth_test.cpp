// One depth for volume and tool; the cut; the light on a face.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 100;
constexpr double kEdge = 0.5e-3;

const Rgba8& pixel(const Image& image, int column, int row) { return image.pixels[static_cast<std::size_t>(row * image.width + column)]; }

/// A plate whose top is z = 2 mm exactly, red below z = 0.
VolumeView plate() {
  return make_volume({.dims = Vec3i(64),
                      .bone_from_index = half_millimetre_cube(),
                      .bone = [](const Vec3& p) { return 2e-3 - p.z; },
                      .soft = {},
                      .color =
                          [](const Vec3& p) {
                            return p.z > 0.0 ? Rgba8{200, 190, 170, 0} : Rgba8{180, 40, 30, 0};
                          }});
}

FrameView from_above() {
  FrameView view;
  view.camera = {.eye = {0.0, -0.04, 0.1}, .target = {0.0, 0.0, 2e-3}, .up = {0.0, 1.0, 0.0}, .vertical_fov = 0.25};
  return view;
}

/// Share of the pixels of the picture's middle that show the volume and not the tool, the tool being a square at height z.
double volume_share(double z) {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  REQUIRE(renderer.set_tool(square(8e-3, 0.0)).ok());
  FrameView view = from_above();
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, z)};
  const auto probe = renderer.probe(view, kSize, kSize);
  REQUIRE(probe.ok());
  int volume = 0;
  for (int row = 40; row < 60; ++row)
    for (int column = 40; column < 60; ++column) volume += probe.value().hit[static_cast<std::size_t>(row * kSize + column)];
  return volume / 400.0;
}

}  // namespace

TEST_CASE("depth: a tool a fifth of a voxel above the bone hides it, a fifth below is hidden") {
  CHECK(volume_share(2e-3 + 0.2 * kEdge) == 0.0);
  CHECK(volume_share(2e-3 - 0.2 * kEdge) == 1.0);
}

TEST_CASE("depth: a picture, whose tool is drawn over a copy of the bone, hides the same as one depth buffer") {
  for (const double off : {0.2, -0.2}) {
    Renderer renderer = require_renderer();
    REQUIRE(renderer.set_volume(plate()).ok());
    REQUIRE(renderer.set_tool(square(8e-3, 0.0)).ok());
    FrameView view = from_above();
    const auto without = renderer.draw(view, kSize, kSize);
    view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, 2e-3 + off * kEdge)};
    const auto with = renderer.draw(view, kSize, kSize);
    const auto probe = renderer.probe(view, kSize, kSize);
    REQUIRE((without.ok() && with.ok() && probe.ok()));
    CHECK(with->pixels == probe->image.pixels);
    CHECK((with->pixels == without->pixels) == (off < 0.0));
  }
}

TEST_CASE("depth: a tool inside the bone leaves the picture as it was, byte for byte") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  REQUIRE(renderer.set_tool(square(8e-3, 0.0)).ok());
  FrameView view = from_above();
  const auto without = renderer.draw(view, kSize, kSize);
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, -5e-3)};
  const auto hidden = renderer.draw(view, kSize, kSize);
  REQUIRE((without.ok() && hidden.ok()));
  // The tool lies within the volume's depth range, so the range is the same and so is every depth.
  CHECK(pictures_agree("tool-hidden", hidden.value(), without.value(), {}));
}

TEST_CASE("depth: the tool is not cut by the cut plane") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  REQUIRE(renderer.set_tool(square(8e-3, 0.0)).ok());
  FrameView view = from_above();
  view.cut = FrameView::Cut{Vec3(0.0, 0.0, 1.0), -20e-3};  // all bone is gone
  const auto empty = renderer.draw(view, kSize, kSize);
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0)};
  const auto tool = renderer.draw(view, kSize, kSize);
  REQUIRE((empty.ok() && tool.ok()));
  CHECK_FALSE(pixel(empty.value(), 50, 50) == pixel(tool.value(), 50, 50));
  CHECK(pixel(empty.value(), 1, 1) == pixel(tool.value(), 1, 1));
}

TEST_CASE("cut: the face shows the colour that lies inside, lit by the face's own normal") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  FrameView view;
  view.camera = {.eye = {0.0, -0.1, 0.0}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.2};
  view.light = {.ambient = 0.3, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {0.6, -0.8, 0.0}};
  view.cut = FrameView::Cut{Vec3(0.0, -2.0, 0.0), -2e-3};  // a normal of length 2 means the plane y = 1 mm all the same
  const auto probe = renderer.probe(view, kSize, kSize);
  REQUIRE(probe.ok());
  const double light = 0.3 + 0.5 * 0.8;  // N = -y
  // One level for rounding the colour, one for the driver's 8-bit filter.
  const Rgba8& below = pixel(probe.value().image, 50, 80);
  CHECK(std::abs(below.r - 180.0 * light) <= 2.0);
  CHECK(std::abs(below.g - 40.0 * light) <= 2.0);
  const Rgba8& above = pixel(probe.value().image, 50, 47);
  CHECK(std::abs(above.r - 200.0 * light) <= 2.0);
  const auto hit = Vec3(probe.value().hit_index[80 * kSize + 50]);
  // Float positions along a ray of 0.1 m: 1e-3 voxel.
  CHECK(half_millimetre_cube().linear[1][1] * hit.y + half_millimetre_cube().offset.y == doctest::Approx(1e-3).epsilon(1e-3));
}

TEST_CASE("cut: the half that is kept is drawn as without the cut") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  FrameView view = from_above();
  const auto whole = renderer.draw(view, kSize, kSize);
  view.cut = FrameView::Cut{Vec3(1.0, 0.0, 0.0), 0.0};
  const auto half = renderer.draw(view, kSize, kSize);
  REQUIRE((whole.ok() && half.ok()));
  CHECK(pixel(half.value(), 30, 50) == pixel(whole.value(), 30, 50));
  CHECK_FALSE(pixel(half.value(), 80, 50) == pixel(whole.value(), 80, 50));
}

TEST_CASE("light: a flat face has the brightness of the paper's model") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(plate()).ok());
  FrameView view = from_above();
  view.light = {.ambient = 0.25, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {0.0, 3.0, 4.0}};
  const auto image = renderer.draw(view, kSize, kSize);
  REQUIRE(image.ok());
  // The stored normal is off by up to 1/255 a component and filtered in 8 bits: 2 levels.
  CHECK(std::abs(pixel(image.value(), 50, 50).r - 200.0 * (0.25 + 0.5 * 0.8)) <= 2.0);
}

TEST_CASE("appearance: by ambient occlusion the floor of a deep hole is darker than the same floor in the open, and only then") {
  const auto floor_brightness = [](bool occlusion, double radius) {
    Renderer renderer = require_renderer({.finish = false, .appearance = {.occlusion = occlusion}});
    const VolumeView volume = make_volume({.dims = Vec3i(64),
                                           .bone_from_index = half_millimetre_cube(),
                                           .bone =
                                               [radius](const Vec3& p) {
                                                 const double hole = std::min(p.z + 8e-3, radius - std::sqrt(p.x * p.x + p.y * p.y));
                                                 return std::min(4e-3 - p.z, -hole);
                                               },
                                           .soft = {},
                                           .color = {}});
    REQUIRE(renderer.set_volume(volume).ok());
    FrameView view = from_above();
    view.camera.eye = Vec3(0.0, -1e-4, 0.1);
    const auto image = renderer.draw(view, kSize, kSize);
    REQUIRE(image.ok());
    return static_cast<int>(pixel(image.value(), 50, 50).r);
  };
  CHECK(floor_brightness(true, 3e-3) < floor_brightness(true, 50e-3) - 20);
  CHECK(std::abs(floor_brightness(false, 3e-3) - floor_brightness(false, 50e-3)) <= 2);
}
