// The skin of a whole head over the bone as triangles: each pixel beside the shell traced on the processor, from the closed form of the head.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "app/view/camera.h"
#include "app/view/skin.h"
#include "tests/app/render/render_scenes.h"
#include "volumes/phantom/head_shape.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kSize = 240;
const Vec3 kColor(0.9, 0.65, 0.5), kBackground(0.2, 0.3, 0.4);
const Pose kOnTop{Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, -9e-3, 113.2e-3)};  // entry on the top of the head

/// The skull of the phantom in voxels of 3 mm, with its skin.
VolumeView head() {
  constexpr double kPitch = 3e-3;
  const Bounds box = HeadShape::skin_box();
  const HeadShape shape(6e-3);
  VolumeView out = make_volume({.dims = Vec3i(glm::ceil((box.hi - box.lo) / kPitch)) + 1,
                                .bone_from_index = Affine::scaling(kPitch, box.lo),
                                .bone = [&](const Vec3& p) { return -shape.at(p).bone.value; },
                                .soft = {},
                                .color = {}});
  SkinConfig skin;
  skin.opacity = 0.5;
  skin.window = 60e-3;
  skin.color = kColor;
  skin.body = HeadShape::skin;
  skin.box = box;
  out.skin = std::make_shared<const SkinView>(make_skin(skin, kOnTop));
  return out;
}

/// Evenly lit: the skin has 0.7 of its colour, below the bend of the tone curve.
FrameView even_view(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = Vec3(0.0, -10e-3, 20e-3), .up = {0.0, 0.0, 1.0}, .vertical_fov = 0.5};
  view.light = {.ambient = 0.7, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  view.background = {.bottom = kBackground, .top = kBackground};
  return view;
}

/// The nearest layer of a mesh at each pixel.
struct Layer {
  double depth = std::numeric_limits<double>::infinity();  ///< [m] along the direction of view
  double cosine = 0.0;                                     ///< between normal and line of sight
};

/// Traces the ray of each pixel through the triangles whose box in the picture contains it. @param beyond empty: all of the mesh.
std::vector<Layer> traced(const TriangleMesh& mesh, const std::vector<float>& beyond, const FrameView& view) {
  const CameraRays rays = make_camera_rays(view.camera, 1.0).value();
  std::vector<Layer> out(std::size_t{kSize} * kSize);
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const std::uint32_t id[3] = {mesh.indices[n], mesh.indices[n + 1], mesh.indices[n + 2]};
    const Vec3 a(mesh.positions[id[0]]), u = Vec3(mesh.positions[id[1]]) - a, v = Vec3(mesh.positions[id[2]]) - a;
    double lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
    for (const Vec3& p : {a, a + u, a + v}) {
      const Vec3 from = p - rays.eye;
      const double along = glm::dot(from, rays.forward);
      const double at[2] = {glm::dot(from, rays.right) / glm::dot(rays.right, rays.right) / along,
                            glm::dot(from, rays.up) / glm::dot(rays.up, rays.up) / along};
      for (int axis = 0; axis < 2; ++axis) {
        const double pixel = (axis == 0 ? 0.5 + 0.5 * at[0] : 0.5 - 0.5 * at[1]) * kSize - 0.5;
        lo[axis] = std::min(lo[axis], pixel);
        hi[axis] = std::max(hi[axis], pixel);
      }
    }
    for (int y = std::max(0, static_cast<int>(std::ceil(lo[1]))); y <= std::min(kSize - 1, static_cast<int>(hi[1])); ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(lo[0]))); x <= std::min(kSize - 1, static_cast<int>(hi[0])); ++x) {
        const Vec3 way = rays.direction(2.0 * (x + 0.5) / kSize - 1.0, 1.0 - 2.0 * (y + 0.5) / kSize);
        const Vec3 across = glm::cross(way, v);
        const double det = glm::dot(u, across);
        if (det == 0.0) continue;
        const Vec3 from = rays.eye - a, turned = glm::cross(from, u);
        const double s = glm::dot(from, across) / det, t = glm::dot(way, turned) / det, depth = glm::dot(v, turned) / det;
        if (s < 0.0 || t < 0.0 || s + t > 1.0 || depth <= 0.0) continue;
        const double weight[3] = {1.0 - s - t, s, t};
        double share = 0.0;
        Vec3 normal(0.0);
        for (int m = 0; m < 3; ++m) {
          share += beyond.empty() ? 0.0 : weight[m] * static_cast<double>(beyond[id[m]]);
          normal += weight[m] * Vec3(mesh.normals[id[m]]);
        }
        Layer& layer = out[static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x)];
        if (share < 0.0 || depth * glm::length(rays.forward) >= layer.depth) continue;
        layer = {depth * glm::length(rays.forward), std::abs(glm::dot(glm::normalize(normal), glm::normalize(way)))};
      }
  }
  return out;
}

Vec3 stored(const Rgba8& p) { return Vec3(p.r, p.g, p.b); }

struct Found {
  int over_bone = 0, over_none = 0, open = 0;              ///< pixels: skin over bone, skin alone, bone in front of the nearest skin
  int off_over_bone = 0, off_over_none = 0, off_open = 0;  ///< of those, pixels that are not the expected ones
};

/// Compares a picture with skin with the traced shell over the picture without. Pixels with the edge of the opening are left out.
Found compare(Renderer& renderer, VolumeView volume, const FrameView& view) {
  const std::shared_ptr<const SkinView> skin = volume.skin;
  REQUIRE(renderer.set_volume(volume).ok());
  const auto covered = renderer.draw(view, kSize, kSize);
  volume.skin.reset();
  REQUIRE(renderer.set_volume(volume).ok());
  const auto plain = renderer.draw(view, kSize, kSize);
  const auto probe = renderer.probe(view, kSize, kSize);
  REQUIRE((covered.ok() && plain.ok() && probe.ok()));
  const std::vector<Layer> shell = traced(skin->shell, skin->beyond, view), rim = traced(skin->rim, {}, view);
  Found out;
  for (std::size_t n = 0; n < shell.size(); ++n) {
    if (std::isfinite(rim[n].depth)) continue;
    const double bone = probe->hit[n] ? static_cast<double>(probe->view_depth[n]) : std::numeric_limits<double>::infinity();
    Vec3 expected = stored(plain->pixels[n]);
    const bool shown = shell[n].depth < bone;
    if (shown) {
      const double opacity = 1.0 - std::pow(1.0 - skin->opacity, 1.0 / std::max(shell[n].cosine, 0.05));
      expected = glm::mix(expected, 255.0 * 0.7 * kColor, opacity);
    }
    const Vec3 off = glm::abs(stored(covered->pixels[n]) - expected);
    // As for a ball (renderer_skin_test.cpp): two roundings to 8 bits, and a blend with an opacity of 8 bits.
    const bool wrong = std::max({off.x, off.y, off.z}) > 4.0;
    if (!shown && !std::isfinite(bone)) {
      CHECK_FALSE(wrong);
      continue;
    }
    ++(!shown ? out.open : std::isfinite(bone) ? out.over_bone : out.over_none);
    (!shown ? out.off_open : std::isfinite(bone) ? out.off_over_bone : out.off_over_none) += wrong;
  }
  return out;
}

}  // namespace

TEST_CASE("mesh skin: over the mesh of a whole head it has the light of its traced shell, and bone in the opening is free") {
  const VolumeView volume = head();
  Renderer mesh = require_renderer({.finish = false, .mesh = true}), rays = require_renderer();
  // Sabotage: skin that does not ask for the bone's depth is drawn over the bone in the opening.
  Renderer blind =
      require_renderer({.finish = false,
                        .mesh = true,
                        .shader_folder = changed_shaders("mesh-skin", "skin.frag", "if (bone > 0.0 && depth > bone) discard;", "")});
  for (const Vec3& eye : {Vec3(0.12, -0.45, 0.30), Vec3(0.02, -0.05, 0.60)}) {
    CAPTURE(eye.z);
    const FrameView view = even_view(eye);
    const Found found = compare(mesh, volume, view);
    MESSAGE(found.over_bone << " pixels of skin over bone, " << found.off_over_bone << " off; " << found.over_none << " of skin alone, "
                            << found.off_over_none << " off; " << found.open << " of bone in the opening, " << found.off_open << " off");
    CHECK(found.over_bone > 8'000);
    CHECK(found.over_none > 500);
    CHECK(found.open > 300);
    // Where a ray is along the shell, two layers are at one pixel, and rounding decides which one is nearer.
    CHECK(found.off_over_bone * 200 < found.over_bone);
    CHECK(found.off_over_none * 50 < found.over_none);
    CHECK(found.off_open * 100 < found.open);
    const Found as_rays = compare(rays, volume, view);
    CHECK(std::abs(as_rays.over_bone - found.over_bone) * 50 < found.over_bone);
    CHECK(as_rays.off_over_bone * 200 < as_rays.over_bone);
    const Found wrong = compare(blind, volume, view);
    CHECK(wrong.off_open * 2 > wrong.open);
  }
}
