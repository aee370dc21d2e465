// Textures of a mesh of bone beside a slow twin, which finds the triangle of each pixel and samples the images by the definition.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "app/render/shader_source.h"
#include "app/view/bone_mesh.h"
#include "app/view/bone_texture.h"
#include "tests/app/render/render_scenes.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr int kWidth = 200, kHeight = 150;
// [level] A filter's weight has 8 bits, which is one level of the full contrast, and each mean is rounded by a half: along two axes of an image
// or three of a volume. One half for the picture.
constexpr double kTolerance = 3 * 1.5 + 0.5;

Rgba8 random_color(std::uint32_t n) {
  n = (n ^ 61u ^ (n >> 16)) * 9u;
  n = (n ^ (n >> 4)) * 0x27d4eb2du;
  n ^= n >> 15;
  return {static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n >> 8), static_cast<std::uint8_t>(n >> 16), 255};
}

/// Images of full contrast, larger than pixels.
BoneTextures random_textures(bool spans, bool tiles, int axis) {
  BoneTextures out;
  out.exterior = {5, 4, {}};
  for (std::uint32_t n = 0; n < 20; ++n) out.exterior.pixels.push_back(random_color(n));
  out.interior.dims = {4, 3, 5};
  for (std::uint32_t n = 0; n < 60; ++n) out.interior.pixels.push_back(random_color(1000 + n));
  out.exterior_edge = 9e-3;
  if (!spans) out.interior_edge = 11e-3;
  out.axis = axis;
  out.exterior_tiles = out.interior_tiles = tiles;
  return out;
}

Vec3 levels(const Rgba8& c) { return {c.r, c.g, c.b}; }

/// The texel of a repeated image: number n of `size`.
int repeated(int n, int size, bool tiles) {
  const int period = tiles ? size : 2 * size, at = (n % period + period) % period;
  return at < size ? at : period - 1 - at;
}

/// Trilinear, by the definition. @param at in repeats.
Vec3 sample(const std::vector<Rgba8>& pixels, const Vec3i& dims, const Vec3& at, bool tiles) {
  const Vec3 x = at * Vec3(dims) - 0.5, base = glm::floor(x), f = x - base;
  Vec3 sum(0.0);
  for (int c = 0; c < 8; ++c) {
    const Vec3i corner(c & 1, (c >> 1) & 1, c >> 2), v = Vec3i(base) + corner;
    const Vec3i texel(repeated(v.x, dims.x, tiles), repeated(v.y, dims.y, tiles), repeated(v.z, dims.z, tiles));
    const Vec3 w = glm::mix(1.0 - f, f, Vec3(corner));
    sum += w.x * w.y * w.z * levels(pixels[VoxelBox{Vec3i(0), dims}.offset_of(texel)]);
  }
  return sum;
}

/// The surface of a mesh with its colours.
class Twin {
 public:
  Twin(BoneMesh mesh, BoneTextures textures) : mesh_(std::move(mesh)), textures_(std::move(textures)), box_(mesh_.loaded_box()) { read(); }
  void update(const TexelBox& texels) {
    mesh_.update(texels);
    read();
  }
  [[nodiscard]] const std::vector<MeshTriangle>& triangles() const { return triangles_; }

  [[nodiscard]] Vec3 interior(const Vec3& p) const {
    Vec3 at(0.0);
    const Vec3 size = box_.hi - box_.lo;
    for (int row = 0; row < 3; ++row) {
      const int a = (textures_.axis + 1 + row) % 3;
      at[row] = textures_.interior_edge ? p[a] / *textures_.interior_edge : (p[a] - box_.lo[a]) / size[a];
    }
    return sample(textures_.interior.pixels, textures_.interior.dims, at, textures_.interior_tiles);
  }

  [[nodiscard]] Vec3 exterior(const Vec3& p, const Vec3& normal) const {
    Vec3 at(0.0), w(0.0);
    const Vec3 n = glm::normalize(normal);
    for (int row = 0; row < 3; ++row) {
      const int a = (textures_.axis + 1 + row) % 3;
      at[row] = p[a] / textures_.exterior_edge;
      w[row] = std::pow(n[a], 4);
    }
    const auto image = [&](double u, double v) {
      const Vec3i dims(textures_.exterior.width, textures_.exterior.height, 1);
      return sample(textures_.exterior.pixels, dims, {u, v, 0.5}, textures_.exterior_tiles);
    };
    return (w.x * image(at.y, at.z) + w.y * image(at.x, at.z) + w.z * image(at.x, at.y)) / (w.x + w.y + w.z);
  }

  /// @returns the colours at p of each triangle that contains it within 1e-7 m: p may be on an edge.
  [[nodiscard]] std::vector<Vec3> colors_at(const Vec3& p) const {
    std::vector<Vec3> out;
    for (const MeshTriangle& t : triangles_) {
      const Vec3 a(t[0].position), b(t[1].position), c(t[2].position), face = glm::cross(b - a, c - a);
      const double twice = glm::length(face);
      if (!(twice > 0.0) || std::abs(glm::dot(p - a, face)) > 1e-7 * twice) continue;
      const double u = glm::dot(glm::cross(c - b, p - b), face) / (twice * twice);
      const double v = glm::dot(glm::cross(a - c, p - c), face) / (twice * twice);
      if (std::min({u, v, 1.0 - u - v}) > -1e-3) out.push_back(color_of(t, {u, v, 1.0 - u - v}, p));
    }
    return out;
  }

 private:
  void read() {
    triangles_.clear();
    for (std::uint32_t number = 0; number < mesh_.slots(); ++number) triangles_.push_back(mesh_.triangle(number));
  }
  [[nodiscard]] Vec3 color_of(const MeshTriangle& t, const Vec3& weights, const Vec3& p) const {
    Vec3 normal(0.0), own(0.0);
    double cut = 0.0, textured = 0.0;
    for (int n = 0; n < 3; ++n) {
      const MeshVertex& v = t[static_cast<std::size_t>(n)];
      normal += weights[n] * Vec3(v.normal[0], v.normal[1], v.normal[2]);
      own += weights[n] * levels(v.color);
      cut += weights[n] * v.color.a / 255.0;
      textured += weights[n] * v.normal[3] / 32767.0;
    }
    const Vec3 outside = textures_.exterior.pixels.empty() ? own : exterior(p, normal);
    const Vec3 inside = textures_.interior.pixels.empty() ? own : interior(p);
    return glm::mix(own, glm::mix(outside, inside, cut), textured);
  }

  BoneMesh mesh_;
  std::vector<MeshTriangle> triangles_;
  BoneTextures textures_;
  Bounds box_;
};

/// Light that leaves colours as they are.
FrameView flat_view(const Vec3& eye) {
  FrameView view;
  view.camera = {.eye = eye, .target = {0.0, 0.0, 0.0}, .up = {0.1, 1.0, 0.2}, .vertical_fov = 0.3};
  view.light = {.ambient = 1.0, .diffuse = 0.0, .fill = 0.0, .direction_to_light = {0.0, 0.0, 1.0}};
  view.world_from_bone = {glm::normalize(Quat(0.9, 0.1, -0.2, 0.3)), {0.001, -0.002, 0.003}};
  return view;
}

Renderer textured_renderer(const BoneTextures& textures, const std::string& shaders = {}) {
  return require_renderer(
      {.finish = false, .mesh = true, .textures = std::make_shared<const BoneTextures>(textures), .shader_folder = shaders});
}

struct Differences {
  int compared = 0, over = 0;
  double worst = 0.0;  // [level]
};

/// Compares every eleventh pixel of the bone.
Differences compare(Renderer& renderer, const Twin& twin, const FrameView& view, const Affine& bone_from_index) {
  const auto probe = renderer.probe(view, kWidth, kHeight);
  REQUIRE(probe.ok());
  Differences out;
  for (std::size_t n = 0; n < probe->hit.size(); n += 11) {
    if (probe->hit[n] == 0) continue;
    const Vec3 p = bone_from_index * Vec3(probe->hit_index[n]);
    double least = INFINITY;
    for (const Vec3& color : twin.colors_at(p)) {
      const Vec3 off = glm::abs(color - levels(probe->image.pixels[n]));
      least = std::min(least, std::max({off.x, off.y, off.z}));
    }
    if (!std::isfinite(least)) continue;  // on the outline, where the hit is beside the triangle
    ++out.compared;
    out.over += least > kTolerance ? 1 : 0;
    out.worst = std::max(out.worst, least);
  }
  return out;
}

/// A block whose lower half is soft tissue's colour; with a pit in its upper face.
VolumeView block(bool drilled) {
  const auto distance = [drilled](const Vec3& p) {
    const Vec3 q = glm::abs(p) - Vec3(7e-3, 6e-3, 5e-3);
    const double body = -std::max({q.x, q.y, q.z});
    const double pit = 3e-3 - glm::length(p - Vec3(0.5e-3, 0.0, 5e-3));
    return drilled ? std::min(body, -pit) : body;
  };
  return make_volume({.dims = Vec3i(40), .bone_from_index = half_millimetre_cube(Vec3i(40)), .bone = distance, .soft = {}, .color = {}});
}

BoneMesh mesh_of(const VolumeView& volume) {
  auto made = BoneMesh::create(volume, {.find_cuts = true});
  REQUIRE(made.ok());
  return std::move(made).value();
}

const VoxelBox kPit{{10, 10, 20}, {32, 32, 38}};

}  // namespace

TEST_CASE("mesh textures: a block and a ball have the colours of the twin, for both ways to repeat, each axis, and both scales") {
  for (const int axis : {0, 1, 2}) {
    const BoneTextures textures = random_textures(axis == 1, axis == 2, axis);
    for (const bool round : {false, true}) {
      const VolumeView volume = round ? ball_on_plate() : block(false);
      Renderer renderer = textured_renderer(textures);
      REQUIRE(renderer.set_volume(volume).ok());
      const Differences found =
          compare(renderer, Twin(mesh_of(volume), textures), flat_view({0.02, -0.03, round ? 0.11 : 0.05}), volume.bone_from_index);
      MESSAGE("axis " << axis << std::string(round ? ", ball: " : ", block: ") << found.compared << " pixels, worst " << found.worst);
      CHECK(found.compared > 250);
      CHECK(found.over == 0);
    }
  }
}

TEST_CASE("mesh textures: before drilling no vertex is cut; then the pit has the inside, and a swap of the two is found") {
  const VolumeView whole = block(false), drilled = block(true);
  const BoneTextures textures = random_textures(true, true, 2);
  Twin twin(mesh_of(whole), textures);
  for (const MeshTriangle& t : twin.triangles())
    for (const MeshVertex& v : t) REQUIRE(v.color.a == 0);
  Renderer renderer = textured_renderer(textures);
  Renderer swapped = textured_renderer(
      textures, changed_shaders("textures-swapped", "mesh.frag", "mix(outside, inside, shares.x)", "mix(inside, outside, shares.x)"));
  Renderer unblended = textured_renderer(textures, changed_shaders("textures-unblended", "mesh_texture.glsl", "  w *= w;\n", "\n"));
  for (Renderer* one : {&renderer, &swapped, &unblended}) {
    REQUIRE(one->set_volume(whole).ok());
    REQUIRE(one->draw(flat_view({0.0, 0.0, 0.06}), 32, 24).ok());
    one->update(texels_of(drilled, kPit));
  }
  twin.update(texels_of(drilled, kPit));
  int floor = 0, away = 0;
  for (const MeshTriangle& t : twin.triangles())
    for (const MeshVertex& v : t) {
      const double from_pit = glm::length(Vec3(v.position) - Vec3(0.5e-3, 0.0, 5e-3));
      // A voxel below the rim all of the bone that was there is gone; two voxels beside it none is.
      if (from_pit < 3.2e-3 && v.position.z < 4e-3f) {
        CHECK(v.color.a == 255);
        ++floor;
      }
      if (from_pit > 4.2e-3) {
        CHECK(v.color.a == 0);
        ++away;
      }
    }
  CHECK(floor > 100);
  CHECK(away > 1000);
  const FrameView view = flat_view({0.012, -0.02, 0.05});
  const Differences found = compare(renderer, twin, view, whole.bone_from_index);
  MESSAGE(found.compared << " pixels, worst " << found.worst << " levels");
  CHECK(found.compared > 250);
  CHECK(found.over == 0);
  CHECK(compare(swapped, twin, view, whole.bone_from_index).over > found.compared / 2);
  CHECK(compare(unblended, twin, view, whole.bone_from_index).over > 10);
}

TEST_CASE("mesh textures: a section through bone has the inside, that through soft tissue its own colour") {
  const auto side = [](const Vec3& p) { return 6e-3 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); };
  const VolumeView volume = make_volume({.dims = Vec3i(32),
                                         .bone_from_index = half_millimetre_cube(Vec3i(32)),
                                         .bone = [&](const Vec3& p) { return std::min(side(p), p.x); },
                                         .soft = [&](const Vec3& p) { return std::min(side(p), -p.x); },
                                         .color =
                                             [](const Vec3&) {
                                               return Rgba8{60, 20, 30, 0};
                                             }});
  const BoneTextures textures = random_textures(false, true, 2);
  const Twin twin(mesh_of(volume), textures);
  Renderer renderer = textured_renderer(textures);
  REQUIRE(renderer.set_volume(volume).ok());
  FrameView view = flat_view({0.004, -0.005, 0.06});
  const Vec3 normal = view.world_from_bone.rotate(Vec3(0.0, 0.0, 1.0));
  view.cut = FrameView::Cut{normal, glm::dot(normal, view.world_from_bone * Vec3(0.0, 0.0, 1e-3))};
  const auto probe = renderer.probe(view, kWidth, kHeight);
  REQUIRE(probe.ok());
  int bone = 0, soft = 0;
  for (std::size_t n = 0; n < probe->hit.size(); ++n) {
    const Vec3 p = volume.bone_from_index * Vec3(probe->hit_index[n]);
    if (probe->hit[n] == 0 || std::abs(p.z - 1e-3) > 1e-7 || std::max(std::abs(p.x), std::abs(p.y)) > 5e-3 || std::abs(p.x) < 1e-3)
      continue;
    const Vec3 expected = p.x > 0.0 ? twin.interior(p) : Vec3(60, 20, 30), off = glm::abs(expected - levels(probe->image.pixels[n]));
    CHECK(std::max({off.x, off.y, off.z}) <= kTolerance);
    ++(p.x > 0.0 ? bone : soft);
  }
  CHECK(bone > 300);
  CHECK(soft > 300);
}

TEST_CASE("mesh textures: soft tissue keeps the colours of its voxels") {
  const auto ball = [](const Vec3& p) { return 7e-3 - glm::length(p); };
  const VolumeView volume = make_volume({.dims = Vec3i(40),
                                         .bone_from_index = half_millimetre_cube(Vec3i(40)),
                                         .bone = [](const Vec3&) { return -1.0; },
                                         .soft = ball,
                                         .color =
                                             [](const Vec3&) {
                                               return Rgba8{90, 40, 30, 0};
                                             }});
  Renderer renderer = textured_renderer(random_textures(false, true, 2));
  REQUIRE(renderer.set_volume(volume).ok());
  const auto probe = renderer.probe(flat_view({0.0, -0.02, 0.08}), kWidth, kHeight);
  REQUIRE(probe.ok());
  int seen = 0;
  for (std::size_t n = 0; n < probe->hit.size(); ++n) {
    if (probe->hit[n] == 0) continue;
    REQUIRE(probe->image.pixels[n] == Rgba8{90, 40, 30, 255});
    ++seen;
  }
  CHECK(seen > 1000);
}

TEST_CASE("mesh textures: without them nothing is sent and no shader has one; with them drilling sends the same triangles and no texel") {
  const VolumeView whole = block(false), drilled = block(true);
  BoneTextures outside = random_textures(true, true, 2), inside = outside;
  const std::uint64_t image = outside.exterior.pixels.size() * 4, volume = outside.interior.pixels.size() * 4;
  outside.interior = {};
  inside.exterior = {};
  Renderer plain = require_renderer({.finish = false, .mesh = true}), both = textured_renderer(random_textures(true, true, 2)),
           outer = textured_renderer(outside), inner = textured_renderer(inside);
  for (Renderer* one : {&plain, &both, &outer, &inner}) {
    REQUIRE(one->set_volume(whole).ok());
    REQUIRE(one->draw(flat_view({0.0, 0.0, 0.06}), 32, 24).ok());
    one->update(texels_of(drilled, kPit));
    REQUIRE(one->draw(flat_view({0.0, 0.0, 0.06}), 32, 24).ok());
    CHECK(one->counters().mesh_update_bytes == plain.counters().mesh_update_bytes);
    CHECK(one->counters().mesh_bytes == plain.counters().mesh_bytes);
  }
  BoneMesh mesh = mesh_of(whole);
  static_cast<void>(mesh.take_changed());
  mesh.update(texels_of(drilled, kPit));
  std::uint64_t changed = 0;
  for (const TriangleRange& range : mesh.take_changed()) changed += range.size();
  CHECK(plain.counters().mesh_update_bytes == changed * sizeof(MeshTriangle));
  CHECK(plain.counters().mesh_update_bytes < plain.counters().mesh_bytes);
  CHECK(plain.counters().texture_bytes == 0);
  CHECK(both.counters().texture_bytes == image + volume);
  CHECK(outer.counters().texture_bytes == image);
  CHECK(inner.counters().texture_bytes == volume);
  for (const ShaderVariant& variant : all_shader_variants()) {
    const std::string text = expand_shader(embedded_shaders(), variant.fragment, variant.defines).value();
    const auto has = [](const std::string& where, const char* what) { return where.find(what) != std::string::npos; };
    CHECK_MESSAGE(has(text, "exterior_image") == has(variant.name, "_exterior"), variant.name);
    CHECK_MESSAGE(has(text, "interior_image") == has(variant.name, "_interior"), variant.name);
    CHECK_MESSAGE(has(text, "uniform Textures") == (has(variant.name, "_exterior") || has(variant.name, "_interior")), variant.name);
  }
}

TEST_CASE("mesh textures: one colour is that of rays without labels") {
  const VolumeView volume = ball_on_plate();
  Renderer rays = require_renderer({.finish = false, .appearance = {.labels = false}}),
           mesh = require_renderer({.finish = false, .appearance = {.labels = false}, .mesh = true});
  const FrameView view = flat_view({0.02, -0.03, 0.11});
  for (Renderer* one : {&rays, &mesh}) REQUIRE(one->set_volume(volume).ok());
  const auto a = rays.probe(view, kWidth, kHeight), b = mesh.probe(view, kWidth, kHeight);
  REQUIRE((a.ok() && b.ok()));
  int seen = 0;
  for (std::size_t n = 0; n < a->hit.size(); ++n) {
    if (a->hit[n] == 0 || b->hit[n] == 0) continue;
    const Vec3 off = glm::abs(levels(a->image.pixels[n]) - levels(b->image.pixels[n]));
    CHECK(std::max({off.x, off.y, off.z}) <= 1.0);  // rounded to a byte in the mesh
    ++seen;
  }
  CHECK(seen > 1000);
}
