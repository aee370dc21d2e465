// The shadow of the tool on bone: its outline in closed form, where it is not, and the pixels that may show it.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "app/render/footprint.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 160;
constexpr double kDistance = 0.2;  ///< [m] of the eye from the floor
constexpr double kFov = 0.15;
constexpr double kRadius = 2e-3;
constexpr double kHeight = 5e-3;  ///< [m] of the tool over the floor
constexpr double kLength = 6e-3;  ///< of the cylinder
const Vec3 kLight = glm::normalize(Vec3(-1.0, 0.4, 1.2));

/// The body that a closed profile of radius and height sweeps round the z axis. Its chords are within 0.3 um of the circle.
TriangleMesh lathe(const std::vector<Vec2>& profile) {
  constexpr std::uint32_t kSides = 256;
  TriangleMesh mesh;
  for (const Vec2& point : profile)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      mesh.positions.emplace_back(point.x * std::cos(angle), point.x * std::sin(angle), point.y);
      mesh.normals.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
  for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = ring * kSides + side, b = ring * kSides + (side + 1) % kSides;
      for (const std::uint32_t corner : {a, b, a + kSides, b, b + kSides, a + kSides}) mesh.indices.push_back(corner);
    }
  return mesh;
}

TriangleMesh ball_tool() {
  std::vector<Vec2> profile;
  for (int n = 0; n <= 128; ++n) {
    const double angle = std::numbers::pi * n / 128;
    profile.emplace_back(kRadius * std::sin(angle), -kRadius * std::cos(angle));
  }
  return lathe(profile);
}

TriangleMesh cylinder_tool() { return lathe({{0.0, 0.0}, {kRadius, 0.0}, {kRadius, kLength}, {0.0, kLength}}); }

/// Whether a point of the floor z = 0 lies in the shadow for a light from `to_light`.
using InShadow = std::function<bool(const Vec3& point, const Vec3& to_light)>;

/// Centre at height kHeight: the ray to the light passes it within its radius.
bool in_shadow_of_ball(const Vec3& point, const Vec3& to_light) {
  return glm::length(glm::cross(Vec3(0.0, 0.0, kHeight) - point, to_light)) < kRadius;
}

/// Upright from kHeight: the part of the ray at its heights passes the axis within its radius, seen from above.
bool in_shadow_of_cylinder(const Vec3& point, const Vec3& to_light) {
  const auto at = [&](double z) { return Vec2(point) + z / to_light.z * Vec2(to_light); };
  const Vec2 low = at(kHeight), along = at(kHeight + kLength) - low;
  const double nearest = std::clamp(-glm::dot(low, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::length(low + nearest * along) < kRadius;
}

/// Seen from above: a level with light 0.4 Cv, and 0.5 Cv N.L that a shadow takes.
FrameView from_above(const Vec3& to_light) {
  FrameView view;
  view.camera = {.eye = {0.0, 0.0, kDistance}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 1.0, 0.0}, .vertical_fov = kFov};
  view.light = {.ambient = 0.4, .diffuse = 0.5, .fill = 0.0, .direction_to_light = to_light};
  return view;
}

VolumeView floor_volume() {
  return make_volume(
      {.dims = Vec3i(64), .bone_from_index = half_millimetre_cube(), .bone = [](const Vec3& p) { return -p.z; }, .soft = {}, .color = {}});
}

Image drawn(Renderer& renderer, const FrameView& view) {
  auto image = renderer.draw(view, kSize, kSize);
  REQUIRE(image.ok());
  return std::move(image).value();
}

struct Outline {
  int dark = 0, lit = 0;  ///< pixels further than one pixel from the outline
  int wrong = 0;          ///< of these, pixels with the other level
};

/// @param expected_light for the closed form.
Outline compare(const TriangleMesh& tool, const InShadow& in_shadow, const Vec3& expected_light) {
  constexpr double kEdgeOfVolume = 14e-3;
  const double pixel = 2.0 * kDistance * std::tan(0.5 * kFov) / kSize;
  Renderer renderer = require_renderer({.finish = false, .appearance = {.shadow = true}});
  REQUIRE(renderer.set_volume(floor_volume()).ok());
  REQUIRE(renderer.set_tool(tool).ok());
  FrameView view = from_above(kLight);
  const auto bare = renderer.probe(view, kSize, kSize);
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, kHeight)};
  const auto covered = renderer.probe(view, kSize, kSize);
  REQUIRE((bare.ok() && covered.ok()));
  const Image image = drawn(renderer, view);
  Outline out;
  for (std::size_t n = 0; n < bare->hit.size(); ++n) {
    const Vec3 p = half_millimetre_cube() * Vec3(bare->hit_index[n]);
    if (bare->hit[n] == 0 || covered->hit[n] == 0 || std::max(std::abs(p.x), std::abs(p.y)) > kEdgeOfVolume) continue;
    const bool dark = in_shadow(p, expected_light);
    bool at_outline = false;
    for (int k = 0; k < 16; ++k) {
      const double angle = std::numbers::pi / 8.0 * k;
      at_outline |= in_shadow(p + pixel * Vec3(std::cos(angle), std::sin(angle), 0.0), expected_light) != dark;
    }
    if (at_outline) continue;
    ++(dark ? out.dark : out.lit);
    const bool as_expected = dark ? std::abs(image.pixels[n].r - 0.4 * 200.0) <= 1.5 : image.pixels[n] == bare->image.pixels[n];
    out.wrong += as_expected ? 0 : 1;
  }
  return out;
}

}  // namespace

TEST_CASE("tool shadow: the outlines of a ball's and of a cylinder's are those of the closed form within one pixel") {
  const Vec3 mirrored(-kLight.x, -kLight.y, kLight.z);
  const std::vector<std::pair<TriangleMesh, InShadow>> tools{{ball_tool(), in_shadow_of_ball}, {cylinder_tool(), in_shadow_of_cylinder}};
  for (const auto& [mesh, in_shadow] : tools) {
    const Outline right = compare(mesh, in_shadow, kLight);
    CHECK(right.dark > 200);
    CHECK(right.lit > 5000);
    CHECK(right.wrong == 0);
    // The shadow of a light on the other side is elsewhere.
    CHECK(compare(mesh, in_shadow, mirrored).wrong > 200);
  }
}

TEST_CASE("tool shadow: bone between the tool and the light has none, and a scene without shadows has none") {
  const VolumeView slab = make_volume({.dims = Vec3i(64),
                                       .bone_from_index = half_millimetre_cube(),
                                       .bone = [](const Vec3& p) { return std::min(4e-3 - p.z, p.z + 4e-3); },
                                       .soft = {},
                                       .color = {}});
  const auto differing = [&](bool shadow, double height, const std::string& shaders) {
    Renderer renderer = require_renderer({.finish = false, .appearance = {.shadow = shadow}, .shader_folder = shaders});
    REQUIRE(renderer.set_volume(slab).ok());
    REQUIRE(renderer.set_tool(ball_tool()).ok());
    FrameView view = from_above(Vec3(0.1, 0.05, 1.0));
    const Image before = drawn(renderer, view);
    view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, height)};
    const auto covered = renderer.probe(view, kSize, kSize);
    REQUIRE(covered.ok());
    const Image after = drawn(renderer, view);
    int out = 0;
    for (std::size_t n = 0; n < after.pixels.size(); ++n) out += covered->hit[n] == 1 && !(after.pixels[n] == before.pixels[n]) ? 1 : 0;
    return out;
  };
  CHECK(differing(true, 10e-3, {}) > 50);
  CHECK(differing(false, 10e-3, {}) == 0);
  CHECK(differing(true, -9e-3, {}) == 0);
  // A shadow that is cast to both sides is noticed.
  CHECK(differing(true, -9e-3, changed_shaders("both-sides", "tool_shadow.glsl", "min(at.z, 1.0)", "1.0")) > 200);
}

TEST_CASE("tool shadow: its footprint contains all pixels that it changes, and is needed") {
  // Beside the box of the volume along the light, and beyond it.
  for (const Vec3& place : {Vec3(-10e-3, 2e-3, 13e-3), Vec3(-34e-3, 10e-3, 42e-3)}) {
    Renderer renderer = require_renderer({.appearance = {.shadow = true}, .keep_picture = false});
    const TriangleMesh mesh = cylinder_tool();
    REQUIRE(renderer.set_volume(ball_on_plate()).ok());
    REQUIRE(renderer.set_tool(mesh).ok());
    FrameView view = oblique_view();
    view.light.direction_to_light = kLight;
    const auto rays = make_camera_rays(view.camera, 1.0);
    REQUIRE(rays.ok());
    std::vector<Vec3> bone;
    for (const double x : {-16e-3, 16e-3})
      for (const double y : {-16e-3, 16e-3})
        for (const double z : {-16e-3, 16e-3}) bone.emplace_back(x, y, z);
    const Image before = drawn(renderer, view);
    const Pose pose{glm::normalize(Quat(0.95, 0.1, 0.25, 0.0)), place};
    view.world_from_tool = pose;
    const Image after = drawn(renderer, view);
    std::vector<Vec3> tool;
    for (const Vec3f& p : mesh.positions) tool.push_back(pose * Vec3(p));
    const PixelRect of_tool = find_footprint(*rays, tool, Vec2i(kSize));
    const PixelRect of_shadow = find_shadow_footprint(*rays, {tool, bone, kLight}, Vec2i(kSize));
    int outside = 0, in_shadow = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const auto n = static_cast<std::size_t>((kSize - 1 - y) * kSize + x);
        const PixelRect here{{x, y}, {x + 1, y + 1}};
        if (after.pixels[n] == before.pixels[n] || of_tool.contains(here)) continue;
        ++(of_shadow.contains(here) ? in_shadow : outside);
      }
    CHECK(outside == 0);
    CHECK(in_shadow > 50);
    CHECK(of_shadow.count() < 3 * kSize * kSize / 4);
  }
}
