// Triangles that effects add: their colour in closed form, their order with bone, tool and cut, and what of a picture is drawn anew.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/view/added_mesh.h"
#include "app/view/camera.h"
#include "app/view/heat_mesh.h"
#include "core/base/color_ramp.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr std::uint64_t kAll = std::uint64_t{kWidth} * kHeight;
constexpr Rgba8 kRed{200, 40, 30, 0};

/// A square of edge 2 half round `middle`, across z.
std::shared_ptr<AddedMesh> square_at(const Vec3& middle, double half, const Rgba8& color = kRed) {
  auto out = std::make_shared<AddedMesh>();
  for (const auto& [x, y] : {std::pair{-half, -half}, std::pair{half, -half}, std::pair{half, half}, std::pair{-half, half}}) {
    out->vertices.emplace_back(middle + Vec3(x, y, 0.0));
    out->colors.push_back(color);
  }
  out->triangles = {{0, 1, 2}, {0, 2, 3}};
  return out;
}

/// From straight above, by ambient light alone: what is added has 0.6 of its colour, below the bend of the tone curve.
FrameView view_from_above() {
  FrameView view = oblique_view();
  view.camera = {.eye = {0.0, 0.0, 0.1}, .target = Vec3(0.0), .up = {0.0, 1.0, 0.0}, .vertical_fov = 0.4};
  view.light = {.ambient = 0.6, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  return view;
}

Image picture_of(Renderer& renderer, const FrameView& view) {
  auto image = renderer.draw(view, kWidth, kHeight);
  REQUIRE(image.ok());
  return std::move(image).value();
}

bool is_added(const Rgba8& p) {
  const auto near = [](int level, int full) { return std::abs(level - 0.6 * full) <= 1.0; };
  return near(p.r, kRed.r) && near(p.g, kRed.g) && near(p.b, kRed.b);
}

int count_added(const Image& image) {
  int out = 0;
  for (const Rgba8& p : image.pixels) out += is_added(p) ? 1 : 0;
  return out;
}

/// [pixels] of a square at a height, seen from straight above.
double area_of(double half, double height) {
  const double pixel = 2.0 * std::tan(0.2) * (0.1 - height) / kHeight;
  return 4.0 * half * half / (pixel * pixel);
}

std::vector<std::pair<const char*, RenderOptions>> methods() {
  const TransferFunction haze{{.density = 0.2, .extinction = 0.0}, {.density = 1.0, .extinction = 300.0}};
  return {{"rays", {.finish = false}},
          {"rays-smooth", {.appearance = {.tissue = true, .occlusion = true}, .supersample = 2}},
          {"shadow", {.appearance = {.shadow = true}}},
          {"mesh", {.mesh = true}},
          {"slices", {.slices = SliceOptions{}}},
          {"translucent", {.translucent = haze}}};
}

}  // namespace

TEST_CASE("added: over bone it has its colour and the pixels of its projection, from both sides; behind bone it is hidden") {
  for (const bool mesh : {false, true}) {
    CAPTURE(mesh);
    Renderer renderer = require_renderer({.mesh = mesh});
    REQUIRE(renderer.set_volume(ball_on_plate()).ok());
    const Image bare = picture_of(renderer, view_from_above());
    CHECK(count_added(bare) == 0);
    for (const bool turned : {false, true}) {
      const auto before = square_at({1e-3, 0.0, 12e-3}, 3e-3);
      if (turned) std::swap(before->triangles[0][1], before->triangles[0][2]), std::swap(before->triangles[1][1], before->triangles[1][2]);
      REQUIRE(renderer.set_added(before).ok());
      // A pixel is drawn if its centre is inside: at most half of those on the edge are wrong.
      const double area = area_of(3e-3, 12e-3);
      CHECK(std::abs(count_added(picture_of(renderer, view_from_above())) - area) < 2.0 * std::sqrt(area));
    }
    // Inside the ball, and below the plate.
    for (const double height : {2e-3, -14e-3}) {
      REQUIRE(renderer.set_added(square_at({1e-3, 0.0, height}, 3e-3)).ok());
      CHECK(picture_of(renderer, view_from_above()).pixels == bare.pixels);
    }
    // A square through the ball is seen outside of its circle of 8 mm.
    REQUIRE(renderer.set_added(square_at({1e-3, 0.0, 2e-3}, 9e-3)).ok());
    const double ring = area_of(9e-3, 2e-3) * (1.0 - 3.14159265 * 64.0 / 324.0);
    CHECK(std::abs(count_added(picture_of(renderer, view_from_above())) - ring) < 0.1 * ring);
    REQUIRE(renderer.set_added(nullptr).ok());
    CHECK(picture_of(renderer, view_from_above()).pixels == bare.pixels);
  }
}

TEST_CASE("added: a shader that leaves out the depth of bone is noticed") {
  const std::string folder = changed_shaders("added", "added.frag", "discard;   // w is", "bone = 0.0;   // w is");
  Renderer renderer = require_renderer({.finish = false, .shader_folder = folder});
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  REQUIRE(renderer.set_added(square_at({1e-3, 0.0, 2e-3}, 3e-3)).ok());
  CHECK(count_added(picture_of(renderer, view_from_above())) > 100);
}

namespace {

/// The middle pixel of a square of a colour, of which a share is not lit.
Rgba8 shown_color(Renderer& renderer, const Rgba8& color, std::uint8_t unlit, const LightView& light) {
  const auto mesh = square_at({0.0, 0.0, 12e-3}, 3e-3, color);
  mesh->unlit.assign(4, unlit);
  REQUIRE(renderer.set_added(mesh).ok());
  FrameView view = view_from_above();
  view.light = light;
  return picture_of(renderer, view).pixels[kWidth * (kHeight / 2) + kWidth / 2];
}

/// @returns the place of the colour of the scale that is nearest.
double read_on_scale(const Rgba8& shown) {
  double best = 0.0, least = 1e9;
  for (int n = 0; n <= 1000; ++n) {
    const RampColor color = ramp_color(n / 1000.0);
    const double far = std::hypot(shown.r - color.r, shown.g - color.g, shown.b - color.b);
    if (far < least) least = far, best = n / 1000.0;
  }
  return best;
}

const LightView kShade{.ambient = 0.35, .diffuse = 0.75, .fill = 0.0, .direction_to_light = {0.0, 0.0, -1.0}};  // from behind the square
const LightView kFull{.ambient = 0.35, .diffuse = 0.75, .fill = 0.12, .direction_to_light = {0.0, 0.0, 1.0}};

/// Largest error of a reading on the scale [-] in full shade, over the whole scale.
double error_in_shade(Renderer& renderer, std::uint8_t unlit) {
  double out = 0.0;
  for (int n = 0; n <= 40; ++n) {
    const RampColor color = ramp_color(n / 40.0);
    out = std::max(out, std::abs(read_on_scale(shown_color(renderer, {color.r, color.g, color.b, 0}, unlit, kShade)) - n / 40.0));
  }
  return out;
}

}  // namespace

TEST_CASE("added: of a colour the unlit share is shown as it is, in full shade and in full light; a shader that leaves it out is noticed") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  for (const int unlit : {0, 51, 204, 255}) {
    CAPTURE(unlit);
    // Ambient light alone: 0.35 of the colour, below the bend of the tone curve. A level is rounded once.
    const Rgba8 shade = shown_color(renderer, kRed, static_cast<std::uint8_t>(unlit), kShade);
    const double factor = unlit / 255.0 + (1.0 - unlit / 255.0) * 0.35;
    CHECK(std::abs(shade.r - factor * kRed.r) <= 1.0);
    CHECK(std::abs(shade.g - factor * kRed.g) <= 1.0);
    CHECK(std::abs(shade.b - factor * kRed.b) <= 1.0);
    CHECK(shown_color(renderer, kRed, static_cast<std::uint8_t>(unlit), kFull).r >= shade.r);
  }
  CHECK(shown_color(renderer, kRed, 255, kFull) == shown_color(renderer, kRed, 255, kShade));
  // 0.098 in closed form: the colour nearest to 0.87 of each colour of the ramp.
  CHECK(error_in_shade(renderer, kHeatUnlit) <= 0.1);
  CHECK(error_in_shade(renderer, 0) > 0.5);
  Renderer broken = require_renderer({.shader_folder = changed_shaders("unlit", "added.frag", "color.rgb, unlit)", "color.rgb, 0.0)")});
  REQUIRE(broken.set_volume(ball_on_plate()).ok());
  CHECK(error_in_shade(broken, kHeatUnlit) > 0.5);
}

namespace {

constexpr std::uint8_t kMoist = 127;  // just not wet

/// As shaders/room.glsl.
double twin_of_room(const Vec3& way, const Vec3& light) {
  const auto smooth = [](double lo, double hi, double x) {
    const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  };
  const double up = glm::dot(way, light);
  const Vec3 across = glm::normalize(glm::cross(std::abs(light.z) < 0.9 ? Vec3(0.0, 0.0, 1.0) : Vec3(0.0, 1.0, 0.0), light));
  const double least = std::max(up, 0.12), x = glm::dot(way, across) / least / 1.1,
               y = glm::dot(way, glm::cross(light, across)) / least / 1.1;
  const double far = std::hypot(x - std::floor(x) - 0.5, y - std::floor(y) - 0.5);
  const double lamps = 14.0 * (1.0 - smooth(0.16, 0.26, far)) + 0.8 * (1.0 - smooth(0.2, 0.5, far));
  return 0.15 + 0.85 * smooth(-0.3, 0.5, up) + lamps * smooth(0.12, 0.4, up) + 16.0 * smooth(0.965, 0.99, up);
}

/// The middle pixel of a square of a dark liquid, seen from an elevation [rad]. @param beside shine of a second square, which that pixel does not show.
Rgba8 shown_liquid(Renderer& renderer, double elevation, std::uint8_t shine, const Vec3& to_light,
                   std::optional<std::uint8_t> beside = {}) {
  const auto mesh = square_at({0.0, 0.0, 12e-3}, 3e-3, {20, 20, 20, shine});
  if (beside) {
    const auto second = square_at({7e-3, 0.0, 12e-3}, 3e-3, {20, 20, 20, *beside});
    mesh->vertices.insert(mesh->vertices.end(), second->vertices.begin(), second->vertices.end());
    mesh->colors.insert(mesh->colors.end(), second->colors.begin(), second->colors.end());
    for (const auto& [a, b, c] : second->triangles) mesh->triangles.push_back({a + 4, b + 4, c + 4});
  }
  REQUIRE(renderer.set_added(mesh).ok());
  FrameView view = view_from_above();
  view.camera.target = {0.0, 0.0, 12e-3};
  view.camera.eye = view.camera.target + 0.09 * Vec3(0.0, -std::cos(elevation), std::sin(elevation));
  view.camera.up = {0.0, 0.0, 1.0};
  if (elevation > 1.5) view.camera.up = {0.0, 1.0, 0.0};
  view.light = {.ambient = 0.3, .diffuse = 0.7, .fill = 0.0, .direction_to_light = to_light};
  return picture_of(renderer, view).pixels[kWidth * (kHeight / 2) + kWidth / 2];
}

/// @param wet false: below a shine of 128, moist at grazing angles, without a room.
double twin_of_liquid(double elevation, double shine, const Vec3& to_light, bool wet) {
  const Vec3 to_eye(0.0, -std::cos(elevation), std::sin(elevation)), light = glm::normalize(to_light);
  const double towards = glm::normalize(light + to_eye).z, fresnel = 0.022 + 0.978 * std::pow(1.0 - to_eye.z, 5.0);
  double out = 20.0 / 255.0 * (0.3 + 0.7 * light.z) + shine * 0.7 * (0.45 * std::pow(towards, 90.0) + 0.22 * std::pow(towards, 14.0));
  out += shine *
         (wet ? 0.7 * fresnel * twin_of_room(Vec3(-to_eye.x, -to_eye.y, to_eye.z), light) : 0.18 * 0.3 * std::pow(1.0 - to_eye.z, 3.0));
  const double over = std::max(out - 0.7, 0.0);
  return 255.0 * (std::min(out, 0.7) + 0.3 * over / (0.3 + over));
}

}  // namespace

TEST_CASE("added: a liquid mirrors the room by Fresnel, from every side, within white; without a film of fluid there is no room") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  const Vec3 oblique(-0.45, -0.35, 0.8);
  const Vec3 steep(0.3, 0.1, 1.0), aside(0.4, -0.2, 1.0);  // where another axis than z is crossed with it
  for (const Vec3& light : {oblique, steep, aside, Vec3(0.0, 0.0, 1.0)})
    for (const double elevation : {0.12, 0.2, 0.35, 0.55, 0.8, 1.1, 1.35}) {
      CAPTURE(elevation);
      // One rounding, and the pixel's middle, half a pixel, 1.7 mrad, beside the point of the twin: at the edge of a lamp, 14 over 0.1 of a cell of 1.1,
      // the room changes by up to 1.5 x 127 a unit, over the square of `up` a radian, times Fresnel's share. Sampled round the point.
      for (const bool film : {true, false}) {
        const std::uint8_t shine = film ? 255 : kMoist;
        const Rgba8 shown = shown_liquid(renderer, elevation, shine, light);
        double lo = 255.0, hi = 0.0;
        for (const double beside : {-3e-3, 0.0, 3e-3}) {
          const double twin = twin_of_liquid(elevation + beside, shine / 255.0, light, film);
          lo = std::min(lo, twin);
          hi = std::max(hi, twin);
        }
        CHECK(shown.r >= lo - 2.0);
        CHECK(shown.r <= hi + 2.0);
        CHECK(shown.r == shown.g);
        CHECK(shown.r < 255);
      }
    }
  // The sabotage: a film that mirrors alike at all angles differs at grazing ones alone; and a room that is bright, which only what is wet may see.
  Renderer even = require_renderer({.shader_folder = changed_shaders("fresnel", "room.glsl", "0.978 * pow", "0.0 * pow")});
  REQUIRE(even.set_volume(ball_on_plate()).ok());
  CHECK(shown_liquid(renderer, 0.12, 255, oblique).r > shown_liquid(even, 0.12, 255, oblique).r + 10);
  CHECK(std::abs(shown_liquid(renderer, 1.35, 255, oblique).r - shown_liquid(even, 1.35, 255, oblique).r) <= 1);
  // A room whose axes are not perpendicular: by the twin 99 levels at this angle.
  Renderer skewed = require_renderer(
      {.shader_folder = changed_shaders("skewed", "room.glsl",
                                        "normalize(cross(abs(light.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0), light.xyz))",
                                        "vec3(1.0, 0.0, 0.0)")});
  REQUIRE(skewed.set_volume(ball_on_plate()).ok());
  CHECK(shown_liquid(skewed, 0.55, 255, aside).r < shown_liquid(renderer, 0.55, 255, aside).r - 50);
  Renderer bright = require_renderer({.shader_folder = changed_shaders("bright", "room.glsl", "return walls", "return 50.0 + walls")});
  REQUIRE(bright.set_volume(ball_on_plate()).ok());
  CHECK(shown_liquid(bright, 0.35, kMoist, oblique) == shown_liquid(renderer, 0.35, kMoist, oblique));
  CHECK(shown_liquid(bright, 0.35, 255, oblique).r > shown_liquid(renderer, 0.35, 255, oblique).r + 100);
}

TEST_CASE("added: what is moist or dull beside a liquid in one mesh mirrors no room; a shader that lets it is noticed") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  Renderer broken = require_renderer({.shader_folder = changed_shaders("mixed", "added.frag", "shine >= 0.5", "shine >= 0.0")});
  REQUIRE(broken.set_volume(ball_on_plate()).ok());
  const Vec3 light(-0.45, -0.35, 0.8);
  for (const std::uint8_t shine : {std::uint8_t{40}, kMoist}) {
    CAPTURE(static_cast<int>(shine));
    for (const double elevation : {0.12, 0.35, 1.1})
      CHECK(shown_liquid(renderer, elevation, shine, light, 255) == shown_liquid(renderer, elevation, shine, light));
    CHECK_FALSE(shown_liquid(broken, 0.12, shine, light, 255) == shown_liquid(broken, 0.12, shine, light));
  }
  for (const std::uint8_t beside : {std::uint8_t{40}, kMoist})
    CHECK(shown_liquid(renderer, 0.35, 255, light, beside) == shown_liquid(renderer, 0.35, 255, light));
}

TEST_CASE("added: the nearer of tool and triangles is seen, and the cut clips triangles") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  REQUIRE(renderer.set_tool(square(3e-3, 0.0)).ok());
  REQUIRE(renderer.set_added(square_at({0.0, 0.0, 14e-3}, 3e-3)).ok());
  FrameView view = view_from_above();
  const int all = count_added(picture_of(renderer, view));
  CHECK(std::abs(all - area_of(3e-3, 14e-3)) < 2.0 * std::sqrt(area_of(3e-3, 14e-3)));
  view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, 12e-3)};  // behind
  CHECK(count_added(picture_of(renderer, view)) == all);
  view.world_from_tool->translation.z = 16e-3;  // before, and by its perspective larger
  CHECK(count_added(picture_of(renderer, view)) == 0);
  view.world_from_tool.reset();
  view.cut = FrameView::Cut{Vec3(0.0, -1.0, 0.0), 0.0};  // y < 0 is clipped
  const int half = count_added(picture_of(renderer, view));
  CHECK(std::abs(2 * half - all) <= 2.0 * std::sqrt(all));
  view.cut.reset();
  view.world_from_bone.translation.z = -40e-3;  // it moves with the bone
  CHECK(std::abs(count_added(picture_of(renderer, view)) - area_of(3e-3, -26e-3)) < 2.0 * std::sqrt(area_of(3e-3, -26e-3)));
}

TEST_CASE("added: whatever is drawn and however, the pixels of the old and the new triangles give the bytes of a whole picture") {
  for (const auto& [name, options] : methods()) {
    CAPTURE(name);
    RenderOptions without = options;
    without.keep_picture = false;
    Renderer kept = require_renderer(options), whole = require_renderer(without);
    for (Renderer* one : {&kept, &whole}) {
      REQUIRE(one->set_volume(ball_on_plate()).ok());
      REQUIRE(one->set_tool(square(2e-3, 0.0)).ok());
    }
    FrameView view = oblique_view();
    const auto drawn = [&] { return kept.counters().drawn_pixels + kept.counters().tool_pixels; };
    const auto draw = [&](const std::string& what) {
      const std::uint64_t before = drawn();
      const Image by_parts = picture_of(kept, view), at_once = picture_of(whole, view);
      CHECK(pictures_agree("added-" + std::string(name) + "-" + what, by_parts, at_once, {}));
      return drawn() - before;
    };
    const auto set = [&](const std::shared_ptr<const AddedMesh>& mesh) {
      REQUIRE(kept.set_added(mesh).ok());
      REQUIRE(whole.set_added(mesh).ok());
    };
    (void)draw("bare");
    set(square_at({1e-3, 0.0, 11e-3}, 2e-3));
    (void)draw("first");
    CHECK(draw("still") == 0);
    set(square_at({-3e-3, 2e-3, 9e-3}, 2e-3));
    CHECK(draw("moved") < kAll / 3);
    set(square_at({-3e-3, 2e-3, 9e-3}, 2e-3, {30, 200, 90, 255}));
    const std::uint64_t recoloured = draw("recoloured");
    CHECK(recoloured > 0);
    CHECK(recoloured < kAll / 4);
    view.world_from_tool = Pose{Quat(0.98, 0.1, 0.05, 0.0), Vec3(-3e-3, 1e-3, 9.2e-3)};  // through the square
    set(square_at({-2e-3, 2e-3, 9e-3}, 2e-3));
    CHECK(draw("tool") < kAll);
    const VoxelBox pit{{32, 16, 40}, {42, 26, 52}};
    for (Renderer* one : {&kept, &whole})
      one->update({pit, std::vector<Rgba8>(pit.count(), Rgba8{128, 128, 255, 0}), std::vector<std::uint16_t>(pit.count(), 0)});
    (void)draw("pit");
    view.cut = FrameView::Cut{{0.0, -1.0, 0.0}, 0.0};
    (void)draw("cut");
    set(square_at({1e-3, 0.5e-3, 4e-3}, 6e-3));
    (void)draw("cut-moved");
    view.world_from_tool.reset();
    set(nullptr);
    (void)draw("gone");
  }
}

TEST_CASE("added: a picture that is drawn in steps ends as one drawn at once") {
  Renderer by_steps = require_renderer({.finish = false}), at_once = require_renderer({.finish = false});
  for (Renderer* one : {&by_steps, &at_once}) {
    REQUIRE(one->set_volume(ball_on_plate()).ok());
    REQUIRE(one->set_added(square_at({1e-3, 0.0, 11e-3}, 2e-3)).ok());
  }
  (void)picture_of(by_steps, oblique_view());
  FrameView view = oblique_view();
  view.camera.eye.x += 2e-3;
  REQUIRE(by_steps.draw_step(view, 4 * kWidth, 4 * kHeight, 0.0).ok());
  for (Renderer* one : {&by_steps, &at_once}) REQUIRE(one->set_added(square_at({-2e-3, 0.0, 11e-3}, 2e-3)).ok());
  std::optional<PictureStep> last;
  for (int n = 0; n < 20 && !(last && last->whole); ++n) {
    auto step = by_steps.draw_step(view, 4 * kWidth, 4 * kHeight, 0.0);
    REQUIRE(step.ok());
    last = std::move(step).value();
  }
  REQUIRE((last && last->whole));
  const auto expected = at_once.draw(view, 4 * kWidth, 4 * kHeight);
  REQUIRE(expected.ok());
  CHECK(pictures_agree("added-steps", last->image, *expected, {}));
}

TEST_CASE("added: wrong triangles are refused with a reason, and the old ones are kept") {
  Renderer renderer = require_renderer();
  REQUIRE(renderer.set_volume(ball_on_plate()).ok());
  REQUIRE(renderer.set_added(square_at({1e-3, 0.0, 12e-3}, 3e-3)).ok());
  const Image before = picture_of(renderer, view_from_above());
  const auto refused = [&](auto&& spoil) {
    const auto mesh = square_at({1e-3, 0.0, 12e-3}, 1e-3);
    spoil(*mesh);
    const Status set = renderer.set_added(mesh);
    return !set.ok() && set.error().code == ErrorCode::bad_input && !set.error().message.empty();
  };
  CHECK(refused([](AddedMesh& m) { m.triangles.clear(); }));
  CHECK(refused([](AddedMesh& m) { m.colors.pop_back(); }));
  CHECK(refused([](AddedMesh& m) { m.unlit.assign(5, 0); }));
  CHECK(refused([](AddedMesh& m) { m.triangles[1][2] = 4; }));
  CHECK(refused([](AddedMesh& m) { m.vertices[2].y = std::numeric_limits<float>::quiet_NaN(); }));
  CHECK(picture_of(renderer, view_from_above()).pixels == before.pixels);
}
