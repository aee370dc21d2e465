// Object-aligned slices: against closed forms and against the rays.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"
#include "tests/support/image_compare.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kEdge = 0.5e-3;

Renderer sliced(const SliceOptions& slices, const std::filesystem::path& shaders = {}) {
  return require_renderer({.finish = false, .slices = slices, .shader_folder = shaders});
}

Image drawn(Renderer& renderer, const FrameView& view, int width = kWidth, int height = kHeight) {
  auto image = renderer.draw(view, width, height);
  REQUIRE(image.ok());
  return std::move(image).value();
}

const Rgba8& middle(const Image& image) { return image.pixels[static_cast<std::size_t>(image.height / 2 * image.width + image.width / 2)]; }

/// Light that leaves colours as they are.
LightView flat_light() { return {.ambient = 1.0, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}}; }

FrameView looking_from(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = {0.0, 0.0, 0.0}, .up = {0.1, 0.2, 1.0}, .vertical_fov = 0.4};
  view.light = flat_light();
  return view;
}

/// Every texel of this opacity, white.
VolumeView haze(std::uint8_t opacity, const Affine& bone_from_index = half_millimetre_cube()) {
  VolumeView volume;
  volume.dims = Vec3i(64);
  volume.bone_from_index = bone_from_index;
  volume.normal_opacity.assign(64u * 64u * 64u, Rgba8{128, 128, 128, opacity});
  volume.color.assign(64u * 64u * 64u, Rgba8{255, 255, 255, 0});
  return volume;
}

VolumeView white_ball() {
  return make_volume({.dims = Vec3i(64),
                      .bone_from_index = half_millimetre_cube(),
                      .bone = [](const Vec3& p) { return 10e-3 - glm::length(p); },
                      .soft = {},
                      .color =
                          [](const Vec3&) {
                            return Rgba8{255, 255, 255, 0};
                          }});
}

/// Share of the background that each pixel still shows where the volume is white in flat light.
std::vector<double> transmitted(const Image& image, const Image& background) {
  std::vector<double> share;
  for (std::size_t n = 0; n < image.pixels.size(); ++n) share.push_back((255.0 - image.pixels[n].r) / (255.0 - background.pixels[n].r));
  return share;
}

/// Length of a ray through the middle of the picture inside the cube of 64 cells, for a direction of length 1.
double chord(const Vec3& direction) {
  const Vec3 d = glm::abs(direction);
  return 64.0 * kEdge / std::max({d.x, d.y, d.z});
}

/// Brightness of the picture's middle with the haze of that opacity, and what the closed form says: T = (1 - a)^(L / edge).
struct Brightness {
  double drawn, expected;
};
Brightness through_haze(const SliceOptions& slices, const Vec3& eye) {
  constexpr std::uint8_t kOpacity = 5;
  const FrameView view = looking_from(eye);
  Renderer bare = require_renderer();
  const double behind = middle(drawn(bare, view)).r;
  Renderer renderer = sliced(slices);
  REQUIRE(renderer.set_volume(haze(kOpacity)).ok());
  const double transmittance = std::pow(1.0 - kOpacity / 255.0, chord(glm::normalize(eye)) / kEdge);
  return {static_cast<double>(middle(drawn(renderer, view)).r), 255.0 * (1.0 - transmittance) + transmittance * behind};
}

const Vec3 kSquareOn(0.0, 0.0, 0.12), kOblique(0.04, -0.05, 0.1);

}  // namespace

TEST_CASE("slices: a haze lets through what the closed form says, whatever the number of slices and the direction") {
  for (const Vec3& eye : {kSquareOn, kOblique, Vec3(-0.1, 0.03, 0.05)})
    for (const double per_voxel : {0.5, 1.0, 3.0}) {
      const Brightness b = through_haze({.per_voxel = per_voxel, .correct = true}, eye);
      // Half a level each for background and picture; the pixel's centre is half a pixel beside the axis, which is less.
      CHECK(std::abs(b.drawn - b.expected) <= 1.5);
    }
}

TEST_CASE("slices: without the correction the closed form holds for one slice a voxel square on, and for nothing else") {
  CHECK(std::abs(through_haze({.per_voxel = 1.0, .correct = false}, kSquareOn).drawn -
                 through_haze({.per_voxel = 1.0, .correct = true}, kSquareOn).expected) <= 1.5);
  for (const double per_voxel : {0.5, 3.0}) {
    const Brightness b = through_haze({.per_voxel = per_voxel, .correct = false}, kSquareOn);
    CHECK(std::abs(b.drawn - b.expected) > 10.0);
  }
  const Brightness b = through_haze({.per_voxel = 1.0, .correct = false}, kOblique);
  CHECK(std::abs(b.drawn - b.expected) > 3.0);
}

namespace {

/// How far from the middle of the white ball a ray passes that keeps half its light. Closed form: opacity rises from 0 a voxel outside the
/// 0.5 level to 1 a voxel inside, and holds over a voxel edge, so T = exp(integral of ln(1 - opacity) / edge along the ray).
double half_light_radius() {
  constexpr double kRadius = 10e-3;
  const auto log_transmittance = [](double beside) {
    const double reach = std::sqrt(std::max(0.0, (kRadius + kEdge) * (kRadius + kEdge) - beside * beside));
    constexpr int kParts = 4000;
    double sum = 0.0;
    for (int n = 0; n < kParts; ++n) {
      const double from_middle = std::hypot(beside, (n + 0.5) / kParts * reach);
      sum += std::log(1.0 - std::clamp(0.5 + (kRadius - from_middle) / (2.0 * kEdge), 0.0, 1.0 - 1e-12));
    }
    return 2.0 * sum * reach / kParts / kEdge;
  };
  double inside = kRadius - kEdge, outside = kRadius + kEdge;
  for (int n = 0; n < 40; ++n) {
    const double tried = 0.5 * (inside + outside);
    (log_transmittance(tried) < std::log(0.5) ? inside : outside) = tried;
  }
  return inside;
}

struct Silhouette {
  int covered = 0;      ///< pixels where less than half of the background is left
  int beside_rays = 0;  ///< of all pixels, those whose eight neighbours and themselves all see it otherwise by rays
  double worst = 0.0;   ///< [pixels] from the closed form's outline to a pixel on its wrong side
};

Silhouette silhouette_of(Renderer& rays, Renderer& slices, Renderer& bare, const FrameView& view) {
  constexpr int kColumns = 128, kRows = 96;  // a pixel as large as a voxel at the ball
  const auto probe = rays.probe(view, kColumns, kRows);
  REQUIRE(probe.ok());
  const std::vector<double> share = transmitted(drawn(slices, view, kColumns, kRows), drawn(bare, view, kColumns, kRows));
  const double radius = half_light_radius();
  const CameraView& camera = view.camera;
  const Vec3 forward = glm::normalize(camera.target - camera.eye);
  const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
  const double pixel = 2.0 * std::tan(0.5 * camera.vertical_fov) / kRows;
  Silhouette found;
  for (int row = 1; row < kRows - 1; ++row)
    for (int column = 1; column < kColumns - 1; ++column) {
      const bool covered = share[static_cast<std::size_t>(row * kColumns + column)] < 0.5;
      found.covered += covered ? 1 : 0;
      bool near = false;
      for (int y = row - 1; y <= row + 1; ++y)
        for (int x = column - 1; x <= column + 1; ++x)
          near = near || (probe->hit[static_cast<std::size_t>(y * kColumns + x)] != 0) == covered;
      found.beside_rays += near ? 0 : 1;
      const Vec3 direction = glm::normalize(forward + (column + 0.5 - 0.5 * kColumns) * pixel * right +
                                            (0.5 * kRows - row - 0.5) * pixel * glm::cross(right, forward));
      const double beside = glm::length(glm::cross(direction, camera.eye));
      if (covered != (beside < radius)) found.worst = std::max(found.worst, std::abs(beside - radius) / (pixel * glm::length(camera.eye)));
    }
  return found;
}

}  // namespace

TEST_CASE("slices: a ball's silhouette is the closed form's, and that of the rays within a pixel") {
  // What is soft by a voxel hides half the light 0.7 voxel outside its 0.5 level, so a pixel must be a voxel to say so.
  CHECK(half_light_radius() - 10e-3 > 0.6 * kEdge);
  CHECK(half_light_radius() - 10e-3 < 0.8 * kEdge);
  Renderer rays = require_renderer();
  Renderer slices = sliced({});
  for (Renderer* renderer : {&rays, &slices}) REQUIRE(renderer->set_volume(white_ball()).ok());
  Renderer bare = require_renderer();
  for (const Vec3& eye : {Vec3(0.12, 0.0, 0.02), Vec3(0.03, -0.11, 0.04), Vec3(0.05, 0.06, -0.09)}) {
    const Silhouette found = silhouette_of(rays, slices, bare, looking_from(eye));
    CHECK(found.covered > 1000);
    CHECK(found.beside_rays == 0);
    // Slices a voxel apart sample a shell that a grazing ray crosses in some ten of them.
    CHECK(found.worst < 0.25);
  }
}

TEST_CASE("slices: from every side the near half hides the far one, and from inside each wall is where it is") {
  const auto two_colored = [](int axis, double hollow) {
    return make_volume({.dims = Vec3i(64),
                        .bone_from_index = half_millimetre_cube(),
                        .bone = [hollow](const Vec3& p) { return std::min(12e-3 - glm::length(p), glm::length(p) - hollow); },
                        .soft = {},
                        .color =
                            [axis](const Vec3& p) {
                              return p[axis] > 0.0 ? Rgba8{250, 10, 10, 0} : Rgba8{10, 10, 250, 0};
                            }});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) {
      Renderer renderer = sliced({});
      Vec3 eye(0.003, 0.004, 0.002);
      eye[axis] = 0.1 * side;
      REQUIRE(renderer.set_volume(two_colored(axis, -1.0)).ok());
      const Rgba8 outside = middle(drawn(renderer, looking_from(eye)));
      CHECK((outside.r > 200) == (side > 0.0));
      CHECK((outside.b > 200) == (side < 0.0));
      // The eye in the middle of the hollow, a little to the side looked at: the wall ahead hides nothing behind the eye.
      REQUIRE(renderer.set_volume(two_colored(axis, 6e-3)).ok());
      FrameView view = looking_from(eye);
      view.camera.eye = Vec3(0.0);
      view.camera.target = eye;
      const Rgba8 inside = middle(drawn(renderer, view));
      CHECK((inside.r > 200) == (side > 0.0));
      CHECK((inside.b > 200) == (side < 0.0));
    }
}

TEST_CASE("slices: drawn from near to far, the order shows, so the test above would notice") {
  const TemporaryFolder written;
  const std::filesystem::path& folder = written.path();
  for (const auto& [name, text] : embedded_shaders()) {
    std::string broken = text;
    constexpr std::string_view kOrder = "count - 1 - gl_InstanceID";
    if (name == "slices.vert") {
      REQUIRE(broken.find(kOrder) != std::string::npos);
      broken.replace(broken.find(kOrder), kOrder.size(), "gl_InstanceID");
    }
    std::ofstream(folder / name) << broken;
  }
  Renderer right = sliced({}), wrong = sliced({}, folder);
  FrameView view = looking_from(Vec3(0.0, 0.02, -0.1));
  view.light = LightView{};
  for (Renderer* renderer : {&right, &wrong}) REQUIRE(renderer->set_volume(ball_on_plate()).ok());
  CHECK(compare_pictures(drawn(right, view), drawn(wrong, view), 30).differing_share > 0.02);
}

namespace {

/// How much a picture changes where the view turns over from slices of one axis to those of another, the view itself standing still.
PictureDifference change_of_axis(const VolumeView& volume, const SliceOptions& slices) {
  Renderer renderer = sliced(slices);
  REQUIRE(renderer.set_volume(volume).ok());
  // A millionth of a radian to either side of 45 degrees moves nothing on the screen by a thousandth of a pixel.
  const auto seen = [&](double angle) {
    FrameView view = looking_from(0.12 * Vec3(std::cos(angle), std::sin(angle), 0.2));
    view.light = LightView{};
    return drawn(renderer, view);
  };
  constexpr double kDiagonal = 0.78539816339744831;
  return compare_pictures(seen(kDiagonal - 1e-6), seen(kDiagonal + 1e-6), 8);
}

double mean_change(const PictureDifference& difference) {
  double sum = 0.0;
  for (const Rgba8& p : difference.picture.pixels) sum += (p.r + p.g + p.b) / 24.0;  // the picture is brightened eight times
  return sum / static_cast<double>(difference.picture.pixels.size());
}

/// Voxels twice as long along y as along x.
Affine stretched() {
  Affine map = half_millimetre_cube();
  map.linear[0] *= 0.5;
  map.offset.x *= 0.5;
  return map;
}

}  // namespace

TEST_CASE("slices: where the view takes another axis the picture changes by no more than the documented bound") {
  const PictureDifference ball = change_of_axis(ball_on_plate(), {});
  MESSAGE("a ball on a plate: mean " << mean_change(ball) << " levels, " << 100.0 * ball.differing_share
                                     << " % of the pixels by more than 8");
  CHECK(mean_change(ball) > 0.0);  // the axis did change
  CHECK(mean_change(ball) < 0.5);
  CHECK(ball.differing_share < 0.02);
  // A haze in long voxels: corrected it stays as it is, uncorrected its opacity jumps with the number of slices.
  const PictureDifference corrected = change_of_axis(haze(5, stretched()), {.correct = true});
  const PictureDifference uncorrected = change_of_axis(haze(5, stretched()), {.correct = false});
  CHECK(mean_change(corrected) < 0.5);
  CHECK(mean_change(uncorrected) > 4.0 * mean_change(corrected));
  CHECK(uncorrected.differing_share > 0.1);
}

namespace {

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

}  // namespace

TEST_CASE("slices: the tool hides bone behind it and is hidden by bone in front of it") {
  Renderer renderer = sliced({});
  REQUIRE(renderer.set_volume(plate()).ok());
  REQUIRE(renderer.set_tool(square(8e-3, 0.0)).ok());
  FrameView view = looking_from(Vec3(0.0, -0.04, 0.1));
  const Image without = drawn(renderer, view);
  const auto with_tool_at = [&](double z) {
    view.world_from_tool = Pose{Quat(1, 0, 0, 0), Vec3(0.0, 0.0, z)};
    return drawn(renderer, view);
  };
  // Opacity starts a voxel above the 0.5 level; three voxels below it several slices of opacity 1 lie in front.
  CHECK(pictures_agree("slices-tool-hidden", with_tool_at(2e-3 - 3.0 * kEdge), without, {}));
  Renderer alone = sliced({});
  REQUIRE(alone.set_volume(haze(0)).ok());
  REQUIRE(alone.set_tool(square(8e-3, 0.0)).ok());
  const Image shown = with_tool_at(2e-3 + 1.2 * kEdge);
  CHECK(middle(shown) == middle(drawn(alone, view)));
  CHECK_FALSE(middle(shown) == middle(without));
}

TEST_CASE("slices: a cut shows the colour inside, lit by the face's own normal") {
  Renderer renderer = sliced({});
  REQUIRE(renderer.set_volume(plate()).ok());
  FrameView view;
  view.camera = {.eye = {0.0, -0.1, 0.0}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.2};
  view.light = {.ambient = 0.3, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {0.6, -0.8, 0.0}};
  view.cut = FrameView::Cut{Vec3(0.0, -1.0, 0.0), -1e-3};
  const Image image = drawn(renderer, view, 100, 100);
  const double light = 0.3 + 0.5 * 0.8;
  const Rgba8& below = image.pixels[80 * 100 + 50];
  // One level for rounding the colour, one for the driver's 8-bit filter, as for rays.
  CHECK(std::abs(below.r - 180.0 * light) <= 2.0);
  CHECK(std::abs(below.g - 40.0 * light) <= 2.0);
}

TEST_CASE("slices: where bone goes on to the end of the volume, its sides are lit by the normals of the faces, as by rays") {
  Renderer slices = sliced({}), rays = require_renderer();
  for (Renderer* renderer : {&slices, &rays}) REQUIRE(renderer->set_volume(plate()).ok());
  FrameView view;  // both sides are seen at 45 degrees, so that neither normal is the direction to the eye
  view.camera = {.eye = {0.07, -0.07, 0.0}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.35};
  view.light = {.ambient = 0.3, .diffuse = 0.5, .fill = 0.0, .direction_to_light = {0.0, -1.0, 0.0}};
  const Image sliced_image = drawn(slices, view, 100, 100), cast_image = drawn(rays, view, 100, 100);
  for (const auto& [column, light] : {std::pair(25, 0.3 + 0.5), std::pair(75, 0.3)}) {
    CAPTURE(column);
    const auto place = static_cast<std::size_t>(80 * 100 + column);
    // One level for rounding the colour, one for the driver's 8-bit filter.
    CHECK(std::abs(sliced_image.pixels[place].r - 180.0 * light) <= 2.0);
    CHECK(std::abs(sliced_image.pixels[place].r - cast_image.pixels[place].r) <= 2);
  }
}

TEST_CASE("slices: a turned, sheared volume gives the picture of the rays, except for its soft edge") {
  VolumeView volume = white_ball();
  for (Rgba8& color : volume.color) color = {200, 184, 160, 0};
  volume.bone_from_index.linear = Mat3(0.5e-3, 0, 0, 0.15e-3, 0.45e-3, 0, -0.1e-3, 0.05e-3, 0.6e-3);
  volume.bone_from_index.offset = -(volume.bone_from_index.linear * Vec3(31.5));
  FrameView view = oblique_view();
  view.world_from_bone = Pose{glm::angleAxis(0.7, glm::normalize(Vec3(1.0, 2.0, -0.5))), Vec3(2e-3, -1e-3, 3e-3)};
  Renderer rays = require_renderer();
  Renderer slices = sliced({.per_voxel = 2.0});
  for (Renderer* renderer : {&rays, &slices}) REQUIRE(renderer->set_volume(volume).ok());
  // Where the ball is met squarely both show the same texel's normal; the edge, a pixel and a half of soft rim, is a tenth of the ball.
  CHECK(pictures_agree("slices-sheared", drawn(slices, view), drawn(rays, view), {.level = 20, .share = 0.04}));
}

TEST_CASE("slices: options out of range and a probe are refused") {
  static_cast<void>(require_renderer());
  CHECK(Renderer::create({.slices = SliceOptions{.per_voxel = 0.0}, .gl = tested_backend()}).error().code == ErrorCode::out_of_range);
  CHECK(Renderer::create({.slices = SliceOptions{.per_voxel = 9.0}, .gl = tested_backend()}).error().code == ErrorCode::out_of_range);
  Renderer renderer = sliced({});
  REQUIRE(renderer.set_volume(white_ball()).ok());
  CHECK(renderer.probe(oblique_view(), 16, 16).error().code == ErrorCode::bad_input);
}
