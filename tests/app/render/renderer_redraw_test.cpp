// What is drawn anew when texels or the tool changed: the bytes of a whole picture, by fewer pixels, whatever is drawn and however.
#include <doctest/doctest.h>

#include <cmath>

#include "app/render/footprint.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr std::uint64_t kAll = std::uint64_t{kWidth} * kHeight;
constexpr VoxelBox kPit{{32, 16, 40}, {42, 26, 52}};

TexelBox filled(const VoxelBox& box, std::uint8_t opacity) {
  return {box, std::vector<Rgba8>(box.count(), Rgba8{128, 128, 255, opacity}),
          std::vector<std::uint16_t>(box.count(), field_of(opacity, 0))};
}

/// Prism standing on a square of 4 mm, 12 mm high.
TriangleMesh post() {
  TriangleMesh mesh;
  for (const float z : {0.0f, 12e-3f})
    for (const auto& [x, y] : {std::pair{-2e-3f, -2e-3f}, std::pair{2e-3f, -2e-3f}, std::pair{2e-3f, 2e-3f}, std::pair{-2e-3f, 2e-3f}}) {
      mesh.positions.push_back({x, y, z});
      mesh.normals.push_back(glm::normalize(Vec3f(x, y, 0.0f)));
    }
  for (std::uint32_t side = 0; side < 4; ++side) {
    const std::uint32_t next = (side + 1) % 4;
    for (const std::uint32_t corner : {side, next, side + 4, next, next + 4, side + 4}) mesh.indices.push_back(corner);
  }
  return mesh;
}

Pose at(double x, double z) { return {Quat(0.98, 0.1, 0.05, 0.0), Vec3(x, 0.0, z)}; }

/// One renderer that keeps its picture and one that never does, fed alike.
struct Pair {
  Renderer kept, whole;
  FrameView view = oblique_view();
  Image last;

  explicit Pair(RenderOptions options) : kept(require_renderer(options)), whole(require_renderer(without_keeping(options))) {
    for (Renderer* one : {&kept, &whole}) {
      REQUIRE(one->set_volume(ball_on_plate()).ok());
      REQUIRE(one->set_tool(post()).ok());
    }
  }
  static RenderOptions without_keeping(RenderOptions options) {
    options.keep_picture = false;
    return options;
  }
  void update(const TexelBox& texels) {
    kept.update(texels);
    whole.update(texels);
  }
  /// @returns pixels that the keeping one drew, those of the tool included.
  std::uint64_t draw(const std::string& name) {
    const auto drawn = [this] { return kept.counters().drawn_pixels + kept.counters().tool_pixels; };
    const std::uint64_t before = drawn();
    const auto by_parts = kept.draw(view, kWidth, kHeight);
    const auto at_once = whole.draw(view, kWidth, kHeight);
    REQUIRE(by_parts.ok());
    REQUIRE(at_once.ok());
    CHECK(pictures_agree("redraw-" + name, *by_parts, *at_once, {}));
    last = *at_once;
    return drawn() - before;
  }
};

void check_sequence(const std::string& name, const RenderOptions& options, double share, const glm::dvec2& shift = glm::dvec2(0.0)) {
  Pair pair(options);
  pair.view.camera.shift = shift;
  CHECK(pair.draw(name + "-first") == kAll);
  CHECK(pair.draw(name + "-again") == 0);
  const Image untouched = pair.last;
  pair.update(filled(kPit, 0));
  const std::uint64_t pit = pair.draw(name + "-pit");
  CHECK(pit > 0);
  CHECK(static_cast<double>(pit) < share * static_cast<double>(kAll));
  CHECK(compare_pictures(pair.last, untouched, 0).differing_share > 0.001);
  pair.view.world_from_tool = at(1e-3, 9e-3);
  const std::uint64_t tool = pair.draw(name + "-tool");
  CHECK(tool > 0);
  CHECK(tool < kAll / 3);
  pair.view.world_from_tool = at(-8e-3, 4e-3);  // far off its old place
  CHECK(pair.draw(name + "-moved") < kAll / 2);
  pair.view.world_from_tool = at(-7e-3, 4e-3);
  pair.update(filled({{20, 30, 40}, {26, 36, 52}}, 0));
  const std::uint64_t most = share < 1.0 ? kAll - 1 : kAll;  // what looks far may reach everywhere
  CHECK(pair.draw(name + "-both") <= most);
  CHECK(pair.draw(name + "-still") == 0);
  // Nearer to the eye than the bone: the depth range follows it, colours must not.
  for (const double way : {0.45, 0.7}) {
    pair.view.world_from_tool = Pose{Quat(0.98, 0.1, 0.05, 0.0), way * pair.view.camera.eye};
    pair.update(filled({{30, 20, 40}, {34, 24, way < 0.5 ? 46 : 52}}, 0));
    CHECK(pair.draw(name + "-near") <= most);
  }
  REQUIRE(pair.kept.probe(pair.view, 50, 40).ok() != options.slices.has_value());  // another target in between
  pair.update(filled({{4, 5, 50}, {12, 14, 60}}, 255));                            // bone grows where rays used to leap
  CHECK(pair.draw(name + "-grown") <= most);
  pair.view.world_from_tool.reset();
  CHECK(pair.draw(name + "-gone") < kAll / 2);
  pair.kept.forget();
  CHECK(pair.draw(name + "-forgotten") == kAll);
}

/// All that the picture is made of but texels and tool, a change of each.
std::vector<std::pair<const char*, void (*)(FrameView&)>> other_changes() {
  return {{"eye", [](FrameView& v) { v.camera.eye.x += 1e-4; }},
          {"target", [](FrameView& v) { v.camera.target.z += 1e-4; }},
          {"up", [](FrameView& v) { v.camera.up.x += 0.01; }},
          {"angle", [](FrameView& v) { v.camera.vertical_fov += 1e-3; }},
          {"light", [](FrameView& v) { v.light.direction_to_light.x += 0.1; }},
          {"ambient", [](FrameView& v) { v.light.ambient += 0.05; }},
          {"diffuse", [](FrameView& v) { v.light.diffuse += 0.05; }},
          {"fill", [](FrameView& v) { v.light.fill += 0.05; }},
          {"bone", [](FrameView& v) { v.world_from_bone.translation.x += 1e-3; }},
          {"cut",
           [](FrameView& v) {
             v.cut = FrameView::Cut{{0, -1, 0}, 0.0};
           }},
          {"cut-moved", [](FrameView& v) { v.cut->offset += 1e-3; }},
          {"uncut", [](FrameView& v) { v.cut.reset(); }}};
}

/// `later` inside the rectangles, `earlier` elsewhere: what redrawing just them would show.
Image composed(const Image& earlier, const Image& later, const std::vector<PixelRect>& rects) {
  Image out = earlier;
  for (const PixelRect& r : rects)
    for (int y = r.lo.y; y < r.hi.y; ++y)
      for (int x = r.lo.x; x < r.hi.x; ++x) {
        const auto n = static_cast<std::size_t>((out.height - 1 - y) * out.width + x);
        out.pixels[n] = later.pixels[n];
      }
  return out;
}

Image drawn(Renderer& renderer, const FrameView& view, int width, int height) {
  auto image = renderer.draw(view, width, height);
  REQUIRE(image.ok());
  return std::move(image).value();
}

}  // namespace

TEST_CASE("redraw: a tool beside the picture changes no byte, however near to the eye it is") {
  for (const bool cut : {false, true}) {
    Pair pair({.appearance = {.tissue = true, .occlusion = true}});
    if (cut) pair.view.cut = FrameView::Cut{{0.0, -1.0, 0.0}, 0.0};
    pair.draw("beside-without");
    const Image without = pair.last;
    const Vec3 forward = glm::normalize(pair.view.camera.target - pair.view.camera.eye);
    const Vec3 right = glm::normalize(glm::cross(forward, pair.view.camera.up));
    for (const double away : {40e-3, 15e-3, 4e-3}) {
      pair.view.world_from_tool = Pose{Quat(1, 0, 0, 0), pair.view.camera.eye + away * forward + 3.0 * away * right + 0.02 * right};
      pair.draw("beside");
      CHECK(pictures_agree("redraw-beside", pair.last, without, {}));
    }
  }
}

TEST_CASE("redraw: rays draw the bytes of a whole picture by the pixels that changed") {
  check_sequence("rays", {.finish = false}, 0.1);
  check_sequence("rays-smooth", {.finish = false, .supersample = 2}, 0.1);
  check_sequence("rays-odd", {.step_voxels = 1.0, .skip_empty = false, .finish = false, .supersample = 3}, 0.1);
}

TEST_CASE("redraw: ambient occlusion reaches further, and no byte differs") {
  check_sequence("occlusion", {.appearance = {.occlusion = true}}, 0.3);
  check_sequence("occlusion-smooth", {.appearance = {.occlusion = true}, .supersample = 2}, 0.3);
  check_sequence("occlusion-recomputed", {.appearance = {.tissue = true, .occlusion = true, .normals = NormalSource::recomputed}}, 0.3);
}

TEST_CASE("redraw: a tool that moves before and behind bone needs no ray, and no byte differs") {
  Pair pair({.appearance = {.tissue = true, .occlusion = true}, .supersample = 2});
  pair.view.world_from_tool = at(-8e-3, 4e-3);
  pair.draw("tool-first");
  const std::uint64_t rays = pair.kept.counters().drawn_pixels;
  for (int n = 1; n < 12; ++n) {
    pair.view.world_from_tool = at(-8e-3 + 1.3e-3 * n, 4e-3 - 1.5e-3 * n);  // from beside the ball into the plate
    CHECK(pair.draw("tool-moves") > 0);
  }
  CHECK(pair.kept.counters().drawn_pixels == rays);
}

TEST_CASE("redraw: a tool that moves over bone moves its shadow without a ray, and no byte differs") {
  for (const int rays : {1, 2}) {
    Pair pair({.appearance = {.occlusion = true, .shadow = true}, .supersample = rays});
    pair.view.world_from_tool = at(-8e-3, 14e-3);
    pair.draw("shadow-first");
    const std::uint64_t drawn = pair.kept.counters().drawn_pixels;
    for (int n = 1; n < 12; ++n) {
      pair.view.world_from_tool = at(-8e-3 + 1.3e-3 * n, 14e-3 - 1.5e-3 * n);  // down to the ball and into it
      CHECK(pair.draw("shadow-moves") < kAll);
    }
    CHECK(pair.kept.counters().drawn_pixels == drawn);
    pair.view.world_from_tool.reset();
    CHECK(pair.draw("shadow-gone") < kAll);
    CHECK(pair.kept.counters().drawn_pixels == drawn);
  }
}

TEST_CASE("redraw: without a tool hits are lit again too, and a refused picture in between spoils nothing") {
  Pair pair({.appearance = {.occlusion = true}});
  pair.draw("bare-first");
  const std::uint64_t before = pair.kept.counters().drawn_pixels;
  Renderer bare = require_renderer({.appearance = {.occlusion = true}});
  REQUIRE(bare.set_volume(ball_on_plate()).ok());
  REQUIRE(bare.draw(pair.view, kWidth, kHeight).ok());
  pair.update(filled(kPit, 0));
  bare.update(filled(kPit, 0));
  const std::uint64_t pit = pair.draw("bare-pit");
  const std::uint64_t drawn = bare.counters().drawn_pixels;
  const auto again = bare.draw(pair.view, kWidth, kHeight);
  REQUIRE(again.ok());
  CHECK(again->pixels == pair.last.pixels);
  CHECK(bare.counters().drawn_pixels - drawn == pit);
  CHECK(pit < kAll / 3);
  CHECK(pair.kept.counters().drawn_pixels > before);
  FrameView dark = pair.view;
  dark.light.direction_to_light = Vec3(0.0);
  CHECK_FALSE(pair.kept.draw(dark, kWidth / 2, kHeight / 2).ok());
  pair.view.world_from_tool = at(1e-3, 9e-3);
  pair.draw("refused-between");
}

TEST_CASE("redraw: marks that leave out a ring of ambient occlusion, or its width, are noticed") {
  const auto differing = [](const std::string& right, const std::string& wrong) {
    const std::string folder = changed_shaders("marks", "occlusion.glsl", right, wrong);
    Pair pair({.appearance = {.occlusion = true}, .shader_folder = folder});
    static_cast<void>(pair.kept.draw(pair.view, kWidth, kHeight));
    static_cast<void>(pair.whole.draw(pair.view, kWidth, kHeight));
    pair.update(filled({{40, 8, 20}, {46, 14, 44}}, 255));  // a post darkens the plate on which it stands
    const auto by_parts = pair.kept.draw(pair.view, kWidth, kHeight), at_once = pair.whole.draw(pair.view, kWidth, kHeight);
    REQUIRE((by_parts.ok() && at_once.ok()));
    return compare_pictures(*by_parts, *at_once, 0).differing_share > 0.0;
  };
  CHECK_FALSE(differing("vec3 half_box = kSkySlope * reach * extent;", "vec3 half_box = kSkySlope * reach * extent;"));
  CHECK(differing("vec3 half_box = kSkySlope * reach * extent;", "vec3 half_box = 0.0 * extent;"));
  CHECK(differing("float reach = across * sky_reach(ring);", "float reach = across * sky_reach(0);"));
}

TEST_CASE("redraw: smooth and recomputed normals, a shadow and a glint draw the bytes of a whole picture") {
  check_sequence("finish", {.finish = true}, 0.15);
  check_sequence("recomputed", {.appearance = {.specular = true, .normals = NormalSource::recomputed}}, 0.15);
  check_sequence("shadow", {.appearance = {.shadow = true}}, 1.01);  // it may reach across all of this small bone
}

TEST_CASE("redraw: an eye of two, its frustum off the axis, draws the bytes of a whole picture by the pixels that changed") {
  check_sequence("off-axis", {.finish = false}, 0.15, {0.3, -0.2});
}

TEST_CASE("redraw: slices draw the bytes of a whole picture by the pixels that changed") {
  check_sequence("slices", {.slices = SliceOptions{}}, 0.1);
  check_sequence("slices-smooth", {.supersample = 2, .slices = SliceOptions{.per_voxel = 0.5, .correct = false}}, 0.1);
}

TEST_CASE("redraw: a mesh draws the bytes of a whole picture by the pixels that changed") {
  // A change of a mesh reaches 6.6 voxels, a look-up of a ray 1.05: round the pit 23 x 23 x 25 voxels instead of 12 x 12 x 14.
  check_sequence("mesh", {.mesh = true}, 0.17);
  check_sequence("mesh-smooth", {.finish = false, .supersample = 2, .mesh = true}, 0.17);
  check_sequence("mesh-off-axis", {.mesh = true}, 0.25, {0.3, -0.2});
}

TEST_CASE("redraw: translucent bone draws the bytes of a whole picture by the pixels that changed") {
  const TransferFunction haze{{.density = 0.2, .extinction = 0.0}, {.density = 1.0, .extinction = 300.0}};
  check_sequence("translucent", {.translucent = haze}, 0.1);
  check_sequence("translucent-smooth", {.supersample = 2, .translucent = haze}, 0.1);
}

TEST_CASE("redraw: any other change draws the whole picture") {
  Pair pair({.finish = false});
  pair.view.world_from_tool = at(1e-3, 9e-3);
  pair.draw("other-first");
  for (const auto& other : other_changes()) {
    const std::string name = other.first;
    CAPTURE(name);
    const Image before = pair.last;
    other.second(pair.view);
    CHECK(pair.draw("other-" + name) == kAll);
    CHECK(pair.last.pixels != before.pixels);
  }
  REQUIRE(pair.kept.set_volume(ball_on_plate()).ok());
  CHECK(pair.draw("other-volume") == kAll);
  REQUIRE(pair.kept.set_tool(post()).ok());
  CHECK(pair.draw("other-mesh") == kAll);
  const std::uint64_t before = pair.kept.counters().drawn_pixels;
  REQUIRE(pair.kept.draw(pair.view, kWidth / 2, kHeight).ok());
  CHECK(pair.kept.counters().drawn_pixels - before == kAll / 2);
}

TEST_CASE("redraw: an eye inside the bone and a tool at the eye draw the bytes of a whole picture") {
  for (const bool by_slices : {false, true}) {
    RenderOptions options{.finish = false};
    if (by_slices) options.slices = SliceOptions{};
    Pair pair(options);
    pair.view.camera = {.eye = {1e-3, -4e-3, 12e-3}, .target = {0.0, 2e-3, -9e-3}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.9};
    pair.draw("inside-first");
    for (int n = 0; n < 6; ++n) {
      pair.view.world_from_tool = at(2e-3 * n - 6e-3, 3e-3 * n - 4e-3);
      pair.update(filled({{30 + n, 28, 20 + 3 * n}, {36 + n, 34, 26 + 3 * n}}, n % 2 == 0 ? 0 : 255));
      pair.draw("inside");
    }
  }
}

TEST_CASE(
    "redraw: a footprint two pixels smaller, one without the reach of ambient occlusion, and one without the tool's old place are "
    "noticed") {
  // Far away: a voxel is a quarter of a pixel, so that the reach of a look-up is less than what is taken away.
  constexpr int kSmall = 96;
  FrameView view = oblique_view();
  view.camera = {.eye = {0.0, 0.0, 0.4}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 1.0, 0.0}, .vertical_fov = 0.4};
  const auto rays = make_camera_rays(view.camera, 1.0);
  REQUIRE(rays.ok());
  const Affine world_from_index = half_millimetre_cube();
  const double edge = world_from_index.longest_edge();
  const VoxelBox box{{8, 10, 40}, {56, 52, 52}};
  const auto footprint = [&](const RenderOptions& options) {
    return find_footprint(*rays, reached_corners(box, reach_of(options, edge).with_occlusion(), world_from_index), Vec2i(kSmall));
  };
  for (const bool occlusion : {false, true}) {
    const RenderOptions options{.finish = false, .appearance = {.occlusion = occlusion}, .keep_picture = false};
    Renderer renderer = require_renderer(options);
    REQUIRE(renderer.set_volume(ball_on_plate()).ok());
    REQUIRE(renderer.set_tool(post()).ok());
    view.world_from_tool.reset();
    const Image before = drawn(renderer, view, kSmall, kSmall);
    renderer.update(filled(box, 255));
    const Image after = drawn(renderer, view, kSmall, kSmall);
    const PixelRect rect = footprint(options);
    CHECK(composed(before, after, {rect}).pixels == after.pixels);
    if (!occlusion) {
      CHECK(composed(before, after, {rect.grown(-2)}).pixels != after.pixels);
    } else {
      // A pit seen from above darkens the rim round it.
      CHECK(composed(before, after, {footprint({.finish = false}).grown(-3)}).pixels != after.pixels);
    }
    const auto place = [&](const Pose& pose) {
      view.world_from_tool = pose;
      std::vector<Vec3> corners;
      for (const Vec3f& p : post().positions) corners.push_back(pose * Vec3(p));
      return find_footprint(*rays, corners, Vec2i(kSmall));
    };
    const PixelRect old_place = place(at(-8e-3, 4e-3));
    const Image was = drawn(renderer, view, kSmall, kSmall);
    const PixelRect new_place = place(at(8e-3, 4e-3));
    const Image is = drawn(renderer, view, kSmall, kSmall);
    CHECK(composed(was, is, {old_place, new_place}).pixels == is.pixels);
    CHECK(composed(was, is, {new_place}).pixels != is.pixels);
    CHECK(composed(was, is, {old_place, new_place.grown(-2)}).pixels != is.pixels);
  }
}

TEST_CASE("steps: a picture drawn in bands is that of one draw, whatever changes between the bands, and shows the last one until then") {
  constexpr int kWide = 480, kHigh = 320;
  for (const auto& [occlusion, shadow] : {std::pair(true, false), std::pair(false, false), std::pair(true, true)}) {
    RenderOptions options{.finish = true, .supersample = 2};
    options.appearance.occlusion = occlusion;
    options.appearance.shadow = shadow;
    Renderer stepped = require_renderer(options), at_once = require_renderer(options);
    FrameView view = oblique_view();
    view.world_from_tool = at(0.0, 6e-3);
    for (Renderer* one : {&stepped, &at_once}) {
      REQUIRE(one->set_volume(ball_on_plate()).ok());
      REQUIRE(one->set_tool(post()).ok());
    }
    // The last picture has a quarter of the rays and half of the size.
    DrawingQuality coarse{.finish = true, .supersample = 1};
    coarse.resolution = 0.5;
    REQUIRE(stepped.set_quality(coarse).ok());
    const auto before = stepped.draw(view, kWide, kHigh);
    REQUIRE(before.ok());
    REQUIRE(stepped.set_quality({.finish = true, .supersample = 2}).ok());
    const std::uint64_t drawn_before = stepped.counters().drawn_pixels;
    int steps = 0;
    for (bool whole = false; !whole; ++steps) {
      REQUIRE(steps < 50);
      if (steps == 2) view.world_from_tool = at(3e-3, 5e-3);
      if (steps == 3)
        for (Renderer* one : {&stepped, &at_once}) one->update(filled(kPit, 0));
      const auto step = stepped.draw_step(view, kWide, kHigh, 0.0);
      REQUIRE(step.ok());
      whole = step->whole;
      if (steps == 0) {
        // The rows of the tool are drawn first; the top row still shows the last picture.
        CHECK_FALSE(whole);
        CHECK(std::equal(step->image.pixels.begin(), step->image.pixels.begin() + kWide, before->pixels.begin()));
        CHECK_FALSE(step->image.pixels == before->pixels);
      }
      if (!whole) continue;
      const auto expected = at_once.draw(view, kWide, kHigh);
      REQUIRE(expected.ok());
      CHECK(pictures_agree(shadow ? "steps-shadow" : (occlusion ? "steps-occlusion" : "steps"), step->image, *expected, {}));
    }
    CHECK(steps >= 5);  // bands of the whole picture
    // What was drawn is drawn once, but for what changed; a shadow of bone reaches across all of it.
    if (!shadow) CHECK(stepped.counters().drawn_pixels - drawn_before < 2u * kWide * kHigh);
    const auto again = stepped.draw_step(view, kWide, kHigh, 0.0);
    REQUIRE(again.ok());
    CHECK(again->whole);
  }
}
