#include "tests/app/render/render_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "app/render/shader_source.h"
#include "tests/support/skip.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {
namespace {

std::uint8_t ramp(double distance, double edge) {
  return static_cast<std::uint8_t>(std::floor(255.0 * std::clamp(0.5 + distance / (2.0 * edge), 0.0, 1.0) + 0.5));
}

Vec3 downhill(const Distance& distance, const Vec3& p) {
  constexpr double kStep = 1e-5;
  Vec3 g(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 d(0.0);
    d[axis] = kStep;
    g[axis] = distance(p - d) - distance(p + d);
  }
  const double size = glm::length(g);
  return size > 0.0 ? g / size : Vec3(0.0);
}

}  // namespace

VolumeView make_volume(const VolumeRecipe& recipe) {
  VolumeView view;
  view.dims = recipe.dims;
  view.bone_from_index = recipe.bone_from_index;
  const double edge = recipe.bone_from_index.mean_edge();
  for_each_voxel({Vec3i(0), recipe.dims}, [&](const Vec3i& v) {
    const Vec3 p = recipe.bone_from_index * Vec3(v);
    // The normal of what is seen: soft tissue's where it is nearer to its surface than bone is.
    const bool soft_is_nearer = recipe.soft && std::abs(recipe.soft(p)) < std::abs(recipe.bone(p));
    view.normal_opacity.push_back(encode_normal(downhill(soft_is_nearer ? recipe.soft : recipe.bone, p), ramp(recipe.bone(p), edge)));
    Rgba8 color = recipe.color ? recipe.color(p) : Rgba8{200, 184, 160, 0};
    color.a = recipe.soft ? ramp(recipe.soft(p), edge) : std::uint8_t{0};
    view.color.push_back(color);
  });
  return view;
}

Affine half_millimetre_cube(const Vec3i& dims) { return Affine::scaling(0.5e-3, -0.25e-3 * Vec3(dims - 1)); }

VolumeView ball_on_plate() {
  const auto distance = [](const Vec3& p) {
    const double ball = 8e-3 - glm::length(p - Vec3(1e-3, 0.0, 2e-3));
    const double plate = std::min(-6e-3 - p.z, p.z + 11e-3);
    return std::max(ball, plate);
  };
  return make_volume({.dims = Vec3i(64), .bone_from_index = half_millimetre_cube(), .bone = distance, .soft = {}, .color = {}});
}

FrameView oblique_view() {
  FrameView view;
  view.camera = {.eye = {0.05, -0.09, 0.07}, .target = {0.0, 0.0, 0.0}, .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.4};
  return view;
}

std::string changed_shaders(const std::string& name, const std::string& file, const std::string& right, const std::string& wrong) {
  const std::filesystem::path folder = in_build("test-shaders-" + name + "-" + std::string(gl_backend_name(tested_backend())));
  std::filesystem::create_directories(folder);
  for (auto [known, text] : embedded_shaders()) {
    if (known == file) {
      const auto at = text.find(right);
      if (at == std::string::npos) std::cerr << file << " does not say: " << right << "\n", std::abort();
      text.replace(at, right.size(), wrong);
    }
    std::ofstream(folder / known) << text;
  }
  return folder.string();
}

TriangleMesh square(double half, double z) {
  const auto h = static_cast<float>(half);
  const auto height = static_cast<float>(z);
  TriangleMesh mesh;
  mesh.positions = {{-h, -h, height}, {h, -h, height}, {h, h, height}, {-h, h, height}};
  mesh.normals.assign(4, Vec3f(0, 0, 1));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

GlBackend tested_backend() {
  const char* name = std::getenv("BURRHOLE_TEST_GL");
  for (const GlBackend backend : gl_backends())
    if (name != nullptr && gl_backend_name(backend) == name) return backend;
  return GlBackend::osmesa;
}

Renderer require_renderer(RenderOptions options) {
  options.gl = tested_backend();
  auto renderer = Renderer::create(options);
  if (!renderer && renderer.error().code == ErrorCode::unavailable) skip(renderer.error().text());
  if (!renderer) {
    std::cerr << renderer.error().text() << '\n';
    std::abort();
  }
  return std::move(renderer).value();
}

TexelBox texels_of(const VolumeView& volume, const VoxelBox& box) {
  const VoxelBox all{Vec3i(0), volume.dims};
  TexelBox texels{box, {}, {}};
  for_each_voxel(box, [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    texels.normal_opacity.push_back(volume.normal_opacity[n]);
    texels.field.push_back(volume.field.empty() ? field_of(volume.normal_opacity[n].a, volume.color[n].a) : volume.field[n]);
  });
  return texels;
}

}  // namespace burrhole::test
