// The shader against a slow ray caster that shares no code with it.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "app/render/shader_source.h"
#include "tests/app/render/render_scenes.h"
#include "tests/app/render/slow_ray_caster.h"
#include "tests/support/image_compare.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 200, kHeight = 150;

// A driver may filter with 8-bit weights: 1/255 off on a stored normal, doubled by eq. 6, times light terms of up to 1.2 on 200 levels is
// 2 levels, and one more for rounding the picture. On silhouettes and creases a ray that grazes the level within 1/255 may hit in one
// picture and miss in the other: some 600 of 30,000 pixels lie there, one in twenty of them may flip.
constexpr PictureTolerance kTolerance{.level = 3, .share = 0.001};

struct Compared {
  Image actual, expected;
};

Compared draw_both(const VolumeView& volume, const FrameView& view, Sabotage sabotage = Sabotage::none,
                   const std::filesystem::path& shaders = {}) {
  const RenderOptions options{.step_voxels = 0.5, .bisections = 6, .finish = false, .shader_folder = shaders};
  Renderer renderer = require_renderer(options);
  REQUIRE(renderer.set_volume(volume).ok());
  auto actual = renderer.draw(view, kWidth, kHeight);
  REQUIRE(actual.ok());
  return {std::move(actual).value(), cast_slowly(volume, view, kWidth, kHeight, options.step_voxels, options.bisections, sabotage)};
}

bool agree(const Compared& pictures) {
  const PictureDifference difference = compare_pictures(pictures.actual, pictures.expected, kTolerance.level);
  return difference.same_size && difference.differing_share <= kTolerance.share;
}

VolumeView layered_head() {
  const auto color = [](const Vec3& p) { return p.z > -2e-3 ? Rgba8{220, 200, 170, 0} : Rgba8{180, 90, 80, 0}; };
  return make_volume({.dims = {64, 48, 56},
                      .bone_from_index = half_millimetre_cube({64, 48, 56}),
                      .bone = [](const Vec3& p) { return std::min(4e-3 - std::abs(p.z), std::sqrt(p.x * p.x + p.y * p.y) - 4e-3); },
                      .soft = [](const Vec3& p) { return -6e-3 - p.z; },
                      .color = color});
}

}  // namespace

TEST_CASE("ray caster: a ball on a plate is drawn as by the slow twin") {
  const Compared pictures = draw_both(ball_on_plate(), oblique_view());
  CHECK(pictures_agree("ball-on-plate", pictures.actual, pictures.expected, kTolerance));
}

TEST_CASE("ray caster: a drilled plate over soft tissue, cut open, is drawn as by the slow twin") {
  FrameView view = oblique_view();
  view.cut = FrameView::Cut{Vec3(0.0, -1.0, 0.0), 1e-3};
  const Compared pictures = draw_both(layered_head(), view);
  CHECK(pictures_agree("layered-cut", pictures.actual, pictures.expected, kTolerance));
}

TEST_CASE("ray caster: a turned, sheared volume is drawn as by the slow twin") {
  VolumeView volume = ball_on_plate();
  volume.bone_from_index.linear = Mat3(0.5e-3, 0, 0, 0.15e-3, 0.45e-3, 0, -0.1e-3, 0.05e-3, 0.6e-3);
  volume.bone_from_index.offset = -(volume.bone_from_index.linear * Vec3(31.5));
  FrameView view = oblique_view();
  view.world_from_bone = Pose{glm::angleAxis(0.7, glm::normalize(Vec3(1.0, 2.0, -0.5))), Vec3(2e-3, -1e-3, 3e-3)};
  const Compared pictures = draw_both(volume, view);
  CHECK(pictures_agree("sheared", pictures.actual, pictures.expected, kTolerance));
}

TEST_CASE("ray caster: the comparison notices a flipped normal, a lookup half a voxel off and a wrong light") {
  for (const Sabotage sabotage : {Sabotage::flipped_normal, Sabotage::half_voxel_shift, Sabotage::light_from_elsewhere})
    CHECK_FALSE(agree(draw_both(ball_on_plate(), oblique_view(), sabotage)));
}

TEST_CASE("ray caster: the comparison detects an error in the shader itself, read from a folder") {
  const TemporaryFolder written;
  const std::filesystem::path& folder = written.path();
  for (const auto& [name, text] : embedded_shaders()) {
    std::string broken = text;
    const std::size_t place = broken.find("(index + 0.5) / dims.xyz");
    if (name == "volume.glsl") {
      REQUIRE(place != std::string::npos);
      broken.replace(place, 24, "(index + 1.0) / dims.xyz");
    }
    std::ofstream(folder / name) << broken;
  }
  CHECK_FALSE(agree(draw_both(ball_on_plate(), oblique_view(), Sabotage::none, folder)));
}
