// What a picture may show beyond the light of the paper: tissue, shadow, glint, one colour, normals from the density.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 160;
constexpr double kEdge = 0.5e-3;
constexpr double kRadius = 4e-3;  ///< of the hole
constexpr double kFloor = -4e-3;  ///< where bone ends below

double from_axis(const Vec3& p) { return std::sqrt(p.x * p.x + p.y * p.y); }

/// A slab with its top at z = 4 mm, or the same with a hole through it: as if it had been drilled.
VolumeView slab(bool drilled, bool tissue_as_drilled = false) {
  const auto whole = [](const Vec3& p) { return std::min(4e-3 - p.z, p.z - kFloor); };
  const auto holed = [whole](const Vec3& p) { return std::min(whole(p), from_axis(p) - kRadius); };
  VolumeRecipe recipe{.dims = Vec3i(64), .bone_from_index = half_millimetre_cube(), .bone = whole, .soft = {}, .color = {}};
  VolumeView loaded = make_volume(recipe);
  recipe.bone = holed;
  VolumeView left = make_volume(recipe);
  VolumeView out = drilled ? left : loaded;
  for (const Rgba8& texel : (tissue_as_drilled ? left : loaded).normal_opacity) out.tissue.push_back({texel.a, 255});
  return out;
}

/// Evenly lit, so that colours are those of the tissue: C = Cv.
FrameView evenly_lit() {
  FrameView view;
  view.camera = {.eye = {0.0, -0.05, 0.07}, .target = {0.0, 0.0, 2e-3}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.35};
  view.light = {.ambient = 1.0, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  return view;
}

FrameProbe probed(const VolumeView& volume, const Appearance& appearance, const FrameView& view) {
  Renderer renderer = require_renderer({.finish = false, .appearance = appearance});
  REQUIRE(renderer.set_volume(volume).ok());
  auto probe = renderer.probe(view, kSize, kSize);
  REQUIRE(probe.ok());
  return std::move(probe).value();
}

/// Pixels by where their ray met the slab, two voxels and more away from the rim of the hole.
struct Places {
  std::vector<std::size_t> top, wall;
};
Places places_of(const FrameProbe& probe) {
  Places places;
  for (std::size_t n = 0; n < probe.hit.size(); ++n) {
    if (probe.hit[n] == 0) continue;
    const Vec3 p = half_millimetre_cube() * Vec3(probe.hit_index[n]);
    if (std::abs(p.z - 4e-3) < 0.1e-3 && from_axis(p) > kRadius + 2.5 * kEdge && from_axis(p) < 12e-3) places.top.push_back(n);
    if (std::abs(from_axis(p) - kRadius) < 0.1e-3 && p.z < 4e-3 - 2.5 * kEdge && p.z > kFloor + 2.5 * kEdge) places.wall.push_back(n);
  }
  return places;
}

/// Red over green: ivory has 200/184, pores of marrow 0.40/0.12.
double redness(const FrameProbe& probe, const std::vector<std::size_t>& pixels) {
  double red = 0.0, green = 0.0;
  for (const std::size_t n : pixels) {
    red += probe.image.pixels[n].r;
    green += probe.image.pixels[n].g;
  }
  return red / green;
}

constexpr Appearance kTissue{.tissue = true};

}  // namespace

TEST_CASE("appearance: the wall of a hole through spongy bone shows pores, old surface beside it keeps its bytes") {
  const FrameProbe before = probed(slab(false), kTissue, evenly_lit());
  const FrameProbe after = probed(slab(true), kTissue, evenly_lit());
  const Places places = places_of(after);
  REQUIRE(places.top.size() > 2000);
  REQUIRE(places.wall.size() > 300);
  for (const std::size_t n : places.top) REQUIRE(before.image.pixels[n] == after.image.pixels[n]);
  CHECK(redness(after, places.wall) > redness(after, places.top) + 0.25);
}

TEST_CASE("appearance: without the bone as loaded a cut has the appearance of old surface") {
  // Sabotage of the test above: the tissue says that the hole was there from the first.
  const FrameProbe after = probed(slab(true, true), kTissue, evenly_lit());
  const Places places = places_of(after);
  CHECK(std::abs(redness(after, places.wall) - redness(after, places.top)) < 0.1);
}

TEST_CASE("appearance: a cut plane through fresh bone shows its inside") {
  FrameView view = evenly_lit();
  view.cut = FrameView::Cut{Vec3(0.0, -1.0, 0.0), 0.0};
  const FrameProbe cut = probed(slab(false), kTissue, view);
  std::vector<std::size_t> face, top;
  for (std::size_t n = 0; n < cut.hit.size(); ++n) {
    if (cut.hit[n] == 0) continue;
    const Vec3 p = half_millimetre_cube() * Vec3(cut.hit_index[n]);
    if (p.y < 1e-5 && p.z < 3e-3) face.push_back(n);
    if (p.y > 1e-3 && p.z > 3.9e-3) top.push_back(n);
  }
  REQUIRE(face.size() > 500);
  CHECK(redness(cut, face) > redness(cut, top) + 0.25);
}

TEST_CASE("appearance: tissue is fixed to the bone, wherever that lies") {
  const FrameProbe still = probed(slab(true), kTissue, evenly_lit());
  FrameView moved = evenly_lit();
  const Pose world_from_bone{glm::angleAxis(0.5, glm::normalize(Vec3(0.2, -1.0, 0.4))), Vec3(0.01, -0.02, 0.005)};
  moved.world_from_bone = world_from_bone;
  moved.camera.eye = world_from_bone * moved.camera.eye;
  moved.camera.target = world_from_bone * moved.camera.target;
  moved.camera.up = world_from_bone.rotate(moved.camera.up);
  const FrameProbe turned = probed(slab(true), kTissue, moved);
  // The same rays but for rounding: pixels on the edges of pores and on silhouettes may go the other way.
  CHECK(pictures_agree("tissue-moved", turned.image, still.image, {.level = 6, .share = 0.01}));
}

TEST_CASE("appearance: a volume without tissue is drawn plain, and sends none") {
  VolumeView volume = slab(true);
  const std::size_t with = volume.tissue.size();
  volume.tissue.clear();
  Renderer renderer = require_renderer({.finish = false, .appearance = kTissue});
  REQUIRE(renderer.set_volume(volume).ok());
  CHECK(renderer.counters().volume_bytes == 10 * with);
  Renderer plain = require_renderer();
  REQUIRE(plain.set_volume(slab(true)).ok());
  CHECK(plain.counters().volume_bytes == 12 * with);
  const auto a = renderer.draw(evenly_lit(), kSize, kSize), b = plain.draw(evenly_lit(), kSize, kSize);
  REQUIRE((a.ok() && b.ok()));
  CHECK(pictures_agree("no-tissue", a.value(), b.value(), {}));
  volume.tissue.resize(with - 1);
  CHECK_FALSE(renderer.set_volume(volume).ok());
}

TEST_CASE("appearance: rays of a pixel that share the samples of ambient occlusion draw what rays with all samples draw") {
  // Pixels whose rays meet several surfaces may differ: those at outlines, one in fifty here.
  const auto post_on_plate = [](const std::string& folder) {
    Renderer renderer = require_renderer({.appearance = {.occlusion = true}, .supersample = 2, .shader_folder = folder});
    REQUIRE(renderer.set_volume(ball_on_plate()).ok());
    const VoxelBox post{{40, 8, 20}, {46, 14, 44}};
    renderer.update(
        {post, std::vector<Rgba8>(post.count(), Rgba8{128, 128, 255, 255}), std::vector<std::uint16_t>(post.count(), field_of(255, 0))});
    auto image = renderer.draw(oblique_view(), 160, 120);
    REQUIRE(image.ok());
    return std::move(image).value();
  };
  const std::string side = "int side = int(background_bottom.w);", place = "ivec2 place = ivec2(gl_FragCoord.xy) % side;";
  const Image all = post_on_plate(changed_shaders("sky-all", "occlusion.glsl", side, "int side = 1;"));
  CHECK(pictures_agree("sky-shared", post_on_plate({}), all, {.level = 4, .share = 0.02}));
  const Image one_of_four = post_on_plate(changed_shaders("sky-quarter", "occlusion.glsl", place, "ivec2 place = ivec2(0);"));
  CHECK(compare_pictures(one_of_four, all, 4).differing_share > 0.02);
}

TEST_CASE("appearance: the length of a wall's shadow follows the slope of the light") {
  constexpr double kWall = 5e-3;
  const VolumeView volume = make_volume({.dims = Vec3i(64),
                                         .bone_from_index = half_millimetre_cube(),
                                         .bone =
                                             [](const Vec3& p) {
                                               const double wall = std::min({p.x + 6e-3, -3e-3 - p.x, kWall - p.z});
                                               return std::max(-p.z, wall);
                                             },
                                         .soft = {},
                                         .color = {}});
  FrameView view = evenly_lit();
  view.camera = {.eye = {0.0, 0.0, 0.2}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 1.0, 0.0}, .vertical_fov = 0.15};
  for (const double slope : {0.7, 1.3}) {
    view.light = {.ambient = 0.4, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {-1.0, 0.0, slope}};
    const FrameProbe lit = probed(volume, {.shadow = true}, view);
    const FrameProbe plain = probed(volume, {}, view);
    const double tip = -3e-3 + kWall / slope;
    int in_shadow = 0, in_light = 0;
    for (std::size_t n = 0; n < lit.hit.size(); ++n) {
      const Vec3 p = half_millimetre_cube() * Vec3(lit.hit_index[n]);
      if (lit.hit[n] == 0 || std::abs(p.z) > 0.1e-3) continue;
      // Of the light of the floor 0.4 of 0.4 + 0.5 N.L is left. Within 2 voxels of the wall's edge and of the shadow's the level is not
      // sharp.
      if (p.x > -3e-3 + 2.0 * kEdge && p.x < tip - 2.0 * kEdge / slope - kEdge) {
        ++in_shadow;
        REQUIRE(std::abs(lit.image.pixels[n].r - 0.4 * 200.0) <= 1.5);
      } else if (p.x > tip + 2.0 * kEdge / slope + kEdge && p.x < 14e-3) {
        ++in_light;
        REQUIRE(lit.image.pixels[n] == plain.image.pixels[n]);
      }
    }
    CHECK(in_shadow > 300);
    CHECK(in_light > 1000);
  }
}

TEST_CASE("appearance: a specular highlight adds a tenth of the light") {
  const VolumeView floor = make_volume(
      {.dims = Vec3i(64), .bone_from_index = half_millimetre_cube(), .bone = [](const Vec3& p) { return -p.z; }, .soft = {}, .color = {}});
  FrameView view = evenly_lit();
  view.camera = {.eye = {0.0, -0.1, 0.1}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.1};
  view.light = {.ambient = 0.3, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {0.0, 1.0, 1.0}};
  const auto middle = [&](const Appearance& appearance) {
    return static_cast<double>(probed(floor, appearance, view).image.pixels[kSize / 2 * kSize + kSize / 2].r);
  };
  // Where half way between light and eye is the normal: 0.1 of the light's 0.5, on 255; a level of rounding on each side.
  CHECK(std::abs(middle({.specular = true}) - middle({}) - 0.1 * 0.5 * 255.0) <= 1.5);
  view.light.direction_to_light = {0.0, -1.0, 1.0};  // the mirror's direction is a right angle away
  CHECK(std::abs(middle({.specular = true}) - middle({})) <= 1.0);
}

TEST_CASE("appearance: without label colours bone is of one ivory, whatever its texels say") {
  VolumeView volume = slab(true);
  for (std::size_t n = 0; n < volume.color.size(); ++n) volume.color[n] = {static_cast<std::uint8_t>(n), 10, 200, 0};
  const FrameProbe seen = probed(volume, {.labels = false}, evenly_lit());
  for (std::size_t n = 0; n < seen.hit.size(); ++n)
    if (seen.hit[n] != 0) REQUIRE(seen.image.pixels[n] == Rgba8{237, 224, 194, 255});  // 0.93, 0.88, 0.76
}

TEST_CASE("appearance: recomputed normals do not depend on those sent, and are those of the surface") {
  VolumeView truth = ball_on_plate(), wrong = truth;
  for (Rgba8& texel : wrong.normal_opacity) texel = {255, 0, 128, texel.a};
  const Appearance recomputed{.normals = NormalSource::recomputed};
  FrameView view = oblique_view();
  view.light = {.ambient = 0.0, .diffuse = 1.0, .fill = 0.0, .direction_to_light = {0.3, -0.5, 0.8}};
  const FrameProbe a = probed(truth, recomputed, view), b = probed(wrong, recomputed, view);
  CHECK(pictures_agree("recomputed", a.image, b.image, {}));
  CHECK_FALSE(compare_pictures(a.image, probed(wrong, {}, view).image, 3).differing_share < 0.1);
}

TEST_CASE("appearance: light by recomputed normals is that of the closed form") {
  // A ball whose density falls from 1 to 0 over twice `half_ramp` voxels across its surface.
  const Vec3 middle(1e-3, 0.0, 2e-3);
  const auto ball = [&](double half_ramp) {
    VolumeView volume;
    volume.dims = Vec3i(64);
    volume.bone_from_index = half_millimetre_cube();
    for_each_voxel({Vec3i(0), volume.dims}, [&](const Vec3i& v) {
      const double inside = 8e-3 - glm::length(volume.bone_from_index * Vec3(v) - middle);
      const double density = std::clamp(0.5 + inside / (2.0 * half_ramp * kEdge), 0.0, 1.0);
      volume.normal_opacity.push_back({0, 0, 0, static_cast<std::uint8_t>(std::floor(255.0 * density + 0.5))});
      volume.color.push_back({200, 184, 160, 0});
    });
    return volume;
  };
  FrameView view = oblique_view();
  view.light = {.ambient = 0.0, .diffuse = 1.0, .fill = 0.0, .direction_to_light = {0.3, -0.5, 0.8}};
  const auto largest_error = [&](double half_ramp) {
    const FrameProbe seen = probed(ball(half_ramp), {.normals = NormalSource::recomputed}, view);
    double largest = 0.0;
    int pixels = 0;
    for (std::size_t n = 0; n < seen.hit.size(); ++n) {
      if (seen.hit[n] == 0) continue;
      const Vec3 out = glm::normalize(half_millimetre_cube() * Vec3(seen.hit_index[n]) - middle);
      const double expected = 200.0 * std::max(0.0, glm::dot(out, glm::normalize(view.light.direction_to_light)));
      largest = std::max(largest, std::abs(seen.image.pixels[n].r - expected));
      ++pixels;
    }
    CHECK(pixels > 1000);
    return largest;
  };
  // By a model of the eight filtered samples over 4000 random places on such a ball: 1.35 levels where the ramp is 4 voxels wide, from the
  // rounding of densities and the curvature. Where the ramp is 2 wide the slope is twice as steep, but the samples' filters reach past its
  // ends, where the density is level: 8.8 levels, 2.6 degrees. Half a level for the picture's own rounding.
  CHECK(largest_error(2.0) <= 1.85);
  CHECK(largest_error(1.0) <= 9.3);
}

TEST_CASE("appearance: a cut plane takes away what lies beyond it, drawn by rays, by slices and translucent") {
  const VolumeView volume = make_volume({.dims = Vec3i(64),
                                         .bone_from_index = half_millimetre_cube(),
                                         .bone = [](const Vec3& p) { return 5e-3 - glm::length(Vec3(std::abs(p.x) - 8e-3, p.y, p.z)); },
                                         .soft = {},
                                         .color = {}});
  FrameView view = evenly_lit();
  view.camera = {.eye = {0.0, -0.1, 0.0}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.35};
  const RenderOptions rays{.finish = false}, slices{.finish = false, .slices = SliceOptions{}},
      translucent{.finish = false,
                  .translucent = TransferFunction{{.density = 0.3, .extinction = 0.0}, {.density = 1.0, .extinction = 300.0}}};
  for (const RenderOptions& options : {rays, slices, translucent}) {
    Renderer renderer = require_renderer(options);
    const auto empty = renderer.draw(view, kSize, kSize);
    REQUIRE(renderer.set_volume(volume).ok());
    const auto whole = renderer.draw(view, kSize, kSize);
    FrameView half = view;
    half.cut = FrameView::Cut{Vec3(2.0, 0.0, 0.0), 0.0};  // the ball at +x, on the right, goes
    const auto cut = renderer.draw(half, kSize, kSize);
    REQUIRE((empty.ok() && whole.ok() && cut.ok()));
    int seen = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const std::size_t n = static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x);
        REQUIRE(cut->pixels[n] == (x < kSize / 2 ? whole : empty)->pixels[n]);
        seen += x > kSize / 2 && whole->pixels[n] != empty->pixels[n] ? 1 : 0;
      }
    CHECK(seen > 1000);  // or there was nothing to cut away
  }
}

TEST_CASE("appearance: a section of the bit is hatched, orange where it cuts and grey elsewhere, and a surface is not") {
  Renderer renderer = require_renderer({.finish = false});
  REQUIRE(renderer.set_volume(slab(false)).ok());
  FrameView view = evenly_lit();
  view.camera = {.eye = {0.0, 0.0, 0.06}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 1.0, 0.0}, .vertical_fov = 0.25};
  view.world_from_tool = Pose{};
  struct Seen {
    double red = 0.0, blue = 0.0, least = 255.0, most = 0.0;  // means, and the range of green
  };
  const auto seen = [&](float length) {
    TriangleMesh mesh = square(5e-3, 6e-3);  // above the slab
    for (Vec3f& normal : mesh.normals) normal *= length;
    REQUIRE(renderer.set_tool(mesh).ok());
    const auto picture = renderer.draw(view, kSize, kSize);
    REQUIRE(picture.ok());
    Seen out;
    int count = 0;
    for (int y = kSize / 2 - 20; y < kSize / 2 + 20; ++y)
      for (int x = kSize / 2 - 20; x < kSize / 2 + 20; ++x, ++count) {
        const Rgba8 c = picture->pixels[static_cast<std::size_t>(y * kSize + x)];
        out.red += c.r;
        out.blue += c.b;
        out.least = std::min(out.least, static_cast<double>(c.g));
        out.most = std::max(out.most, static_cast<double>(c.g));
      }
    out.red /= count, out.blue /= count;
    return out;
  };
  const Seen surface = seen(1.0f), cuts = seen(2.0f), body = seen(3.0f);
  CHECK(surface.most - surface.least < 25.0);  // reflections change slowly
  CHECK(std::abs(surface.red - surface.blue) < 20.0);
  CHECK(cuts.red > 2.0 * cuts.blue);
  CHECK(std::abs(body.red - body.blue) < 25.0);
  // Lines have 0.55 of the colour between them.
  CHECK(cuts.least < 0.7 * cuts.most);
  CHECK(body.least < 0.7 * body.most);
}
