// Which pixels a change may reach, against rays cast one by one and sets of pixels painted one by one.
#include "app/render/footprint.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "app/render/renderer.h"
#include "app/render/shader_source.h"

using namespace burrhole;

namespace {

/// Whether the ray meets the box with these corners in index coordinates, in front of the eye: by slabs.
bool meets(const CameraRays& rays, const Vec2& ndc, const Affine& index_from_world, const Vec3& lo, const Vec3& hi) {
  const Vec3 eye = index_from_world * rays.eye, d = index_from_world.linear * rays.direction(ndc.x, ndc.y);
  double enter = 0.0, leave = 1e9;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (lo[a] - eye[a]) / d[a], t1 = (hi[a] - eye[a]) / d[a];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter <= leave;
}

struct Meeting {
  int inside = 0, outside = 0;  ///< pixels whose rays meet the box, by where they lie of a rectangle
};

Meeting count_meeting(const CameraRays& rays, const Affine& world_from_index, const Vec3& lo, const Vec3& hi, const Vec2i& picture,
                      const PixelRect& rect) {
  const Affine index_from_world = world_from_index.inverse();
  Meeting found;
  for (int y = 0; y < picture.y; ++y)
    for (int x = 0; x < picture.x; ++x) {
      const Vec2 ndc = 2.0 * (Vec2(x, y) + 0.5) / Vec2(picture) - 1.0;
      if (!meets(rays, ndc, index_from_world, lo, hi)) continue;
      ++(rect.contains(PixelRect{{x, y}, {x + 1, y + 1}}) ? found.inside : found.outside);
    }
  return found;
}

}  // namespace

TEST_CASE("footprint: holds every pixel whose ray meets the box, and by two pixels less it would not") {
  const unsigned seed = 20260;
  MESSAGE("seed " << seed);
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const Vec2i picture(90, 70);
  int tight = 0, seen = 0;
  for (int n = 0; n < 60; ++n) {
    Affine world_from_index = Affine::scaling(uniform(0.3e-3, 0.6e-3), Vec3(-0.01));
    world_from_index.linear[1] += uniform(-0.2, 0.2) * world_from_index.linear[0];  // sheared, as scans are
    const CameraView camera{.eye = {uniform(-0.1, 0.1), uniform(-0.2, -0.08), uniform(0.05, 0.1)},
                            .target = {uniform(-0.01, 0.01), 0.0, uniform(-0.01, 0.01)},
                            .up = {0.0, 0.0, 1.0},
                            .vertical_fov = uniform(0.2, 0.8)};
    const auto rays = make_camera_rays(camera, 90.0 / 70.0);
    REQUIRE(rays.ok());
    const Vec3i lo(Vec3(uniform(0, 40), uniform(0, 40), uniform(0, 40)));
    const VoxelBox box{lo, lo + Vec3i(Vec3(uniform(1, 20), uniform(1, 20), uniform(1, 20)))};
    const Reach reach{uniform(0.0, 2.0), uniform(0.0, 2e-3), 0.0};
    const PixelRect rect = find_footprint(*rays, reached_corners(box, reach, world_from_index), picture);
    // The same growth, from the inverse map's rows.
    const Affine inverse = world_from_index.inverse();
    Vec3 grow(0.0);
    for (int a = 0; a < 3; ++a)
      grow[a] = reach.voxels + reach.metres * glm::length(Vec3(inverse.linear[0][a], inverse.linear[1][a], inverse.linear[2][a]));
    const Vec3 low = Vec3(box.lo) - grow, high = Vec3(box.hi - 1) + grow;
    const Meeting all = count_meeting(*rays, world_from_index, low, high, picture, rect);
    CHECK(all.outside == 0);
    if (rect.empty()) continue;
    ++seen;
    const bool within = rect.lo.x > 0 && rect.lo.y > 0 && rect.hi.x < picture.x && rect.hi.y < picture.y;
    if (within && count_meeting(*rays, world_from_index, low, high, picture, rect.grown(-2)).outside > 0) ++tight;
  }
  CHECK(seen > 30);
  CHECK(tight > 20);
}

TEST_CASE("footprint: all of the picture when a part lies beside or behind the eye, nothing when the box is out of sight") {
  const auto rays = make_camera_rays({.eye = {0, 0, 0}, .target = {0, 1, 0}, .up = {0, 0, 1}, .vertical_fov = 0.5}, 1.0);
  REQUIRE(rays.ok());
  const std::vector<Vec3> around{{-1, -1, -1}, {1, 1, 1}};
  CHECK(find_footprint(*rays, around, {40, 30}) == PixelRect{{0, 0}, {40, 30}});
  const std::vector<Vec3> aside{{3, 1, 0}, {4, 1, 1}};
  CHECK(find_footprint(*rays, aside, {40, 30}).empty());
}

TEST_CASE("footprint: a region's rectangles are disjoint and hold what was added") {
  const unsigned seed = 77;
  MESSAGE("seed " << seed);
  std::mt19937 random(seed);
  const auto number = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(random); };
  constexpr int kSide = 48;
  for (int round = 0; round < 200; ++round) {
    PixelRegion region;
    std::vector<int> asked(kSide * kSide), held(kSide * kSide);
    const auto paint = [&](const PixelRect& r, std::vector<int>& into) {
      for (int y = r.lo.y; y < r.hi.y; ++y)
        for (int x = r.lo.x; x < r.hi.x; ++x) ++into[static_cast<std::size_t>(y * kSide + x)];
    };
    for (int n = number(1, 7); n > 0; --n) {
      const Vec2i lo(number(0, 40), number(0, 40));
      const PixelRect rect{lo, glm::min(lo + Vec2i(number(0, 20), number(0, 20)), Vec2i(kSide))};
      region.add(rect);
      paint(rect, asked);
    }
    REQUIRE(region.rects().size() <= PixelRegion::kMost);
    for (const PixelRect& r : region.rects()) {
      REQUIRE_FALSE(r.empty());
      paint(r, held);
    }
    std::int64_t pixels = 0;
    for (std::size_t n = 0; n < held.size(); ++n) {
      REQUIRE(held[n] <= 1);
      if (asked[n] > 0) REQUIRE(held[n] == 1);
      pixels += held[n];
    }
    REQUIRE(region.pixels() == pixels);
  }
}

TEST_CASE("footprint: its reach is that of the shaders") {
  const ShaderFiles files = embedded_shaders();
  const auto holds = [&](const char* file, const char* text) { return files.find(file)->second.find(text) != std::string::npos; };
  // The figures of footprint.cpp stand in these lines; whoever changes one must change the other.
  CHECK(holds("occlusion.glsl", "kSamples = 3 * kSpokes;"));
  CHECK(holds("occlusion.glsl", "return 0.0011 * exp2(1.15 * float(ring));"));
  CHECK(holds("occlusion.glsl", "vec3 offset = sky_reach(ring) * normalize("));
  CHECK(holds("occlusion.glsl", "return 1.2 * (edges.w * grain_at(p)) * n;"));
  CHECK(holds("volume.glsl", "stored_normal(p + 1.25 * grain * (vec3("));
  CHECK(holds("volume.glsl", "density_at(p + 0.5 * grain * corner)"));
  CHECK(holds("shadow.glsl", "vec3 start = 1.5 * voxel * n;"));
  CHECK(holds("shadow.glsl", "i < 28"));
  CHECK(holds("shadow.glsl", "way += min(0.7 * voxel * pow(1.08, float(i)), 0.001);"));
  CHECK(holds("tissue.glsl", "vec3 before = p + 0.75 * grain_at(p) * outward;"));
  // Lengths near the faces of a detail are at most those of coarse voxels, in which changes of a bone in two levels are given.
  CHECK(holds("volume.glsl", "return mix(part.w, 1.0, smoothstep("));
  const Reach surface = reach_of({.appearance = {.occlusion = true}}, 0.25e-3);
  CHECK(surface.metres == 0.0);
  CHECK(surface.occlusion == doctest::Approx(0.0011 * std::exp2(2.3) + 1.2 * 0.25e-3));
  CHECK(surface.with_occlusion().metres == surface.occlusion);
  CHECK(surface.voxels + surface.occlusion / 0.25e-3 > 2.25);
  CHECK(reach_of({.finish = false}, 0.25e-3).metres == 0.0);
  CHECK(reach_of({.finish = false}, 0.25e-3).voxels >= 1.0);
  CHECK(reach_of({.finish = false, .appearance = {.normals = NormalSource::recomputed}}, 0.25e-3).voxels >= 1.5);
  CHECK(reach_of({.finish = false, .appearance = {.tissue = true}}, 0.25e-3).voxels >= 1.75);
  CHECK(reach_of({.finish = true}, 0.25e-3).voxels >= 2.25);
  const Reach both = reach_of({.appearance = {.occlusion = true, .shadow = true}}, 0.25e-3);
  CHECK(both.occlusion == 0.0);
  CHECK(both.metres > surface.occlusion);
  const double shaded = reach_of({.appearance = {.shadow = true}}, 0.25e-3).metres;
  CHECK(shaded > 14e-3);
  CHECK(shaded < 17e-3);
}
